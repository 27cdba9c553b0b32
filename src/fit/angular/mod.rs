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
mod likelihood;
mod slope;

use serde::{Deserialize, Serialize};

use crate::fit::Estimate;
use crate::observe::angular::AngularError;

pub(in crate::fit) use crossover::{Crossover, Located, Shape, locate};
pub use crossover::{CrossoverFit, CrossoverOutcome, CrossoverSettings, ExponentChoice, fit_crossover};
pub use slope::{SlopeFit, SlopeOutcome, fit_slope};

/// Powers a fit needs.
pub const LEAST_POWER_COUNT: usize = 3;

/// Which powers are fitted, and what may be in them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SpectrumWindowSettings {
    /// Lowest f, f_1 \[1\].
    pub lowest: usize,
    /// Highest f, f_2.
    pub highest: HighestFrequency,
    /// Values of single disks.
    pub noise: SingleDiskNoise,
    /// Highest frequency of the field itself over the number of disks \[1\]: the model ends there.
    pub frequencies_per_disk: f64,
}

impl Default for SpectrumWindowSettings {
    /// From f = 1; no noise of single disks; a field up to 16 frequencies a disk.
    fn default() -> Self {
        SpectrumWindowSettings {
            lowest: 1,
            highest: HighestFrequency::default(),
            noise: SingleDiskNoise::None,
            frequencies_per_disk: 16.0,
        }
    }
}

impl SpectrumWindowSettings {
    /// Whether every number makes sense, whatever the rings.
    pub(crate) fn check(&self) -> Result<(), SpectrumFitError> {
        let value = self.frequencies_per_disk;
        if (1.0..=1e3).contains(&value) {
            Ok(())
        } else {
            Err(SpectrumFitError::SettingOutOfRange { setting: "frequencies_per_disk", value })
        }
    }
}

/// The highest frequency fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HighestFrequency {
    /// n/16, but n/4 or 15, whichever is less, where that is more. Above n/16 leakage makes powers depend on each other, and
    /// the errors come out too small (`fits::powers_above_a_sixteenth_claim_too_much`).
    #[default]
    Resolved,
    /// This one, at most n/2.
    Fixed(usize),
}

/// Values of single disks on top of the field: white noise of variance ρ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SingleDiskNoise {
    /// There is none.
    #[default]
    None,
    /// ρ of every ring is fitted with the rest.
    Fitted,
}

/// A fitted number with its interval of two standard errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// The best value \[1, rad of an angle\].
    pub best: f64,
    /// Lower end \[the same\]; none if it reaches the end of the search.
    pub lower: Option<f64>,
    /// Upper end \[the same\]; none if it reaches the end of the search.
    pub upper: Option<f64>,
}

impl Interval {
    /// Best value and a fourth of the interval, if it has both ends.
    pub fn estimate(&self) -> Option<Estimate> {
        Some(Estimate { value: self.best, standard_error: 0.25 * (self.upper? - self.lower?) })
    }

    /// Whether a number lies in it.
    pub fn holds(&self, value: f64) -> bool {
        self.lower.is_none_or(|lower| lower <= value) && self.upper.is_none_or(|upper| value <= upper)
    }
}

/// Why there is nothing to fit. That a spectrum is white or scale-free is an outcome, not an error.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpectrumFitError {
    /// No ring was given.
    #[error("no ring to fit")]
    NoRing,
    /// Fewer powers than [`LEAST_POWER_COUNT`].
    #[error(
        "{power_count} powers from f = {lowest} to {highest} of {disk_count} disks: at least {LEAST_POWER_COUNT} are needed"
    )]
    TooFewPowers {
        /// Powers in the window.
        power_count: usize,
        /// Lowest f.
        lowest: usize,
        /// Highest f.
        highest: usize,
        /// Disks of the ring.
        disk_count: usize,
    },
    /// The window begins at 0 or ends above n/2.
    #[error("powers from f = {lowest} to {highest} of {disk_count} disks: from 1 to n/2 there are")]
    WindowOutOfRange {
        /// Lowest f.
        lowest: usize,
        /// Highest f.
        highest: usize,
        /// Disks of the ring.
        disk_count: usize,
    },
    /// Every value of a ring is the same.
    #[error("ring {ring} has no power")]
    NoPower {
        /// Index of the ring.
        ring: usize,
    },
    /// A setting out of its range.
    #[error("{setting} = {value} is out of range")]
    SettingOutOfRange {
        /// The setting.
        setting: &'static str,
        /// Its value.
        value: f64,
    },
    /// The spectrum could not be taken.
    #[error("the spectrum: {0}")]
    Spectrum(#[from] AngularError),
}
