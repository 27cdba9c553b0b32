//! [`RadialProfile`]: the mean radial displacement in rings around the inflated disk.

use serde::{Deserialize, Serialize};

/// One ring of a radial profile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ring {
    /// Mean distance of the disks of the ring from the centre \[length\].
    pub radius: f64,
    /// Number of disks in the ring.
    pub disk_count: usize,
    /// Mean radial displacement ⟨d_r⟩ \[length\].
    pub mean: f64,
    /// Standard deviation of d_r within the ring \[length\].
    pub spread: f64,
    /// Standard error of the mean \[length\].
    pub standard_error: f64,
}

/// Mean radial displacement against distance from the centre, ring by ring from the inside out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RadialProfile {
    /// The rings that hold at least one disk.
    pub rings: Vec<Ring>,
}
