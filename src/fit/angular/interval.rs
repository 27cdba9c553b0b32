//! [`Interval`]: a fitted number with its interval of two standard errors.

use serde::{Deserialize, Serialize};

use crate::fit::Estimate;

/// A fitted number with its interval of two standard errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// The best value \[1; rad for an angle\].
    pub best: f64,
    /// Lower end \[the same unit\]; none if it reaches the end of the search.
    pub lower: Option<f64>,
    /// Upper end \[the same unit\]; none if it reaches the end of the search.
    pub upper: Option<f64>,
}

impl Interval {
    /// Best value, with a fourth of the interval as standard error, if both ends exist.
    pub fn estimate(&self) -> Option<Estimate> {
        Some(Estimate { value: self.best, standard_error: 0.25 * (self.upper? - self.lower?) })
    }

    /// Whether the interval contains a number.
    pub fn holds(&self, value: f64) -> bool {
        self.lower.is_none_or(|lower| lower <= value) && self.upper.is_none_or(|upper| value <= upper)
    }
}
