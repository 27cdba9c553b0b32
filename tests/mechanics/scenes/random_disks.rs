//! Random overlapping disks: the input of tests that want any packing at all.

use jamscope::packing::{Domain, Packing};
use jamscope::vector::Vector;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Largest radius of [`disks`].
pub const LARGEST_RADIUS: f64 = 1.0;

/// A periodic box with these sides over the shortest one allowed (two contact ranges), at an odd corner.
pub fn periodic<const D: usize>(sides: Vector<D>) -> Domain<D> {
    let corner = std::array::from_fn(|d| -3.25 + 1.5 * d as f64);
    Domain::rectangular(corner, sides.map(|side| 4.0 * LARGEST_RADIUS * side))
}

/// The box of [`periodic`] with these tilts xy, xz, yz over the side along their own axis, on the grid of the disks.
pub fn tilted<const D: usize>(sides: Vector<D>, tilts: [f64; 3]) -> Domain<D> {
    let Domain::Periodic { corner, mut edges } = periodic(sides) else { unreachable!("periodic") };
    for (tilt, (d, axis)) in tilts.into_iter().zip([(1, 0), (2, 0), (2, 1)]).filter(|(_, (d, _))| *d < D) {
        edges[d][axis] = on_grid(tilt * edges[axis][axis]);
    }
    Domain::Periodic { corner, edges }
}

/// Disks with radii from 0.3 to 1; in a periodic box up to one box away from it, in the open plane within a cube of
/// twice the volume of the disks. A share of them is held.
///
/// All numbers are multiples of 2⁻²⁰, so that moving or turning them by such a multiple rounds nothing.
pub fn disks<const D: usize>(seed: u64, count: usize, domain: Domain<D>, held_share: f64) -> Packing<D> {
    let mut generator = Pcg64::seed_from_u64(seed);
    let (low, extent) = match domain {
        Domain::Periodic { corner, edges } => {
            (std::array::from_fn(|d| corner[d] - edges[d][d]), std::array::from_fn(|d| 3.0 * edges[d][d]))
        }
        Domain::Open => ([0.0; D], [(6.0 * count as f64).powf(1.0 / D as f64); D]),
    };
    let positions =
        (0..count).map(|_| std::array::from_fn(|d| on_grid(low[d] + extent[d] * generator.random::<f64>()))).collect();
    let radii = (0..count).map(|_| on_grid(0.3 + 0.7 * generator.random::<f64>())).collect();
    let held = (0..count).map(|_| generator.random::<f64>() < held_share).collect();
    Packing::new(domain, positions, radii).and_then(|packing| packing.with_held(held)).expect("valid disks")
}

/// The nearest multiple of 2⁻²⁰.
pub fn on_grid(value: f64) -> f64 {
    const PER_UNIT: f64 = 1_048_576.0;
    (value * PER_UNIT).round() / PER_UNIT
}
