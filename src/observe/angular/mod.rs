//! Angular correlations of the radial displacement in a ring: [`RingSample`], [`PowerSpectrum`],
//! [`AngularCorrelation`].
//!
//! ```text
//! δd_r = d_r − ⟨d_r⟩       S(f) ∝ |∫ δd_r e^(−ifθ) dθ|²,  S(1) = 1       G(θ) = ⟨δd_r(θ_0) δd_r(θ_0 + θ)⟩/⟨δd_r²⟩
//! G(θ) = Σ S(f) cos fθ / Σ S(f)                 G* = −G(π)                 G(θ*) = 0.1
//! ```
//!
//! d_r is known only at the disks, at irregular angles, so there are several estimators of both. Which is the most
//! accurate depends on the number of disks and on the share of d_r that is independent between disks.
//! [`SpectralWindow`] gives the expected value of one estimator at the angles of a ring; [`synthetic`] makes rings of a
//! known spectrum.
//!
//! Two dimensions only. Results depend only on the disks, not on their order, and on rotation only by rounding.

mod block_errors;
mod correlation;
mod crossing;
mod error;
mod even_grid;
mod fourier;
mod limits;
mod pairs;
mod power_dependence;
mod power_spectrum;
mod radial_dependence;
mod ring;
mod statistics;
pub mod synthetic;
mod unmixing;
mod window;

pub use block_errors::{BlockErrors, block_errors};
pub use correlation::{AngularCorrelation, CorrelationEstimator, CorrelationOutcome, CorrelationSettings};
pub use crossing::{CrossingOutcome, ThresholdCrossing};
pub use error::{AngularError, LEAST_DISK_COUNT};
pub use fourier::{Route, fourier_sums, fourier_sums_by};
pub use limits::{MOST_COUPLED_FREQUENCIES, MOST_GRID_POINTS, MOST_STEPS};
pub(crate) use pairs::correlation_of_bins;
pub use power_dependence::dependence;
pub use power_spectrum::{FrequencyLimit, Leakage, PowerSpectrum, SpectrumEstimator, SpectrumSettings};
pub use radial_dependence::{RadialDependenceSettings, RingAnalysis, RingOutcome, radial_dependence};
pub use ring::{RingSample, RingSettings, Weights};
pub(crate) use statistics::quantile;
pub use statistics::{
    CorrelationStatistics, CrossingStatistics, Mean, SpectrumStatistics, correlation_statistics, spectrum_statistics,
};
pub(crate) use unmixing::solve;
pub use window::{Source, SpectralWindow};
