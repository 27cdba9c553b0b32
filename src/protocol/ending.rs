//! [`Ending`]: where one protocol ended.

use serde::Serialize;

#[cfg(feature = "fit")]
use crate::protocol::ending_fit::EndingFit;
use crate::protocol::ending_response::EndingResponse;
use crate::relax::{Cost, Stop};

/// Where one protocol ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ending {
    /// The relaxer, with its damping law if it has one.
    pub relaxer: String,
    /// Why the relaxer itself stopped.
    pub stop: Stop,
    /// Why Newton's method after it stopped; absent where it was not called (not at rest, or no contacts).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finish: Option<Stop>,
    /// What the relaxer cost, Newton's method after it left out.
    pub cost: Cost,
    /// Largest way of a disk of the backbone during the finish \[length\]; 0 where there was none.
    pub finish_way: f64,
    /// Relative residual in the end \[1\].
    pub relative_residual: f64,
    /// Number of the minimum, from 1, in the order in which they were found; absent if not at rest or without contacts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub minimum: Option<usize>,
    /// Largest distance of a disk of both backbones from where it is in the reference \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<f64>,
    /// Labels of the disks farther away than [`ProtocolSettings::differing`] mean overlaps, farthest first.
    pub differing: Vec<u64>,
    /// Contacts between disks of the backbone that the reference has and this has not, or the other way about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_difference_count: Option<usize>,
    /// Number of contacts.
    pub contact_count: usize,
    /// Elastic energy, with that of sites \[energy\].
    pub energy: f64,
    /// Pressure \[force / length^(D−1)\].
    pub pressure: f64,
    /// Δp \[force / length^(D−1)\]; absent if not at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_change: Option<f64>,
    /// Its angular correlation and contact changes, where they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub response: Option<EndingResponse>,
    /// What was fitted to its radial profile.
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fit: Option<EndingFit>,
}

impl Ending {
    /// Whether it came to rest, contacts or not.
    pub fn at_rest(&self) -> bool {
        self.pressure_change.is_some()
    }
}
