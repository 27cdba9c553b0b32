//! [`SeriesPoint`]: one cell of a series, and the names of its observables.

use serde::Serialize;

/// One cell of a series.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SeriesPoint {
    /// Its index among the cells of the study.
    pub cell: usize,
    /// p, mean over samples \[force / length\].
    pub pressure: f64,
    /// p̂, mean over samples \[force / length\].
    pub reduced_pressure: f64,
    /// Number of samples measured.
    pub sample_count: usize,
}

/// G*.
pub(crate) const ANTICORRELATION: &str = "anticorrelation";

/// θ* at the threshold 0.1.
pub(crate) const ANGLE: &str = "correlation_angle_at_0.1";
