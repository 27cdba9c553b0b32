//! Bessel functions of orders zero and one: of real and of imaginary argument, in two dimensions and in three.
//!
//! | module | functions | solve |
//! |---|---|---|
//! | [`cylinder`] | J_0, J_1, Y_0, Y_1 | `f'' + f'/x + (1 − n²/x²) f = 0` |
//! | [`modified`] | I_0, I_1, K_0, K_1, plain and scaled | `f'' + f'/x − (1 + n²/x²) f = 0` |
//! | [`spherical`] | j_0, j_1, y_0, y_1, i_0, i_1, k_0, k_1 | `f'' + 2f'/x ± f − n(n+1) f/x² = 0` |
//! | [`modulus_phase`](mod@modulus_phase) | `J_1 + i Y_1 = M exp(iθ)` | the form without cancellation in differences |
//!
//! They are functions of one real number. Profiles consist of cross products of them, computed without cancellation by
//! [`RimSolution`](crate::reference::rim::RimSolution).

pub mod cylinder;
pub mod modified;
mod modified_tables;
pub mod modulus_phase;
mod modulus_tables;
pub(crate) mod polynomial;
pub mod spherical;

pub use modulus_phase::{ASYMPTOTIC_FROM, ModulusPhase, modulus_phase};
