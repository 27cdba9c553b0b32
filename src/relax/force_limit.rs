//! [`ForceLimit`]: when a packing counts as at rest. Thresholds for an unjammed packing and for a disk that ran away.

use serde::{Deserialize, Serialize};

/// When a packing counts as at rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceLimit {
    /// Largest net force on a mobile disk of the backbone over the mean contact force \[1\].
    Relative(f64),
    /// Largest net force on a mobile disk of the backbone; on any mobile disk without a backbone \[force\].
    Absolute(f64),
}

impl Default for ForceLimit {
    /// 10⁻⁸ of the mean contact force. An absolute limit of 10⁻⁷ means 2·10⁻⁶ of it at p = 0.04 and 10⁻¹⁰ at p = 860.
    fn default() -> Self {
        ForceLimit::Relative(1e-8)
    }
}

impl ForceLimit {
    /// The value of the limit \[1, or force\].
    pub fn value(&self) -> f64 {
        match *self {
            ForceLimit::Relative(value) | ForceLimit::Absolute(value) => value,
        }
    }

    /// A relative limit that replaces this one; none if this one is relative and not below it.
    pub(crate) fn loosened(self, limit: f64) -> Option<ForceLimit> {
        (!matches!(self, ForceLimit::Relative(own) if own >= limit)).then_some(ForceLimit::Relative(limit))
    }
}

/// Contact forces below this share of the force at an overlap of one radius count as zero: the packing is unjammed.
///
/// 10⁻¹² is 3.5·10⁻⁸ for the Hertzian disks of the model, where a packing at p = 0.05 has contact forces of 0.05.
pub const UNJAMMED_FORCE: f64 = 1e-12;

/// Distance of a disk from its site, over the largest radius, at which it has run away \[1\]. At a diameter it has left
/// the cage of its neighbours. Closer to the site, contacts may still hold it; farther out, the push Γu only grows.
pub const RUNAWAY: f64 = 2.0;
