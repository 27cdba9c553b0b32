//! [`ProtocolSettings`]: how protocols are compared.

use serde::{Deserialize, Serialize};

/// How protocols are compared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ProtocolSettings {
    /// Share of the samples of a scene it is done to, at least one of them \[1\].
    pub fraction: f64,
    /// ε: farthest disks of two states in one minimum, over the mean overlap \[1\].
    pub same_minimum: f64,
    /// Distance over the mean overlap beyond which a disk is named as one that differs \[1\].
    pub differing: f64,
    /// Relative residual to which Newton's method brings every ending \[1\]; four times the rounding floor where that is more.
    pub residual: f64,
}

impl Default for ProtocolSettings {
    /// All samples; ε = 10⁻⁴; a tenth of an overlap; 10⁻¹⁰.
    fn default() -> Self {
        ProtocolSettings { fraction: 1.0, same_minimum: 1e-4, differing: 0.1, residual: 1e-10 }
    }
}
