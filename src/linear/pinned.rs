//! A packing without rigid motions: [`pinned`].

use crate::network::ContactNetwork;
use crate::packing::{Packing, PackingError};

/// The packing with the first disk of its backbone held, where nothing holds it: no rigid motion is left, and since
/// internal forces add up to nothing, holding one disk costs none. None without a backbone.
///
/// K with the rows of one disk taken out has as many negative eigenvalues as K: every displacement is one that leaves the
/// disk where it is plus a translation, and a translation costs nothing.
pub(crate) fn pinned<const D: usize>(
    packing: &Packing<D>,
    network: &ContactNetwork<D>,
) -> Result<Option<Packing<D>>, PackingError> {
    let Some(first) = network.backbone.iter().position(|&member| member) else { return Ok(None) };
    packing.clone().with_held((0..packing.len()).map(|disk| disk == first).collect()).map(Some)
}
