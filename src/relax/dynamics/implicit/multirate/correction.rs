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

use crate::law::damping::DampingLaw;
use crate::law::pair_law::PairLaw;
use crate::packing::PackingError;
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::relax::dynamics::implicit::multirate::patch::{Patch, Refine};
use crate::relax::dynamics::implicit::multirate::shells::{DONE, LONGEST_WAY, Refinement};
use crate::relax::dynamics::implicit::rkc::coefficients::Chebyshev;
use crate::relax::dynamics::implicit::rkc::stages::measure;
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

/// How far the list should hold over the width of the skin; half of it is the most a list can.
const LISTED: f64 = 0.25;

impl<const D: usize, L: PairLaw, C: DampingLaw> ImplicitMotion<D, L, C> {
    /// Makes the last stabilised step again around some disks. False if that cannot be done: the step is to be taken back then.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(crate) fn refine(&mut self, refine: &Refine<'_, impl Fn(usize, f64) -> f64>) -> Result<bool, PackingError> {
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
    use crate::law::pair_law::Hertzian;
    use crate::relax::dynamics::implicit::inertia::Inertia;

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
