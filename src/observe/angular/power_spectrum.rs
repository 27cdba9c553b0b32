//! [`PowerSpectrum`]: S(f) of the radial displacement in a ring.
//!
//! ```text
//! P_f = 2 |Σ_k w_k (x_k − m) e^(−ifθ_k)|²        Σ_(f ≥ 1) P_f is the variance if the angles are evenly spaced
//! S(f) = P_f / P_1
//! ```
//!
//! The errors of the estimators are derived in the chapter "Power spectrum" of the book and measured by `cargo run
//! --release --features measurements --example angular_estimators`.

use serde::{Deserialize, Serialize};

use crate::observe::angular::error::AngularError;
use crate::observe::angular::even_grid::{binned, interpolated};
use crate::observe::angular::fourier::{fourier_sums, transform};
use crate::observe::angular::limits::{MOST_COUPLED_FREQUENCIES, MOST_GRID_POINTS, at_most};
use crate::observe::angular::ring::{Centred, RingSample, Weights};
use crate::observe::angular::unmixing::{Shares, unmix};
use crate::observe::angular::window::SpectralWindow;

/// How the spectrum is estimated from values at irregular angles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SpectrumEstimator {
    /// Fourier sums at the actual angles.
    Direct {
        /// Weight of a disk.
        weights: Weights,
        /// Treatment of the leakage between frequencies from irregular angles.
        leakage: Leakage,
    },
    /// Piecewise linear interpolation on an even grid, then a transform.
    Interpolated {
        /// Number of grid points per disk \[1\].
        points_per_disk: f64,
    },
    /// Means in equal bins, then a transform; empty bins are interpolated.
    Binned {
        /// Number of bins per disk \[1\].
        bins_per_disk: f64,
    },
}

impl Default for SpectrumEstimator {
    /// Gaps as weights, leakage removed: the least bias if disks have independent parts, and the most accurate G
    /// (`benches/measurements/angular_estimators.rs`).
    fn default() -> Self {
        SpectrumEstimator::Direct { weights: Weights::Gaps, leakage: Leakage::Removed }
    }
}

/// Treatment of leakage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Leakage {
    /// Leakage is not removed; powers are never negative.
    Kept,
    /// The expected power is inverted for the spectrum and the variance above it. Unbiased if that variance is white;
    /// single powers may be negative.
    Removed,
}

/// The highest frequency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FrequencyLimit {
    /// This number per disk, rounded down, at least one.
    PerDisk(f64),
    /// This one.
    Fixed(usize),
}

impl FrequencyLimit {
    pub(super) fn of(self, disk_count: usize) -> Result<usize, AngularError> {
        match self {
            FrequencyLimit::Fixed(0) => {
                Err(AngularError::FrequencyLimitOutOfRange { frequency_limit: 0, highest: disk_count / 2 })
            }
            FrequencyLimit::Fixed(limit) => Ok(limit),
            FrequencyLimit::PerDisk(share) => {
                Ok(((positive("frequencies per disk", share)? * disk_count as f64) as usize).max(1))
            }
        }
    }
}

/// How a spectrum is computed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SpectrumSettings {
    /// The estimator. Changes results.
    pub estimator: SpectrumEstimator,
    /// Highest f, at most n/2 for direct sums and half the number of points for a grid.
    pub frequency_limit: FrequencyLimit,
}

impl Default for SpectrumSettings {
    /// One frequency per eight disks: eight disks per shortest wavelength.
    fn default() -> Self {
        SpectrumSettings { estimator: SpectrumEstimator::default(), frequency_limit: FrequencyLimit::PerDisk(0.125) }
    }
}

