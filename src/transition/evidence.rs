//! Minimum evidence for a statement: [`CannotTell`], [`Sampled`].
//!
//! | rule | minimum |
//! |---|---|
//! | a cell counts | 8 samples |
//! | half of the samples: either side of the crossing | 2 cells and 20 samples |
//! | a bound | the end cell excludes one half, or the level, at 95 %; 2 cells on its side |
//! | θ†(p̂) as a divergence | 5 cells |
//! | a comparison | an interval, 8 samples in every cell, and an interval that is not too wide |
//!
//! An interval that contains the published value may be too wide. For a pressure, its ends are then more than a factor
//! of 10 apart. For any other number, it is wider than the published value and wider than 0.1. A pressure is not
//! compared if its interval extends by more than a factor of 10 from the best value, or beyond the cells.

use serde::Serialize;

use crate::fit::ensemble::BootstrapInterval;

/// Minimum number of samples of a cell. A 95 % bootstrap interval uses n for n − 1 and normal quantiles for Student's.
/// Its coverage of the mean of normal numbers is 89 % for 8 samples and 75 % for 3.
pub(crate) const LEAST_SAMPLES: usize = 8;

/// Minimum number of cells on either side of a crossing by halves, and on the side of a bound. A single cell could be
/// an outlier.
pub(super) const LEAST_CELLS_OF_SIDE: usize = 2;

/// Minimum number of samples on either side of a crossing by halves. The standard error of a share of 20 is at most
/// √(1/4/20) = 0.11.
pub(super) const LEAST_SAMPLES_OF_SIDE: f64 = 20.0;

/// Minimum number of cells of a divergence. A, μ and p̂_c are fitted: five points leave two degrees of freedom.
pub(crate) const LEAST_CELLS: usize = 5;

/// Square of the normal quantile of 95 %, 1.959 964.
const QUANTILE_SQUARED: f64 = 3.841_459;

/// Widest informative factor between pressures: recipes span two to three decades.
const WIDEST_FACTOR: f64 = 10.0;

/// Published numbers below this are compared on this scale. For Δp/p^(1/3) = −0.05, an interval of ±0.05 still
/// determines the sign.
const SMALLEST_SCALE: f64 = 0.1;

/// Why a study gives no conclusion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CannotTell {
    /// Fewer than 8 samples in a cell, or fewer than two cells with 8.
    FewSamples,
    /// A bound from a single cell.
    FewCells,
    /// Fewer than two cells, or fewer than 20 samples, on one side of the crossing.
    OneSide,
    /// The end cell, which would give a bound, may lie on either side.
    EndUndecided,
    /// A cell has samples, but they do not give the number.
    NoValue,
    /// Cells are significant, but not in the order of a transition.
    Unordered,
    /// No interval: more than a tenth of the resamplings give no number.
    NoInterval,
    /// The interval is too wide.
    WideInterval,
    /// The interval extends beyond the measured cells.
    BeyondCells,
}

impl CannotTell {
    /// A description in words.
    pub fn words(self) -> &'static str {
        match self {
            CannotTell::FewSamples => "fewer than 8 samples in a cell",
            CannotTell::FewCells => "fewer than 2 cells on one side",
            CannotTell::OneSide => "fewer than 2 cells or 20 samples on one side",
            CannotTell::EndUndecided => "the end cell may be on either side",
            CannotTell::NoValue => "a cell without a value",
            CannotTell::Unordered => "no single transition",
            CannotTell::NoInterval => "no interval",
            CannotTell::WideInterval => "the interval is too wide",
            CannotTell::BeyondCells => "the interval goes beyond the cells",
        }
    }
}

/// A number, its interval, and the number of samples behind it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sampled {
    /// The number with its interval.
    #[serde(flatten)]
    pub found: BootstrapInterval,
    /// Smallest number of samples of a cell.
    pub sample_count: usize,
}

/// Type of a compared quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    /// A pressure, compared by ratio.
    Pressure,
    /// Any other number, compared by difference.
    Number,
}

impl Quantity {
    /// Whether an interval is too wide for its agreement with the published value to be significant.
    pub fn too_wide(self, [low, high]: [f64; 2], published: f64) -> bool {
        match self {
            // NaN and values that are not positive are too wide.
            Quantity::Pressure => !(low > 0.0 && high <= WIDEST_FACTOR * low),
            Quantity::Number => (high - low).is_nan() || high - low > published.abs().max(SMALLEST_SCALE),
        }
    }
}

