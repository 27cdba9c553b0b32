//! [`AllowedError`]: the error that a step of a motion may have.

use crate::law::damping::DampingLaw;
use crate::law::pair_law::PairLaw;
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::vector::larger;

/// Allowed error off the backbone over that on it. Where rattlers hit matters little to the backbone. But an error there is an
/// overlap, and so energy.
const OFF_BACKBONE: f64 = 3.0;

/// The error that a step may have.
pub(crate) struct AllowedError<'a> {
    /// Mean overlap \[length\].
    pub(crate) overlap: f64,
    /// Allowed error over the mean overlap.
    pub(crate) tolerance: f64,
    /// The disks of the backbone, in working order.
    pub(crate) backbone: &'a [bool],
}

impl AllowedError<'_> {
    /// Largest error of a disk in the last step over the allowed one \[1\]; NaN if an error is NaN.
    pub(crate) fn share<const D: usize, L: PairLaw, C: DampingLaw>(
        &self,
        motion: &ImplicitMotion<D, L, C>,
        error: impl Fn(&ImplicitMotion<D, L, C>, usize) -> f64,
    ) -> f64 {
        let of_disk = |disk: usize| error(motion, disk) * self.weight(disk);
        (0..motion.assembly.mobile_count()).map(of_disk).fold(0.0, |most, error| larger(error, most))
    }

    /// The ratio of an error to the allowed one is this times the error \[1 / length\].
    pub(crate) fn weight(&self, disk: usize) -> f64 {
        (if self.backbone[disk] { 1.0 } else { 1.0 / OFF_BACKBONE }) / (self.tolerance * self.overlap)
    }
}
