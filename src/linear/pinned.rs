//! A packing without rigid motions: [`pinned`].

use crate::network::ContactNetwork;
use crate::packing::{Packing, PackingError};

/// The packing with the first disk of its backbone held, if nothing else holds it. This removes rigid translations.
/// Internal forces add up to zero, so the held disk carries no force. None without a backbone.
///
/// K without the rows of one disk has as many negative eigenvalues as K. Every displacement is the sum of a
/// translation, which has no stiffness, and of one that leaves this disk fixed.
pub(crate) fn pinned<const D: usize>(
    packing: &Packing<D>,
    network: &ContactNetwork<D>,
) -> Result<Option<Packing<D>>, PackingError> {
    let Some(first) = network.backbone.iter().position(|&member| member) else { return Ok(None) };
    packing.clone().with_held((0..packing.len()).map(|disk| disk == first).collect()).map(Some)
}
