//! [`EnergyAccount`]: the energies of a relaxation.

use serde::{Deserialize, Serialize};

/// Energies of a relaxation, from its start to its end.
///
/// ```text
/// before = after + damped + left ± imbalance
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct EnergyAccount {
    /// Elastic energy at the start \[energy\].
    pub before: f64,
    /// Elastic energy at the end \[energy\].
    pub after: f64,
    /// Work of damping and friction along a motion; not written if 0 \[energy\].
    #[serde(default, skip_serializing_if = "is_none")]
    pub damped: f64,
    /// Elastic and kinetic energy above the end, when the motion stopped or Newton's method took over \[energy\].
    #[serde(default, skip_serializing_if = "is_none")]
    pub left: f64,
    /// Energy that the steps of a motion leave unaccounted for: the sum of |Δ(E + K + W)| \[energy\].
    #[serde(default, skip_serializing_if = "is_none")]
    pub imbalance: f64,
}

fn is_none(energy: &f64) -> bool {
    *energy == 0.0
}

impl EnergyAccount {
    /// The account of this relaxation and of one that begins where it ended.
    pub(crate) fn then(self, next: EnergyAccount) -> EnergyAccount {
        EnergyAccount {
            before: self.before,
            after: next.after,
            damped: self.damped + next.damped,
            left: self.left + next.left,
            imbalance: self.imbalance + next.imbalance,
        }
    }
}
