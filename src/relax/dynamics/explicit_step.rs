//! [`ExplicitStep`]: the length of explicit steps of damped dynamics while contacts stiffen.
//!
//! ```text
//! δ'_ij = δ_ij + max(0, −v_n) τ + max(0, −a_n) τ²/2        τ = M h: the time until the next check
//! h = fraction × stability bound at overlaps δ'
//! ```
//!
//! While the front of an inflation spreads, overlaps grow tenfold within a few steps. Contacts that do not exist yet
//! then become the stiffest. So the bound is computed for the predicted overlaps. The number M of steps between two
//! checks is halved if the step has become much shorter, and doubled otherwise.

use crate::relax::dynamics::verlet::Motion;

/// Fewest steps between two checks of the bound.
const SHORTEST_INTERVAL: usize = 2;

/// Largest number of steps between two checks.
const LONGEST_INTERVAL: usize = 50;

/// Ratio of a step to the previous one below which the number of steps between checks is halved. For smaller changes of
/// stiffness, the step stays within the margin of [`TimeStep`](crate::relax::TimeStep).
const STEADY: f64 = 0.9;

/// Length of explicit steps.
#[derive(Debug, Clone)]
pub(crate) struct ExplicitStep {
    /// Step over its stability bound \[1\].
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

    /// Step over its stability bound \[1\].
    pub(crate) fn share(&self) -> f64 {
        self.share
    }

    /// Shortens all further steps by this factor.
    pub(crate) fn shorten(&mut self, factor: f64) {
        self.share *= factor;
        (self.left, self.interval, self.time_step) = (0, SHORTEST_INTERVAL, self.time_step * factor);
    }

    /// Lengthens the steps after the next check by this factor, up to this fraction of the bound.
    pub(crate) fn lengthen(&mut self, factor: f64, most: f64) {
        self.share = (self.share * factor).min(most);
    }

    /// Length of the next step of this motion \[time\].
    pub(crate) fn next<const D: usize>(&mut self, motion: &mut Motion<D>) -> f64 {
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
