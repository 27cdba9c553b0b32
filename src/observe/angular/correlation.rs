//! [`AngularCorrelation`]: G(θ) of the radial displacement in a ring, G* and θ*.
//!
//! From the spectrum, or from the pairs of disks:
//!
//! ```text
//! G(θ) = Σ_(f=1)^(f_max) P_f cos fθ / (Σ P_f + ρ)   (θ > 0)        G(0) = 1
//! ```
//!
//! ρ, the variance above f_max and of independent values of single disks, is a peak at θ = 0. With ρ = 0 both are a
//! Fourier pair (Wiener, Khinchin): P_f/Σ P = (2/π) ∫_0^π G cos fθ dθ; otherwise the peak is included. The estimate
//! from pairs is not: the number of pairs varies with the angle, and a bin is wide.
//!
//! Every correlation lies in \[−1, 1\]. An estimate may not, if some powers are negative or a bin has few pairs. The
//! outcome is then [`CorrelationOutcome::OutOfRange`]. A slightly negative ρ, down to −0.05 Σ P, is an estimation error
//! and counts as 0: otherwise G would exceed 1 near θ = 0.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::observe::angular::crossing::{CrossingOutcome, ThresholdCrossing};
use crate::observe::angular::error::AngularError;
use crate::observe::angular::limits::{MOST_STEPS, at_most};
use crate::observe::angular::pairs::PairSums;
use crate::observe::angular::power_spectrum::{FrequencyLimit, PowerSpectrum, SpectrumSettings};
use crate::observe::angular::ring::{RingSample, Weights};

/// How the correlation function is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CorrelationEstimator {
    /// The cosine sum of a spectrum.
    Spectral(SpectrumSettings),
    /// All pairs of disks, in equal bins of their angle.
    Pairs {
        /// Number of bins of \[0, π\].
        bin_count: usize,
    },
}

impl Default for CorrelationEstimator {
    /// The defaults of the spectrum.
    fn default() -> Self {
        CorrelationEstimator::Spectral(SpectrumSettings::default())
    }
}

/// How a correlation function is computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CorrelationSettings {
    /// The estimator. Changes results.
    pub estimator: CorrelationEstimator,
    /// Equal steps of [0, π] in the table of a spectral estimate; a crossing narrower than one step is missed.
    pub step_count: usize,
    /// Thresholds of G, each below 1 \[1\].
    pub thresholds: Vec<f64>,
}

impl Default for CorrelationSettings {
    /// Steps of half a degree; the thresholds of the study, its usual one first.
    fn default() -> Self {
        CorrelationSettings {
            estimator: CorrelationEstimator::default(),
            step_count: 360,
            thresholds: vec![0.1, 0.02, 0.05, 0.2],
        }
    }
}

/// Whether there is a correlation function.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CorrelationOutcome {
    /// There is a correlation function.
    #[default]
    Found,
    /// The values have no variance.
    NoVariance,
    /// The estimate leaves \[−1, 1\], so it is not a correlation function.
    OutOfRange {
        /// Angle of the largest violation \[rad\].
        angle: f64,
        /// Its value there \[1\].
        value: f64,
    },
}

/// G(θ), normalised to G(0) = 1; NaN everywhere if `outcome` states that there is none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AngularCorrelation {
    /// How it was estimated.
    pub estimator: CorrelationEstimator,
    /// Number of disks.
    pub disk_count: usize,
    /// Whether there is a correlation function.
    #[serde(default)]
    pub outcome: CorrelationOutcome,
    /// θ \[rad\], ascending from 0; for bins their midpoints.
    pub angles: Vec<f64>,
    /// G(θ) \[1\].
    pub values: Vec<f64>,
    /// G* = −G(π) \[1\]; for bins, from the last one.
    pub anticorrelation: f64,
    /// θ* at every threshold.
    pub crossings: Vec<ThresholdCrossing>,
}

impl AngularCorrelation {
    /// The correlation function of a ring.
    ///
    /// # Errors
    /// Settings out of range, a threshold that is not below 1; see [`PowerSpectrum::of`].
    ///
    /// # Cost
    /// Spectral: the spectrum, and f_max multiplications per step. Pairs: n²/2.
    pub fn of(ring: &RingSample, settings: &CorrelationSettings) -> Result<Self, AngularError> {
        settings.check()?;
        match settings.estimator {
            CorrelationEstimator::Spectral(spectrum) => {
                Self::of_spectrum(&PowerSpectrum::of(ring, &spectrum)?, settings)
            }
            CorrelationEstimator::Pairs { bin_count } => Ok(Self::of_pairs(ring, bin_count, settings)),
        }
    }

    /// The correlation function of a spectrum; the estimator of the settings is ignored.
    ///
    /// # Errors
    /// No steps, a threshold that is not below 1.
    pub fn of_spectrum(spectrum: &PowerSpectrum, settings: &CorrelationSettings) -> Result<Self, AngularError> {
        settings.check()?;
        let curve = |angle: f64| spectrum_correlation(spectrum, angle);
        let steps = settings.step_count;
        let angles: Vec<f64> = (0..=steps).map(|j| PI * j as f64 / steps as f64).collect();
        let mut values: Vec<f64> = angles.iter().map(|&angle| curve(angle)).collect();
        if values[0].is_finite() {
            values[0] = 1.0;
        }
        let crossings = settings.crossings(|threshold| CrossingOutcome::of_curve(&angles, &values, threshold, curve));
        let estimator = CorrelationEstimator::Spectral(SpectrumSettings {
            estimator: spectrum.estimator,
            frequency_limit: FrequencyLimit::Fixed(spectrum.frequency_limit()),
        });
        let (disk_count, anticorrelation) = (spectrum.disk_count, -values[steps]);
        let outcome = CorrelationOutcome::Found;
        Ok(AngularCorrelation { estimator, disk_count, outcome, angles, values, anticorrelation, crossings }
            .with_outcome())
    }

