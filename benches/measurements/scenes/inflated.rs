//! The start of every relaxation that is compared here: nothing has moved yet.

use std::error::Error;

use jamscope::inflation::{Centre, Circle, choose_centre};
use jamscope::law::Hertzian;
use jamscope::packing::Packing;

/// The packing cut to a circle around a small disk of its backbone, which has grown by 0.1.
pub fn inflated(packing: &Packing<2>, seed: u64) -> Result<Packing<2>, Box<dyn Error>> {
    let chosen = choose_centre(packing, &Hertzian::default(), Centre::Backbone, seed)?;
    let side = packing.domain().lengths().ok_or("the packing is not periodic")?[0];
    let circle = Circle::cut(packing, chosen, 0.48 * side)?;
    let radius = circle.packing.radii()[circle.centre];
    Ok(circle.packing.with_radius(circle.centre, radius + 0.1)?)
}
