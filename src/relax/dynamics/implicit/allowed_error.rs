//! [`AllowedError`]: what error a step of a motion may have.

use crate::law::damping::DampingLaw;
use crate::law::pair_law::PairLaw;
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::vector::larger;

/// Error allowed off the backbone over that on it. Rattlers fly and hit; where they hit matters little to the backbone, but an
/// error there is an overlap, and so energy.
const OFF_BACKBONE: f64 = 3.0;

/// What error a step may have.
pub(crate) struct Allowed<'a> {
    /// Mean overlap \[length\].
    pub(crate) overlap: f64,
    /// Error allowed over that.
    pub(crate) tolerance: f64,
    /// See [`Monitor::backbone`].
    pub(crate) backbone: &'a [bool],
}

impl Allowed<'_> {
    /// Largest error of a disk in the last step over what is allowed \[1\]; NaN if one is.
    pub(crate) fn share<const D: usize, L: PairLaw, C: DampingLaw>(
        &self,
        motion: &ImplicitMotion<D, L, C>,
        error: impl Fn(&ImplicitMotion<D, L, C>, usize) -> f64,
    ) -> f64 {
        let of_disk = |disk: usize| error(motion, disk) * self.weight(disk);
        (0..motion.assembly.mobile_count()).map(of_disk).fold(0.0, |most, error| larger(error, most))
    }

    /// What an error of a disk \[length\] is over the one allowed is this times it.
    pub(crate) fn weight(&self, disk: usize) -> f64 {
        (if self.backbone[disk] { 1.0 } else { 1.0 / OFF_BACKBONE }) / (self.tolerance * self.overlap)
    }
}
