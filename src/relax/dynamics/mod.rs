//! Damped dynamics and gradient flow, by explicit and by implicit steps.

pub mod damped;
mod energy_balance;
mod explicit_step;
#[cfg(feature = "linear")]
pub mod implicit;
pub mod verlet;
