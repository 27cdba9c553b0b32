//! [`ContactChanges`]: which contacts are kept, made and broken from one state to another, and where;
//! [`ContactCycle`]: which of them return after a deflation.
//!
//! ```text
//! C(S): pairs (i, j) with δ_ij > 0 in state S
//! kept = C(A) ∩ C(B)        broken = C(A) \ C(B)        made = C(B) \ C(A)
//! ```
//!
//! Counted are the disks on the backbone of both states, including held ones and the inflated one. Contacts with any
//! other disk are counted separately: contacts of rattlers are accidental. Contacts between two held disks do not
//! count.
//!
//! # Source
//! van Deen, Simon, Zeravcic, Dagois-Bohy, Tighe, van Hecke (2014), Phys. Rev. E 90, 020202.

use std::cmp::Ordering;

use serde::Serialize;

use crate::inflation::Inflated;
use crate::law::pair_law::PairLaw;
use crate::network::Contact;
use crate::observe::state::{State, common_backbone};
use crate::packing::PackingError;
use crate::vector::Vector;

/// A contact that only one of the two states has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(bound(serialize = "[f64; D]: Serialize"))]
pub struct ChangedContact<const D: usize> {
    /// First disk, an index into the packings compared.
    pub first: u32,
    /// Second disk.
    pub second: u32,
    /// Midpoint of the two centres in the state with the contact, relative to the inflated disk \[length\].
    pub midpoint: Vector<D>,
    /// Distance of the midpoint from the inflated disk \[length\].
    pub distance: f64,
}

/// Numbers of contacts kept, made and broken with disks that are rattlers in either state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct RattlerContacts {
    /// In both states.
    pub kept_count: usize,
    /// In the second state only.
    pub made_count: usize,
    /// In the first state only.
    pub broken_count: usize,
}

/// Changes of the contacts of the backbone from one state to another.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(bound(serialize = "[f64; D]: Serialize"))]
pub struct ContactChanges<const D: usize> {
    /// Number of contacts in both states.
    pub kept_count: usize,
    /// Contacts of the second state only, in ascending order of (first, second).
    pub made: Vec<ChangedContact<D>>,
    /// Contacts of the first state only, in the same order.
    pub broken: Vec<ChangedContact<D>>,
    /// Contacts with rattlers.
    pub rattlers: RattlerContacts,
}

impl<const D: usize> ContactChanges<D> {
    /// From the state before an inflation to the one after.
    ///
    /// # Errors
    /// See [`ContactNetwork::new`](crate::network::ContactNetwork::new).
    pub fn of_inflation(inflated: &Inflated<D>, law: &dyn PairLaw) -> Result<Self, PackingError> {
        let before = State::new(inflated.before.packing.get(), law)?;
        let after = State::new(inflated.after.packing.get(), law)?;
        Ok(Self::between(&before, &after, inflated.centre))
    }

    /// From one state to another of the same disks; distances are from disk `centre`.
    ///
    /// # Panics
    /// If the packings differ in their number of disks.
    ///
    /// # Cost
    /// Linear in disks and contacts.
    pub fn between(before: &State<D>, after: &State<D>, centre: usize) -> Self {
        let counts = common_backbone(before, after);
        let on_both = |contact: &Contact<D>| counts[contact.first as usize] && counts[contact.second as usize];
        let at = |state: &State<D>, contact: &Contact<D>| {
            let (midpoint, distance) = state.midpoint(contact, centre);
            ChangedContact { first: contact.first, second: contact.second, midpoint, distance }
        };
        let mut changes = ContactChanges {
            kept_count: 0,
            made: Vec::new(),
            broken: Vec::new(),
            rattlers: RattlerContacts::default(),
        };
        let rattlers = &mut changes.rattlers;
        for pair in merged(&before.network.contacts, &after.network.contacts) {
            match pair {
                (Some(old), Some(_)) if on_both(old) => changes.kept_count += 1,
                (Some(_), Some(_)) => rattlers.kept_count += 1,
                (Some(old), None) if on_both(old) => changes.broken.push(at(before, old)),
                (Some(_), None) => rattlers.broken_count += 1,
                (None, Some(new)) if on_both(new) => changes.made.push(at(after, new)),
                (None, Some(_)) => rattlers.made_count += 1,
                (None, None) => {}
            }
        }
        changes
    }

