//! [`Patch`]: some disks that are integrated separately over one long step. The motion of the surrounding disks is
//! given.
//!
//! ```text
//! w(x) = w_1 (3x² − 2x³) + h v_0 (x − 2x² + x³) + h v_1 (x³ − x²)        0 ≤ x = t/h ≤ 1
//! ```
//!
//! w is the displacement of an outer disk, h the long step.

use crate::forces::damped::damped_forces;
use crate::law::damping::ContactDamping;
use crate::law::pair_law::PairLaw;
use crate::neighbours::pair_list::PairList;
use crate::relax::dynamics::implicit::rkc::coefficients::{Chebyshev, Stiffness};
use crate::relax::dynamics::implicit::rkc::stages::{Stages, estimated_error};
use crate::relax::dynamics::implicit::step_control::{LARGEST_RATIO, step_ratio};
use crate::vector::{Vector, difference, larger, sum};

/// Ratio of the long step to the first short step. It is an initial guess that the error control corrects at once.
const FIRST_PARTS: f64 = 4.0;

/// Largest number of short steps, rejected ones included. If more are needed, the long step is much too long.
const MOST_STEPS: usize = 500;

/// No index.
const ABSENT: u32 = u32::MAX;

/// The disks whose errors are too large for the long step, and the accuracy they need.
pub(crate) struct PatchDisks<'a, S> {
    /// Length of the long step \[time\].
    pub(crate) time_step: f64,
    pub(crate) stiffness: Stiffness,
    /// Disks whose errors are too large.
    pub(crate) disks: &'a [u32],
    /// Ratio of an error of a disk \[length\] to the allowed one.
    pub(crate) share: S,
}

/// Inner disks, and the outer disks around them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Patch<const D: usize> {
    /// The inner disks, which move, then the outer disks; numbers in working order.
    pub(crate) disks: Vec<u32>,
    /// Which of the inner disks belong to the last shell.
    pub(crate) last_shell: Vec<bool>,
    /// Index in the patch of each disk of the packing.
    places: Vec<u32>,
    /// Every pair of an inner disk that may touch: its ends, and its index in the list of all pairs.
    found: Vec<([u32; 2], u32)>,
    starts: Vec<u32>,
    seconds: Vec<(u32, u32)>,
    pairs: PairList<D>,
    damping: Vec<f64>,
    /// Positions at the start of the long step, displacements in it, and velocities at its start and end.
    start: Vec<Vector<D>>,
    moved: Vec<Vector<D>>,
    start_velocity: Vec<Vector<D>>,
    end_velocity: Vec<Vector<D>>,
    /// Positions, forces and power of damping; the velocities are in `stages`.
    pub(crate) displacements: Vec<Vector<D>>,
    pub(crate) forces: Vec<Vector<D>>,
    pub(crate) power: f64,
    stages: Stages<D>,
    /// The inner disks at the start of a short step.
    before: Before<D>,
    /// Forces at the end of the long step.
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

/// The result of the long step in a patch.
pub(crate) struct LongStep {
    /// Work of damping \[energy\].
    pub(crate) work: f64,
    /// Its power at the end \[energy / time\].
    pub(crate) power: f64,
}

impl<const D: usize> Patch<D> {
    /// Sets the number of disks of the packing.
    pub(crate) fn set_disk_count(&mut self, disk_count: usize) {
        self.places.clear();
        self.places.resize(disk_count, ABSENT);
    }

