//! [`slope_of_mean`]: the slope s of a mean power spectrum, by least squares and by maximum likelihood.

use serde::{Deserialize, Serialize};

use crate::fit::Estimate;
use crate::fit::angular::Interval;
use crate::fit::ensemble::bootstrap::{BootstrapInterval, bootstrap_all};
use crate::fit::ensemble::error::EnsembleFitError;
use crate::fit::ensemble::mean_powers::{Best, Factor, MeanPowers, tabulated};
use crate::fit::search::GridMinimum;

/// Search range of the exponent: −2 to 6 in steps of 1/4.
const FIRST: f64 = -2.0;
const STEP: f64 = 0.25;
const STEPS: u32 = 32;

/// Rise of −2 ln L at two standard errors of one parameter.
const RISE: f64 = 4.0;

/// Both slopes of a mean spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeanSlope {
    /// Least squares of ln P̄ against ln f, with equal weights.
    pub least_squares: LeastSquaresSlope,
    /// Maximum likelihood of gamma-distributed means.
    pub likelihood: LikelihoodSlope,
    /// Number of samples.
    pub sample_count: usize,
    /// Lowest and highest f fitted.
    pub window: [usize; 2],
}

/// A line through ln P̄ against ln f.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LeastSquaresSlope {
    /// The slope exists.
    Found {
        /// s of P̄ ∝ f^(−s), with the error from the scatter about the line \[1\].
        exponent: Estimate,
        /// A, the line at f = 1 \[power\].
        amplitude: f64,
    },
    /// A mean power is not positive and has no logarithm.
    NonPositivePower {
        /// The first such f.
        frequency: usize,
    },
}

impl LeastSquaresSlope {
    /// s, if there is one.
    pub fn exponent(&self) -> Option<f64> {
        match self {
            LeastSquaresSlope::Found { exponent, .. } => Some(exponent.value),
            LeastSquaresSlope::NonPositivePower { .. } => None,
        }
    }
}

/// A maximum-likelihood power law.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LikelihoodSlope {
    /// The maximum exists.
    Found {
        /// s, with the interval where −2 ln L has risen by 4 \[1\].
        exponent: Interval,
        /// A \[power\].
        amplitude: f64,
    },
    /// −2 ln L decreases up to the end of the search range, −2 to 6.
    Undetermined,
    /// At the minimum of −2 ln L, negative means contribute more than a tenth of Σ |P̄/E|.
    NegativePowers,
}

impl LikelihoodSlope {
    /// s, if there is one.
    pub fn exponent(&self) -> Option<f64> {
        match self {
            LikelihoodSlope::Found { exponent, .. } => Some(exponent.best),
            _ => None,
        }
    }
}

/// Fits P̄_f = A f^(−s) in the window f_1 ≤ f ≤ f_2 to the mean of the samples, whose powers are at f = 1, 2, …
///
/// ```text
/// least squares   Σ_f (ln P̄_f − ln A + s ln f)²
/// likelihood      −2 ln L = 2 n Σ_f (ln E_f + P̄_f/E_f)        E_f = A f^(−s),  A in closed form
/// ```
///
/// The likelihood interval assumes that powers at different f are independent and exponentially distributed in each
/// sample. After removal of leakage they scatter more, and the interval by resampling, [`slope_interval`], is reliable
/// instead.
///
/// # Accuracy
/// The mean of powers over the variance of their sample is too flat if few f carry the variance: s = 1.42 instead of
/// 1.5 for f = 1 to 15. Spectra with leakage removed only up to the end of the window are too steep, because higher
/// frequencies count as white. For 240 disks s = 1.58 instead of 1.5 with window and spectrum up to n/8, but 1.51 with
/// the spectrum up to 0.42 n and the window to n/16 (`cargo test ensemble_fits::rings -- --nocapture`).
///
/// # Errors
/// No sample, samples of different lengths, a power that is not finite, a window of fewer than three powers or beyond
/// them.
///
/// # Cost
/// Samples × powers, then powers × evaluations of a one-dimensional search.
///
/// # Example
/// ```
/// use jamscope::fit::ensemble::slope_of_mean;
/// let powers: Vec<f64> = (1..=20).map(|f| 0.3 * f64::from(f).powf(-1.5)).collect();
/// let fit = slope_of_mean(&[&powers, &powers], [1, 20])?;
/// assert!((fit.least_squares.exponent().expect("a line") - 1.5).abs() < 1e-12);
/// assert!((fit.likelihood.exponent().expect("a maximum") - 1.5).abs() < 1e-6);
/// # Ok::<(), jamscope::fit::ensemble::EnsembleFitError>(())
/// ```
pub fn slope_of_mean(samples: &[&[f64]], window: [usize; 2]) -> Result<MeanSlope, EnsembleFitError> {
    let powers = MeanPowers::of(samples, window)?;
    let (least_squares, likelihood) = (least_squares(&powers), likelihood(&powers, &PowerLaws::of(window)));
    Ok(MeanSlope { least_squares, likelihood, sample_count: powers.sample_count, window })
}

