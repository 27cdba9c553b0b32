//! [`CrossingOutcome`]: where a measured correlation function first falls to a threshold.

use serde::{Deserialize, Serialize};

/// A threshold of G and where G first falls to it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ThresholdCrossing {
    /// G_th \[1\].
    pub threshold: f64,
    /// θ*, or why there is none.
    pub outcome: CrossingOutcome,
}

/// Where a measured correlation function first falls to a threshold.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CrossingOutcome {
    /// At this angle.
    At {
        /// θ* \[rad\].
        angle: f64,
    },
    /// G stays above the threshold up to π.
    Never {
        /// The lowest value of G \[1\].
        lowest: f64,
    },
    /// There is no G: the values have no variance.
    NoCorrelation,
    /// There is no G: its estimate leaves \[−1, 1\].
    OutOfRange {
        /// The value farthest from the range \[1\].
        farthest: f64,
    },
}

impl CrossingOutcome {
    /// The angle \[rad\], if there is one.
    pub fn angle(self) -> Option<f64> {
        match self {
            CrossingOutcome::At { angle } => Some(angle),
            CrossingOutcome::Never { .. } | CrossingOutcome::NoCorrelation | CrossingOutcome::OutOfRange { .. } => None,
        }
    }

    /// The first crossing in a table, ascending from θ = 0, with linear interpolation.
    pub(crate) fn in_table(angles: &[f64], values: &[f64], threshold: f64) -> Self {
        Self::refined(angles, values, threshold, |low, high| {
            let share = (values[low] - threshold) / (values[low] - values[high]);
            angles[low] + share * (angles[high] - angles[low])
        })
    }

    /// The first crossing of a curve: bracketed by its table, then by bisection down to adjacent floating-point
    /// numbers.
    pub(super) fn of_curve(angles: &[f64], values: &[f64], threshold: f64, curve: impl Fn(f64) -> f64) -> Self {
        Self::refined(angles, values, threshold, |low, high| {
            let (mut low, mut high) = (angles[low], angles[high]);
            loop {
                let middle = 0.5 * (low + high);
                if middle <= low || middle >= high {
                    return high;
                }
                if curve(middle) > threshold { low = middle } else { high = middle }
            }
        })
    }

    fn refined(angles: &[f64], values: &[f64], threshold: f64, at: impl Fn(usize, usize) -> f64) -> Self {
        if values.iter().any(|value| value.is_nan()) {
            return CrossingOutcome::NoCorrelation;
        }
        match values.iter().position(|&value| value <= threshold) {
            Some(0) => CrossingOutcome::At { angle: angles[0] },
            Some(point) => CrossingOutcome::At { angle: at(point - 1, point) },
            None => CrossingOutcome::Never { lowest: values.iter().copied().fold(f64::INFINITY, f64::min) },
        }
    }
}
