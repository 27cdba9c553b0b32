//! [`ProtocolChoice`]: the relaxation protocols, by name.
//!
//! ```text
//! random points ─► quenched at φ, or quenched and brought to p, by FIRE ─► inflated ─► relaxed by the relaxer of the
//! protocol
//! ```
//!
//! Near jamming a packing has many minima, and the relaxer determines the final one. With viscoelastic damping a
//! contact near jamming is underdamped: inertia carries disks over barriers that the other relaxers never cross. So the
//! plastic phase of an ensemble depends on the protocol, and every report names it.

use serde::{Deserialize, Serialize};

use crate::law::damping::{ConstantDamping, DampingChoice, ViscoelasticDamping};
use crate::relax::{Fire, RelaxerChoice};
#[cfg(feature = "linear")]
use crate::relax::{ImplicitDynamics, Staged};
use crate::scene::source::Source;

/// The protocol of relaxation after the inflation.
///
/// The default is that of the study. In builds without the feature `linear` it is FIRE, because explicit damped steps
/// take a hundred times longer near jamming.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ProtocolChoice {
    /// Damped dynamics, c_ij = γ m_eff √(δ R_ij) with γ = 500: underdamped near jamming. Source: the study
    /// (viscoelastic damping, η_n = 500).
    #[cfg_attr(feature = "linear", default)]
    Study,
    /// Damped dynamics, c_ij = γ with γ = 500: overdamped near jamming.
    Constant,
    /// FIRE, then Newton's method: a minimum near the start.
    FireNewton,
    /// FIRE alone.
    #[cfg_attr(not(feature = "linear"), default)]
    Fire,
}

/// γ of either damping law. Source: the study, η_n = 500.
const RATE: f64 = 500.0;

impl ProtocolChoice {
    /// All protocols.
    pub const ALL: [ProtocolChoice; 4] =
        [ProtocolChoice::Study, ProtocolChoice::Constant, ProtocolChoice::FireNewton, ProtocolChoice::Fire];

    /// Its name in a scene and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            ProtocolChoice::Study => "study",
            ProtocolChoice::Constant => "constant",
            ProtocolChoice::FireNewton => "fire-newton",
            ProtocolChoice::Fire => "fire",
        }
    }

    /// A short description.
    pub fn title(self) -> &'static str {
        match self {
            ProtocolChoice::Study => "damped dynamics, viscoelastic damping of rate 500, as the published study",
            ProtocolChoice::Constant => "damped dynamics, constant damping of rate 500",
            ProtocolChoice::FireNewton => "FIRE and Newton's method in turn",
            ProtocolChoice::Fire => "FIRE alone",
        }
    }

    /// The relaxer after the inflation. Without the feature `linear` damped dynamics take explicit steps, and FIRE is
    /// not followed by Newton's method.
    pub fn relaxer(self) -> RelaxerChoice {
        match self {
            ProtocolChoice::Study => damped(DampingChoice::Viscoelastic(ViscoelasticDamping { rate: RATE })),
            ProtocolChoice::Constant => damped(DampingChoice::Constant(ConstantDamping { rate: RATE })),
            #[cfg(feature = "linear")]
            ProtocolChoice::FireNewton => RelaxerChoice::Staged(Staged::default()),
            #[cfg(not(feature = "linear"))]
            ProtocolChoice::FireNewton => RelaxerChoice::Fire(Fire::default()),
            ProtocolChoice::Fire => RelaxerChoice::Fire(Fire::default()),
        }
    }

    /// The relaxer of a packing of disks from this source: FIRE for one quenched below jamming.
    pub fn relaxer_of(self, source: &Source) -> RelaxerChoice {
        self.relaxer_in(2, source)
    }

    /// The same in two or three dimensions.
    pub fn relaxer_in(self, dimension: usize, source: &Source) -> RelaxerChoice {
        if source.is_below_jamming(dimension) { RelaxerChoice::Fire(Fire::default()) } else { self.relaxer() }
    }

    /// The protocol with this relaxer after the inflation, if there is one.
    pub fn of(relaxer: &RelaxerChoice) -> Option<Self> {
        Self::ALL.into_iter().find(|protocol| protocol.relaxer() == *relaxer)
    }
}

#[cfg(feature = "linear")]
fn damped(damping: DampingChoice) -> RelaxerChoice {
    RelaxerChoice::Implicit(ImplicitDynamics { damping, ..ImplicitDynamics::default() })
}

#[cfg(not(feature = "linear"))]
fn damped(damping: DampingChoice) -> RelaxerChoice {
    RelaxerChoice::Damped(crate::relax::DampedDynamics { damping, ..Default::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_that_of_a_scene_file() {
        for protocol in ProtocolChoice::ALL {
            let written = serde_json::to_string(&protocol).expect("a name");
            assert_eq!(written, format!("\"{}\"", protocol.name()));
        }
    }

    #[test]
    fn fire_relaxes_what_is_quenched_below_jamming() {
        let fire = RelaxerChoice::Fire(Fire::default());
        for protocol in ProtocolChoice::ALL {
            assert_eq!(protocol.relaxer_of(&Source::PackingFraction(0.82)), fire);
            assert_eq!(protocol.relaxer_of(&Source::PackingFraction(0.86)), protocol.relaxer());
            assert_eq!(protocol.relaxer_of(&Source::Pressure(1.0)), protocol.relaxer());
        }
        #[cfg(feature = "linear")]
        for protocol in ProtocolChoice::ALL {
            assert_eq!(ProtocolChoice::of(&protocol.relaxer()), Some(protocol));
        }
    }
}