fn least_squares(powers: &MeanPowers) -> LeastSquaresSlope {
    if let Some(frequency) = powers.non_positive() {
        return LeastSquaresSlope::NonPositivePower { frequency };
    }
    let count = powers.powers.len() as f64;
    let values: Vec<f64> = powers.powers.iter().map(|&power| libm::log(power)).collect();
    let mean = |of: &[f64]| of.iter().sum::<f64>() / count;
    let (at, value) = (mean(&powers.logarithms), mean(&values));
    let pairs = || powers.logarithms.iter().zip(&values).map(|(x, y)| (x - at, y - value));
    let square: f64 = pairs().map(|(x, _)| x * x).sum();
    let slope = pairs().map(|(x, y)| x * y).sum::<f64>() / square;
    let residual: f64 = pairs().map(|(x, y)| (y - slope * x) * (y - slope * x)).sum();
    let standard_error = (residual / (count - 2.0) / square).sqrt();
    LeastSquaresSlope::Found {
        exponent: Estimate { value: -slope, standard_error },
        amplitude: libm::exp(value - slope * at),
    }
}

/// Power laws in a window, each with its exponent.
struct PowerLaws {
    exponents: Vec<f64>,
    factors: Vec<Vec<Factor>>,
}

impl PowerLaws {
    fn of(window: [usize; 2]) -> Self {
        let exponents: Vec<f64> = (0..=STEPS).map(|step| FIRST + STEP * f64::from(step)).collect();
        let factors = exponents.iter().map(|exponent| tabulated(window, |logarithm| -exponent * logarithm)).collect();
        PowerLaws { exponents, factors }
    }

    /// Passes the minimum of −2 ln L to `use_minimum`.
    fn fit<T>(
        &self,
        powers: &MeanPowers,
        use_minimum: impl FnOnce(GridMinimum<'_>) -> T,
    ) -> Result<T, LikelihoodSlope> {
        let grid = &self.exponents;
        let deviance = |best: Option<Best>| best.map_or(f64::INFINITY, |best| best.deviance);
        let values: Vec<f64> =
            self.factors.iter().map(|factors| deviance(powers.best_of(factors.iter().copied()))).collect();
        let lowest = (0..grid.len()).fold(0, |best, i| if values[i] < values[best] { i } else { best });
        // The exponents around the minimum that negative powers allow.
        let first = (0..=lowest).rev().take_while(|&i| values[i].is_finite()).last();
        let last = (lowest..grid.len()).take_while(|&i| values[i].is_finite()).last();
        let (Some(first), Some(last)) = (first, last) else { return Err(LikelihoodSlope::NegativePowers) };
        if lowest == first && first > 0 || lowest == last && last + 1 < grid.len() {
            return Err(LikelihoodSlope::NegativePowers);
        }
        if lowest == first || lowest == last {
            return Err(LikelihoodSlope::Undetermined);
        }
        let at = |exponent: f64| deviance(powers.best(|logarithm| -exponent * logarithm));
        Ok(use_minimum(GridMinimum::of(&grid[first..=last], &values[first..=last], &at)))
    }
}

fn likelihood(powers: &MeanPowers, laws: &PowerLaws) -> LikelihoodSlope {
    let fitted = laws.fit(powers, |found| {
        let [lower, upper] = found.ends(RISE);
        let amplitude = powers.best(|logarithm| -found.at * logarithm).map_or(f64::NAN, |best| best.amplitude);
        LikelihoodSlope::Found { exponent: Interval { best: found.at, lower, upper }, amplitude }
    });
    fitted.unwrap_or_else(|outcome| outcome)
}

/// s over resamplings of the samples, by least squares and by likelihood; none if the original samples have no s.
///
/// # Errors
/// See [`slope_of_mean`].
///
/// # Cost
/// Per resampling samples × powers, then powers × evaluations of a one-dimensional search.
pub fn slope_interval(
    samples: &[&[f64]],
    window: [usize; 2],
    resamplings: usize,
) -> Result<[Option<BootstrapInterval>; 2], EnsembleFitError> {
    let whole = slope_of_mean(samples, window)?;
    let there = [whole.least_squares.exponent(), whole.likelihood.exponent()].map(|exponent| exponent.is_some());
    let laws = PowerLaws::of(window);
    let found = bootstrap_all(&[samples.len()], resamplings, |groups| {
        let chosen: Vec<&[f64]> = groups[0].iter().map(|&i| samples[i]).collect();
        let powers = MeanPowers::of(&chosen, window).ok()?;
        let both = [least_squares(&powers).exponent(), laws.fit(&powers, |found| found.at).ok()];
        // Numbers that the original data do not have are left out below.
        Some(both.iter().zip(there).map(|(s, there)| if there { s.unwrap_or(f64::NAN) } else { 0.0 }).collect())
    });
    let found = found.unwrap_or_default();
    Ok([0, 1].map(|i| found.get(i).copied().filter(|_| there[i])))
}