/// The power of a ring at f = 0, …, f_max.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PowerSpectrum {
    /// How it was estimated.
    pub estimator: SpectrumEstimator,
    /// Number of disks.
    pub disk_count: usize,
    /// Variance of the values, with the weights of the estimator \[value²\].
    pub variance: f64,
    /// P_f at its index f \[value²\]; P_0 is the squared mean.
    pub power: Vec<f64>,
    /// ρ, the variance at higher frequencies and of independent values of single disks, if leakage is removed;
    /// otherwise 0 \[value²\].
    pub unresolved: f64,
    /// 2 σ² Σ w²: the expected power at every f of uncorrelated values with this variance \[value²\].
    pub white_floor: f64,
}

impl SpectrumSettings {
    /// Checks the settings, independently of a ring.
    pub(crate) fn check(&self) -> Result<(), AngularError> {
        self.frequency_limit.of(1)?;
        match self.estimator {
            SpectrumEstimator::Direct { .. } => Ok(()),
            SpectrumEstimator::Interpolated { points_per_disk: value } => positive("points per disk", value).map(drop),
            SpectrumEstimator::Binned { bins_per_disk: value } => positive("bins per disk", value).map(drop),
        }
    }
}

impl PowerSpectrum {
    /// The spectrum of a ring.
    ///
    /// # Errors
    /// Settings out of range; a highest frequency above n/2 or above that of the grid.
    ///
    /// # Cost
    /// Direct: n·f_max rotations or a fast transform, and f_max³/3 multiplications if leakage is removed. On a grid:
    /// one transform.
    ///
    /// # Example
    /// ```
    /// use jamscope::observe::angular::{PowerSpectrum, RingSample, SpectrumSettings};
    /// let angles: Vec<f64> = (0..40).map(|k| std::f64::consts::PI * f64::from(k) / 20.0).collect();
    /// let values: Vec<f64> = angles.iter().map(|angle| 1.0 + 0.2 * angle.cos() + 0.1 * (3.0 * angle).sin()).collect();
    /// let spectrum = PowerSpectrum::of(&RingSample::new(&angles, &values)?, &SpectrumSettings::default())?;
    /// assert!((spectrum.power[0] - 1.0).abs() < 1e-14 && (spectrum.power[1] - 0.02).abs() < 1e-15);
    /// let relative = spectrum.normalised().expect("power at f = 1");
    /// assert!((relative[3] - 0.25).abs() < 1e-13);
    /// # Ok::<(), jamscope::observe::angular::AngularError>(())
    /// ```
    pub fn of(ring: &RingSample, settings: &SpectrumSettings) -> Result<Self, AngularError> {
        let frequency_limit = settings.frequency_limit.of(ring.disk_count())?;
        let within = |highest: usize| {
            if frequency_limit <= highest {
                Ok(())
            } else {
                Err(AngularError::FrequencyLimitOutOfRange { frequency_limit, highest })
            }
        };
        match settings.estimator {
            SpectrumEstimator::Direct { weights, leakage } => {
                within(ring.disk_count() / 2)?;
                if leakage == Leakage::Removed {
                    let bytes_each = 8.0 * frequency_limit as f64;
                    at_most(MOST_COUPLED_FREQUENCIES).check("frequency_limit", frequency_limit, bytes_each)?;
                }
                Ok(Self::direct(ring, settings.estimator, weights, leakage, frequency_limit))
            }
            SpectrumEstimator::Interpolated { points_per_disk } => {
                let count = grid_size("points per disk", points_per_disk, ring.disk_count())?;
                within(count / 2)?;
                Ok(Self::on_grid(&interpolated(ring, count), settings.estimator, ring, frequency_limit))
            }
            SpectrumEstimator::Binned { bins_per_disk } => {
                let count = grid_size("bins per disk", bins_per_disk, ring.disk_count())?;
                within(count / 2)?;
                Ok(Self::on_grid(&binned(ring, count), settings.estimator, ring, frequency_limit))
            }
        }
    }

