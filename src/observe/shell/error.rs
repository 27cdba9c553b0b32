//! [`ShellError`]: why a shell, its spectrum or its correlation function could not be computed.

use thiserror::Error;

use crate::memory::TooLarge;

/// Minimum number of spheres in a shell.
pub const LEAST_DISK_COUNT: usize = 16;

/// Why a shell, its spectrum or its correlation function could not be computed.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ShellError {
    /// The numbers of directions and of values differ.
    #[error("{direction_count} directions but {value_count} values: the numbers must be equal")]
    LengthsDiffer {
        /// Number of directions.
        direction_count: usize,
        /// Number of values.
        value_count: usize,
    },
    /// Fewer spheres than [`LEAST_DISK_COUNT`].
    #[error("{disk_count} spheres in the shell, at least {LEAST_DISK_COUNT} are needed")]
    TooFewDisks {
        /// Spheres in the shell.
        disk_count: usize,
    },
    /// A direction has no length, or a number is not finite or above 10¹⁵⁰, whose square overflows.
    #[error(
        "sphere {disk}: direction {direction:?}, value {value}: both must be finite, at most 1e150, and the direction not zero"
    )]
    NotFinite {
        /// Index of the sphere as given.
        disk: usize,
        /// Its direction.
        direction: [f64; 3],
        /// Its value.
        value: f64,
    },
    /// The radius of the shell or its width is not positive and finite.
    #[error("a shell at r/R = {relative_radius} ± {half_width}: both must be positive and finite")]
    ShellOutOfRange {
        /// The middle, r̂.
        relative_radius: f64,
        /// The half width.
        half_width: f64,
    },
    /// All values are equal: there is no fluctuation to correlate.
    #[error("the {disk_count} values of the shell are all {mean}: there is no fluctuation")]
    NoFluctuation {
        /// Spheres in the shell.
        disk_count: usize,
        /// Their mean value.
        mean: f64,
    },
    /// A setting that must be positive and finite is not.
    #[error("{setting} must be positive and finite, it is {value}")]
    NotPositive {
        /// The setting.
        setting: &'static str,
        /// Its value.
        value: f64,
    },
    /// The highest degree requested is 0, or its harmonics are as many as the spheres.
    #[error("highest degree {degree_limit} of {disk_count} spheres: must be from 1 to {highest}")]
    DegreeLimitOutOfRange {
        /// The highest degree requested.
        degree_limit: usize,
        /// Spheres in the shell.
        disk_count: usize,
        /// The highest degree available.
        highest: usize,
    },
    /// The directions cannot separate the degrees.
    #[error("the directions of {disk_count} spheres do not separate degrees up to {degree_limit}")]
    NotSeparable {
        /// Spheres in the shell.
        disk_count: usize,
        /// Highest degree.
        degree_limit: usize,
    },
    /// A threshold is not below 1, the value of G at γ = 0.
    #[error("a threshold of G must be below 1, it is {threshold}")]
    ThresholdNotBelowOne {
        /// The threshold.
        threshold: f64,
    },
    /// A number of bins, degrees or spheres is beyond the limits.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
}
