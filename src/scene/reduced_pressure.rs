//! The reduced pressure p̂ = p N^(α−1) of a scene: N is the number of disks in the circle by area, α the exponent of
//! the law.

use crate::inflation::Boundary;
use crate::packing::ball_volume;
use crate::scene::definition::Scene;

/// N, the number of disks in the circle by area (of spheres in the ball by volume), or of the whole periodic box.
pub(crate) fn mobile_count(disk_count: usize, boundary: Boundary, dimension: usize) -> f64 {
    let share = match boundary {
        Boundary::HeldRim { outer_radius_over_side: ratio } if dimension == 3 => ball_volume::<3>(ratio),
        Boundary::HeldRim { outer_radius_over_side: ratio } => std::f64::consts::PI * ratio * ratio,
        Boundary::Periodic => 1.0,
    };
    share * disk_count as f64
}

/// p̂/p = N^(α−1).
pub(crate) fn reduction(scene: &Scene) -> f64 {
    libm::pow(mobile_count(scene.disk_count, scene.inflation.boundary, scene.dimension), scene.law.exponent() - 1.0)
}
