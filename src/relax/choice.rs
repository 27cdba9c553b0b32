//! [`RelaxerChoice`]: a relaxer chosen at run time.

use serde::{Deserialize, Serialize};

use crate::law::damping::DampingChoice;
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::dynamics::damped::{DampedDynamics, NetForce};
#[cfg(feature = "linear")]
use crate::relax::dynamics::implicit::relaxers::{GradientFlow, ImplicitDynamics};
use crate::relax::fire::settings::{Fire, Precision};
use crate::relax::force_limit::ForceLimit;
use crate::relax::minimise::conjugate_gradients::NonlinearConjugateGradients;
#[cfg(feature = "linear")]
use crate::relax::minimise::fire_then_newton::Staged;
use crate::relax::minimise::lbfgs::QuasiNewton;
#[cfg(feature = "linear")]
use crate::relax::minimise::newton::Newton;
use crate::relax::outcome::Outcome;
use crate::relax::relaxer::Relaxer;
use crate::relax::trace::Trace;

/// A relaxer chosen at run time, as named in a scene.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RelaxerChoice {
    /// [`Fire`].
    Fire(Fire),
    /// [`DampedDynamics`].
    Damped(DampedDynamics),
    /// [`NonlinearConjugateGradients`].
    ConjugateGradients(NonlinearConjugateGradients),
    /// [`QuasiNewton`].
    QuasiNewton(QuasiNewton),
    /// [`ImplicitDynamics`].
    #[cfg(feature = "linear")]
    Implicit(ImplicitDynamics),
    /// [`GradientFlow`].
    #[cfg(feature = "linear")]
    GradientFlow(GradientFlow),
    /// [`Newton`].
    #[cfg(feature = "linear")]
    Newton(Newton),
    /// [`Staged`].
    #[cfg(feature = "linear")]
    Staged(Staged),
}

impl Default for RelaxerChoice {
    fn default() -> Self {
        RelaxerChoice::Fire(Fire::default())
    }
}

impl RelaxerChoice {
    /// Its force limit.
    pub fn limit(&self) -> ForceLimit {
        match self {
            RelaxerChoice::Fire(fire) => fire.limit,
            RelaxerChoice::Damped(damped) => damped.limit,
            RelaxerChoice::ConjugateGradients(conjugate_gradients) => conjugate_gradients.limit,
            RelaxerChoice::QuasiNewton(quasi_newton) => quasi_newton.limit,
            #[cfg(feature = "linear")]
            RelaxerChoice::Implicit(dynamics) => dynamics.limit,
            #[cfg(feature = "linear")]
            RelaxerChoice::GradientFlow(flow) => flow.limit,
            #[cfg(feature = "linear")]
            RelaxerChoice::Newton(newton) => newton.limit,
            #[cfg(feature = "linear")]
            RelaxerChoice::Staged(staged) => staged.limit,
        }
    }

    /// Its description in a report. Dynamics are described by their damping law and rate: "viscoelastic 500".
    ///
    /// It contains what a minimum depends on, but no limits and no tolerances.
    pub fn description(&self) -> String {
        let precise = |words: &str, precision: Precision| match precision {
            Precision::Double => words.to_string(),
            Precision::Mixed => format!("{words}, mixed precision"),
        };
        let damped = |damping: DampingChoice, net_force: NetForce| {
            let law = match damping {
                DampingChoice::Constant(_) => "constant damping",
                DampingChoice::Viscoelastic(_) => "viscoelastic",
            };
            let total = if net_force == NetForce::Total { ", total force" } else { "" };
            format!("{law} {}{total}", damping.rate())
        };
        match self {
            RelaxerChoice::Fire(fire) => precise("FIRE", fire.precision),
            RelaxerChoice::Damped(dynamics) => format!("{}, explicit", damped(dynamics.damping, dynamics.net_force)),
            RelaxerChoice::ConjugateGradients(_) | RelaxerChoice::QuasiNewton(_) => self.name().into(),
            #[cfg(feature = "linear")]
            RelaxerChoice::Implicit(dynamics) => damped(dynamics.damping, dynamics.net_force),
            #[cfg(feature = "linear")]
            RelaxerChoice::GradientFlow(_) | RelaxerChoice::Newton(_) => self.name().into(),
            #[cfg(feature = "linear")]
            RelaxerChoice::Staged(staged) => precise("FIRE and Newton", staged.precision),
        }
    }

