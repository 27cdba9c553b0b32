//! [`Rest`]: a state at rest of an inflation, and [`Stage`]: which of the states it is.

use serde::{Deserialize, Serialize};

use crate::packing::Packing;
use crate::relax::{Cost, Criterion, Relaxed, Residual};

/// The relaxations of an inflation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Before the inflation; takes no steps if the packing is at rest.
    Before,
    /// After the inflation.
    Inflated,
    /// After the deflation.
    Deflated,
}

impl std::fmt::Display for Stage {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Stage::Before => "before the inflation",
            Stage::Inflated => "after the inflation",
            Stage::Deflated => "after the deflation",
        })
    }
}

/// A state at rest of an inflation.
#[derive(Debug, Clone)]
pub struct Rest<const D: usize> {
    /// The disks.
    pub packing: Relaxed<Packing<D>>,
    /// Pressure of the circle or the box \[force / length^(D−1)\].
    pub pressure: f64,
    /// Elastic energy, including that of sites and loads \[energy\].
    pub energy: f64,
    /// Number of contacts, without those between held disks.
    pub contact_count: usize,
    /// Number of mobile disks that are rattlers.
    pub rattler_count: usize,
    /// Whether each disk belongs to the backbone.
    pub backbone: Vec<bool>,
    /// Residual reached.
    pub residual: Residual,
    /// Rounding floor of the relative residual \[1\].
    pub rounding_floor: f64,
    /// Which limit was met.
    pub criterion: Criterion,
    /// Cost of the relaxation.
    pub cost: Cost,
}
