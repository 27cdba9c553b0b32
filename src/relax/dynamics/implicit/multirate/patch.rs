//! [`Patch`]: some disks that are moved by themselves over one step of all, between others whose course is known.
//!
//! ```text
//! w(x) = w_1 (3x² − 2x³) + h v_0 (x − 2x² + x³) + h v_1 (x³ − x²)        0 ≤ x = t/h ≤ 1: way of a disk outside, h the step of all
//! ```

use crate::forces::damped::damped_forces;
use crate::law::damping::DampingLaw;
use crate::law::pair_law::PairLaw;
use crate::neighbours::pair_list::PairList;
use crate::relax::dynamics::implicit::rkc::coefficients::{Chebyshev, Stiffness};
use crate::relax::dynamics::implicit::rkc::stages::{Chain, estimated_error};
use crate::relax::dynamics::implicit::step_control::{LARGEST_GROWTH, growth};
use crate::vector::{Vector, difference, larger, sum};

/// The first step of a patch is the step of all over this: a guess, which its errors lengthen or shorten at once.
const FIRST_PARTS: f64 = 4.0;

/// Most steps of a patch, rejected ones included: with more the step of all is too long by far.
const MOST_STEPS: usize = 500;

/// No place.
const NOWHERE: u32 = u32::MAX;

/// Which disks are to be moved again, and how exactly.
pub(crate) struct Refine<'a, S> {
    /// Length of the step that was too long for them \[time\].
    pub(crate) time_step: f64,
    pub(crate) stiffness: Stiffness,
    /// Disks whose errors are too large.
    pub(crate) disks: &'a [u32],
    /// What an error of a disk \[length\] is over the one allowed.
    pub(crate) share: S,
}

/// Some disks, and those around them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Patch<const D: usize> {
    /// The disks inside, which move, then those around them, in working order's numbers.
    pub(crate) disks: Vec<u32>,
    /// Which of the disks inside are of the last shell.
    pub(crate) last_shell: Vec<bool>,
    /// Place of each disk of the packing.
    places: Vec<u32>,
    /// Every pair of a disk inside that may touch: its ends and its place in the list of all.
    found: Vec<([u32; 2], u32)>,
    starts: Vec<u32>,
    seconds: Vec<(u32, u32)>,
    pairs: PairList<D>,
    damping: Vec<f64>,
    /// Where each disk was at the start of the step of all, its way in it, velocities at its start and end.
    start: Vec<Vector<D>>,
    way: Vec<Vector<D>>,
    start_velocity: Vec<Vector<D>>,
    end_velocity: Vec<Vector<D>>,
    /// Where the disks are, forces and power of damping there; velocities are in the chain.
    pub(crate) displacements: Vec<Vector<D>>,
    pub(crate) forces: Vec<Vector<D>>,
    pub(crate) power: f64,
    chain: Chain<D>,
    /// The disks inside at the start of a step of the patch.
    before: Before<D>,
    /// Forces at the end of the step of all.
    pub(crate) long_forces: Vec<Vector<D>>,
    pair_count: usize,
}

#[derive(Debug, Clone, Default)]
struct Before<const D: usize> {
    displacements: Vec<Vector<D>>,
    velocities: Vec<Vector<D>>,
    forces: Vec<Vector<D>>,
    power: f64,
}

/// What the step of all came to in a patch.
pub(crate) struct AtOnce {
    /// Work of damping \[energy\].
    pub(crate) work: f64,
    /// Its power at the end \[energy / time\].
    pub(crate) power: f64,
}

impl<const D: usize> Patch<D> {
    /// For a packing of so many disks.
    pub(crate) fn set_disk_count(&mut self, disk_count: usize) {
        self.places.clear();
        self.places.resize(disk_count, NOWHERE);
    }

    /// Without disks.
    pub(crate) fn begin(&mut self) {
        self.disks.clear();
        self.found.clear();
        for column in [&mut self.start, &mut self.way, &mut self.start_velocity, &mut self.end_velocity] {
            column.clear();
        }
    }

    /// Adds a disk that is not in the patch yet.
    pub(crate) fn add(&mut self, disk: u32) {
        if !self.has(disk) {
            self.places[disk as usize] = self.disks.len() as u32;
            self.disks.push(disk);
        }
    }

    pub(crate) fn has(&self, disk: u32) -> bool {
        self.places[disk as usize] != NOWHERE
    }

    /// Place of a disk in the patch.
    pub(crate) fn place(&self, disk: u32) -> Option<usize> {
        self.has(disk).then(|| self.places[disk as usize] as usize)
    }

    /// The disks so far are those inside.
    pub(crate) fn close_inside(&mut self, is_last: impl Fn(u32) -> bool) {
        self.last_shell.clear();
        self.last_shell.extend(self.disks.iter().map(|&disk| is_last(disk)));
    }

