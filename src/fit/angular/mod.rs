//! The slope of an angular power spectrum and its crossover frequency f†, by maximum likelihood: [`fit_slope`], [`fit_crossover`].
//!
//! ```text
//! power law     S(f) = A f^(−s)
//! Lorentzian    S(f) = A/(1 + (f/f†)^s),  s = 1.5 or free        θ† = k/f†
//! ```
//!
//! A power P_f of a random field is exponentially distributed about its mean, log P_f with a standard deviation of π/√6, whatever
//! the number of disks: hence Whittle's likelihood, and no least squares. The mean is not S(f) but what the very angles of
//! the ring make of it ([`SpectralWindow`](crate::observe::angular::SpectralWindow)), so that irregular angles bias nothing:
//!
//! ```text
//! −2 ln L = 2 Σ_f (ln E_f + P_f/E_f)          E_f = Σ_g K_fg S(g) + ρ N_f          gaps as weights
//! ```
//!
//! A, of each ring its own, has its best value in closed form, P/E in the mean 1. Several rings, those of samples, are fitted
//! together. The interval of a parameter holds where −2 ln L, all other parameters at their best, rises by no more than
//! 4 (1 + 0.4 D/m): two standard errors, with the correction of a small number of powers m (Bartlett's; 0.4 is that of independent
//! exponential variates, by Lawley's expansion). m/D is how many independent powers would scatter as much: at few irregular angles
//! what low frequencies leak is common to all ([`dependence`](crate::observe::angular::dependence)). The standard error is a fourth
//! of the interval.
//!
//! Source: Whittle (1953), Ark. Mat. 2, 423; Sykulski et al. (2019), Biometrika 106, 251; Lawley (1956), Biometrika 43, 295.

mod crossover;
mod error;
mod interval;
mod likelihood;
mod slope;
mod window;

pub(in crate::fit) use crossover::{Crossover, Located, Shape, locate};
pub use crossover::{CrossoverFit, CrossoverOutcome, CrossoverSettings, ExponentChoice, fit_crossover};
pub use error::{LEAST_POWER_COUNT, SpectrumFitError};
pub use interval::Interval;
pub use slope::{SlopeFit, SlopeOutcome, fit_slope};
pub use window::{HighestFrequency, SingleDiskNoise, SpectrumWindowSettings};
