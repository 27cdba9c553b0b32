//! [`Ending`]: the end state of one protocol.

use serde::Serialize;

#[cfg(feature = "fit")]
use crate::protocol::ending_fit::EndingFit;
use crate::protocol::ending_response::EndingResponse;
use crate::relax::{Cost, Stop};

/// The end state of one protocol.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ending {
    /// The relaxer, with its damping law if it has one.
    pub relaxer: String,
    /// Why the relaxer itself stopped.
    pub stop: Stop,
    /// Why Newton's method stopped after the relaxer; absent if it did not run (not at rest, or no contacts).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finish: Option<Stop>,
    /// Cost of the relaxer, without that of Newton's method.
    pub cost: Cost,
    /// Largest displacement of a disk of the backbone in Newton's method \[length\]; 0 if it did not run.
    pub finish_way: f64,
    /// Final relative residual \[1\].
    pub relative_residual: f64,
    /// Number of the minimum, from 1, in the order of their discovery; absent if not at rest or without contacts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub minimum: Option<usize>,
    /// Largest distance of a disk of both backbones from its position in the reference \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<f64>,
    /// Labels of the disks farther away than [`ProtocolSettings::differing`](crate::protocol::ProtocolSettings::differing) mean overlaps, farthest first.
    pub differing: Vec<u64>,
    /// Number of contacts of the backbone that only one of this state and the reference has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_difference_count: Option<usize>,
    /// Number of contacts.
    pub contact_count: usize,
    /// Elastic energy, including that of sites \[energy\].
    pub energy: f64,
    /// Pressure \[force / length^(D−1)\].
    pub pressure: f64,
    /// Δp \[force / length^(D−1)\]; absent if not at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_change: Option<f64>,
    /// Its angular correlation and contact changes, if they were computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub response: Option<EndingResponse>,
    /// The fit to its radial profile.
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fit: Option<EndingFit>,
}

impl Ending {
    /// Whether it came to rest, with or without contacts.
    pub fn at_rest(&self) -> bool {
        self.pressure_change.is_some()
    }
}