    /// How many disks are inside.
    pub(crate) fn inside_count(&self) -> usize {
        self.last_shell.len()
    }

    /// Adds a pair of two disks in the patch, by its place in the list of all.
    pub(crate) fn add_pair(&mut self, pair: usize, ends: [u32; 2]) {
        self.found.push((ends.map(|end| self.places[end as usize]), pair as u32));
    }

    /// All disks and pairs are there.
    pub(crate) fn close(&mut self, whole: &PairList<D>) {
        self.found.sort_unstable();
        self.starts.clear();
        self.starts.resize(self.disks.len() + 1, 0);
        self.seconds.clear();
        for &([first, second], pair) in &self.found {
            self.starts[first as usize + 1] += 1;
            self.seconds.push((second, pair));
        }
        for place in 0..self.disks.len() {
            self.starts[place + 1] += self.starts[place];
        }
        self.pairs.select(whole, &self.starts, &self.seconds);
        for &disk in &self.disks {
            self.places[disk as usize] = NOWHERE;
        }
    }

    /// Coefficients of damping, by the radii of all disks.
    pub(crate) fn set_damping(&mut self, damping: &impl DampingLaw, radii: &[f64]) {
        let radius = |place: u32| radii[self.disks[place as usize] as usize];
        let ends = self.pairs.first.iter().zip(&self.pairs.second);
        self.damping.clear();
        self.damping.extend(ends.map(|(&i, &j)| damping.coefficient(radius(i), radius(j))));
    }

    /// The course of the next disk: displacement at the end of the step of all, way in it, velocities at its start and end.
    pub(crate) fn set_course(&mut self, end: Vector<D>, way: Vector<D>, velocities: [Vector<D>; 2]) {
        self.start.push(difference(end, way));
        self.way.push(way);
        self.start_velocity.push(velocities[0]);
        self.end_velocity.push(velocities[1]);
    }

    /// Velocities of the disks inside.
    pub(crate) fn velocities(&self) -> &[Vector<D>] {
        &self.chain.velocity[..self.inside_count()]
    }

    /// Pairs evaluated since the last call.
    pub(crate) fn take_pair_count(&mut self) -> usize {
        std::mem::take(&mut self.pair_count)
    }

    /// The step of all once more, of length h \[time\], with what is around as everywhere here; leaves its forces.
    pub(crate) fn go_at_once<L: PairLaw, C: DampingLaw>(
        &mut self,
        laws: (&L, &C),
        time_step: f64,
        method: &Chebyshev,
    ) -> AtOnce {
        self.set_start(laws);
        let (work, _) = self.step(laws, method, [0.0, time_step, time_step]);
        for ((at, &start), &way) in self.displacements.iter_mut().zip(&self.start).zip(&self.way) {
            *at = sum(start, way);
        }
        self.chain.velocity.copy_from_slice(&self.end_velocity);
        self.evaluate(laws);
        self.long_forces.clone_from(&self.forces);
        AtOnce { work, power: self.power }
    }

    /// All steps of the patch over the step of all; the work of damping. None if there would be too many, or a disk would go
    /// farther than `longest`.
    pub(crate) fn refine<L: PairLaw, C: DampingLaw>(
        &mut self,
        laws: (&L, &C),
        longest: f64,
        refine: &Refine<'_, impl Fn(usize, f64) -> f64>,
    ) -> Option<f64> {
        self.set_start(laws);
        let whole = refine.time_step;
        let (mut time, mut time_step) = (0.0, whole / FIRST_PARTS);
        let (mut work, mut way) = (0.0, 0.0);
        for _ in 0..MOST_STEPS {
            let left = whole - time;
            let last = time_step > 0.99 * left;
            if last {
                time_step = left;
            }
            let method = Chebyshev::new(refine.stiffness.stage_count(time_step));
            let (step_work, step_way) = self.step(laws, &method, [time, time_step, whole]);
            let mut share = 0.0;
            for place in 0..self.inside_count() {
                let velocities = [self.before.velocities[place], self.chain.velocity[place]];
                let forces = [self.before.forces[place], self.forces[place]];
                let error = estimated_error(time_step, self.chain.way[place], velocities, forces);
                share = larger((refine.share)(self.disks[place] as usize, error), share);
            }
            if share <= 1.0 {
                (work, way) = (work + step_work, way + step_way);
                // Of each coordinate.
                if way * (D as f64).sqrt() > longest {
                    return None;
                }
                if last {
                    return Some(work);
                }
                time += time_step;
                let count = self.inside_count();
                self.before.velocities.copy_from_slice(&self.chain.velocity[..count]);
                self.remember();
            }
            time_step *= growth(share, LARGEST_GROWTH);
        }
        None
    }

