//! [`AngularError`]: why a ring, its spectrum or its correlation function could not be computed.

use thiserror::Error;

use crate::memory::TooLarge;

/// Minimum number of disks in a ring.
pub const LEAST_DISK_COUNT: usize = 4;

/// Why a ring, its spectrum or its correlation function could not be computed.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum AngularError {
    /// The numbers of angles and of values differ.
    #[error("{angle_count} angles but {value_count} values: the numbers must be equal")]
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
    /// An angle or a value is not finite, or a value is above 10¹⁵⁰, whose square overflows.
    #[error("disk {disk}: angle {angle}, value {value}: both must be finite, and the value at most 1e150")]
    NotFinite {
        /// Index of the disk as given.
        disk: usize,
        /// Its angle.
        angle: f64,
        /// Its value.
        value: f64,
    },
    /// The radius of the ring or its width is not positive and finite.
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
    /// A number of steps, bins, points or frequencies is beyond the memory limits.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// The highest frequency requested is 0, or above the limit of the estimator.
    #[error("highest frequency {frequency_limit}: must be from 1 to {highest}")]
    FrequencyLimitOutOfRange {
        /// The highest frequency requested.
        frequency_limit: usize,
        /// The highest frequency available.
        highest: usize,
    },
    /// A threshold is not below 1, the value of G at θ = 0.
    #[error("a threshold of G must be below 1, it is {threshold}")]
    ThresholdNotBelowOne {
        /// The threshold.
        threshold: f64,
    },
    /// Too few blocks to have a scatter, or too many for the disks.
    #[error(
        "{block_count} blocks of {disk_count} disks: must be at least 4 and at most a quarter of the number of disks"
    )]
    BlockCountOutOfRange {
        /// Number of blocks requested.
        block_count: usize,
        /// Number of disks.
        disk_count: usize,
    },
    /// No samples, or samples with different angles, thresholds or frequencies.
    #[error("sample {sample} of {sample_count} cannot be averaged: {reason}")]
    SamplesDiffer {
        /// The first sample that differs from sample 0.
        sample: usize,
        /// Number of samples.
        sample_count: usize,
        /// The difference.
        reason: &'static str,
    },
}
