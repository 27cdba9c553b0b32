//! [`Dynamics`]: how the packings of a recipe come to rest after the inflation, by name.
//!
//! Which minimum a packing ends in depends on the way it takes there. With viscoelastic damping a contact near jamming is underdamped: inertia carries
//! disks over barriers that the other dynamics never cross. So the plastic phase of an ensemble depends on the dynamics, and a recipe says which it has.

use serde::Serialize;

#[cfg(feature = "linear")]
use crate::contact::damping::{ConstantDamping, DampingChoice, ViscoelasticDamping};
use crate::relax::{Fire, RelaxerChoice};
#[cfg(feature = "linear")]
use crate::relax::{ImplicitDynamics, Staged};

/// How packings come to rest after the inflation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Dynamics {
    /// FIRE and Newton's method in turn: a minimum near the start.
    #[default]
    FireNewton,
    /// FIRE alone.
    Fire,
    /// Damped dynamics, c_ij = γ with γ = 500: overdamped near jamming.
    #[cfg(feature = "linear")]
    Constant,
    /// Damped dynamics, c_ij = γ m_eff √(δ R_ij) with γ = 500: underdamped near jamming. The published study's source names viscoelastic
    /// damping and η_n = 500.
    #[cfg(feature = "linear")]
    Study,
}

impl Dynamics {
    /// All of them.
    #[cfg(feature = "linear")]
    pub const ALL: &[Dynamics] = &[Dynamics::FireNewton, Dynamics::Fire, Dynamics::Constant, Dynamics::Study];
    /// All of them.
    #[cfg(not(feature = "linear"))]
    pub const ALL: &[Dynamics] = &[Dynamics::FireNewton, Dynamics::Fire];

    /// As it stands on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Dynamics::FireNewton => "fire-newton",
            Dynamics::Fire => "fire",
            #[cfg(feature = "linear")]
            Dynamics::Constant => "constant",
            #[cfg(feature = "linear")]
            Dynamics::Study => "study",
        }
    }

    /// What it is, in a few words.
    pub fn title(self) -> &'static str {
        match self {
            Dynamics::FireNewton => "FIRE and Newton's method in turn",
            Dynamics::Fire => "FIRE alone",
            #[cfg(feature = "linear")]
            Dynamics::Constant => "damped dynamics, constant damping of rate 500",
            #[cfg(feature = "linear")]
            Dynamics::Study => "damped dynamics, viscoelastic damping of rate 500, as the published study",
        }
    }

    /// The relaxer.
    pub fn relaxer(self) -> RelaxerChoice {
        match self {
            #[cfg(feature = "linear")]
            Dynamics::FireNewton => RelaxerChoice::Staged(Staged::default()),
            #[cfg(not(feature = "linear"))]
            Dynamics::FireNewton => RelaxerChoice::Fire(Fire::default()),
            Dynamics::Fire => RelaxerChoice::Fire(Fire::default()),
            #[cfg(feature = "linear")]
            Dynamics::Constant => damped(DampingChoice::Constant(ConstantDamping { rate: RATE })),
            #[cfg(feature = "linear")]
            Dynamics::Study => damped(DampingChoice::Viscoelastic(ViscoelasticDamping { rate: RATE })),
        }
    }
}

/// γ of either law. Source: the published study, η_n = 500.
#[cfg(feature = "linear")]
const RATE: f64 = 500.0;

#[cfg(feature = "linear")]
fn damped(damping: DampingChoice) -> RelaxerChoice {
    RelaxerChoice::Implicit(ImplicitDynamics { damping, ..ImplicitDynamics::default() })
}
