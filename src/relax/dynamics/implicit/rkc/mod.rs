//! The Runge–Kutta–Chebyshev method: stabilised explicit steps.

pub(super) mod coefficients;
pub(super) mod stabilised_phase;
pub(super) mod stages;
mod step;
