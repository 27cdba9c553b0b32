//! The stabilised explicit method of Runge, Kutta and Chebyshev.

pub(super) mod coefficients;
pub(super) mod phase;
pub(super) mod stages;
mod step;
