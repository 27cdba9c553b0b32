//! Fits of measured profiles and spectra to exact solutions, with errors and decisions.
//!
//! Start from [`profile::fit_radial_profile`]: one radial profile against the elastic and the screened solution, in
//! two or three dimensions; from
//! [`angular::fit_slope`] and [`angular::fit_crossover`]: angular power spectra; or from [`modes::fit_elastic_modes`]:
//! angular modes against the elastic ones. For ensembles see [`ensemble`].

pub mod angular;
mod dimension;
pub mod ensemble;
mod incomplete_beta;
pub mod modes;
pub mod profile;
mod profile_fit;
mod rings;
mod screening;
mod search;
mod significance;
mod units;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::reference::ReferenceError;

/// A fitted number and its standard error, in the units of the number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The best value \[unit of the number\].
    pub value: f64,
    /// One standard error \[unit of the number\].
    pub standard_error: f64,
}

/// Why data could not be fitted. If no solution describes the data, that is an outcome, not an error:
/// [`Decision::Neither`](profile::Decision::Neither).
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum FitError {
    /// Too few rings in the range.
    #[error("{ring_count} rings between {from} and {to}: at least {needed} are needed")]
    TooFewRings {
        /// Number of rings in the range.
        ring_count: usize,
        /// Number of rings required.
        needed: usize,
        /// Inner end of the range \[length\].
        from: f64,
        /// Outer end of the range \[length\].
        to: f64,
    },
    /// The displacement of every ring in the range is zero, to less than 10⁻¹⁰⁰ of the errors.
    #[error("all {ring_count} rings of the range have zero displacement")]
    NoDisplacement {
        /// Number of rings in the range.
        ring_count: usize,
    },
    /// The ratio of the radii is out of range.
    #[error("the annulus: {0}")]
    Annulus(#[from] ReferenceError),
    /// A ring has invalid numbers.
    #[error(
        "ring {ring}: radius {radius} (positive), mean {mean} (up to 1e200), standard error {standard_error} (not negative, \
         up to 1e200) of {disk_count} disks (at least one)"
    )]
    RingUnusable {
        /// Index of the ring, from 0.
        ring: usize,
        /// Its radius \[length\].
        radius: f64,
        /// Its mean radial displacement \[length\].
        mean: f64,
        /// Standard error of that mean \[length\].
        standard_error: f64,
        /// Its number of disks.
        disk_count: usize,
    },
    /// The margins cover the whole annulus.
    #[error("the range of the fit is empty: from {from} to {to}")]
    RangeEmpty {
        /// Inner end of the range \[length\].
        from: f64,
        /// Outer end of the range \[length\].
        to: f64,
    },
    /// A margin is negative or not a number.
    #[error("a margin must be finite and not negative: {inner} at the disk, {rim} at the rim")]
    MarginNegative {
        /// The margin at the inflated disk \[diameters\].
        inner: f64,
        /// The margin at the rim \[diameters\].
        rim: f64,
    },
    /// The setting must be at least two rings per wavelength, for the wavelength to be resolved.
    #[error("the shortest wavelength searched must span at least 2 rings, it spans {rings_per_wavelength}")]
    WavelengthUnresolved {
        /// The setting.
        rings_per_wavelength: f64,
    },
    /// Poisson's ratio in two dimensions is not between −1 and 1.
    #[error("poisson_ratio is {ratio}, not between -1 and 1")]
    PoissonRatioOutside {
        /// The ratio given.
        ratio: f64,
    },
    /// The level of significance or the share of variance is not between 0 and 1.
    #[error("significance {significance} and least share {least_share} must lie between 0 and 1, ends excluded")]
    LevelOutOfRange {
        /// The level of significance.
        significance: f64,
        /// The minimum share of variance.
        least_share: f64,
    },
}
