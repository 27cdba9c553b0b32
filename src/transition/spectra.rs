//! [`CellSpectrum`]: slope and crossover of the mean spectrum of a cell, and θ†(p̂).
//!
//! There are two slopes, from the same powers P̄ at f = 2 to 24:
//!
//! ```text
//! least squares   Σ_f (ln P̄_f − ln E_f)²            likelihood   Σ_f (ln E_f + P̄_f/E_f)            E_f = A f^(−s)
//! ```
//!
//! With δ = ln(P̄/E), a term of the likelihood is 1 + ln P̄ + δ²/2 + δ³/6 + …: to second order both are equal and weigh
//! all f equally. They differ if δ is not small. A power far above the line adds e^δ to the likelihood but δ² to least
//! squares: a strong f = 2 or 3 makes the likelihood slope steeper. A power far below it, as after removal of leakage
//! at high f, adds δ² to least squares but only |δ| to the likelihood: it makes the least-squares slope steeper. Smooth
//! bends cause little difference. If the two slopes differ by more than their intervals, the mean spectrum is not a
//! single power law.

use serde::Serialize;

use crate::fit::angular::CrossoverOutcome;
use crate::fit::ensemble::{
    BootstrapInterval, DivergenceAt, DivergenceOutcome, MeanCrossover, MeanCrossoverSettings, MeanSlope, MeasuredPoint,
    crossover_interval, crossover_of_mean, fit_divergence, fit_divergence_at, slope_interval, slope_of_mean,
};
use crate::study::{CellSamples, MeanCurve};
use crate::transition::evidence::{LEAST_CELLS, RESAMPLINGS};
use crate::transition::series_point::SeriesPoint;

/// Range of f for a slope: f = 1 is a separate mode at high pressure, and above some tens removed leakage leaves noise.
const SLOPE_WINDOW: [usize; 2] = [2, 24];

/// Range of f for a crossover, which needs S(1).
const CROSSOVER_WINDOW: [usize; 2] = [1, 24];

/// Largest f†: a white spectrum has none.
const LARGEST_CROSSOVER: f64 = 1e3;

/// The mean spectrum of one cell.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CellSpectrum {
    /// Its cell.
    pub point: SeriesPoint,
    /// s of S ∝ f^(−s) by least squares in logarithms, f from 2 to 24.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slope: Option<BootstrapInterval>,
    /// s by maximum likelihood.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub likelihood_slope: Option<BootstrapInterval>,
    /// f† of the Lorentzian with exponent 1.5, f from 1 to 24.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crossover: Option<MeanCrossover>,
    /// Its interval; 0 means a power law, infinity a white spectrum.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crossover_interval: Option<BootstrapInterval>,
}

/// θ† against p̂.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AngleDivergence {
    /// Number of cells with a crossover.
    pub point_count: usize,
    /// Number of those cells below p̂_c by the slope of the spectrum.
    pub below_count: usize,
    /// Smallest number of samples of a cell below p̂_c; 0 without such cells.
    pub sample_count: usize,
    /// μ for p̂_c by the slope of the spectrum (least squares); absent for fewer than 5 cells below it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_transition: Option<DivergenceAt>,
    /// Fit of both μ and p̂_c; absent for fewer than 5 cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub free: Option<DivergenceOutcome>,
}

/// Slope of the mean spectrum of a ring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RingSlope {
    /// r̂ \[1\].
    pub relative_radius: f64,
    /// s, by least squares.
    pub slope: f64,
    /// Standard error from the scatter about the line.
    pub standard_error: f64,
}

/// The part of the window in which all samples have powers.
fn window([lowest, highest]: [usize; 2], powers: &[Vec<f64>]) -> Option<[usize; 2]> {
    let common = powers.iter().map(Vec::len).min()?;
    let highest = highest.min(common);
    (highest >= lowest + 2).then_some([lowest, highest])
}

fn both_slopes(powers: &[Vec<f64>], chosen: &[usize]) -> Option<MeanSlope> {
    let window = window(SLOPE_WINDOW, powers)?;
    let rows: Vec<&[f64]> = chosen.iter().map(|&i| &powers[i][..window[1]]).collect();
    slope_of_mean(&rows, window).ok()
}

/// Slope of the mean spectrum of some of the samples, by least squares in logarithms.
pub(super) fn slope_of(powers: &[Vec<f64>], chosen: &[usize]) -> Option<f64> {
    both_slopes(powers, chosen)?.least_squares.exponent()
}

