//! [`PressureChange`]: the change of the pressure by an inflation, Δp, and Δp over the power of p of the bulk modulus.
//!
//! ```text
//! Δp = p_after − p_before        Δp/p^((α−2)/(α−1)),  p = p_before:  Δp/p^(1/3) for Hertzian contacts, Δp for Hookean
//! ```
//!
//! The bulk modulus of a jammed packing scales with its overlaps as δ^(α−2), the pressure as δ^(α−1). So the ratio of
//! an elastic response does not depend on p.
//!
//! # Source
//! O'Hern, Silbert, Liu, Nagel (2003), Phys. Rev. E 68, 011306 (exponents).

use serde::{Deserialize, Serialize};

use crate::inflation::{Inflated, Rest};
use crate::law::pair_law::PairLaw;

/// Δp of an inflation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PressureChange {
    /// p before \[force / length^(D−1)\].
    pub before: f64,
    /// p after \[force / length^(D−1)\].
    pub after: f64,
    /// Δp \[force / length^(D−1)\].
    pub change: f64,
    /// (α − 2)/(α − 1) \[1\].
    pub exponent: f64,
    /// Δp over that power of p \[(force / length^(D−1))^(1/(α−1))\]; absent if the pressure was 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scaled: Option<f64>,
}

impl PressureChange {
    /// Δp between two pressures, under a law of energy ∝ δ^α with α = `law_exponent`.
    pub fn between(before: f64, after: f64, law_exponent: f64) -> Self {
        let (change, exponent) = (after - before, pressure_exponent(law_exponent));
        let scaled = (before > 0.0).then(|| change / libm::pow(before, exponent));
        PressureChange { before, after, change, exponent, scaled }
    }

    /// Δp of an inflation.
    pub fn of_inflation<const D: usize>(inflated: &Inflated<D>, law: &dyn PairLaw) -> Self {
        Self::to(inflated, &inflated.after, law)
    }

    /// Δp that remains after the deflation; none without a deflation.
    pub fn of_cycle<const D: usize>(inflated: &Inflated<D>, law: &dyn PairLaw) -> Option<Self> {
        inflated.deflated.as_ref().map(|deflated| Self::to(inflated, deflated, law))
    }

    fn to<const D: usize>(inflated: &Inflated<D>, state: &Rest<D>, law: &dyn PairLaw) -> Self {
        Self::between(inflated.before.pressure, state.pressure, law.exponent())
    }
}

/// (α − 2)/(α − 1): the exponent of the bulk modulus of a jammed packing as a power of p \[1\].
pub fn pressure_exponent(law_exponent: f64) -> f64 {
    (law_exponent - 2.0) / (law_exponent - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hertzian_contacts_have_a_third_and_hookean_ones_nothing() {
        // 8^(1/3) = 2 to rounding.
        let hertzian = PressureChange::between(8.0, 7.5, 2.5);
        assert_eq!((hertzian.change, hertzian.exponent), (-0.5, 0.5 / 1.5));
        assert!((hertzian.scaled.expect("jammed") + 0.25).abs() < 1e-15);
        assert_eq!(PressureChange::between(8.0, 7.5, 2.0).scaled, Some(-0.5));
        assert_eq!(PressureChange::between(0.0, 0.0, 2.5).scaled, None);
    }
}
