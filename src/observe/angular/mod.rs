//! Angular correlations of the radial displacement in a ring: [`RingSample`], [`PowerSpectrum`], [`AngularCorrelation`].
//!
//! ```text
//! δd_r = d_r − ⟨d_r⟩       S(f) ∝ |∫ δd_r e^(−ifθ) dθ|²,  S(1) = 1       G(θ) = ⟨δd_r(θ_0) δd_r(θ_0 + θ)⟩/⟨δd_r²⟩
//! G(θ) = Σ S(f) cos fθ / Σ S(f)                 G* = −G(π)                 G(θ*) = 0.1
//! ```
//!
//! d_r is known only where disks are, at irregular angles: there are several estimators of both, and which is the nearest to
//! the truth depends on the number of disks and on how much of d_r is of single disks. [`SpectralWindow`] gives the expected
//! value of one of them at the very angles of a ring, [`synthetic`] rings of a known spectrum.
//!
//! Two dimensions. Every number depends on the disks only, not on their order, and on rotation only by rounding.

mod block_errors;
mod correlation;
mod crossing;
mod dependence;
mod even_grid;
mod fourier;
mod pairs;
mod power_spectrum;
mod radial_dependence;
mod ring;
mod statistics;
pub mod synthetic;
mod unmixing;
mod window;

use thiserror::Error;

use crate::memory::{Limit, TooLarge};

pub use block_errors::{BlockErrors, block_errors};
pub use correlation::{AngularCorrelation, CorrelationEstimator, CorrelationOutcome, CorrelationSettings};
pub use crossing::{CrossingOutcome, ThresholdCrossing};
pub use dependence::dependence;
pub use fourier::{Route, fourier_sums, fourier_sums_by};
pub use power_spectrum::{FrequencyLimit, Leakage, PowerSpectrum, SpectrumEstimator, SpectrumSettings};
pub use radial_dependence::{RadialDependenceSettings, RingAnalysis, RingOutcome, radial_dependence};
pub use ring::{RingSample, RingSettings, Weights};
pub(crate) use statistics::quantile;
pub use statistics::{
    CorrelationStatistics, CrossingStatistics, Mean, SpectrumStatistics, correlation_statistics, spectrum_statistics,
};
pub use window::{Source, SpectralWindow};

/// Disks a ring needs: with fewer there is no angle to speak of.
pub const LEAST_DISK_COUNT: usize = 4;

/// Steps or bins of a correlation function: a million of them stand 3 10⁻⁶ rad apart, closer than any two disks can.
pub const MOST_STEPS: usize = 1_000_000;

/// Points of a grid on which a ring is interpolated or binned.
pub const MOST_GRID_POINTS: usize = 1 << 26;

/// Frequencies between which leakage is removed: f_max² numbers and f_max³/3 multiplications, 0.8 GB and some minutes at most.
pub const MOST_COUPLED_FREQUENCIES: usize = 10_000;

/// A limit on what a table may have.
const fn at_most(largest: usize) -> Limit {
    Limit { largest: largest as u64, reason: "a limit on memory and time" }
}

/// Why a ring, its spectrum or its correlation function could not be had.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum AngularError {
    /// As many values as angles are needed.
    #[error("{angle_count} angles and {value_count} values")]
    LengthsDiffer {
        /// Number of angles.
        angle_count: usize,
        /// Number of values.
        value_count: usize,
    },
    /// Fewer disks than [`LEAST_DISK_COUNT`].
    #[error("{disk_count} disks in the ring, at least {LEAST_DISK_COUNT} are needed")]
    TooFewDisks {
        /// Disks in the ring.
        disk_count: usize,
    },
    /// An angle or a value that is not finite, or a value beyond 10¹⁵⁰, whose square is none.
    #[error("disk {disk}: angle {angle}, value {value}")]
    NotFinite {
        /// Index of the disk as given.
        disk: usize,
        /// Its angle.
        angle: f64,
        /// Its value.
        value: f64,
    },
    /// Where the ring lies, or its width, is not positive and finite.
    #[error("a ring at r/R = {relative_radius} ± {half_width}: both must be positive and finite")]
    RingOutOfRange {
        /// The middle, r̂.
        relative_radius: f64,
        /// The half width.
        half_width: f64,
    },
    /// A setting that must be positive and finite is not.
    #[error("{setting} must be positive and finite, it is {value}")]
    NotPositive {
        /// The setting.
        setting: &'static str,
        /// Its value.
        value: f64,
    },
    /// A number of steps, bins, points or frequencies beyond what memory allows.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// The highest frequency asked for is 0, or the estimator does not reach it.
    #[error("frequencies up to {frequency_limit}: from 1 to {highest} can be had")]
    FrequencyLimitOutOfRange {
        /// The highest frequency asked for.
        frequency_limit: usize,
        /// The highest there is.
        highest: usize,
    },
    /// A threshold that is not below 1, where G begins.
    #[error("a threshold of G must be below 1, it is {threshold}")]
    ThresholdNotBelowOne {
        /// The threshold.
        threshold: f64,
    },
    /// Fewer blocks than can have a scatter, or more than disks to put into them.
    #[error("{block_count} blocks of {disk_count} disks: at least 4, and at most a fourth as many as disks")]
    BlockCountOutOfRange {
        /// Blocks asked for.
        block_count: usize,
        /// Disks.
        disk_count: usize,
    },
    /// No sample, or samples that are not alike in their angles, thresholds or frequencies.
    #[error("sample {sample} of {sample_count} cannot be averaged: {reason}")]
    SamplesDiffer {
        /// The first that differs from sample 0.
        sample: usize,
        /// How many there are.
        sample_count: usize,
        /// In what.
        reason: &'static str,
    },
}