/// Slope of the mean spectrum of some of the samples, by maximum likelihood.
pub(super) fn likelihood_slope_of(powers: &[Vec<f64>], chosen: &[usize]) -> Option<f64> {
    both_slopes(powers, chosen)?.likelihood.exponent()
}

/// f† of the mean spectrum of some of the samples: 0 for a power law, at most [`LARGEST_CROSSOVER`].
pub(super) fn crossover_of(powers: &[Vec<f64>], chosen: &[usize]) -> Option<f64> {
    let window = window(CROSSOVER_WINDOW, powers)?;
    let rows: Vec<&[f64]> = chosen.iter().map(|&i| &powers[i][..window[1]]).collect();
    match crossover_of_mean(&rows, window, &MeanCrossoverSettings::default()).ok()? {
        MeanCrossover::Fitted { crossover, .. } => Some(crossover.min(LARGEST_CROSSOVER)),
        MeanCrossover::NegativePowers => None,
    }
}

impl CellSpectrum {
    pub(super) fn of(point: &SeriesPoint, samples: &CellSamples) -> Option<Self> {
        let powers = &samples.powers;
        let [slope, likelihood_slope] = window(SLOPE_WINDOW, powers)
            .and_then(|window| {
                let rows: Vec<&[f64]> = powers.iter().map(|row| &row[..window[1]]).collect();
                slope_interval(&rows, window, RESAMPLINGS).ok()
            })
            .unwrap_or_default();
        let settings = MeanCrossoverSettings::default();
        let (mut crossover, mut interval) = (None, None);
        if let Some(window) = window(CROSSOVER_WINDOW, powers) {
            let rows: Vec<&[f64]> = powers.iter().map(|row| &row[..window[1]]).collect();
            crossover = crossover_of_mean(&rows, window, &settings).ok();
            interval = crossover_interval(&rows, window, &settings, RESAMPLINGS).ok().flatten();
        }
        (slope.is_some() || likelihood_slope.is_some() || crossover.is_some()).then_some(CellSpectrum {
            point: *point,
            slope,
            likelihood_slope,
            crossover,
            crossover_interval: interval,
        })
    }

    /// θ† with its standard error, if there is a crossover \[rad\].
    pub fn angle(&self) -> Option<(f64, f64)> {
        let Some(MeanCrossover::Fitted { outcome: CrossoverOutcome::Found { crossover, angle }, .. }) = self.crossover
        else {
            return None;
        };
        let error = self.crossover_interval?.standard_error.filter(|error| error.is_finite())?;
        Some((angle.best, angle.best * error / crossover.best))
    }
}

impl AngleDivergence {
    pub(super) fn of(spectra: &[CellSpectrum], critical: Option<f64>) -> Self {
        let points: Vec<(MeasuredPoint, usize)> = spectra
            .iter()
            .filter_map(|spectrum| {
                let (y, error) = spectrum.angle()?;
                let point = MeasuredPoint { x: spectrum.point.reduced_pressure, y, error };
                Some((point, spectrum.point.sample_count))
            })
            .collect();
        AngleDivergence::through(&points, critical)
    }

    /// Fits through points with the numbers of samples of their cells.
    fn through(points: &[(MeasuredPoint, usize)], critical: Option<f64>) -> Self {
        let is_below = |point: &MeasuredPoint| critical.is_some_and(|critical| point.x < critical);
        let own: Vec<(MeasuredPoint, usize)> = points.iter().copied().filter(|(point, _)| is_below(point)).collect();
        let [all, below] = [points, &own].map(|own| own.iter().map(|(point, _)| *point).collect::<Vec<_>>());
        let enough = |points: &[MeasuredPoint]| points.len() >= LEAST_CELLS;
        AngleDivergence {
            point_count: all.len(),
            below_count: below.len(),
            sample_count: own.iter().map(|(_, count)| *count).min().unwrap_or(0),
            at_transition: critical
                .filter(|_| enough(&below))
                .and_then(|critical| fit_divergence_at(&below, critical).ok()),
            free: enough(&all).then(|| fit_divergence(&all).ok()).flatten(),
        }
    }
}

impl RingSlope {
    /// The slopes of every ring with a spectrum, from the inside out.
    pub fn of(samples: &CellSamples) -> Vec<RingSlope> {
        let mut all: Vec<RingSlope> =
            samples.curves.iter().filter_map(|(name, curve)| Self::ring(name, curve)).collect();
        all.sort_by(|a, b| a.relative_radius.total_cmp(&b.relative_radius));
        all
    }