/// Why a pressure cannot be compared, if so.
pub(super) fn unsound(found: &BootstrapInterval, measured: [f64; 2]) -> Option<CannotTell> {
    let Some([low, high]) = found.interval else { return Some(CannotTell::NoInterval) };
    // Ends computed from the same cells as e^(ln p̂) may differ by rounding.
    let slack = 1e-9;
    if low < (1.0 - slack) * measured[0] || high > (1.0 + slack) * measured[1] {
        return Some(CannotTell::BeyondCells);
    }
    let wide = found.best > WIDEST_FACTOR * low || high > WIDEST_FACTOR * found.best;
    wide.then_some(CannotTell::WideInterval)
}

/// Whether the 95 % Wilson interval of a share excludes one half.
///
/// Source: Wilson (1927), J. Am. Stat. Assoc. 22, 209: the interval contains the shares P with (h − n P)² ≤ z² n P (1 −
/// P).
pub(super) fn excludes_half(hits: f64, count: f64) -> bool {
    (2.0 * hits - count).powi(2) > QUANTILE_SQUARED * count
}

/// Number of bootstrap resamplings: the ends of an interval are then the tenth values from either end.
pub(crate) const RESAMPLINGS: usize = 400;

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    #[test]
    fn one_of_eight_excludes_one_half_and_two_do_not() {
        assert!(excludes_half(0.0, 4.0) && excludes_half(1.0, 8.0) && excludes_half(7.0, 8.0));
        assert!(!excludes_half(3.0, 3.0) && !excludes_half(2.0, 8.0) && !excludes_half(10.0, 20.0));
        // At 20 the interval of Wilson for 5 hits is 0.112 to 0.469, for 6 hits 0.145 to 0.519.
        assert!(excludes_half(5.0, 20.0) && !excludes_half(6.0, 20.0));
    }

    #[test]
    fn intervals_of_eight_samples_hold_the_mean_in_89_percent_and_of_three_in_75() {
        let mut generator = Pcg64::seed_from_u64(1);
        let mut normal = || {
            let (u, v): (f64, f64) = (generator.random(), generator.random());
            libm::sqrt(-2.0 * libm::log(1.0 - u)) * libm::cos(2.0 * std::f64::consts::PI * v)
        };
        // Resampled means of n have the standard deviation √(Σ (x − mean)²/n²).
        let mut held = |count: usize| {
            let holds = (0..20_000).filter(|_| {
                let values: Vec<f64> = (0..count).map(|_| normal()).collect();
                let mean = values.iter().sum::<f64>() / count as f64;
                let square: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
                mean.abs() < QUANTILE_SQUARED.sqrt() * square.sqrt() / count as f64
            });
            holds.count() as f64 / 20_000.0
        };
        // Standard errors of the shares: 0.0022 and 0.0031.
        let (eight, three) = (held(LEAST_SAMPLES), held(3));
        assert!((eight - 0.89).abs() < 0.01 && (three - 0.75).abs() < 0.012, "{eight} {three}");
    }

    #[test]
    fn intervals_are_too_wide_by_factors_or_by_the_published_value() {
        let pressure = |interval| Quantity::Pressure.too_wide(interval, 1e8);
        assert!(!pressure([4e7, 4e8]) && pressure([4e7, 4.1e8]) && pressure([0.0, 1e8]));
        let number = |interval, published| Quantity::Number.too_wide(interval, published);
        assert!(number([-0.78, 1.13], 0.75) && !number([0.5, 1.24], 0.75));
        // Near 0 the scale is 0.1.
        assert!(!number([-0.1, -0.001], -0.05) && number([-0.1, 0.01], -0.05));
        assert!(number([f64::NAN, 1.0], 0.75));
    }

    #[test]
    fn pressures_far_from_their_cells_or_their_best_are_unsound() {
        let found = |interval| BootstrapInterval {
            best: 1e8,
            standard_error: Some(1e7),
            interval,
            resampling_count: 400,
            failed_count: 0,
        };
        let of = |interval| unsound(&found(interval), [1e6, 1e10]);
        assert_eq!(of(Some([5e7, 2e8])), None);
        assert_eq!(of(None), Some(CannotTell::NoInterval));
        assert_eq!(of(Some([9e6, 2e8])), Some(CannotTell::WideInterval));
        assert_eq!(of(Some([5e7, 1.1e9])), Some(CannotTell::WideInterval));
        assert_eq!(of(Some([9e5, 2e8])), Some(CannotTell::BeyondCells));
        assert_eq!(of(Some([5e7, 1.1e10])), Some(CannotTell::BeyondCells));
    }
}
