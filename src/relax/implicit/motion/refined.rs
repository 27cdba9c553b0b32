//! Stabilised steps that are too long for a few disks, made again with shorter ones around those disks only.
//!
//! Where a contact opens or closes, the error of a step is thousands of times that of the rest of the packing. Each such disk is
//! taken with its surroundings, some shells of contacts, and that [`Patch`] is moved once more from the start of the step to
//! its end, in steps as long as its own errors allow; the disks around it move as the long step found them. So every disk has
//! the error that is allowed, and the work of an event is that of its surroundings. What a patch would have done to the disks
//! around it is left out: those of its last shell must be where the long step found them, to a share of the error allowed.
//! The momentum that is left out with it goes to all disks alike where nothing holds them: else a packing would end in a drift
//! that no contact damps.
//!
//! # Source
//! Savcenco, Hundsdorfer, Verwer (2007), BIT Numer. Math. 47, 137: first one step for all, then shorter ones for the components
//! whose error is too large, with the others interpolated.

use crate::forces::assembly::Assembly;
use crate::forces::elastic::geometry;
use crate::law::damping::DampingLaw;
use crate::law::pair_law::PairLaw;
use crate::neighbours::pair_list::PairList;
use crate::packing::PackingError;
use crate::relax::implicit::chebyshev::{Chebyshev, Stiffness};
use crate::relax::implicit::motion::ImplicitMotion;
use crate::relax::implicit::motion::patch::Patch;
use crate::relax::implicit::motion::stabilised::measure;
use crate::vector::{Vector, difference, larger, norm, scaled, sum};

/// Change of the last shell of a patch over the error allowed, at most: the disks around, which are not moved again, would change by less.
const OUTSIDE: f64 = 0.5;

/// Shells of a patch beyond those its disks push in one step, of which there are [`PUSHED`] √(hλ).
const LEAST_SHELLS: u32 = 1;

/// See [`LEAST_SHELLS`]. Of 3000 to 4000 steps of 16 508 disks at p = 10 patches fail in 3 at 1, in 34 at 1/2 and in 461 at 0.3; at 1 the whole
/// motion takes a third longer, at 0.3 as long as at 1/2.
const PUSHED: f64 = 0.5;

/// Disks in patches over all that can move, at most: with more a shorter step of all costs less.
const MOST_DISKS: f64 = 0.25;

/// Way of a disk of a patch over the longest of the long step there, at most. The list of pairs must hold for such ways.
const LONGEST_WAY: f64 = 4.0;

/// How far the list should hold over the width of the skin; half of it is the most a list can.
const LISTED: f64 = 0.25;

/// Not in a patch.
const OUT: u32 = u32::MAX;

/// In a patch that is done.
const DONE: u32 = u32::MAX - 1;

/// Which disks are to be moved again, and how exactly.
pub(in crate::relax::implicit) struct Refine<'a, S> {
    /// Length of the step that was too long for them \[time\].
    pub(in crate::relax::implicit) time_step: f64,
    pub(in crate::relax::implicit) stiffness: Stiffness,
    /// Disks whose errors are too large.
    pub(in crate::relax::implicit) disks: &'a [u32],
    /// What an error of a disk \[length\] is over the one allowed.
    pub(in crate::relax::implicit) share: S,
}

/// Buffers of patches.
#[derive(Debug, Clone, Default)]
pub(super) struct Refinement<const D: usize> {
    /// Pairs of each disk, and which list they are of.
    starts: Vec<u32>,
    pairs: Vec<u32>,
    list: usize,
    /// Shell of each disk around those whose errors are too large; `OUT`, `DONE`.
    shells: Vec<u32>,
    /// Disks of all patches, shell by shell.
    inside: Vec<u32>,
    patch: Patch<D>,
    /// Pairs evaluated in patches that are not in the count of evaluations yet.
    pair_count: usize,
}

