//! Minimisers of the energy: along lines (conjugate gradients, L-BFGS), by Newton's method, and FIRE followed by
//! Newton's method.

pub mod conjugate_gradients;
#[cfg(feature = "linear")]
pub mod fire_then_newton;
pub mod lbfgs;
mod line_descent;
mod line_search;
#[cfg(feature = "linear")]
pub mod newton;
#[cfg(feature = "linear")]
pub(super) mod newton_descent;
#[cfg(feature = "linear")]
mod shifted_hessian;