    fn direct(
        ring: &RingSample,
        estimator: SpectrumEstimator,
        weights: Weights,
        leakage: Leakage,
        frequency_limit: usize,
    ) -> Self {
        let counts = ring.weights(weights);
        let centred = ring.centred(&counts);
        let strengths: Vec<f64> = counts.iter().zip(&centred.values).map(|(w, x)| w * x).collect();
        let sums = fourier_sums(ring.angles(), &strengths, frequency_limit);
        let mut power: Vec<f64> = sums.iter().map(|sum| 2.0 * sum.norm_sqr()).collect();
        power[0] = centred.mean * centred.mean;
        let square: f64 = counts.iter().map(|w| w * w).sum();
        let mut spectrum = PowerSpectrum {
            estimator,
            disk_count: ring.disk_count(),
            variance: centred.variance,
            power,
            unresolved: 0.0,
            white_floor: 2.0 * square * centred.variance,
        };
        if leakage == Leakage::Removed {
            let window = SpectralWindow::new(ring, weights, frequency_limit, frequency_limit);
            let sums = fourier_sums(ring.angles(), &counts, frequency_limit);
            let modes = sums[1..].iter().map(|sum| 1.0 - sum.norm_sqr()).collect();
            let shares = Shares { modes, white: 1.0 - square };
            // Singular only if the angles cannot separate the frequencies: the measured powers are then kept.
            if let Some((solved, unresolved)) = unmix(&window, &spectrum.power[1..], centred.variance, shares) {
                spectrum.power[1..].copy_from_slice(&solved);
                spectrum.unresolved = unresolved;
            }
        }
        spectrum
    }

    fn on_grid(values: &[f64], estimator: SpectrumEstimator, ring: &RingSample, frequency_limit: usize) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let Centred { values: centred, variance, .. } =
            Centred::of(mean, values, |values| values.iter().map(|value| value * value).sum::<f64>() / count);
        let sums = transform(&centred);
        let mut power: Vec<f64> = (0..=frequency_limit)
            // The highest frequency of an even grid is its own alias.
            .map(|f| if 2 * f == values.len() { 1.0 } else { 2.0 } * (sums[f] / count).norm_sqr())
            .collect();
        power[0] = mean * mean;
        let white_floor = 2.0 * variance / ring.disk_count() as f64;
        let disk_count = ring.disk_count();
        PowerSpectrum { estimator, disk_count, variance, power, unresolved: 0.0, white_floor }
    }

    /// S(f) = P_f/P_1 \[1\] at its index f; none if P_1 is not positive.
    pub fn normalised(&self) -> Option<Vec<f64>> {
        let first = self.power[1];
        (first > 0.0).then(|| self.power.iter().map(|power| power / first).collect())
    }

    /// (P_f + 2ρ/n)/(P_1 + 2ρ/n): the unresolved variance is added as a white floor, as for n even angles. Flat for
    /// uncorrelated values. None if the divisor is not positive.
    pub fn normalised_with_floor(&self) -> Option<Vec<f64>> {
        let floor = 2.0 * self.unresolved / self.disk_count as f64;
        let first = self.power[1] + floor;
        (first > 0.0).then(|| self.power.iter().map(|power| (power + floor) / first).collect())
    }

    /// Highest f.
    pub fn frequency_limit(&self) -> usize {
        self.power.len() - 1
    }
}

/// Memory per point: its value, the centred value and the transform \[bytes\].
const GRID_POINT_BYTES: f64 = 48.0;

/// An even number of points, at least four.
pub(super) fn grid_size(setting: &'static str, per_disk: f64, disk_count: usize) -> Result<usize, AngularError> {
    let half = 0.5 * positive(setting, per_disk)? * disk_count as f64;
    let count = 2 * (half.round() as usize).max(2);
    at_most(MOST_GRID_POINTS).check(setting, count, GRID_POINT_BYTES)?;
    Ok(count)
}

/// Checks that a setting is positive and finite, at most 1000 per disk.
fn positive(setting: &'static str, value: f64) -> Result<f64, AngularError> {
    if value > 0.0 && value <= 1e3 { Ok(value) } else { Err(AngularError::NotPositive { setting, value }) }
}
