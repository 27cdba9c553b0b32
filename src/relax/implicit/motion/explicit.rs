//! Stretches of explicit steps, by velocity Verlet.

use crate::contact::PairLaw;
use crate::contact::damping::DampingLaw;
use crate::contact::totals::Totals;
use crate::packing::PackingError;
use crate::relax::damped::{BOUND_EVERY, Motion};
use crate::relax::implicit::motion::ImplicitMotion;
use crate::vector::scaled;

impl<const D: usize, L: PairLaw, C: DampingLaw> ImplicitMotion<D, L, C> {
    /// So many explicit steps of damped dynamics, each of this share of the bound on a stable one; the last one's length
    /// \[time\] beside the totals. `ahead` is the length of the step that is to follow, which looks out for contacts that far.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(in crate::relax::implicit) fn go_explicitly(
        &mut self,
        count: usize,
        share: f64,
        ahead: f64,
    ) -> Result<(Totals<D>, f64), PackingError> {
        let mut motion = Motion::moving(self.assembly.clone(), &self.velocities, &self.damping);
        let mut time_step = 0.0;
        for step in 0..count {
            if step % BOUND_EVERY == 0 {
                time_step = share * motion.stable_step();
            }
            motion.step(time_step)?;
            self.time += time_step;
        }
        self.work.evaluation_count += count + 1;
        self.dissipated += motion.dissipated;
        self.velocities.copy_from_slice(&motion.velocities[..self.assembly.mobile_count()]);
        self.assembly = motion.assembly;
        self.taken_back = false;
        for (moved, &velocity) in self.moved.iter_mut().zip(&self.velocities) {
            *moved = scaled(ahead, velocity);
        }
        self.set_damping_coefficients();
        Ok((self.evaluate(), time_step))
    }

    /// The longest stable explicit step, as [`Motion::stable_step`].
    pub(in crate::relax::implicit) fn stable_step(&mut self) -> f64 {
        self.work.evaluation_count += 1;
        Motion::of(self.assembly.clone(), &self.damping).stable_step()
    }
}