    fn of_pairs(ring: &RingSample, bin_count: usize, settings: &CorrelationSettings) -> Self {
        let centred = ring.centred(&ring.weights(Weights::Equal));
        let bins = PairSums::of(ring, &centred.values, bin_count).correlation(centred.variance);
        let middle = |bin: usize| PI * (bin as f64 + 0.5) / bin_count as f64;
        let angles: Vec<f64> = std::iter::once(0.0).chain((0..bin_count).map(middle)).collect();
        let first = if centred.variance > 0.0 { 1.0 } else { f64::NAN };
        let values: Vec<f64> = std::iter::once(first).chain(bins).collect();
        let crossings = settings.crossings(|threshold| CrossingOutcome::in_table(&angles, &values, threshold));
        let anticorrelation = -values[bin_count];
        let (estimator, disk_count) = (settings.estimator, ring.disk_count());
        let outcome = CorrelationOutcome::Found;
        AngularCorrelation { estimator, disk_count, outcome, angles, values, anticorrelation, crossings }.with_outcome()
    }

    /// Sets the outcome, and removes the values if there is no correlation function.
    fn with_outcome(mut self) -> Self {
        if self.values[0].is_nan() {
            return AngularCorrelation { outcome: CorrelationOutcome::NoVariance, ..self };
        }
        let beyond = self.values.iter().zip(&self.angles).filter(|(value, _)| value.abs() > 1.0 + ROUNDING);
        if let Some((&value, &angle)) = beyond.max_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs())) {
            self.outcome = CorrelationOutcome::OutOfRange { angle, value };
            self.values.fill(f64::NAN);
            self.anticorrelation = f64::NAN;
            for crossing in &mut self.crossings {
                crossing.outcome = CrossingOutcome::OutOfRange { farthest: value };
            }
            return self;
        }
        for value in self.values.iter_mut().chain([&mut self.anticorrelation]) {
            *value = value.clamp(-1.0, 1.0);
        }
        self
    }

    /// θ* at a threshold \[rad\], if the settings contain it and G reaches it.
    pub fn crossing(&self, threshold: f64) -> Option<f64> {
        self.crossings.iter().find(|crossing| crossing.threshold == threshold)?.outcome.angle()
    }
}

/// Rounding may raise G above 1 by this: sums of up to 10⁴ powers, 10⁴ · 2⁻⁵³ with a margin of a thousand \[1\].
const ROUNDING: f64 = 1e-9;

/// A negative ρ up to this share of Σ P counts as 0 \[1\]. Larger ones give an estimate far out of range.
const NOISE: f64 = 0.05;
/// Memory of a step or bin: its angle, its value, and both as text \[bytes\].
const STEP_BYTES: f64 = 64.0;

/// Frequencies between two exact evaluations of the rotation.
const RESTART: usize = 64;

/// Σ P_f cos fθ/(Σ P_f + ρ), with a slightly negative ρ set to 0, by one rotation per frequency.
fn spectrum_correlation(spectrum: &PowerSpectrum, angle: f64) -> f64 {
    let resolved: f64 = spectrum.power[1..].iter().sum();
    let noise = spectrum.unresolved < 0.0 && -spectrum.unresolved <= NOISE * resolved;
    let total = if noise { resolved } else { resolved + spectrum.unresolved };
    if total.is_nan() || total <= 0.0 {
        return f64::NAN;
    }
    let (sine, cosine) = libm::sincos(angle);
    let mut sum = 0.0;
    for (block, powers) in spectrum.power[1..].chunks(RESTART).enumerate() {
        let (mut s, mut c) = libm::sincos((block * RESTART + 1) as f64 * angle);
        for power in powers {
            sum += power * c;
            (c, s) = (c * cosine - s * sine, s * cosine + c * sine);
        }
    }
    sum / total
}

impl CorrelationSettings {
    /// Checks the settings, independently of a ring.
    pub(crate) fn check(&self) -> Result<(), AngularError> {
        let bin_count = match self.estimator {
            CorrelationEstimator::Pairs { bin_count } => bin_count,
            CorrelationEstimator::Spectral(spectrum) => {
                spectrum.check()?;
                1
            }
        };
        for (setting, field, count) in [("steps", "step_count", self.step_count), ("bins", "bin_count", bin_count)] {
            if count == 0 {
                return Err(AngularError::NotPositive { setting, value: 0.0 });
            }
            at_most(MOST_STEPS).check(field, count, STEP_BYTES)?;
        }
        match self.thresholds.iter().find(|&&threshold| threshold.is_nan() || threshold >= 1.0) {
            Some(&threshold) => Err(AngularError::ThresholdNotBelowOne { threshold }),
            None => Ok(()),
        }
    }

    fn crossings(&self, at: impl Fn(f64) -> CrossingOutcome) -> Vec<ThresholdCrossing> {
        self.thresholds.iter().map(|&threshold| ThresholdCrossing { threshold, outcome: at(threshold) }).collect()
    }
}
