//! Pressed disks on a square lattice: at rest, and at a saddle.

use jamscope::packing::{Domain, Packing};

/// n × n disks of radius 1/2 at the sites of a square lattice of spacing `1 − overlap`, columns moved along y by ± `height`.
///
/// An overlap that is a power of two from 2⁻⁴⁶ on rounds nothing in sites up to 8.
pub fn square_lattice(count: usize, overlap: f64, height: f64) -> Packing<2> {
    let spacing = 1.0 - overlap;
    let sites = (0..count * count).map(|site| (site / count, site % count));
    let positions = sites.clone().map(|(x, y)| [x as f64 * spacing, y as f64 * spacing]).collect();
    let corrections = sites.map(|(x, _)| [0.0, if x % 2 == 0 { height } else { -height }]).collect();
    Packing::new(Domain::cube(count as f64 * spacing), positions, vec![0.5; count * count])
        .and_then(|packing| packing.with_corrections(corrections))
        .expect("valid")
}
