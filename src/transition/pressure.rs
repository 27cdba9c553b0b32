//! [`TransitionPressure`]: p̂_c of a series, by several methods.
//!
//! | method | p̂_c is where | evidence |
//! |---|---|---|
//! | κ | half of the samples have κ_fit ≥ κ_1/2 | logistic regression in ln p̂ |
//! | Δp | half of the samples have Δp < 0 | the same |
//! | G* | the mean crosses 1 − 2^(−1/2) = 0.293, its value for S ∝ f^(−1.5) | linear in ln p̂ between cells, after isotonic regression |
//! | θ* | the mean crosses 0.303 π, its value for S ∝ f^(−1.5) | the same |
//! | S(f), least squares | the slope of the mean spectrum by least squares in logarithms crosses 1.5 | the same |
//! | S(f), likelihood | the same slope by maximum likelihood | the same |
//! | f† | f† of the mean spectrum falls below 0.1: from f = 1 on a power law within 3 % | the same |
//!
//! A cell counts if it has at least 8 samples. For κ and Δp, two such cells and 20 samples must lie on either side of a
//! crossing. A bound needs two cells on its side, and an end cell that excludes one half, or the level, at 95 %.
//! Otherwise the method is [uninformative](TransitionPressure::Uninformative).
//!
//! κ_1 R = 3.8317, the first zero of J_1: κ_fit of single samples is either near 0 or at least κ_1 (the study, fig. 2).
//!
//! For spheres κ_1 R = 4.4934, the first zero of j_1, and only κ and Δp are used: what G*, γ* and S(ℓ) are at a
//! transition in three dimensions is not known.

use std::f64::consts::PI;

use serde::Serialize;

use crate::fit::ensemble::BootstrapInterval;
use crate::transition::evidence::CannotTell;

/// κ_1 R and κ_2 R for a ≪ R: the first zeros of J_1 for disks (2), of j_1 for spheres (3), of the sine in a strip (1).
/// Source: DLMF, §10.21(i), §10.58.
pub(crate) fn poles(spreading_dimension: usize) -> [f64; 2] {
    match spreading_dimension {
        1 => [PI, 2.0 * PI],
        3 => [4.493_409_457_909_064, 7.725_251_836_937_707],
        _ => [3.831_705_970_207_512, 7.015_586_669_815_618],
    }
}

/// G* for S ∝ f^(−1.5): 1 − 2^(−1/2).
pub(crate) const SCALE_FREE_ANTICORRELATION: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// θ* for S ∝ f^(−1.5), threshold 0.1 \[rad\].
pub(crate) const SCALE_FREE_ANGLE: f64 = 0.303_004 * PI;

/// Slope of the scale-free spectrum.
pub(crate) const SCALE_FREE_SLOPE: f64 = 1.5;

/// Method to determine p̂_c.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// κ_fit.
    Wavenumber,
    /// The sign of Δp.
    PressureChange,
    /// G*.
    Anticorrelation,
    /// θ*.
    Angle,
    /// The slope of S(f) by least squares in logarithms.
    Spectrum,
    /// The slope of S(f) by maximum likelihood.
    SpectrumLikelihood,
    /// f†.
    Crossover,
}

impl Method {
    /// A description in words.
    pub fn name(self) -> &'static str {
        match self {
            Method::Wavenumber => "κ",
            Method::PressureChange => "Δp",
            Method::Anticorrelation => "G*",
            Method::Angle => "θ*",
            Method::Spectrum => "slope of S(f), least squares",
            Method::SpectrumLikelihood => "slope of S(f), likelihood",
            Method::Crossover => "f†",
        }
    }
}

/// p̂_c by one method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MethodEstimate {
    /// The method.
    pub method: Method,
    /// The result.
    pub pressure: TransitionPressure,
    /// Lowest and highest p̂ of the cells that count; none for fewer than two \[force / length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<[f64; 2]>,
    /// Smallest number of samples of the cells that count; of all cells if fewer than two count.
    pub sample_count: usize,
}

impl MethodEstimate {
    /// p̂_c by the slope of the spectrum by least squares, if this method was used.
    pub(super) fn by_spectrum(&self) -> Option<TransitionPressure> {
        (self.method == Method::Spectrum).then_some(self.pressure)
    }
}

/// The position of the transition.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TransitionPressure {
    /// At this p̂, with its interval.
    Found(BootstrapInterval),
    /// Between the p̂ of two cells: all samples are plastic up to the first, none from the second on.
    Between([f64; 2]),
    /// Above the highest p̂ of the series: all its cells are plastic.
    Above(f64),
    /// Below the lowest p̂ of the series: all its cells are quasielastic.
    Below(f64),
    /// There are significantly plastic and quasielastic cells, but not in this order.
    Unordered,
    /// No conclusion.
    Uninformative {
        /// The reason.
        reason: CannotTell,
    },
}

impl TransitionPressure {
    /// The best value of p̂_c \[force / length\].
    pub fn best(self) -> Option<f64> {
        match self {
            TransitionPressure::Found(found) => Some(found.best),
            TransitionPressure::Between([low, high]) => Some((low * high).sqrt()),
            _ => None,
        }
    }

    /// Its interval \[force / length\], if there is one; a bound has none.
    pub fn interval(self) -> Option<[f64; 2]> {
        match self {
            TransitionPressure::Found(found) => found.interval,
            TransitionPressure::Between(between) => Some(between),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::bessel::{cylinder, spherical};

    #[test]
    fn poles_are_the_first_zeros_of_the_bessel_functions() {
        for dimension in [2, 3] {
            let j1 = |x| if dimension == 3 { spherical::j1(x) } else { cylinder::j1(x) };
            let [first, second] = poles(dimension);
            for zero in [first, second] {
                // A slope of at most 0.41 and a number rounded to 16 digits.
                assert!(j1(zero).abs() < 1e-15, "{dimension}: {zero}");
            }
            // The next zeros are about π apart, so none lies between.
            assert!(first > 3.0 && second - first < 3.5 && j1(1.0) > 0.0);
        }
    }
}
