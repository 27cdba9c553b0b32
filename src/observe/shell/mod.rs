//! Angular correlations of the radial displacement in a shell around an inflated sphere: [`ShellAnalysis`],
//! [`ShellSpectrum`], [`ShellCorrelation`].
//!
//! ```text
//! δd_r = d_r − ⟨d_r⟩        |r/R − 0.5| ≤ 0.03        G(γ) = ⟨δd_r(n) δd_r(n')⟩/⟨δd_r²⟩,  cos γ = n·n'
//! G(γ) = Σ (2ℓ+1) S(ℓ) P_ℓ(cos γ)/Σ (2ℓ+1) S(ℓ),  S(1) = 1        G* = −G(π)        G(γ*) = 0.1
//! ```
//!
//! S(ℓ) is the power of one of the 2ℓ+1 harmonics of degree ℓ: C_ℓ/C_1. [`ShellSpectrum`] compares it with the S(f) of a
//! ring. [`ShellWindow`] gives the expected power at the directions of a shell; [`synthetic`] makes shells of a known
//! spectrum.
//!
//! The counterpart of [`angular`](crate::observe::angular) in three dimensions. Results depend only on the spheres, not
//! on their order. Rotation changes S(ℓ), G and G* only by rounding; the blocks of the errors do not rotate.

mod analysis;
mod correlation;
mod error;
mod harmonics;
mod limits;
mod pairs;
mod power_spectrum;
mod sample;
pub mod synthetic;
mod window;

pub use analysis::{SHELL_HALF_WIDTH, SHELL_RADIUS, ShellAnalysis, ShellSettings};
pub use correlation::{Anticorrelation, ShellCorrelation, ShellCorrelationSettings, ShellCrossing};
pub use error::{LEAST_DISK_COUNT, ShellError};
pub use limits::{MOST_BINS, MOST_DEGREES, MOST_PAIRED};
pub use power_spectrum::{DegreeLimit, ShellSpectrum, ShellSpectrumSettings};
pub use sample::ShellSample;
pub use window::ShellWindow;
