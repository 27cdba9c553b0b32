//! Damped dynamics and gradient flow by long implicit steps.
//!
//! ```text
//! damped dynamics   v̇ = F(u) − Σ c_ij (n·v_ij) n,  u̇ = v        gradient flow   ζ u̇ = F(u)
//! ```
//!
//! The equations are stiff: contacts relax in 10⁻³ of the time the softest modes take, and an explicit step follows the
//! contacts. Here a step follows what still moves. Its length is set by the estimated error, the largest one over the
//! backbone in units of the mean overlap; where a contact opens or closes within a step, the force or the damping kinks or
//! jumps, the stages disagree, and the step is repeated with a shorter one. Near the minimum the steps grow without bound
//! and become Newton's. See [`ImplicitMotion`] for the step, [`tableau`] for the method. While collisions keep steps short,
//! stabilised explicit steps take their place, made again with shorter ones around the disks that collide.

mod allowed_error;
mod explicit_phase;
mod finish;
mod inertia;
mod integration;
mod method_selection;
mod motion;
mod multirate;
pub(crate) mod relaxers;
mod rkc;
mod rosenbrock;
mod stagnation;
mod step_control;
mod step_matrix;
pub mod tableau;

pub use finish::Finish;
pub use inertia::{Inertia, Stepped, Work};
pub use motion::ImplicitMotion;
pub use relaxers::{GradientFlow, ImplicitDynamics};
