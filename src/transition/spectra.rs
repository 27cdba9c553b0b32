//! [`CellSpectrum`]: slope and crossover of the mean spectrum of a cell, and θ†(p̂).

use serde::Serialize;

use crate::fit::angular::CrossoverOutcome;
use crate::fit::ensemble::{
    BootstrapInterval, DivergenceAt, DivergenceOutcome, MeanCrossover, MeanCrossoverSettings, MeasuredPoint, bootstrap,
    crossover_interval, crossover_of_mean, fit_divergence, fit_divergence_at, slope_of_mean,
};
use crate::study::{CellSamples, MeanCurve};
use crate::transition::RESAMPLINGS;
use crate::transition::series::SeriesPoint;

/// f from which to which a slope is taken: f = 1 is a mode of its own at high pressure, and above a few tens leakage removed is noise.
const SLOPE_WINDOW: [usize; 2] = [2, 24];

/// The same of a crossover, which needs S(1).
const CROSSOVER_WINDOW: [usize; 2] = [1, 24];

/// A white spectrum has an f† as good as this.
const LARGEST_CROSSOVER: f64 = 1e3;

/// The mean spectrum of one cell.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CellSpectrum {
    /// The cell.
    pub point: SeriesPoint,
    /// s of S ∝ f^(−s) by least squares in logarithms, f from 2 to 24.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slope: Option<BootstrapInterval>,
    /// f† of the Lorentzian with exponent 1.5, f from 1 to 24.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crossover: Option<MeanCrossover>,
    /// Its interval; 0 is a power law, infinity white.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crossover_interval: Option<BootstrapInterval>,
}

/// θ† against p̂.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AngleDivergence {
    /// Cells with a crossover.
    pub point_count: usize,
    /// μ with p̂_c by the slope of the spectrum.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_transition: Option<DivergenceAt>,
    /// μ and p̂_c together.
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
    /// From the scatter about the line.
    pub standard_error: f64,
}

/// The window as far as all samples have powers.
fn window([lowest, highest]: [usize; 2], powers: &[Vec<f64>]) -> Option<[usize; 2]> {
    let common = powers.iter().map(Vec::len).min()?;
    let highest = highest.min(common);
    (highest >= lowest + 2).then_some([lowest, highest])
}

/// Slope of the mean spectrum of some of the samples.
pub(super) fn slope_of(powers: &[Vec<f64>], chosen: &[usize]) -> Option<f64> {
    let window = window(SLOPE_WINDOW, powers)?;
    let rows: Vec<&[f64]> = chosen.iter().map(|&i| &powers[i][..window[1]]).collect();
    slope_of_mean(&rows, window).ok()?.least_squares.exponent()
}

/// f† of the mean spectrum of some of the samples: 0 of a power law, at most [`LARGEST_CROSSOVER`].
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
        let slope = bootstrap(&[powers.len()], RESAMPLINGS, |groups| slope_of(powers, &groups[0]));
        let settings = MeanCrossoverSettings::default();
        let (mut crossover, mut interval) = (None, None);
        if let Some(window) = window(CROSSOVER_WINDOW, powers) {
            let rows: Vec<&[f64]> = powers.iter().map(|row| &row[..window[1]]).collect();
            crossover = crossover_of_mean(&rows, window, &settings).ok();
            interval = crossover_interval(&rows, window, &settings, RESAMPLINGS).ok().flatten();
        }
        (slope.is_some() || crossover.is_some()).then_some(CellSpectrum {
            point: *point,
            slope,
            crossover,
            crossover_interval: interval,
        })
    }

    /// θ† with its standard error, where there is a crossover \[rad\].
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
        let points: Vec<MeasuredPoint> = spectra
            .iter()
            .filter_map(|spectrum| {
                let (y, error) = spectrum.angle()?;
                Some(MeasuredPoint { x: spectrum.point.reduced_pressure, y, error })
            })
            .collect();
        let below: Vec<MeasuredPoint> =
            points.iter().copied().filter(|point| critical.is_some_and(|critical| point.x < critical)).collect();
        AngleDivergence {
            point_count: points.len(),
            at_transition: critical.and_then(|critical| fit_divergence_at(&below, critical).ok()),
            free: fit_divergence(&points).ok(),
        }
    }
}

impl RingSlope {
    /// Of every ring whose spectrum a cell keeps, from the inside out.
    pub fn of(samples: &CellSamples) -> Vec<RingSlope> {
        let mut all: Vec<RingSlope> =
            samples.curves.iter().filter_map(|(name, curve)| Self::ring(name, curve)).collect();
        all.sort_by(|a, b| a.relative_radius.total_cmp(&b.relative_radius));
        all
    }

    fn ring(name: &str, curve: &MeanCurve) -> Option<RingSlope> {
        let relative_radius = name.strip_prefix("power_spectrum_at_")?.parse().ok()?;
        // Only what all samples have.
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
