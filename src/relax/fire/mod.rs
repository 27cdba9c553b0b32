//! FIRE: a ball rolls downhill and is stopped whenever it climbs.
//!
//! ```text
//! P = F·v > 0:  after a delay  dt ← min(1.1 dt, dt_max), α ← 0.99 α        otherwise  v ← 0, dt ← dt/2, α ← 0.1
//! v ← v + dt F,   v ← (1 − α) v + α |v| F/|F|,   u ← u + dt v              (masses 1)
//! ```
//!
//! The largest time step follows the contacts: `dt_max = c · 2/√λ`. Here λ is Gershgorin's bound on the largest eigenvalue of
//! the present stiffness matrix. It is recomputed every few steps, so the step needs no choice for a pressure.
//!
//! [`Uphill::StepBack`] stands for the corrections of FIRE 2.0. After a climbing step the disks go half of it back before they
//! rest, `u ← u − (dt/2) v`. The first steps may climb without a shorter time step. The forces are evaluated where the disks then
//! are, in place of the evaluation that every restart has.
//!
//! FIRE lets the energy rise within a run. But every restart (v ← 0) has an energy not above that of the restart before, to
//! rounding: 10⁻¹³ of it. Where disks have sites, the rounding is relative to the summed contact and site energies. Where a
//! restart would be higher, the disks go back to the last one and the time step is halved. The final energy is therefore never
//! above the first.
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
