//! [`State`]: a packing with its contacts, for observables that compare two of them.

use crate::law::pair_law::PairLaw;
use crate::network::{Contact, ContactNetwork};
use crate::packing::{Packing, PackingError};
use crate::vector::{Vector, difference, norm, scaled, sum};

/// A packing and its contact network.
#[derive(Debug, Clone)]
pub struct State<'a, const D: usize> {
    /// The disks.
    pub packing: &'a Packing<D>,
    /// Their contacts.
    pub network: ContactNetwork<D>,
}

impl<'a, const D: usize> State<'a, D> {
    /// The contacts of a packing under a law.
    ///
    /// # Errors
    /// See [`ContactNetwork::new`].
    pub fn new(packing: &'a Packing<D>, law: &dyn PairLaw) -> Result<Self, PackingError> {
        Ok(State { packing, network: ContactNetwork::new(packing, law)? })
    }

    /// The midpoint between the centres of a contact, relative to the centre of disk `centre`, and its distance
    /// \[length\].
    ///
    /// In a periodic box the two disks may be nearest to the centre in different images; the nearer midpoint is then
    /// used. Exchanging the two disks does not change the result.
    pub fn midpoint(&self, contact: &Contact<D>, centre: usize) -> (Vector<D>, f64) {
        let half = scaled(0.5, contact.separation);
        let first = difference(self.packing.separation(contact.first as usize, centre), half);
        let second = sum(self.packing.separation(contact.second as usize, centre), half);
        let midpoint = if norm(difference(first, second)) < norm(half) {
            scaled(0.5, sum(first, second))
        } else if (norm(first), first) <= (norm(second), second) {
            first
        } else {
            second
        };
        (midpoint, norm(midpoint))
    }
}

/// The disks on the backbone of both states.
///
/// # Panics
/// If the packings differ in their number of disks.
pub(crate) fn common_backbone<const D: usize>(before: &State<D>, after: &State<D>) -> Vec<bool> {
    let (first, second) = (&before.network.backbone, &after.network.backbone);
    assert_eq!(first.len(), second.len(), "two states of one packing have the same disks");
    first.iter().zip(second).map(|(&a, &b)| a && b).collect()
}
