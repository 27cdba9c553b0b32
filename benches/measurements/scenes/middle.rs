//! One small disk in the middle of a periodic packing, grown and held.

use std::error::Error;

use jamscope::packing::Packing;
use jamscope::vector::norm;

/// The packing with the smallest disk nearest to the middle of the box grown by 0.1 and held.
pub fn inflated(packing: Packing<2>) -> Result<Packing<2>, Box<dyn Error>> {
    let lengths = packing.domain().lengths().ok_or("the packing is not periodic")?;
    let smallest = packing.radii().iter().copied().fold(f64::INFINITY, f64::min);
    let from_middle = |disk: usize| {
        let position = packing.positions()[disk];
        norm([position[0] - 0.5 * lengths[0], position[1] - 0.5 * lengths[1]])
    };
    let centre = (0..packing.len())
        .filter(|&disk| packing.radii()[disk] == smallest)
        .min_by(|&a, &b| from_middle(a).total_cmp(&from_middle(b)))
        .ok_or("no disk")?;
    let held = (0..packing.len()).map(|disk| disk == centre).collect();
    Ok(packing.with_radius(centre, smallest + 0.1)?.with_held(held)?)
}