    /// Removes all disks.
    pub(crate) fn begin(&mut self) {
        self.disks.clear();
        self.found.clear();
        for column in [&mut self.start, &mut self.moved, &mut self.start_velocity, &mut self.end_velocity] {
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
        self.places[disk as usize] != ABSENT
    }

    /// Index of a disk in the patch.
    pub(crate) fn place(&self, disk: u32) -> Option<usize> {
        self.has(disk).then(|| self.places[disk as usize] as usize)
    }

    /// Marks the disks so far as the inner ones.
    pub(crate) fn close_inside(&mut self, is_last: impl Fn(u32) -> bool) {
        self.last_shell.clear();
        self.last_shell.extend(self.disks.iter().map(|&disk| is_last(disk)));
    }

    /// Number of inner disks.
    pub(crate) fn inside_count(&self) -> usize {
        self.last_shell.len()
    }

    /// Adds a pair of two disks of the patch, by its index in the list of all pairs.
    pub(crate) fn add_pair(&mut self, pair: usize, ends: [u32; 2]) {
        self.found.push((ends.map(|end| self.places[end as usize]), pair as u32));
    }

    /// Completes the patch after all disks and pairs were added.
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
            self.places[disk as usize] = ABSENT;
        }
    }

    /// Sets the damping coefficients, from the radii of all disks.
    pub(crate) fn set_damping(&mut self, damping: &ContactDamping, radii: &[f64]) {
        let radius = |place: u32| radii[self.disks[place as usize] as usize];
        let ends = self.pairs.first.iter().zip(&self.pairs.second);
        self.damping.clear();
        self.damping.extend(ends.map(|(&i, &j)| damping.coefficient(radius(i), radius(j))));
    }

    /// Sets the motion of the next disk: position at the end of the long step, displacement in it, and velocities at
    /// its start and end.
    pub(crate) fn set_course(&mut self, end: Vector<D>, moved: Vector<D>, velocities: [Vector<D>; 2]) {
        self.start.push(difference(end, moved));
        self.moved.push(moved);
        self.start_velocity.push(velocities[0]);
        self.end_velocity.push(velocities[1]);
    }

    /// Velocities of the inner disks.
    pub(crate) fn velocities(&self) -> &[Vector<D>] {
        &self.stages.velocity[..self.inside_count()]
    }

    /// Pairs evaluated since the last call.
    pub(crate) fn take_pair_count(&mut self) -> usize {
        std::mem::take(&mut self.pair_count)
    }

    /// Repeats the long step, of length h \[time\], with interpolated outer disks. Stores its forces.
    pub(crate) fn long_step(
        &mut self,
        laws: (&dyn PairLaw, &ContactDamping),
        time_step: f64,
        method: &Chebyshev,
    ) -> LongStep {
        self.set_start(laws);
        let (work, _) = self.step(laws, method, [0.0, time_step, time_step]);
        for ((at, &start), &moved) in self.displacements.iter_mut().zip(&self.start).zip(&self.moved) {
            *at = sum(start, moved);
        }
        self.stages.velocity.copy_from_slice(&self.end_velocity);
        self.evaluate(laws);
        self.long_forces.clone_from(&self.forces);
        LongStep { work, power: self.power }
    }

    /// Takes short steps over the long step. Returns the work of damping. Returns None if there are too many steps, or
    /// if a disk would move farther than `longest`.
    pub(crate) fn short_steps(
        &mut self,
        laws: (&dyn PairLaw, &ContactDamping),
        longest: f64,
        fast: &PatchDisks<'_, impl Fn(usize, f64) -> f64>,
    ) -> Option<f64> {
        self.set_start(laws);
        let whole = fast.time_step;
        let (mut time, mut time_step) = (0.0, whole / FIRST_PARTS);
        let (mut work, mut reach) = (0.0, 0.0);
        for _ in 0..MOST_STEPS {
            let left = whole - time;
            let last = time_step > 0.99 * left;
            if last {
                time_step = left;
            }
            let method = Chebyshev::new(fast.stiffness.stage_count(time_step));
            let (step_work, step_reach) = self.step(laws, &method, [time, time_step, whole]);
            let mut share = 0.0;
            for place in 0..self.inside_count() {
                let velocities = [self.before.velocities[place], self.stages.velocity[place]];
                let forces = [self.before.forces[place], self.forces[place]];
                let error = estimated_error(time_step, self.stages.moved[place], velocities, forces);
                share = larger((fast.share)(self.disks[place] as usize, error), share);
            }
            if share <= 1.0 {
                (work, reach) = (work + step_work, reach + step_reach);
                // The bound is per component.
                if reach * (D as f64).sqrt() > longest {
                    return None;
                }
                if last {
                    return Some(work);
                }
                time += time_step;
                let count = self.inside_count();
                self.before.velocities.copy_from_slice(&self.stages.velocity[..count]);
                self.remember();
            }
            time_step *= step_ratio(share, LARGEST_RATIO);
        }
        None
    }

    /// Sets everything to the start of the long step.
    fn set_start(&mut self, laws: (&dyn PairLaw, &ContactDamping)) {
        self.displacements.clone_from(&self.start);
        self.stages.velocity.clone_from(&self.start_velocity);
        self.forces.resize(self.disks.len(), [0.0; D]);
        self.evaluate(laws);
        self.before.velocities.clear();
        self.before.velocities.extend_from_slice(&self.start_velocity[..self.inside_count()]);
        self.remember();
    }

    /// Stores the present positions and forces as the start of the next step. The caller sets the velocities.
    fn remember(&mut self) {
        let count = self.inside_count();
        self.before.displacements.clear();
        self.before.displacements.extend_from_slice(&self.displacements[..count]);
        self.before.forces.clear();
        self.before.forces.extend_from_slice(&self.forces[..count]);
        self.before.power = self.power;
    }

    /// One short step of the inner disks at this time of the long step. Returns the work of damping and a bound on
    /// displacements.
    fn step(
        &mut self,
        laws: (&dyn PairLaw, &ContactDamping),
        method: &Chebyshev,
        [time, time_step, whole]: [f64; 3],
    ) -> (f64, f64) {
        let count = self.inside_count();
        self.stages.begin(&self.before.velocities, self.disks.len());
        self.displacements[..count].copy_from_slice(&self.before.displacements);
        self.forces[..count].copy_from_slice(&self.before.forces);
        self.power = self.before.power;
        let (mut work, mut earlier_work, mut reach) = (0.0, 0.0, 0.0);
        for terms in &method.stages {
            let slopes = [terms.slope, terms.start_slope].map(|factor| time_step * factor);
            let start = (self.before.velocities.as_flattened(), self.before.forces.as_flattened());
            let displacements = self.displacements[..count].as_flattened_mut();
            let (change, _) = self.stages.advance(terms, slopes, start, self.forces.as_flattened(), displacements);
            reach += change;
            let next_work = terms.last * work
                + terms.earlier * earlier_work
                + slopes[0] * self.power
                + slopes[1] * self.before.power;
            (earlier_work, work) = (work, next_work);
            self.set_around(whole, (time + terms.time * time_step) / whole);
            self.evaluate(laws);
        }
        (work, reach)
    }

    /// Interpolates the outer disks at this fraction x of the long step h.
    fn set_around(&mut self, h: f64, x: f64) {
        let rest = 1.0 - x;
        let position = [x * x * (3.0 - 2.0 * x), h * x * rest * rest, -h * x * x * rest];
        let slope = [6.0 * x * rest / h, rest * (1.0 - 3.0 * x), x * (3.0 * x - 2.0)];
        for place in self.inside_count()..self.disks.len() {
            let terms = [self.moved[place], self.start_velocity[place], self.end_velocity[place]];
            let summed = |factors: [f64; 3]| -> Vector<D> {
                std::array::from_fn(|d| factors[0] * terms[0][d] + factors[1] * terms[1][d] + factors[2] * terms[2][d])
            };
            self.displacements[place] = sum(self.start[place], summed(position));
            self.stages.velocity[place] = summed(slope);
        }
    }

    /// Evaluates forces and power at the present positions.
    fn evaluate(&mut self, laws: (&dyn PairLaw, &ContactDamping)) {
        self.pair_count += self.pairs.len();
        let (at, velocities) = (&self.displacements, &self.stages.velocity);
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
        patch.stages.velocity = vec![[0.0; 2]];
        for k in 0..=10 {
            let x = f64::from(k) / 10.0;
            patch.set_around(h, x);
            let (found, velocity) = (patch.displacements[0], patch.stages.velocity[0]);
            assert!((found[0] - at(x * h)).abs() < 1e-15 && found[1] == 0.0, "{found:?}");
            // The terms are up to 6/h.
            assert!((velocity[0] - speed(x * h)).abs() < 1e-14 && velocity[1] == 0.0, "{velocity:?}");
        }
    }
}