    /// Its name in a table.
    pub fn name(&self) -> &'static str {
        match self {
            RelaxerChoice::Fire(fire) => match fire.precision {
                Precision::Double => "FIRE",
                Precision::Mixed => "FIRE, mixed",
            },
            RelaxerChoice::Damped(damped) => match damped.net_force {
                NetForce::Elastic => "damped dynamics",
                NetForce::Total => "damped, total force",
            },
            RelaxerChoice::ConjugateGradients(_) => "conjugate gradients",
            RelaxerChoice::QuasiNewton(_) => "L-BFGS",
            #[cfg(feature = "linear")]
            RelaxerChoice::Implicit(dynamics) => match dynamics.net_force {
                NetForce::Elastic => "implicit dynamics",
                NetForce::Total => "implicit, total force",
            },
            #[cfg(feature = "linear")]
            RelaxerChoice::GradientFlow(_) => "gradient flow",
            #[cfg(feature = "linear")]
            RelaxerChoice::Newton(_) => "Newton",
            #[cfg(feature = "linear")]
            RelaxerChoice::Staged(staged) => match staged.precision {
                Precision::Double => "FIRE, then Newton",
                Precision::Mixed => "mixed FIRE, Newton",
            },
        }
    }
}

impl Relaxer for RelaxerChoice {
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        match self {
            RelaxerChoice::Fire(fire) => fire.relax(packing, law, trace),
            RelaxerChoice::Damped(damped) => damped.relax(packing, law, trace),
            RelaxerChoice::ConjugateGradients(conjugate_gradients) => conjugate_gradients.relax(packing, law, trace),
            RelaxerChoice::QuasiNewton(quasi_newton) => quasi_newton.relax(packing, law, trace),
            #[cfg(feature = "linear")]
            RelaxerChoice::Implicit(dynamics) => dynamics.relax(packing, law, trace),
            #[cfg(feature = "linear")]
            RelaxerChoice::GradientFlow(flow) => flow.relax(packing, law, trace),
            #[cfg(feature = "linear")]
            RelaxerChoice::Newton(newton) => newton.relax(packing, law, trace),
            #[cfg(feature = "linear")]
            RelaxerChoice::Staged(staged) => staged.relax(packing, law, trace),
        }
    }

    fn for_intermediate_states(&self, limit: f64) -> Option<Self> {
        Some(match self {
            RelaxerChoice::Fire(fire) => RelaxerChoice::Fire(fire.for_intermediate_states(limit)?),
            RelaxerChoice::Damped(damped) => RelaxerChoice::Damped(damped.for_intermediate_states(limit)?),
            RelaxerChoice::ConjugateGradients(relaxer) => {
                RelaxerChoice::ConjugateGradients(relaxer.for_intermediate_states(limit)?)
            }
            RelaxerChoice::QuasiNewton(relaxer) => RelaxerChoice::QuasiNewton(relaxer.for_intermediate_states(limit)?),
            #[cfg(feature = "linear")]
            RelaxerChoice::Implicit(dynamics) => RelaxerChoice::Implicit(dynamics.for_intermediate_states(limit)?),
            #[cfg(feature = "linear")]
            RelaxerChoice::GradientFlow(flow) => RelaxerChoice::GradientFlow(flow.for_intermediate_states(limit)?),
            #[cfg(feature = "linear")]
            RelaxerChoice::Newton(newton) => RelaxerChoice::Newton(newton.for_intermediate_states(limit)?),
            #[cfg(feature = "linear")]
            RelaxerChoice::Staged(staged) => RelaxerChoice::Staged(staged.for_intermediate_states(limit)?),
        })
    }
}