impl<const D: usize> Refinement<D> {
    /// Pairs of each disk, if the list is a new one.
    fn set_list(&mut self, pairs: &PairList<D>, disk_count: usize, list: usize) {
        if self.list == list && self.shells.len() == disk_count {
            return;
        }
        self.list = list;
        self.starts.clear();
        self.starts.resize(disk_count + 1, 0);
        for pair in pairs.numbers() {
            self.starts[pairs.first[pair] as usize + 1] += 1;
            self.starts[pairs.second[pair] as usize + 1] += 1;
        }
        for disk in 0..disk_count {
            self.starts[disk + 1] += self.starts[disk];
        }
        self.pairs.clear();
        self.pairs.resize(2 * pairs.len(), 0);
        for pair in pairs.numbers() {
            for disk in [pairs.first[pair], pairs.second[pair]] {
                self.pairs[self.starts[disk as usize] as usize] = pair as u32;
                self.starts[disk as usize] += 1;
            }
        }
        // Each start has run to that of the next disk.
        self.starts.rotate_right(1);
        self.starts[0] = 0;
        self.shells.clear();
        self.shells.resize(disk_count, OUT);
        self.patch.set_disk_count(disk_count);
    }

    /// Pairs of a disk, each with the other disk.
    fn pairs_of<'a>(&'a self, pairs: &'a PairList<D>, disk: u32) -> impl Iterator<Item = (usize, u32)> + 'a {
        let places = self.starts[disk as usize] as usize..self.starts[disk as usize + 1] as usize;
        self.pairs[places].iter().map(move |&pair| {
            let pair = pair as usize;
            (pair, if pairs.first[pair] == disk { pairs.second[pair] } else { pairs.first[pair] })
        })
    }

    /// Takes shells of contacts around some disks, of those that can move; gaps up to `margin` are contacts. Whether there are no
    /// more than `most` of them.
    fn set_shells<L: PairLaw>(
        &mut self,
        assembly: &Assembly<D, L>,
        (disks, last): (&[u32], u32),
        (margin, most): (f64, usize),
    ) -> bool {
        let (pairs, mobile) = (assembly.pairs(), assembly.mobile_count() as u32);
        self.inside.clear();
        self.inside.extend_from_slice(disks);
        for &disk in disks {
            self.shells[disk as usize] = 0;
        }
        let mut shells = std::mem::take(&mut self.shells);
        let mut inside = std::mem::take(&mut self.inside);
        let mut next = 0;
        while next < inside.len() && inside.len() <= most {
            let disk = inside[next];
            next += 1;
            let shell = shells[disk as usize];
            if shell == last {
                break;
            }
            for (pair, other) in self.pairs_of(pairs, disk) {
                let new = other < mobile && shells[other as usize] == OUT;
                if new && geometry(pairs, pair, &assembly.displacements).2 > -margin {
                    shells[other as usize] = shell + 1;
                    inside.push(other);
                }
            }
        }
        (self.shells, self.inside) = (shells, inside);
        self.inside.len() <= most
    }

    /// The patch of a disk: all disks inside that hang together with it by pairs of the list, and those around them; how far a
    /// disk of it may go \[length\]. Pairs too far apart to touch then are left out.
    fn set_patch(
        &mut self,
        (pairs, displacements): (&PairList<D>, &[Vector<D>]),
        moved: &[Vector<D>],
        (disk, last): (u32, u32),
    ) -> f64 {
        let mut patch = std::mem::take(&mut self.patch);
        patch.begin();
        patch.add(disk);
        let mut next = 0;
        while next < patch.disks.len() {
            for (_, other) in self.pairs_of(pairs, patch.disks[next]) {
                if self.shells[other as usize] < DONE && !patch.has(other) {
                    patch.add(other);
                }
            }
            next += 1;
        }
        patch.close_inside(|disk| self.shells[disk as usize] == last);
        let way = |disk: u32| moved.get(disk as usize).map_or(0.0, |&way| norm(way));
        let around =
            patch.disks.iter().flat_map(|&disk| self.pairs_of(pairs, disk).map(|(_, other)| other).chain([disk]));
        let longest = LONGEST_WAY * around.map(way).fold(0.0, |most, way| larger(way, most));
        for inside in 0..patch.inside_count() {
            let disk = patch.disks[inside];
            for (pair, other) in self.pairs_of(pairs, disk) {
                // Each pair is met from both its disks if both are inside.
                let met = patch.place(other).is_some_and(|place| place < inside);
                // Both disks may come nearer.
                if !met && geometry(pairs, pair, displacements).2 > -2.0 * longest {
                    patch.add(other);
                    patch.add_pair(pair, [pairs.first[pair], pairs.second[pair]]);
                }
            }
        }
        patch.close(pairs);
        self.patch = patch;
        longest
    }

