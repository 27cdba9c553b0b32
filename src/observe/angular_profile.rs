//! [`AngularProfile`]: the radial displacement of the disks in one ring against their angle.

use serde::{Deserialize, Serialize};

use crate::displacement::DisplacementField;

/// Half width of a ring over R \[1\]. Source: the study, δr̂ = 0.03.
pub const RING_HALF_WIDTH: f64 = 0.03;

/// The disks of the ring r̂ ± 0.03, sorted by angle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AngularProfile {
    /// r̂ = r/R, the middle of the ring \[1\].
    pub relative_radius: f64,
    /// Angles θ in (−π, π], ascending \[rad\].
    pub angles: Vec<f64>,
    /// Radial displacements d_r \[length\].
    pub radial: Vec<f64>,
    /// Distances r from the centre \[length\].
    pub distances: Vec<f64>,
}

impl AngularProfile {
    /// The ring of a field around r̂, from the disks that count.
    pub fn of(field: &DisplacementField<2>, relative_radius: f64) -> Self {
        Self::within(field, relative_radius, RING_HALF_WIDTH)
    }

    /// The ring r̂ ± `half_width`.
    pub fn within(field: &DisplacementField<2>, relative_radius: f64, half_width: f64) -> Self {
        let near = |distance: f64| (distance / field.outer_radius - relative_radius).abs() <= half_width;
        let mut disks: Vec<(f64, f64, f64)> = field
            .counted()
            .filter(|disk| near(disk.distance))
            .map(|disk| (disk.angle(), disk.radial, disk.distance))
            .collect();
        disks.sort_by(|a, b| a.0.total_cmp(&b.0));
        AngularProfile {
            relative_radius,
            angles: disks.iter().map(|disk| disk.0).collect(),
            radial: disks.iter().map(|disk| disk.1).collect(),
            distances: disks.iter().map(|disk| disk.2).collect(),
        }
    }
}
