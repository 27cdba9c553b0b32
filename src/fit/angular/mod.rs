//! The slope of an angular power spectrum and its crossover frequency f†, by maximum likelihood: [`fit_slope`],
//! [`fit_crossover`].
//!
//! ```text
//! power law     S(f) = A f^(−s)
//! Lorentzian    S(f) = A/(1 + (f/f†)^s),  s = 1.5 or free        θ† = k/f†
//! ```
//!
//! A power P_f of a random field is exponentially distributed about its mean; log P_f has a standard deviation of π/√6
//! for any number of disks. The fit therefore uses Whittle's likelihood instead of least squares. The mean is not S(f)
//! itself but its expected value at the angles of the ring
//! ([`SpectralWindow`](crate::observe::angular::SpectralWindow)), so irregular angles cause no bias:
//!
//! ```text
//! −2 ln L = 2 Σ_f (ln E_f + P_f/E_f)          E_f = Σ_g K_fg S(g) + ρ N_f          gaps as weights
//! ```
//!
//! The best A, one for each ring, has a closed form, for which the mean of P/E is 1. Several rings, one per sample, are
//! fitted together. The interval of a parameter is where −2 ln L, minimised over all other parameters, rises by at most
//! 4 (1 + 0.4 D/m). This is two standard errors with Bartlett's correction for a small number m of powers; 0.4 is the
//! value for independent exponential variates, by Lawley's expansion. m/D is the number of independent powers with the
//! same scatter: at few irregular angles the leakage of low frequencies is common to all
//! ([`dependence`](crate::observe::angular::dependence)). The standard error is a fourth of the interval.
//!
//! For shells of spheres, [`fit_shell_slope`] and [`fit_shell_crossover`] use the same likelihood with
//! 2ℓ+1 modes per power.
//!
//! Source: Whittle (1953), Ark. Mat. 2, 423; Sykulski et al. (2019), Biometrika 106, 251; Lawley (1956), Biometrika 43,
//! 295.

mod crossover;
mod error;
mod interval;
mod likelihood;
mod shell;
mod slope;
mod window;

pub(in crate::fit) use crossover::{Crossover, CrossoverMinimum, Shape, octaves};
pub use crossover::{CrossoverFit, CrossoverOutcome, CrossoverSettings, ExponentChoice, fit_crossover};
pub use error::{LEAST_POWER_COUNT, SpectrumFitError};
pub use interval::Interval;
pub use shell::{ShellCrossoverSettings, ShellFitSettings, fit_shell_crossover, fit_shell_slope};
pub use slope::{SlopeFit, SlopeOutcome, fit_slope};
pub use window::{HighestFrequency, SingleDiskNoise, SpectrumWindowSettings};
