//! [`Step`]: one step of FIRE.

use crate::forces::single_precision::Units;
use crate::relax::column_operations::kick_and_drift;
use crate::simd::real::Real;

/// A step: `v ← keep·v + push·F`, then `u ← u + dt·v`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) keep: f64,
    pub(super) push: f64,
    pub(super) time_step: f64,
}

impl Step {
    /// Applies the step. Returns the largest velocity component, in the units of the step.
    pub(super) fn kick<T: Real, const D: usize>(
        &self,
        forces: &[[T; D]],
        velocities: &mut [[T; D]],
        displacements: &mut [[T; D]],
    ) -> f64 {
        let (velocities, displacements) = (velocities.as_flattened_mut(), displacements.as_flattened_mut());
        kick_and_drift(self.keep, self.push, self.time_step, forces.as_flattened(), velocities, displacements)
    }

    /// The same step in other units.
    pub(super) fn in_units(&self, units: Units) -> Step {
        let push = self.push * (units.force / units.speed());
        Step { keep: self.keep, push, time_step: self.time_step / units.time }
    }
}