    fn leave(&mut self) {
        for &disk in &self.inside {
            self.shells[disk as usize] = OUT;
        }
    }
}

impl<const D: usize, L: PairLaw, C: DampingLaw> ImplicitMotion<D, L, C> {
    /// Makes the last stabilised step again around some disks. False if that cannot be done: the step is to be taken back then.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(in crate::relax::implicit) fn refine(
        &mut self,
        refine: &Refine<'_, impl Fn(usize, f64) -> f64>,
    ) -> Result<bool, PackingError> {
        let longest = LONGEST_WAY * self.moved.iter().fold(0.0, |most, &way| larger(norm(way), most));
        if self.assembly.listed_way() < longest.min(LISTED * self.assembly.skin()) {
            self.assembly.reanchor()?;
            self.set_damping_coefficients();
        }
        let mut refinement = std::mem::take(&mut self.refinement);
        let assembly = &self.assembly;
        refinement.set_list(assembly.pairs(), assembly.len(), assembly.rebuild_count());
        let shells = LEAST_SHELLS + (PUSHED * (refine.time_step * refine.stiffness.decay).sqrt()) as u32;
        let most = (MOST_DISKS * assembly.mobile_count() as f64) as usize;
        let momentum = total(&self.velocities);
        let change = if refinement.set_shells(assembly, (refine.disks, shells), (self.margin, most)) {
            self.refine_patches(shells, refine, &mut refinement)
        } else {
            None
        };
        refinement.leave();
        refinement.pair_count += refinement.patch.take_pair_count();
        let all = self.assembly.pairs().len().max(1);
        self.work.evaluation_count += refinement.pair_count / all;
        refinement.pair_count %= all;
        self.refinement = refinement;
        let Some(change) = change else { return Ok(false) };
        if self.is_free() {
            self.lose(difference(total(&self.velocities), momentum));
        }
        if self.assembly.keep_listed(change)? {
            self.set_damping_coefficients();
        }
        Ok(true)
    }

    /// Whether the disks push each other only, and their momentum stays.
    fn is_free(&self) -> bool {
        self.assembly.mobile_count() == self.assembly.len() && !self.assembly.law().has_sites()
    }

    /// Takes this momentum from all disks alike: bonds, and so forces, are as they were.
    fn lose(&mut self, momentum: Vector<D>) {
        let kick = scaled(-1.0 / self.velocities.len() as f64, momentum);
        for velocity in &mut self.velocities {
            *velocity = sum(*velocity, kick);
        }
    }

    /// The longest change of a disk by all patches; none if one failed.
    fn refine_patches(
        &mut self,
        shells: u32,
        refine: &Refine<'_, impl Fn(usize, f64) -> f64>,
        refinement: &mut Refinement<D>,
    ) -> Option<f64> {
        let mut change = 0.0;
        for &disk in refine.disks {
            if refinement.shells[disk as usize] == DONE {
                continue;
            }
            let listed = (self.assembly.pairs(), self.assembly.displacements.as_slice());
            let longest = refinement.set_patch(listed, &self.moved, (disk, shells));
            if longest > self.assembly.listed_way() {
                return None;
            }
            change = larger(self.refine_patch(longest, refine, &mut refinement.patch)?, change);
            let Refinement { patch, shells, .. } = refinement;
            for &disk in &patch.disks[..patch.inside_count()] {
                shells[disk as usize] = DONE;
            }
        }
        Some(change)
    }

    /// The longest change of a disk; none if the patch could not be made again.
    fn refine_patch(
        &mut self,
        longest: f64,
        refine: &Refine<'_, impl Fn(usize, f64) -> f64>,
        patch: &mut Patch<D>,
    ) -> Option<f64> {
        let (law, time_step) = (*self.assembly.law(), refine.time_step);
        let laws = (&law, &self.damping);
        patch.set_damping(&self.damping, self.assembly.radii());
        // Held disks have neither way nor velocity.
        let of_disk = |column: &[Vector<D>], disk: u32| column.get(disk as usize).copied().unwrap_or([0.0; D]);
        for place in 0..patch.disks.len() {
            let disk = patch.disks[place];
            let velocities = [of_disk(&self.before.velocities, disk), of_disk(&self.velocities, disk)];
            patch.set_course(self.assembly.displacements[disk as usize], of_disk(&self.moved, disk), velocities);
        }
        let method = Chebyshev::new(refine.stiffness.stage_count(time_step));
        let long = patch.go_at_once(laws, time_step, &method);
        let work = patch.refine(laws, longest, refine)?;
        let mut longest_change = 0.0;
        for place in 0..patch.inside_count() {
            let disk = patch.disks[place] as usize;
            let way = difference(patch.displacements[place], self.assembly.displacements[disk]);
            let kick = difference(patch.velocities()[place], self.velocities[disk]);
            longest_change = larger(norm(way), longest_change);
            if patch.last_shell[place] && (refine.share)(disk, measure(time_step, way, kick)) > OUTSIDE {
                return None;
            }
        }
        let mobile = self.assembly.mobile_count();
        for (place, &disk) in patch.disks.iter().enumerate() {
            let disk = disk as usize;
            if place < patch.inside_count() {
                let way = difference(patch.displacements[place], self.assembly.displacements[disk]);
                self.moved[disk] = sum(self.moved[disk], way);
                self.assembly.displacements[disk] = patch.displacements[place];
                self.velocities[disk] = patch.velocities()[place];
                self.net_forces[disk] = patch.forces[place];
            } else if disk < mobile {
                let change = difference(patch.forces[place], patch.long_forces[place]);
                self.net_forces[disk] = sum(self.net_forces[disk], change);
            }
        }
        self.dissipated += work - long.work;
        self.dissipation += patch.power - long.power;
        Some(longest_change)
    }
}

