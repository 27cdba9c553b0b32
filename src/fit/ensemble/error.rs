//! [`EnsembleFitError`]: why there is nothing to fit.

use thiserror::Error;

/// Why there is nothing to fit. That the data do not say what was asked is an outcome, not an error.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum EnsembleFitError {
    /// No sample at all.
    #[error("no sample")]
    NoSample,
    /// Too few points, or too few different x.
    #[error("{point_count} different points: at least {needed} are needed")]
    TooFewPoints {
        /// Points with different x.
        point_count: usize,
        /// Points needed.
        needed: usize,
    },
    /// Fewer than two curves with points, or none with two.
    #[error("{curve_count} curves with points: two are needed, one of them with two points")]
    TooFewCurves {
        /// Curves with points.
        curve_count: usize,
    },
    /// A point that cannot be used: not finite, its error not positive, or of the wrong sign where a logarithm is taken.
    #[error("point {point}: x = {x}, y = {y}, error {error}")]
    PointUnusable {
        /// Index of the point, from 0.
        point: usize,
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
        /// Its error.
        error: f64,
    },
    /// A group whose x or counts cannot be used.
    #[error("group {group}: {hits} hits of {count} at x = {x}")]
    GroupUnusable {
        /// Index of the group, from 0.
        group: usize,
        /// Its x.
        x: f64,
        /// Its hits.
        hits: f64,
        /// Its samples.
        count: f64,
    },
    /// A sample with another number of powers than the first.
    #[error("sample {sample} has {power_count} powers, the first {expected}")]
    SamplesDiffer {
        /// Index of the sample, from 0.
        sample: usize,
        /// Its powers.
        power_count: usize,
        /// Powers of the first sample.
        expected: usize,
    },
    /// A power that is not finite.
    #[error("sample {sample}: the power at f = {frequency} is not finite")]
    PowerNotFinite {
        /// Index of the sample, from 0.
        sample: usize,
        /// f.
        frequency: usize,
    },
    /// A window beyond the powers, or of fewer than three.
    #[error("powers from f = {lowest} to {highest} of f = 1 to {power_count}: at least 3 are needed")]
    WindowOutOfRange {
        /// Lowest f.
        lowest: usize,
        /// Highest f.
        highest: usize,
        /// Highest f there is.
        power_count: usize,
    },
    /// A point that is not below the x of the divergence.
    #[error("point {point} at x = {x} is not below x_c = {critical}")]
    NotBelowCritical {
        /// Index of the point, from 0.
        point: usize,
        /// Its x.
        x: f64,
        /// x_c.
        critical: f64,
    },
    /// A scale factor whose logarithm is not finite.
    #[error("curve {curve}: the logarithm of a scale factor is {logarithm}")]
    ScaleUnusable {
        /// Index of the curve, from 0.
        curve: usize,
        /// The logarithm.
        logarithm: f64,
    },
    /// A setting out of its range.
    #[error("{setting} = {value} is out of range")]
    SettingOutOfRange {
        /// The setting.
        setting: &'static str,
        /// Its value.
        value: f64,
    },
}
