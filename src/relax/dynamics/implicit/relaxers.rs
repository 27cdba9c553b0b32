//! [`ImplicitDynamics`] and [`GradientFlow`]: the relaxers with implicit steps, and their settings.

use serde::{Deserialize, Serialize};

use crate::law::damping::{ConstantDamping, ContactDamping, DampingChoice};
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::dynamics::damped::NetForce;
use crate::relax::dynamics::implicit::inertia::Inertia;
use crate::relax::dynamics::implicit::integration::Integration;
use crate::relax::dynamics::implicit::newton_finish::Finish;
use crate::relax::force_limit::ForceLimit;
use crate::relax::outcome::Outcome;
use crate::relax::relaxer::Relaxer;
use crate::relax::trace::Trace;

/// Settings of damped dynamics with implicit steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ImplicitDynamics {
    /// Damping law of contacts. Changes results.
    pub damping: DampingChoice,
    /// Criterion of mechanical equilibrium. Changes results.
    pub limit: ForceLimit,
    /// Net force to which the limit applies. Changes results.
    pub net_force: NetForce,
    /// Error allowed in one step, over the median overlap \[1\]. Changes results where minima lie close together.
    pub tolerance: f64,
    /// How the motion ends.
    pub finish: Finish,
    /// Largest number of steps, rejected ones included. A phase of explicit or stabilised steps counts as one.
    pub step_limit: usize,
}

/// Settings of gradient flow, the path of steepest descent, with implicit steps. It ends in the minimum whose basin
/// contains the start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GradientFlow {
    /// Criterion of mechanical equilibrium. Changes results.
    pub limit: ForceLimit,
    /// Error allowed in one step, over the median overlap \[1\]. Changes results where minima lie close together.
    pub tolerance: f64,
    /// How the flow ends.
    pub finish: Finish,
    /// Largest number of steps, rejected ones included.
    pub step_limit: usize,
}

/// Default tolerance, see the book.
const TOLERANCE: f64 = 0.01;

/// Default largest number of steps.
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
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
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

    fn for_intermediate_states(&self, limit: f64) -> Option<Self> {
        self.limit.loosened(limit).map(|limit| ImplicitDynamics { limit, ..*self })
    }
}

impl Relaxer for GradientFlow {
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let run = Integration {
            limit: self.limit,
            net_force: NetForce::Elastic,
            tolerance: self.tolerance,
            finish: self.finish,
            step_limit: self.step_limit,
        };
        // The friction sets the unit of time: its value is arbitrary.
        run.relax(packing, law, &ContactDamping::Constant(ConstantDamping { rate: 0.0 }), Inertia::Friction(1.0), trace)
    }

    fn for_intermediate_states(&self, limit: f64) -> Option<Self> {
        self.limit.loosened(limit).map(|limit| GradientFlow { limit, ..*self })
    }
}