    fn ring(name: &str, curve: &MeanCurve) -> Option<RingSlope> {
        let relative_radius = name.strip_prefix("power_spectrum_at_")?.parse().ok()?;
        // Only frequencies of all samples.
        let points = curve.points();
        let most = points.first()?.count;
        let powers: Vec<f64> = points.iter().take_while(|point| point.count == most).map(|point| point.y).collect();
        let highest = SLOPE_WINDOW[1].min(powers.len());
        let fit = slope_of_mean(&[&powers[..highest]], [SLOPE_WINDOW[0], highest]).ok()?;
        match fit.least_squares {
            crate::fit::ensemble::LeastSquaresSlope::Found { exponent, .. } => {
                Some(RingSlope { relative_radius, slope: exponent.value, standard_error: exponent.standard_error })
            }
            crate::fit::ensemble::LeastSquaresSlope::NonPositivePower { .. } => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both slopes of a spectrum without noise, f = 2 to 24.
    fn slopes(spectrum: impl Fn(f64) -> f64) -> [f64; 2] {
        let powers: Vec<f64> = (1..=24).map(|f| spectrum(f64::from(f))).collect();
        let all = [powers];
        [slope_of(&all, &[0]).expect("positive powers"), likelihood_slope_of(&all, &[0]).expect("a maximum")]
    }

    #[test]
    fn smooth_bends_flatten_both_slopes_alike() {
        let [line, likely] = slopes(|f| libm::pow(f, -1.5));
        assert!((line - 1.5).abs() < 1e-12 && (likely - 1.5).abs() < 1e-6);
        // A Lorentzian of f† = 2, and white floors of a fifth and of twice the power law at f = 24: least squares are
        // lower, by 0.004, 0.0001 and 0.006.
        let [line, likely] = slopes(|f| 1.0 / (1.0 + libm::pow(f / 2.0, 1.5)));
        assert!((line - 1.2875).abs() < 1e-3 && (likely - line - 0.0037).abs() < 5e-4, "{line} {likely}");
        for (floor, expected, gap) in [(0.0017, 1.427, 1e-3), (0.017, 1.041, 1e-2)] {
            let [line, likely] = slopes(|f| libm::pow(f, -1.5) + floor);
            assert!((line - expected).abs() < 2e-2 && line < likely && likely - line < gap, "{floor}: {line} {likely}");
        }
    }

    #[test]
    fn a_strong_low_power_pulls_the_likelihood_and_a_lost_high_one_least_squares() {
        // Four times the power at f = 2: 1.72 by least squares, 1.81 by likelihood.
        let [line, likely] = slopes(|f| libm::pow(f, -1.5) * if f == 2.0 { 4.0 } else { 1.0 });
        assert!((line - 1.7246).abs() < 1e-3 && (likely - 1.8109).abs() < 1e-3, "{line} {likely}");
        // A tenth of the power at f = 24: 1.68 and 1.57.
        let [line, likely] = slopes(|f| libm::pow(f, -1.5) * if f == 24.0 { 0.1 } else { 1.0 });
        assert!((line - 1.6758).abs() < 1e-3 && (likely - 1.5746).abs() < 1e-3, "{line} {likely}");
    }

    #[test]
    fn a_divergence_is_fitted_from_five_cells_on() {
        let point = |i: u32| {
            let x = f64::from(i);
            let y = libm::pow(10.5 - x, -0.9);
            (MeasuredPoint { x, y, error: 0.02 * y }, 10 + i as usize)
        };
        let through = |count: u32| AngleDivergence::through(&(0..count).map(point).collect::<Vec<_>>(), Some(10.5));
        let four = through(4);
        assert_eq!((four.point_count, four.below_count, four.sample_count), (4, 4, 10));
        assert!(four.at_transition.is_none() && four.free.is_none());
        let five = through(5);
        assert!((five.at_transition.expect("five cells").exponent.value - 0.9).abs() < 1e-12 && five.free.is_some());
        // Five cells, four of them below p̂_c.
        let one_above = AngleDivergence::through(&(0..5).map(point).collect::<Vec<_>>(), Some(3.5));
        assert_eq!((one_above.point_count, one_above.below_count), (5, 4));
        assert!(one_above.at_transition.is_none() && one_above.free.is_some());
    }
}
