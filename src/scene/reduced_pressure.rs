//! The reduced pressure p̂ = p N^(2(α−1)/D) of a scene: N is the number of disks in the circle by area (of spheres in the
//! ball by volume), α the exponent of the law, D the dimension. In the plane p̂ = p N^(α−1).

use crate::inflation::Boundary;
use crate::law::pair_law::PairLaw;
use crate::packing::ball_volume;
use crate::scene::definition::Scene;

/// N, the number of disks in the circle by area (of spheres in the ball by volume), between the walls of a strip, or of the
/// whole periodic box.
pub(crate) fn mobile_count(disk_count: usize, boundary: Boundary, dimension: usize) -> f64 {
    let share = match boundary {
        Boundary::HeldRim { outer_radius_over_side: ratio } if dimension == 3 => ball_volume::<3>(ratio),
        Boundary::HeldRim { outer_radius_over_side: ratio } => std::f64::consts::PI * ratio * ratio,
        Boundary::HeldWalls { distance_over_side: ratio, .. } => 2.0 * ratio,
        Boundary::Periodic => 1.0,
    };
    share * disk_count as f64
}

/// The exponent of N in p̂ = p N^(2(α−1)/D).
///
/// The isostatic length ℓ ∼ 1/ΔZ ∼ p^(−1/(2(α−1))) reaches R ∼ N^(1/D) at p ∼ N^(−2(α−1)/D).
pub(crate) fn exponent_of_size(law: &dyn PairLaw, dimension: usize) -> f64 {
    2.0 * (law.exponent() - 1.0) / dimension as f64
}

/// p̂/p = N^(2(α−1)/D).
pub(crate) fn reduction(scene: &Scene) -> f64 {
    let mobile = mobile_count(scene.disk_count, scene.inflation.boundary, scene.dimension);
    libm::pow(mobile, exponent_of_size(&scene.law, scene.dimension))
}
