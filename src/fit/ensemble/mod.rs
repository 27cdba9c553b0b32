//! Fits over ensembles: crossings, divergences and collapses of quantities from many samples, with errors by
//! resampling.
//!
//! Numbers only: no packings or studies. Start from [`half_crossing`], [`slope_of_mean`] and [`crossover_of_mean`],
//! [`fit_power_law`] and [`fit_divergence`], or [`collapse`]; for errors see [`bootstrap`].
//!
//! ```text
//! P(hit) = 1/(1 + exp(±(x − x_c)/w))                 half crossing
//! E_f = A f^(−s),   E_f = A/(1 + (f/f†)^s)           mean spectra
//! y = A x^b,   y = A (x_c − x)^(−μ)                  power laws
//! y = F(x N^a d_0^(−b))                              collapse, F unknown
//! ```
//!
//! Samples are assumed to be independent, and x to be exact.

mod bootstrap;
mod collapse;
mod collapse_quality;
mod divergence;
mod error;
mod half_crossing;
mod mean_crossover;
mod mean_powers;
mod mean_slope;
mod measured_point;
mod power_law;

pub use bootstrap::{BootstrapInterval, bootstrap, bootstrap_all};
pub use collapse::{Collapse, CollapseOutcome, CollapseSettings, collapse};
pub use collapse_quality::{CollapseQuality, Curve, collapse_quality};
pub use divergence::{Divergence, DivergenceAt, DivergenceOutcome, fit_divergence, fit_divergence_at};
pub use error::EnsembleFitError;
pub use half_crossing::{HalfCrossing, HitCount, Trend, half_crossing, half_crossing_interval};
pub use mean_crossover::{MeanCrossover, MeanCrossoverSettings, crossover_interval, crossover_of_mean};
pub use mean_slope::{LeastSquaresSlope, LikelihoodSlope, MeanSlope, slope_interval, slope_of_mean};
pub use measured_point::MeasuredPoint;
pub use power_law::{PowerLaw, fit_power_law};
