//! Multirate steps: a stabilised step that is too long for a few disks is repeated around these disks, in shorter
//! steps.
//!
//! If a contact opens or closes, the error of a step is thousands of times that of the rest of the packing. Each disk
//! with such an error and some shells of contacts around it form a [`Patch`]. The patch is integrated again from the
//! start of the step to its end, in steps as long as its own errors allow. The disks around it follow the long step. So
//! every disk has the allowed error, and the work of an event is that of its surroundings. The effect of the patch on
//! the disks around it is neglected. So its last shell must agree with the long step, up to a fraction of the allowed
//! error. If the packing has no held disks or sites, the neglected momentum is distributed evenly over all disks.
//! Otherwise the packing would drift, and no contact damps a drift.
//!
//! # Source
//! Savcenco, Hundsdorfer, Verwer (2007), BIT Numer. Math. 47, 137: first one step for all components, then shorter
//! steps for those whose error is too large, with the others interpolated.

use crate::packing::PackingError;
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::relax::dynamics::implicit::multirate::patch::{Patch, PatchDisks};
use crate::relax::dynamics::implicit::multirate::shells::{DONE, LONGEST_MOVE, Shells};
use crate::relax::dynamics::implicit::rkc::coefficients::Chebyshev;
use crate::relax::dynamics::implicit::rkc::stages::measure;
use crate::vector::{Vector, difference, larger, norm, scaled, sum};

/// Largest change of the last shell of a patch over the allowed error. The surrounding disks, which are kept, would
/// change by less.
const LAST_SHELL_CHANGE: f64 = 0.5;

/// Number of shells of a patch in addition to those affected in one step, which are [`AFFECTED_SHELLS`] √(hλ).
const EXTRA_SHELLS: u32 = 1;

/// See [`EXTRA_SHELLS`]. With a smaller value more patches fail; a larger value makes the motion slower.
const AFFECTED_SHELLS: f64 = 0.5;

/// Largest fraction of the mobile disks in patches. Above it a shorter step of all disks costs less.
const LARGEST_SHARE: f64 = 0.25;

/// Displacement for which the list must be complete, over the width of the skin. At most half of the skin is possible.
const LISTED_SKIN: f64 = 0.25;

