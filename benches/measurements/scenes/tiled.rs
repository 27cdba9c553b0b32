//! A periodic packing repeated along both axes: as many disks as wanted, in the same state.

use std::error::Error;

use jamscope::packing::{Domain, Packing};

/// The packing repeated `count` times along both axes.
pub fn tiled(packing: &Packing<2>, count: usize) -> Result<Packing<2>, Box<dyn Error>> {
    let lengths = packing.domain().lengths().ok_or("the packing is not periodic")?;
    let mut positions = Vec::new();
    let mut radii = Vec::new();
    for row in 0..count {
        for column in 0..count {
            for (position, &radius) in packing.positions().iter().zip(packing.radii()) {
                positions.push([position[0] + column as f64 * lengths[0], position[1] + row as f64 * lengths[1]]);
                radii.push(radius);
            }
        }
    }
    let domain = Domain::rectangular([0.0; 2], lengths.map(|length| length * count as f64));
    Ok(Packing::new(domain, positions, radii)?)
}
