//! [`AllowedError`]: the largest error allowed in a step of a motion.

use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::vector::larger;

/// Allowed error of rattlers over that of backbone disks. The positions of rattlers hardly affect the backbone, but an
/// error there changes overlaps, and so the energy.
const OFF_BACKBONE: f64 = 3.0;

/// The error allowed in a step.
pub(crate) struct AllowedError<'a> {
    /// Median overlap of the contacts \[length\].
    pub(crate) overlap: f64,
    /// Allowed error over the median overlap \[1\].
    pub(crate) tolerance: f64,
    /// The disks of the backbone, in working order.
    pub(crate) backbone: &'a [bool],
}

impl AllowedError<'_> {
    /// Largest error of a disk in the last step over the allowed one \[1\]; NaN if an error is NaN.
    pub(crate) fn largest_ratio<const D: usize>(
        &self,
        motion: &ImplicitMotion<D>,
        error: impl Fn(&ImplicitMotion<D>, usize) -> f64,
    ) -> f64 {
        let of_disk = |disk: usize| error(motion, disk) * self.weight(disk);
        (0..motion.assembly.mobile_count()).map(of_disk).fold(0.0, |most, error| larger(error, most))
    }

    /// Factor from an error to its ratio to the allowed one \[1 / length\].
    pub(crate) fn weight(&self, disk: usize) -> f64 {
        (if self.backbone[disk] { 1.0 } else { 1.0 / OFF_BACKBONE }) / (self.tolerance * self.overlap)
    }
}
