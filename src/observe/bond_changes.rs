//! [`BondChanges`]: the stretch or compression of every bond between touching disks, d_∥.
//!
//! ```text
//! d_∥ = n·(d_i − d_j)        n = r_ij/r_ij before, r_ij from j to i        d_∥ > 0: stretched
//! ```
//!
//! d_∥ is linear in the displacements. Up to terms of second order it is the change of the length of the bond, which is
//! also given.
//!
//! # Source
//! Ellenbroek, van Hecke, van Saarloos (2009), Phys. Rev. E 80, 061307.

use serde::{Deserialize, Serialize};

use crate::inflation::Inflated;
use crate::law::pair_law::PairLaw;
#[cfg(feature = "linear")]
use crate::linear::LinearResponse;
use crate::network::Contact;
use crate::observe::contact_changes::merged;
use crate::observe::state::{State, common_backbone};
use crate::packing::PackingError;
use crate::packing::displacement;
#[cfg(feature = "linear")]
use crate::vector::scaled;
use crate::vector::{Vector, difference, dot, norm, sum};

/// Which contacts of the state before are bonds; both disks are on the backbone in both states.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BondSet {
    /// Contacts that still exist after.
    #[default]
    Kept,
    /// All contacts, including broken ones.
    Before,
}

/// One bond.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(bound(serialize = "[f64; D]: Serialize"))]
pub struct BondChange<const D: usize> {
    /// First disk, an index into the packings compared.
    pub first: u32,
    /// Second disk.
    pub second: u32,
    /// Midpoint of the two centres before, relative to the inflated disk \[length\].
    pub midpoint: Vector<D>,
    /// Distance of the midpoint from the inflated disk \[length\].
    pub distance: f64,
    /// Vector from the second to the first centre before \[length\].
    pub separation: Vector<D>,
    /// d_∥ \[length\].
    pub parallel: f64,
    /// Length after minus length before \[length\].
    pub length_change: f64,
}

/// The bonds of a packing between two states.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(bound(serialize = "[f64; D]: Serialize"))]
pub struct BondChanges<const D: usize> {
    /// The contacts included.
    pub set: BondSet,
    /// Bonds in ascending order of (first, second).
    pub bonds: Vec<BondChange<D>>,
}

impl<const D: usize> BondChanges<D> {
    /// The bonds of an inflation.
    ///
    /// # Errors
    /// See [`ContactNetwork::new`](crate::network::ContactNetwork::new).
    pub fn of_inflation(inflated: &Inflated<D>, law: &dyn PairLaw, set: BondSet) -> Result<Self, PackingError> {
        let before = State::new(inflated.before.packing.get(), law)?;
        let after = State::new(inflated.after.packing.get(), law)?;
        Ok(Self::between(&before, &after, inflated.centre, set))
    }

    /// From one state to another of the same disks; distances are from disk `centre`.
    ///
    /// # Panics
    /// If the packings differ in their number of disks.
    ///
    /// # Accuracy
    /// d_∥ and the change of length are exact to a few roundings of the displacements, not of the distances.
    pub fn between(before: &State<D>, after: &State<D>, centre: usize, set: BondSet) -> Self {
        let counts = common_backbone(before, after);
        let moved = |disk: usize| displacement(before.packing, after.packing, disk);
        let bonds = merged(&before.network.contacts, &after.network.contacts).filter_map(|pair| match pair {
            (Some(_), None) if set == BondSet::Kept => None,
            (Some(contact), _) => BondChange::of(before, contact, centre, &counts, moved),
            (None, _) => None,
        });
        BondChanges { set, bonds: bonds.collect() }
    }

    /// The bonds in the linear response to an inflation by `increase` \[length\]. The linear response breaks no bond.
    /// Distances are from the growing disk.
    ///
    /// `before` is the state of the response.
    ///
    /// # Panics
    /// If the response belongs to another packing, or is not that to the growth of a disk.
    #[cfg(feature = "linear")]
    pub fn of_linear_response(before: &State<D>, response: &LinearResponse<D>, increase: f64) -> Self {
        assert_eq!(
            before.packing.len(),
            response.displacements.len(),
            "a response belongs to the packing it was made from"
        );
        let &[centre] = response.growing.as_slice() else { panic!("bonds are seen from the disk that grows") };
        let moved = |disk: usize| scaled(increase, response.displacements[disk]);
        let counts = &before.network.backbone;
        let bonds = before.network.contacts.iter();
        let bonds = bonds.filter_map(|contact| BondChange::of(before, contact, centre, counts, moved)).collect();
        BondChanges { set: BondSet::Before, bonds }
    }
}

impl<const D: usize> BondChange<D> {
    /// The bond of one contact of the state before; none if one of its disks does not count.
    fn of(
        before: &State<D>,
        contact: &Contact<D>,
        centre: usize,
        counts: &[bool],
        moved: impl Fn(usize) -> Vector<D>,
    ) -> Option<Self> {
        let (i, j) = (contact.first as usize, contact.second as usize);
        if !(counts[i] && counts[j]) {
            return None;
        }
        let relative = difference(moved(i), moved(j));
        let separation = contact.separation;
        let length = norm(separation);
        let along = dot(separation, relative);
        // |s + d| − |s| = (2 s·d + d·d)/(|s + d| + |s|), without cancellation for small d.
        let length_change = (2.0 * along + dot(relative, relative)) / (norm(sum(separation, relative)) + length);
        let (midpoint, distance) = before.midpoint(contact, centre);
        Some(BondChange {
            first: contact.first,
            second: contact.second,
            midpoint,
            distance,
            separation,
            parallel: along / length,
            length_change,
        })
    }
}
