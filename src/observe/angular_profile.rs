//! [`AngularProfile`]: the radial displacement of the disks in one ring against their angle.
//!
//! In a strip a ring is the row at this distance from the line, on the side of positive y. The angle stands for the place
//! along it, θ = 2πx/L, and a frequency f for the wave number q = 2πf/L.

use serde::{Deserialize, Serialize};

use crate::displacement::{DisplacementField, Moved, Shape};

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
            .filter(|disk| near(disk.distance) && is_on_side(field, disk))
            .map(|disk| (field.angle(disk), disk.radial, disk.distance))
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

/// Whether a disk is on the side that a ring belongs to. The two sides of a held row respond independently, so a ring has
/// one of them.
fn is_on_side(field: &DisplacementField<2>, disk: &Moved<2>) -> bool {
    match field.shape {
        Shape::Round => true,
        Shape::Strip { .. } => disk.position[1] > 0.0,
    }
}
