//! [`EnsembleFitError`]: why data could not be fitted.

use thiserror::Error;

/// Why data could not be fitted. Data without a clear result are an outcome, not an error.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum EnsembleFitError {
    /// There is no sample.
    #[error("there are no samples")]
    NoSample,
    /// Too few points, or too few different x.
    #[error("{point_count} different points: at least {needed} are needed")]
    TooFewPoints {
        /// Number of points with different x.
        point_count: usize,
        /// Number of points required.
        needed: usize,
    },
    /// Fewer than two curves with points, or none with two points.
    #[error("{curve_count} curves with points: at least two are needed, and one of them needs two points")]
    TooFewCurves {
        /// Number of curves with points.
        curve_count: usize,
    },
    /// An invalid point: not finite, an error that is not positive, or a value without a logarithm.
    #[error("point {point} is invalid: x = {x}, y = {y}, error {error}")]
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
    /// A group with invalid x or counts.
    #[error("group {group} is invalid: {hits} hits of {count} at x = {x}")]
    GroupUnusable {
        /// Index of the group, from 0.
        group: usize,
        /// Its x.
        x: f64,
        /// Its number of hits.
        hits: f64,
        /// Its number of samples.
        count: f64,
    },
    /// The number of powers of a sample differs from that of the first.
    #[error("sample {sample} has {power_count} powers, but the first sample has {expected}")]
    SamplesDiffer {
        /// Index of the sample, from 0.
        sample: usize,
        /// Its number of powers.
        power_count: usize,
        /// Number of powers of the first sample.
        expected: usize,
    },
    /// A power is not finite.
    #[error("sample {sample}: the power at f = {frequency} is not finite")]
    PowerNotFinite {
        /// Index of the sample, from 0.
        sample: usize,
        /// f.
        frequency: usize,
    },
    /// A window beyond the powers, or with fewer than three of them.
    #[error("powers from f = {lowest} to {highest}: must be at least 3 powers, within f = 1 to {power_count}")]
    WindowOutOfRange {
        /// Lowest f.
        lowest: usize,
        /// Highest f.
        highest: usize,
        /// Highest f available.
        power_count: usize,
    },
    /// A point is not below the x of the divergence.
    #[error("point {point} at x = {x} is not below x_c = {critical}")]
    NotBelowCritical {
        /// Index of the point, from 0.
        point: usize,
        /// Its x.
        x: f64,
        /// x_c.
        critical: f64,
    },
    /// The logarithm of a scale factor is not finite.
    #[error("curve {curve}: the logarithm of a scale factor is {logarithm}, not a finite number")]
    ScaleUnusable {
        /// Index of the curve, from 0.
        curve: usize,
        /// The logarithm.
        logarithm: f64,
    },
    /// A setting is out of range.
    #[error("{setting} = {value} is out of range")]
    SettingOutOfRange {
        /// The setting.
        setting: &'static str,
        /// Its value.
        value: f64,
    },
}
