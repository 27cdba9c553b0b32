//! A polynomial by Horner's rule.

/// `Σ c_k t^k`.
pub(crate) fn polynomial(coefficients: &[f64], t: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, &coefficient| sum * t + coefficient)
}
