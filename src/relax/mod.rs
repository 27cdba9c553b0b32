//! Bringing a packing to rest: [`Relaxer`], its [`Outcome`], and [`Relaxed`], which only a converged outcome can make.
//!
//! The residual is the largest net force on a mobile disk of the backbone over the mean contact force of the backbone.
//! Without a backbone, as in a chain of pressed disks, all mobile disks count. Held disks never count. Rattlers only
//! have to meet the square root of the limit: their contacts open algebraically slowly, without touching the backbone.

mod choice;
mod column_operations;
mod convergence;
pub mod dynamics;
mod energy_account;
pub mod fire;
mod force_limit;
pub mod minimise;
mod outcome;
mod relaxer;
mod rounding;
mod trace;

pub use choice::RelaxerChoice;
pub use dynamics::damped::{DampedDynamics, NetForce, TimeStep};
#[cfg(feature = "linear")]
pub use dynamics::implicit;
#[cfg(feature = "linear")]
pub use dynamics::implicit::{GradientFlow, ImplicitDynamics};
pub use dynamics::verlet::Motion;
pub use energy_account::EnergyAccount;
pub use fire::{Fire, Precision, StepBack, Uphill};
pub use force_limit::{ForceLimit, RUNAWAY, UNJAMMED_FORCE};
pub use minimise::conjugate_gradients::NonlinearConjugateGradients;
#[cfg(feature = "linear")]
pub use minimise::fire_then_newton::Staged;
pub use minimise::lbfgs::QuasiNewton;
#[cfg(feature = "linear")]
pub use minimise::newton::Newton;
pub use outcome::{Cost, Criterion, Outcome, Relaxed, Residual, Stop};
pub use relaxer::Relaxer;
pub use rounding::rounding_floor;
pub use trace::{Check, Trace};