    /// Everything where the step of all starts.
    fn set_start<L: PairLaw, C: DampingLaw>(&mut self, laws: (&L, &C)) {
        self.displacements.clone_from(&self.start);
        self.chain.velocity.clone_from(&self.start_velocity);
        self.forces.resize(self.disks.len(), [0.0; D]);
        self.evaluate(laws);
        self.before.velocities.clear();
        self.before.velocities.extend_from_slice(&self.start_velocity[..self.inside_count()]);
        self.remember();
    }

    /// Where the disks are becomes the start of the next step; velocities are set by who calls.
    fn remember(&mut self) {
        let count = self.inside_count();
        self.before.displacements.clear();
        self.before.displacements.extend_from_slice(&self.displacements[..count]);
        self.before.forces.clear();
        self.before.forces.extend_from_slice(&self.forces[..count]);
        self.before.power = self.power;
    }

    /// One step of the disks inside, at this time of the step of all; the work of damping, and a bound on how far a coordinate went.
    fn step<L: PairLaw, C: DampingLaw>(
        &mut self,
        laws: (&L, &C),
        method: &Chebyshev,
        [time, time_step, whole]: [f64; 3],
    ) -> (f64, f64) {
        let count = self.inside_count();
        self.chain.begin(&self.before.velocities, self.disks.len());
        self.displacements[..count].copy_from_slice(&self.before.displacements);
        self.forces[..count].copy_from_slice(&self.before.forces);
        self.power = self.before.power;
        let (mut work, mut earlier_work, mut way) = (0.0, 0.0, 0.0);
        for terms in &method.stages {
            let slopes = [terms.slope, terms.start_slope].map(|factor| time_step * factor);
            let start = (self.before.velocities.as_flattened(), self.before.forces.as_flattened());
            let displacements = self.displacements[..count].as_flattened_mut();
            let (change, _) = self.chain.go(terms, slopes, start, self.forces.as_flattened(), displacements);
            way += change;
            let next_work = terms.last * work
                + terms.earlier * earlier_work
                + slopes[0] * self.power
                + slopes[1] * self.before.power;
            (earlier_work, work) = (work, next_work);
            self.set_around(whole, (time + terms.time * time_step) / whole);
            self.evaluate(laws);
        }
        (work, way)
    }

    /// The disks around where they are at this share x of the step h of all.
    fn set_around(&mut self, h: f64, x: f64) {
        let rest = 1.0 - x;
        let way = [x * x * (3.0 - 2.0 * x), h * x * rest * rest, -h * x * x * rest];
        let slope = [6.0 * x * rest / h, rest * (1.0 - 3.0 * x), x * (3.0 * x - 2.0)];
        for place in self.inside_count()..self.disks.len() {
            let terms = [self.way[place], self.start_velocity[place], self.end_velocity[place]];
            let summed = |factors: [f64; 3]| -> Vector<D> {
                std::array::from_fn(|d| factors[0] * terms[0][d] + factors[1] * terms[1][d] + factors[2] * terms[2][d])
            };
            self.displacements[place] = sum(self.start[place], summed(way));
            self.chain.velocity[place] = summed(slope);
        }
    }

    /// Forces and power where the disks are.
    fn evaluate<L: PairLaw, C: DampingLaw>(&mut self, laws: (&L, &C)) {
        self.pair_count += self.pairs.len();
        let (at, velocities) = (&self.displacements, &self.chain.velocity);
        self.power = damped_forces(laws, &self.pairs, &self.damping, at, velocities, &mut self.forces);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disks_around_follow_any_cubic() {
        // u = 1 + 2t − 3t² + 4t³ from t = 0 to h.
        let (h, at) = (0.5, |t: f64| 1.0 + t * (2.0 + t * (-3.0 + 4.0 * t)));
        let speed = |t: f64| 2.0 + t * (-6.0 + 12.0 * t);
        let mut patch = Patch::<2>::default();
        patch.set_disk_count(1);
        patch.add(0);
        patch.set_course([at(h), 0.0], [at(h) - at(0.0), 0.0], [[speed(0.0), 0.0], [speed(h), 0.0]]);
        patch.displacements = vec![[0.0; 2]];
        patch.chain.velocity = vec![[0.0; 2]];
        for k in 0..=10 {
            let x = f64::from(k) / 10.0;
            patch.set_around(h, x);
            let (found, velocity) = (patch.displacements[0], patch.chain.velocity[0]);
            assert!((found[0] - at(x * h)).abs() < 1e-15 && found[1] == 0.0, "{found:?}");
            // Of terms up to 6/h.
            assert!((velocity[0] - speed(x * h)).abs() < 1e-14 && velocity[1] == 0.0, "{velocity:?}");
        }
    }
}