impl<const D: usize> ImplicitMotion<D> {
    /// Repeats the last stabilised step around some disks. Returns false if that is impossible: the step must then be
    /// taken back.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(crate) fn correct_fast_disks(
        &mut self,
        fast: &PatchDisks<'_, impl Fn(usize, f64) -> f64>,
    ) -> Result<bool, PackingError> {
        let longest = LONGEST_MOVE * self.moved.iter().fold(0.0, |most, &change| larger(norm(change), most));
        if self.assembly.remaining_displacement() < longest.min(LISTED_SKIN * self.assembly.skin()) {
            self.assembly.reanchor()?;
            self.set_damping_coefficients();
        }
        let mut shells = std::mem::take(&mut self.shells);
        let assembly = &self.assembly;
        shells.set_list(assembly.pairs(), assembly.len(), assembly.build_count());
        let shell_count = EXTRA_SHELLS + (AFFECTED_SHELLS * (fast.time_step * fast.stiffness.decay).sqrt()) as u32;
        let most = (LARGEST_SHARE * assembly.mobile_count() as f64) as usize;
        let momentum = total(&self.velocities);
        let change = if shells.set_shells(assembly, (fast.disks, shell_count), (self.margin, most)) {
            self.correct_patches(shell_count, fast, &mut shells)
        } else {
            None
        };
        shells.leave();
        shells.pair_count += shells.patch.take_pair_count();
        let all = self.assembly.pairs().len().max(1);
        self.work.evaluation_count += shells.pair_count / all;
        shells.pair_count %= all;
        self.shells = shells;
        let Some(change) = change else { return Ok(false) };
        if self.is_free() {
            self.remove_momentum(difference(total(&self.velocities), momentum));
        }
        if self.assembly.update_list(change)? {
            self.set_damping_coefficients();
        }
        Ok(true)
    }

    /// Whether only contacts between mobile disks act, so that their momentum is constant.
    fn is_free(&self) -> bool {
        self.assembly.mobile_count() == self.assembly.len() && !self.assembly.law().has_sites()
    }

    /// Removes this momentum evenly from all disks. This changes no relative velocity, and so no force.
    fn remove_momentum(&mut self, momentum: Vector<D>) {
        let kick = scaled(-1.0 / self.velocities.len() as f64, momentum);
        for velocity in &mut self.velocities {
            *velocity = sum(*velocity, kick);
        }
    }

    /// The largest change of a disk in all patches. None if a patch failed.
    fn correct_patches(
        &mut self,
        shell_count: u32,
        fast: &PatchDisks<'_, impl Fn(usize, f64) -> f64>,
        shells: &mut Shells<D>,
    ) -> Option<f64> {
        let mut change = 0.0;
        for &disk in fast.disks {
            if shells.shell_of[disk as usize] == DONE {
                continue;
            }
            let listed = (self.assembly.pairs(), self.assembly.displacements.as_slice());
            let longest = shells.set_patch(listed, &self.moved, (disk, shell_count));
            if longest > self.assembly.remaining_displacement() {
                return None;
            }
            change = larger(self.correct_patch(longest, fast, &mut shells.patch)?, change);
            let Shells { patch, shell_of, .. } = shells;
            for &disk in &patch.disks[..patch.inside_count()] {
                shell_of[disk as usize] = DONE;
            }
        }
        Some(change)
    }

    /// The largest change of a disk. None if the patch failed.
    fn correct_patch(
        &mut self,
        longest: f64,
        fast: &PatchDisks<'_, impl Fn(usize, f64) -> f64>,
        patch: &mut Patch<D>,
    ) -> Option<f64> {
        let time_step = fast.time_step;
        let laws = (self.assembly.law(), &self.damping);
        patch.set_damping(&self.damping, self.assembly.radii());
        // Held disks have neither displacement nor velocity.
        let of_disk = |column: &[Vector<D>], disk: u32| column.get(disk as usize).copied().unwrap_or([0.0; D]);
        for place in 0..patch.disks.len() {
            let disk = patch.disks[place];
            let velocities = [of_disk(&self.before.velocities, disk), of_disk(&self.velocities, disk)];
            patch.set_course(self.assembly.displacements[disk as usize], of_disk(&self.moved, disk), velocities);
        }
        let method = Chebyshev::new(fast.stiffness.stage_count(time_step));
        let long = patch.long_step(laws, time_step, &method);
        let work = patch.short_steps(laws, longest, fast)?;
        let mut longest_change = 0.0;
        for place in 0..patch.inside_count() {
            let disk = patch.disks[place] as usize;
            let change = difference(patch.displacements[place], self.assembly.displacements[disk]);
            let kick = difference(patch.velocities()[place], self.velocities[disk]);
            longest_change = larger(norm(change), longest_change);
            if patch.last_shell[place] && (fast.share)(disk, measure(time_step, change, kick)) > LAST_SHELL_CHANGE {
                return None;
            }
        }
        let mobile = self.assembly.mobile_count();
        for (place, &disk) in patch.disks.iter().enumerate() {
            let disk = disk as usize;
            if place < patch.inside_count() {
                let change = difference(patch.displacements[place], self.assembly.displacements[disk]);
                self.moved[disk] = sum(self.moved[disk], change);
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

/// Sum of all vectors.
fn total<const D: usize>(vectors: &[Vector<D>]) -> Vector<D> {
    vectors.iter().fold([0.0; D], |total, &vector| sum(total, vector))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::read_packing;
    use crate::law::damping::{ConstantDamping, ContactDamping};
    use crate::law::power_laws::Hertzian;
    use crate::relax::dynamics::implicit::inertia::Inertia;

    type Motion = ImplicitMotion<2>;

    /// Length of a step that is too long for a few disks.
    const STEP: f64 = 0.01;

    /// Error allowed \[length\].
    const ALLOWED: f64 = 1e-5;

    /// A stored packing in which one disk, in the middle, has a large velocity.
    fn knocked() -> Motion {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N5548_p100.xyz");
        let packing = read_packing::<2>(file).expect("a stored packing");
        let (law, damping) = (Hertzian::default(), ContactDamping::Constant(ConstantDamping { rate: 500.0 }));
        let mut motion = ImplicitMotion::new(&packing, &law, &damping, Inertia::Massive).expect("no coincidence");
        motion.margin = 0.01;
        motion.velocities[2000] = [0.3, 0.15];
        let _ = motion.evaluate();
        motion
    }

    /// Integrates over [`STEP`], in this number of steps.
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

    /// Largest distance of a disk between two motions of one packing \[length\].
    fn apart(one: &Motion, other: &Motion) -> f64 {
        let places =
            (0..one.assembly.len()).map(|disk| difference(one.assembly.place(disk), other.assembly.place(disk)));
        places.map(norm).fold(0.0, larger)
    }

    fn refined(motion: &mut Motion, disks: &[u32]) -> bool {
        let stiffness = motion.stiffness().expect("every contact is damped");
        motion.correct_fast_disks(&PatchDisks { time_step: STEP, stiffness, disks, share }).expect("no coincidence")
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
        // Each step of the patch has at most the allowed error, and usually a fraction SAFETY of it. The errors add up.
        assert!(long_error > 20.0 * ALLOWED && error < 10.0 * ALLOWED, "{error}, without {long_error}");
        let moved = motion.assembly.displacements.iter().zip(&before).filter(|(now, before)| now != before).count();
        assert!(moved < before.len() / 4, "{moved} disks moved again");
        // Contacts between mobile disks conserve momentum, up to the rounding of a sum of N velocities below 1.
        let gained = difference(total(&motion.velocities), [0.3, 0.15]);
        assert!(norm(gained) < motion.velocities.len() as f64 * f64::EPSILON, "{gained:?}");
        // The stored forces are those at the present positions, up to rounding of forces of 10³.
        let kept = motion.net_forces().to_vec();
        let dissipation = motion.dissipation;
        let totals = motion.evaluate();
        let wrong = kept.iter().zip(motion.net_forces()).map(|(&a, &b)| norm(difference(a, b))).fold(0.0, larger);
        assert!(wrong < 1e-9 && (dissipation / motion.dissipation - 1.0).abs() < 1e-9, "{wrong}");
        // The energy balances as well, unlike in the long step.
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
        // Too many disks; then a disk whose surroundings move with it.
        let every_other: Vec<u32> = (0..mobile).step_by(2).collect();
        assert!(!refined(&mut motion, &every_other));
        motion.velocities.iter_mut().for_each(|velocity| *velocity = [30.0, 0.0]);
        assert!(!refined(&mut motion, &[2000]));
        assert_eq!(motion.assembly.displacements, before);
    }
}
