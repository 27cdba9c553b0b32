//! FIRE (fast inertial relaxation engine): descent with inertia, stopped whenever the power of the forces is negative.
//!
//! ```text
//! P = F·v > 0:  after a delay  dt ← min(1.1 dt, dt_max), α ← 0.99 α        otherwise  v ← 0, dt ← dt/2, α ← 0.1
//! v ← v + dt F,   v ← (1 − α) v + α |v| F/|F|,   u ← u + dt v              (masses 1)
//! ```
//!
//! The largest time step follows from the contacts: `dt_max = c · 2/√λ`. Here λ is Gershgorin's bound on the largest
//! eigenvalue of the present stiffness matrix. It is recomputed every few steps, so no step has to be chosen for each
//! pressure.
//!
//! [`Uphill::StepBack`] applies the corrections of FIRE 2.0. After an uphill step the disks go back by half of it
//! before they stop, `u ← u − (dt/2) v`. The first steps may be uphill without a reduction of the time step. The forces
//! are then evaluated at the new positions, in place of the evaluation of every restart.
//!
//! Within a run, FIRE lets the energy increase. But the energy at a restart (v ← 0) is never above that at the previous
//! restart, up to a relative rounding error of 10⁻¹³. For disks with sites, rounding is relative to the summed contact
//! and site energies. If a restart had a higher energy, the disks return to the last one, and the time step is halved.
//! So the final energy is never above the initial one.
//!
//! # Source
//! Bitzek, Koskinen, Gähler, Moseler, Gumbsch (2006), Phys. Rev. Lett. 97, 170201; order of kick, mixing and drift
//! (semi-implicit Euler): Guénolé et al. (2020), Comput. Mater. Sci. 175, 109584.

mod advance;
mod checks;
mod descent;
mod restart;
mod run;
pub(super) mod settings;
mod state;
mod step;

pub use settings::{Fire, Precision, StepBack, Uphill};
