//! [`SpectrumFitError`]: why a spectrum could not be fitted.

use crate::observe::angular::AngularError;
use crate::observe::shell::ShellError;

/// Minimum number of powers for a fit.
pub const LEAST_POWER_COUNT: usize = 3;

/// Why a spectrum could not be fitted. A white or scale-free spectrum is an outcome, not an error.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpectrumFitError {
    /// No ring was given.
    #[error("there is no ring to fit")]
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
    #[error("powers from f = {lowest} to {highest} of {disk_count} disks: must be from 1 to half the number of disks")]
    WindowOutOfRange {
        /// Lowest f.
        lowest: usize,
        /// Highest f.
        highest: usize,
        /// Disks of the ring.
        disk_count: usize,
    },
    /// All values of a ring are equal.
    #[error("ring {ring} has no power, because all its values are equal")]
    NoPower {
        /// Index of the ring.
        ring: usize,
    },
    /// A setting is out of range.
    #[error("{setting} = {value} is out of range")]
    SettingOutOfRange {
        /// The setting.
        setting: &'static str,
        /// Its value.
        value: f64,
    },
    /// The spectrum could not be computed.
    #[error("the spectrum: {0}")]
    Spectrum(#[from] AngularError),
    /// The spectrum of a shell could not be computed.
    #[error("the spectrum: {0}")]
    Shell(#[from] ShellError),
}