    /// Share of the contacts of the first state that are broken \[1\]; none without contacts.
    pub fn broken_share(&self) -> Option<f64> {
        let all = self.kept_count + self.broken.len();
        (all > 0).then(|| self.broken.len() as f64 / all as f64)
    }
}

/// The contacts of both lists in ascending order of (first, second); equal pairs are adjacent.
pub(crate) fn merged<'a, const D: usize>(
    before: &'a [Contact<D>],
    after: &'a [Contact<D>],
) -> impl Iterator<Item = (Option<&'a Contact<D>>, Option<&'a Contact<D>>)> {
    let key = |contact: &Contact<D>| (contact.first, contact.second);
    let (mut old, mut new) = (before.iter().peekable(), after.iter().peekable());
    std::iter::from_fn(move || {
        let order = match (old.peek(), new.peek()) {
            (Some(a), Some(b)) => key(a).cmp(&key(b)),
            (Some(_), None) => Ordering::Less,
            (None, Some(_)) => Ordering::Greater,
            (None, None) => return None,
        };
        Some(match order {
            Ordering::Less => (old.next(), None),
            Ordering::Equal => (old.next(), new.next()),
            Ordering::Greater => (None, new.next()),
        })
    })
}

/// The contacts of an inflation and the deflation after it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(bound(serialize = "[f64; D]: Serialize"))]
pub struct ContactCycle<const D: usize> {
    /// From before the inflation to after it.
    pub inflation: ContactChanges<D>,
    /// From the inflated state to the deflated one.
    pub deflation: ContactChanges<D>,
    /// From before the inflation to after the deflation: the permanent changes of the cycle.
    pub left: ContactChanges<D>,
    /// Number of contacts that the inflation broke and the deflation restored.
    pub broken_returned_count: usize,
    /// Number of contacts that the inflation made and the deflation broke again.
    pub made_returned_count: usize,
}

impl<const D: usize> ContactCycle<D> {
    /// The cycle of an inflation; none if the disk was not deflated.
    ///
    /// # Errors
    /// See [`ContactNetwork::new`](crate::network::ContactNetwork::new).
    pub fn of(inflated: &Inflated<D>, law: &dyn PairLaw) -> Result<Option<Self>, PackingError> {
        let Some(deflated) = &inflated.deflated else { return Ok(None) };
        let states = [&inflated.before, &inflated.after, deflated];
        let [before, after, deflated] = states.map(|rest| State::new(rest.packing.get(), law));
        Ok(Some(Self::through([&before?, &after?, &deflated?], inflated.centre)))
    }

    /// The cycle through the states before, inflated and deflated of the same disks; distances are from disk `centre`.
    ///
    /// # Panics
    /// If the packings differ in their number of disks.
    pub fn through([before, inflated, deflated]: [&State<D>; 3], centre: usize) -> Self {
        let inflation = ContactChanges::between(before, inflated, centre);
        let there = |contact: &&ChangedContact<D>| {
            let key = (contact.first, contact.second);
            deflated.network.contacts.binary_search_by_key(&key, |other| (other.first, other.second)).is_ok()
        };
        ContactCycle {
            broken_returned_count: inflation.broken.iter().filter(there).count(),
            made_returned_count: inflation.made.iter().filter(|contact| !there(contact)).count(),
            deflation: ContactChanges::between(inflated, deflated, centre),
            left: ContactChanges::between(before, deflated, centre),
            inflation,
        }
    }

    /// Share of the contacts changed by the inflation that the deflation restores \[1\]; none without changes.
    pub fn returned_share(&self) -> Option<f64> {
        let all = self.inflation.made.len() + self.inflation.broken.len();
        (all > 0).then(|| (self.broken_returned_count + self.made_returned_count) as f64 / all as f64)
    }
}
