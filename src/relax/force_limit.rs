//! [`ForceLimit`]: when a packing counts as at rest; and the limits beyond which no residual is asked for.

use serde::{Deserialize, Serialize};

/// When a packing counts as being at rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceLimit {
    /// Largest net force on a mobile disk of the backbone over the mean contact force \[1\].
    Relative(f64),
    /// Largest net force on a mobile disk of the backbone, of any mobile disk where there is no backbone \[force\].
    Absolute(f64),
}

impl Default for ForceLimit {
    /// 10⁻⁸ of the mean contact force. Source: design §7 (an absolute limit means 2·10⁻⁶ at p = 0.04 and 10⁻¹⁰ at 860).
    fn default() -> Self {
        ForceLimit::Relative(1e-8)
    }
}

impl ForceLimit {
    /// The number, whatever it is relative to \[1, or force\].
    pub fn value(&self) -> f64 {
        match *self {
            ForceLimit::Relative(value) | ForceLimit::Absolute(value) => value,
        }
    }

    /// A relative limit in place of this one, unless this is a relative one that asks for no less.
    pub(crate) fn loosened(self, limit: f64) -> Option<ForceLimit> {
        (!matches!(self, ForceLimit::Relative(own) if own >= limit)).then_some(ForceLimit::Relative(limit))
    }
}

/// Contact forces below this share of the force at an overlap of one radius count as none: the packing is unjammed.
///
/// 10⁻¹² is 3.5·10⁻⁸ for the Hertzian disks of the model, where a packing at p = 0.05 has contact forces of 0.05.
pub const UNJAMMED_FORCE: f64 = 1e-12;

/// Way of a disk from its site over the largest radius from which on it counts as run away \[1\]: a diameter, so it has left
/// the cage of its neighbours. Up to there contacts could have held it; beyond, the push Γu only grows.
pub const RUNAWAY: f64 = 2.0;
