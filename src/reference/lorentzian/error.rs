//! [`LorentzianError`]: why a Lorentzian, or an angle of one, could not be computed.

use thiserror::Error;

/// Largest exponent: nodes and time grow with s, and S is nearly a step long before.
pub const LARGEST_EXPONENT: f64 = 100.0;

pub(super) fn check_exponent(exponent: f64) -> Result<(), LorentzianError> {
    if exponent > 1.0 && exponent <= LARGEST_EXPONENT {
        Ok(())
    } else {
        Err(LorentzianError::ExponentOutOfRange { exponent })
    }
}

pub(super) fn check_threshold(threshold: f64) -> Result<(), LorentzianError> {
    if threshold < 1.0 { Ok(()) } else { Err(LorentzianError::ThresholdNotBelowOne { threshold }) }
}

/// Why a Lorentzian, or an angle of one, could not be computed.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum LorentzianError {
    /// The crossover frequency is not positive and finite.
    #[error("the crossover frequency must be positive and finite, it is {crossover}")]
    CrossoverNotPositive {
        /// The frequency given \[1\].
        crossover: f64,
    },
    /// The exponent is 1 or less, where Σ S diverges, or too large, or not finite.
    #[error("the exponent must be above 1 and at most {LARGEST_EXPONENT}, it is {exponent}")]
    ExponentOutOfRange {
        /// The exponent given \[1\].
        exponent: f64,
    },
    /// The threshold is not below 1, the value of G at θ = 0.
    #[error("the threshold must be below 1, it is {threshold}")]
    ThresholdNotBelowOne {
        /// The threshold given \[1\].
        threshold: f64,
    },
}
