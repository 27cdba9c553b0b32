//! [`MeasuredPoint`]: a number with its error.

use serde::{Deserialize, Serialize};

/// A number measured at a parameter known without error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredPoint {
    /// The parameter \[any unit\].
    pub x: f64,
    /// The number \[any unit\].
    pub y: f64,
    /// Standard error of y, positive \[y\].
    pub error: f64,
}
