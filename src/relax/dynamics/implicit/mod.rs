//! Damped dynamics and gradient flow by long implicit steps.
//!
//! ```text
//! damped dynamics   v̇ = F(u) − Σ c_ij (n·v_ij) n,  u̇ = v        gradient flow   ζ u̇ = F(u)
//! ```
//!
//! The equations are stiff: contacts relax in 10⁻³ of the time of the softest modes, and an explicit step must resolve
//! the contacts. An implicit step need not. The estimated error sets its length: the largest error over the backbone,
//! in units of the median overlap. If a contact opens or closes within a step, the force or the damping has a kink or a
//! jump. The stages then disagree, and the step is repeated with a shorter length. Near the minimum the steps grow
//! without bound and become Newton steps. See [`ImplicitMotion`] for the step and [`tableau`] for the method. While
//! collisions keep steps short, stabilised explicit steps replace them, and multirate steps resolve the colliding
//! disks.

mod allowed_error;
mod explicit_phase;
mod inertia;
mod integration;
mod method_selection;
mod motion;
mod multirate;
mod newton_finish;
pub(crate) mod relaxers;
mod rkc;
mod rosenbrock;
mod stagnation;
mod step_control;
mod step_matrix;
pub mod tableau;

pub use inertia::{Inertia, Stepped, Work};
pub use motion::ImplicitMotion;
pub use newton_finish::Finish;
pub use relaxers::{GradientFlow, ImplicitDynamics};