/// Sum of all.
fn total<const D: usize>(vectors: &[Vector<D>]) -> Vector<D> {
    vectors.iter().fold([0.0; D], |total, &vector| sum(total, vector))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::read_packing;
    use crate::law::damping::ConstantDamping;
    use crate::law::power_laws::Hertzian;
    use crate::relax::implicit::Inertia;

    type Motion = ImplicitMotion<2, Hertzian, ConstantDamping>;

    /// The length of the step that is too long for a few disks.
    const STEP: f64 = 0.01;

    /// Error allowed \[length\].
    const ALLOWED: f64 = 1e-5;

    /// A stored packing one of whose disks, in the middle, has been given a knock, some time ago.
    fn knocked() -> Motion {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N5548_p100.xyz");
        let packing = read_packing::<2>(file).expect("a stored packing");
        let (law, damping) = (Hertzian::default(), ConstantDamping { rate: 500.0 });
        let mut motion = ImplicitMotion::new(&packing, &law, &damping, Inertia::Massive).expect("no coincidence");
        motion.margin = 0.01;
        motion.velocities[2000] = [0.3, 0.15];
        let _ = motion.evaluate();
        motion
    }

    /// Moves on by [`STEP`] in so many steps.
    fn go(motion: &mut Motion, step_count: usize) {
        let stiffness = motion.stiffness().expect("every contact is damped");
        let time_step = STEP / step_count as f64;
        for _ in 0..step_count {
            let stage_count = stiffness.stage_count(time_step);
            assert!(motion.stabilised_step(time_step, stage_count).expect("no coincidence"));
        }
    }

    fn share(_: usize, error: f64) -> f64 {
        error / ALLOWED
    }

    /// Disks whose estimated errors are too large.
    fn too_large(motion: &Motion) -> Vec<u32> {
        let mobile = motion.assembly.mobile_count() as u32;
        (0..mobile).filter(|&disk| share(0, motion.stabilised_error(STEP, disk as usize)) > 1.0).collect()
    }

    /// Longest distance of a disk between two motions of one packing \[length\].
    fn apart(one: &Motion, other: &Motion) -> f64 {
        let places =
            (0..one.assembly.len()).map(|disk| difference(one.assembly.place(disk), other.assembly.place(disk)));
        places.map(norm).fold(0.0, larger)
    }

    fn refined(motion: &mut Motion, disks: &[u32]) -> bool {
        let stiffness = motion.stiffness().expect("every contact is damped");
        motion.refine(&Refine { time_step: STEP, stiffness, disks, share }).expect("no coincidence")
    }

    #[test]
    fn a_few_disks_moved_again_are_where_short_steps_of_all_lead() {
        let (mut exact, mut motion) = (knocked(), knocked());
        go(&mut exact, 1000);
        go(&mut motion, 1);
        let long_error = apart(&motion, &exact);
        let disks = too_large(&motion);
        assert!((1..200).contains(&disks.len()), "{}", disks.len());
        let before = motion.assembly.displacements.clone();
        assert!(refined(&mut motion, &disks));
        let error = apart(&motion, &exact);
        // Each step of the patch has the error allowed at most, mostly less by SAFETY or more; the steps add up.
        assert!(long_error > 20.0 * ALLOWED && error < 10.0 * ALLOWED, "{error}, without {long_error}");
        let moved = motion.assembly.displacements.iter().zip(&before).filter(|(now, before)| now != before).count();
        assert!(moved < before.len() / 4, "{moved} disks moved again");
        // What pushes each other only keeps its momentum, up to rounding of a sum of N velocities below 1.
        let gained = difference(total(&motion.velocities), [0.3, 0.15]);
        assert!(norm(gained) < motion.velocities.len() as f64 * f64::EPSILON, "{gained:?}");
        // The account of forces is kept: they are those of where the disks are, up to rounding of forces of 10³.
        let kept = motion.net_forces().to_vec();
        let dissipation = motion.dissipation;
        let totals = motion.evaluate();
        let wrong = kept.iter().zip(motion.net_forces()).map(|(&a, &b)| norm(difference(a, b))).fold(0.0, larger);
        assert!(wrong < 1e-9 && (dissipation / motion.dissipation - 1.0).abs() < 1e-9, "{wrong}");
        // And that of energy, which the long step has wrong.
        let defect =
            |motion: &Motion, energy: f64, start: f64| start - energy - motion.kinetic_energy() - motion.dissipated;
        let mut start = knocked();
        let energy = start.evaluate().energy + start.kinetic_energy();
        let mut long = knocked();
        go(&mut long, 1);
        let without = defect(&long, long.assembly.clone().evaluate_totals().energy, energy);
        let with = defect(&motion, totals.energy, energy);
        assert!(with.abs() < 0.1 * without.abs(), "{with}, without {without}");
    }

    #[test]
    fn what_cannot_be_moved_again_by_itself_is_told() {
        let mut motion = knocked();
        go(&mut motion, 1);
        let mobile = motion.assembly.mobile_count() as u32;
        let before = motion.assembly.displacements.clone();
        // Too many; and one whose surroundings have moved with it.
        let every_other: Vec<u32> = (0..mobile).step_by(2).collect();
        assert!(!refined(&mut motion, &every_other));
        motion.velocities.iter_mut().for_each(|velocity| *velocity = [30.0, 0.0]);
        assert!(!refined(&mut motion, &[2000]));
        assert_eq!(motion.assembly.displacements, before);
    }
}
