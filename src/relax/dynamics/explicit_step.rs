//! [`ExplicitStep`]: how long explicit steps of damped dynamics are, while contacts stiffen.
//!
//! ```text
//! δ'_ij = δ_ij + max(0, −v_n) τ + max(0, −a_n) τ²/2        τ = M h: the time until the next check
//! h = share × the bound on a stable step at overlaps δ'
//! ```
//!
//! The inflation is a blow. While its front spreads, overlaps grow tenfold within a few steps, and contacts that do not exist yet
//! become the stiffest of all. So the bound is taken where the disks are going to be. The number M of steps between two checks is
//! halved where the step got much shorter, and doubled where it did not.

use crate::law::damping::DampingLaw;
use crate::law::pair_law::PairLaw;
use crate::relax::dynamics::verlet::Motion;

/// Fewest steps between two checks of the bound.
const SHORTEST_INTERVAL: usize = 2;

/// Most steps between two checks.
const LONGEST_INTERVAL: usize = 50;

/// Ratio of a step to the one before below which checks come twice as often. Where stiffness changes by less between two checks, the
/// step stays within the margin that [`TimeStep`](crate::relax::TimeStep) leaves.
const STEADY: f64 = 0.9;

/// Length of explicit steps.
#[derive(Debug, Clone)]
pub(crate) struct ExplicitStep {
    /// Step over the bound on a stable one \[1\].
    share: f64,
    interval: usize,
    /// Steps left before the next check.
    left: usize,
    time_step: f64,
}

impl ExplicitStep {
    pub(crate) fn new(share: f64) -> Self {
        ExplicitStep { share, interval: SHORTEST_INTERVAL, left: 0, time_step: 0.0 }
    }

    /// The last step \[time\].
    #[cfg(feature = "linear")]
    pub(crate) fn time_step(&self) -> f64 {
        self.time_step
    }

    /// Step over the bound on a stable one \[1\].
    pub(crate) fn share(&self) -> f64 {
        self.share
    }

    /// Steps from here on are shorter by this factor.
    pub(crate) fn shorten(&mut self, factor: f64) {
        self.share *= factor;
        (self.left, self.interval, self.time_step) = (0, SHORTEST_INTERVAL, self.time_step * factor);
    }

    /// Steps from the next check on are longer by this factor, up to this share of the bound.
    pub(crate) fn lengthen(&mut self, factor: f64, most: f64) {
        self.share = (self.share * factor).min(most);
    }

    /// Length of the next step of this motion \[time\].
    pub(crate) fn next<const D: usize, L: PairLaw, C: DampingLaw>(&mut self, motion: &mut Motion<D, L, C>) -> f64 {
        if self.left == 0 {
            let before = self.time_step;
            let now = if before > 0.0 { before } else { self.share * motion.stable_step() };
            self.time_step = self.share * motion.stable_step_within(self.interval as f64 * now);
            self.interval = if before > 0.0 && self.time_step >= STEADY * before {
                (2 * self.interval).min(LONGEST_INTERVAL)
            } else {
                (self.interval / 2).max(SHORTEST_INTERVAL)
            };
            self.left = self.interval;
        }
        self.left -= 1;
        self.time_step
    }
}
