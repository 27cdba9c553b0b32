//! The reduced pressure p̂ = p N^(α−1) of a scene: N is the number of disks in the circle by area, α the exponent of
//! the law.

use crate::inflation::Boundary;
use crate::scene::definition::Scene;

/// N, the number of disks in the circle by area, or of the whole periodic box.
pub(crate) fn mobile_count(disk_count: usize, boundary: Boundary) -> f64 {
    let share = match boundary {
        Boundary::HeldRim { outer_radius_over_side: ratio } => std::f64::consts::PI * ratio * ratio,
        Boundary::Periodic => 1.0,
    };
    share * disk_count as f64
}

/// p̂/p = N^(α−1).
pub(crate) fn reduction(scene: &Scene) -> f64 {
    libm::pow(mobile_count(scene.disk_count, scene.inflation.boundary), scene.law.exponent() - 1.0)
}
