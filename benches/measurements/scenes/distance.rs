//! Whether two relaxations ended in the same place.

use std::error::Error;

use jamscope::law::Hertzian;
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::vector::{larger, norm};

/// Largest distance between the places of a disk of the second one's backbone.
pub fn distance(one: &Packing<2>, two: &Packing<2>) -> Result<f64, Box<dyn Error>> {
    let backbone = ContactNetwork::new(two, &Hertzian::default())?.backbone;
    let way = |disk: usize| norm(one.domain().separation(one.centre(disk), two.centre(disk)));
    Ok((0..one.len()).filter(|&disk| backbone[disk]).map(way).fold(0.0, larger))
}
