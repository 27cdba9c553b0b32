//! [`ProtocolSettings`]: how protocols are compared.

use serde::{Deserialize, Serialize};

/// How protocols are compared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ProtocolSettings {
    /// Share of the samples of a scene that is compared, at least one sample \[1\].
    pub fraction: f64,
    /// ε: largest distance of a disk between two states of one minimum, over the mean overlap \[1\].
    pub same_minimum: f64,
    /// Distance over the mean overlap above which a disk counts as different \[1\].
    pub differing: f64,
    /// Relative residual that Newton's method reaches for every ending \[1\]; at least four times the rounding floor.
    pub residual: f64,
}

impl Default for ProtocolSettings {
    /// All samples; ε = 10⁻⁴; a tenth of an overlap; a residual of 10⁻¹⁰.
    fn default() -> Self {
        ProtocolSettings { fraction: 1.0, same_minimum: 1e-4, differing: 0.1, residual: 1e-10 }
    }
}
