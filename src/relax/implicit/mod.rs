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

mod chebyshev;
mod finish;
mod growth;
mod integration;
mod matrix;
mod motion;
mod pace;
mod restless;
mod stretch;
pub mod tableau;

use serde::{Deserialize, Serialize};

use crate::law::damping::{ConstantDamping, ContactDamping, DampingChoice};
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::implicit::integration::Integration;
use crate::relax::{ForceLimit, NetForce, Outcome, Relaxer, Trace};

pub use motion::{ImplicitMotion, Inertia, Stepped, Work};

/// Damped dynamics by implicit steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ImplicitDynamics {
    /// How contacts dissipate. Changes results.
    pub damping: DampingChoice,
    /// When the packing counts as at rest. Changes results.
    pub limit: ForceLimit,
    /// Which net force the limit is on. Changes results.
    pub net_force: NetForce,
    /// Error allowed in one step, over the mean overlap \[1\]. Changes results where minima lie close together.
    pub tolerance: f64,
    /// What the last part of the way is left to.
    pub finish: Finish,
    /// Steps allowed, rejected ones included; a stretch of explicit or stabilised steps counts as one.
    pub step_limit: usize,
}

/// Gradient flow, the path of steepest descent, by implicit steps: it ends in the minimum to whose basin the start belongs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GradientFlow {
    /// When the packing counts as at rest. Changes results.
    pub limit: ForceLimit,
    /// Error allowed in one step, over the mean overlap \[1\]. Changes results where minima lie close together.
    pub tolerance: f64,
    /// What the last part of the way is left to.
    pub finish: Finish,
    /// Steps allowed, rejected ones included.
    pub step_limit: usize,
}

/// How a motion ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finish {
    /// By its own steps.
    Motion,
    /// By [`Newton`](super::Newton) from this relative residual r on \[1\], once the backbone's kinetic energy is r² of the elastic one.
    /// Its minimum is taken if it is nearer than a tenth of an overlap, or if it is found again after the kinetic energy has fallen to
    /// a quarter; until then the motion goes on from where it was.
    Newton(f64),
}

impl Default for Finish {
    /// From 10⁻² on. Nine viscoelastic motions of 5548 disks (p = 0.05 to 1) end in the same minimum, each, when Newton's method is tried from
    /// 3·10⁻², 10⁻² or 10⁻³ on; the last takes two to four times the evaluations.
    fn default() -> Self {
        Finish::Newton(1e-2)
    }
}

/// Default of the tolerance: see the book.
const TOLERANCE: f64 = 0.01;

/// Steps allowed by default.
const STEP_LIMIT: usize = 100_000;

impl Default for ImplicitDynamics {
    fn default() -> Self {
        ImplicitDynamics {
            damping: DampingChoice::default(),
            limit: ForceLimit::default(),
            net_force: NetForce::default(),
            tolerance: TOLERANCE,
            finish: Finish::default(),
            step_limit: STEP_LIMIT,
        }
    }
}

impl Default for GradientFlow {
    fn default() -> Self {
        GradientFlow {
            limit: ForceLimit::default(),
            tolerance: TOLERANCE,
            finish: Finish::default(),
            step_limit: STEP_LIMIT,
        }
    }
}

impl Relaxer for ImplicitDynamics {
    fn relax<const D: usize, L: PairLaw>(
        &self,
        packing: Packing<D>,
        law: &L,
        trace: &mut impl Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let run = Integration {
            limit: self.limit,
            net_force: self.net_force,
            tolerance: self.tolerance,
            finish: self.finish,
            step_limit: self.step_limit,
        };
        run.relax(packing, law, &law.contact_damping(&self.damping), Inertia::Massive, trace)
    }

    fn passing(&self, limit: f64) -> Option<Self> {
        self.limit.loosened(limit).map(|limit| ImplicitDynamics { limit, ..*self })
    }
}

impl Relaxer for GradientFlow {
    fn relax<const D: usize, L: PairLaw>(
        &self,
        packing: Packing<D>,
        law: &L,
        trace: &mut impl Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let run = Integration {
            limit: self.limit,
            net_force: NetForce::Elastic,
            tolerance: self.tolerance,
            finish: self.finish,
            step_limit: self.step_limit,
        };
        // The unit of time is that of the friction: 1 is as good as any.
        run.relax(packing, law, &ContactDamping::Constant(ConstantDamping { rate: 0.0 }), Inertia::Friction(1.0), trace)
    }

    fn passing(&self, limit: f64) -> Option<Self> {
        self.limit.loosened(limit).map(|limit| GradientFlow { limit, ..*self })
    }
}
