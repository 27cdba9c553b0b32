//! [`AngularError`]: why a ring, its spectrum or its correlation function could not be had.

use thiserror::Error;

use crate::memory::TooLarge;

/// Disks a ring needs: with fewer there is no angle to speak of.
pub const LEAST_DISK_COUNT: usize = 4;

/// Why a ring, its spectrum or its correlation function could not be had.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum AngularError {
    /// As many values as angles are needed.
    #[error("{angle_count} angles and {value_count} values")]
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
    /// An angle or a value that is not finite, or a value beyond 10¹⁵⁰, whose square is none.
    #[error("disk {disk}: angle {angle}, value {value}")]
    NotFinite {
        /// Index of the disk as given.
        disk: usize,
        /// Its angle.
        angle: f64,
        /// Its value.
        value: f64,
    },
    /// Where the ring lies, or its width, is not positive and finite.
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
    /// A number of steps, bins, points or frequencies beyond what memory allows.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// The highest frequency asked for is 0, or the estimator does not reach it.
    #[error("frequencies up to {frequency_limit}: from 1 to {highest} can be had")]
    FrequencyLimitOutOfRange {
        /// The highest frequency asked for.
        frequency_limit: usize,
        /// The highest there is.
        highest: usize,
    },
    /// A threshold that is not below 1, where G begins.
    #[error("a threshold of G must be below 1, it is {threshold}")]
    ThresholdNotBelowOne {
        /// The threshold.
        threshold: f64,
    },
    /// Fewer blocks than can have a scatter, or more than disks to put into them.
    #[error("{block_count} blocks of {disk_count} disks: at least 4, and at most a fourth as many as disks")]
    BlockCountOutOfRange {
        /// Blocks asked for.
        block_count: usize,
        /// Disks.
        disk_count: usize,
    },
    /// No sample, or samples that are not alike in their angles, thresholds or frequencies.
    #[error("sample {sample} of {sample_count} cannot be averaged: {reason}")]
    SamplesDiffer {
        /// The first that differs from sample 0.
        sample: usize,
        /// How many there are.
        sample_count: usize,
        /// In what.
        reason: &'static str,
    },
}
