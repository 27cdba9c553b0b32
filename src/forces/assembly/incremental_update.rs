//! Incremental update: a few fast disks get their present positions as reference, so that a list lasts for the slow
//! disks.
//!
//! The cost depends on the number of fast disks: portions whose bound excludes fast disks are not checked.

use std::ops::Range;

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::neighbours::displacement_bounds::SKIN_FRACTION;
use crate::neighbours::missing_pairs::insert_missing_pairs;
use crate::neighbours::pair_list::PairList;
use crate::neighbours::verlet_list::ListRoom;
use crate::vector::{Vector, difference, dot, longest_difference_squared};

/// At most one disk in so many may be fast.
const FAST_ONE_OF: usize = 128;

/// Parameters that differ between lists of one tile, which stay in cache and are built quickly, and long lists. They
/// change speed only.
pub(crate) struct Tuning {
    /// A disk is fast if its displacement exceeds this fraction of the limit of its list \[1\].
    fast_fraction: f64,
    /// At most one disk in so many may have been updated since the list was built.
    updated_one_of: usize,
    /// Time of an incremental update over that of pruning \[1\].
    update_cost: f64,
    /// Widest inner skin over the skin of the list in use \[1\].
    pub widest_inner: f64,
}

const SHORT: Tuning = Tuning { fast_fraction: 0.5, updated_one_of: 64, update_cost: 0.4, widest_inner: 0.16 };
const LONG: Tuning = Tuning { fast_fraction: 0.7, updated_one_of: 8, update_cost: 0.1, widest_inner: 0.3 };

/// Cost of pruning a large list relative to its gain, over the same ratio for small lists \[1\].
const LARGE_LIST_FACTOR: f64 = 3.5;

/// One disk in so many may exceed the common displacement.
const EXCEPTED_ONE_OF: usize = 512;

/// Size of the sample of disks for the common displacement; some 250 of the sample exceed it.
const SAMPLE_SIZE: usize = 1 << 17;

impl<const D: usize, L: PairLaw> Assembly<D, L> {
    pub(crate) fn tuning(&self) -> &'static Tuning {
        if self.pairs.is_long() { &LONG } else { &SHORT }
    }

    /// Whether lists are updated before they expire. A step by tiles is then never interrupted by an expired list.
    fn updates_ahead(&self) -> bool {
        self.prunes && self.pairs.is_long()
    }

    /// Updates the list in use if a step like the last one may exceed its limit. Returns whether it did.
    pub(crate) fn update_ahead(&mut self) -> bool {
        let limit = SKIN_FRACTION * self.skin();
        let nearly: Vec<usize> = self.bounds.nearly_expired(limit).collect();
        if !self.updates_ahead() || nearly.is_empty() {
            return false;
        }
        self.tighten_bounds(nearly);
        self.bounds.nearly_expired(limit).next().is_some() && self.update_fast_disks()
    }

    /// The disks that [`Assembly::keep`] checks after a step for which the list was complete.
    pub(crate) fn disks_to_check(&self) -> Vec<Range<usize>> {
        let limit = SKIN_FRACTION * self.skin();
        if !self.updates_ahead() || self.bounds.nearly_expired(limit).next().is_none() {
            return Vec::new();
        }
        let mut portions: Vec<usize> = self.bounds.nearly_expired(limit).collect();
        portions.extend(self.fast_portions());
        portions.extend(self.fast_portions_of_outer());
        portions.sort_unstable();
        portions.dedup();
        portions.into_iter().map(|portion| self.bounds.disks_of(portion)).collect()
    }

    /// Updates the few fast disks to their present positions and inserts the pairs that the list in use is missing.
    /// Returns false if that is impossible. Then the list in use is unchanged, and the outer list stays valid up to its
    /// old limit.
    pub(crate) fn update_fast_disks(&mut self) -> bool {
        if !self.pairs.reserves_blocks {
            return false;
        }
        // Disks that are fast in the inner list are searched in the cells of the outer list, so they must not be far
        // from those cells.
        let outer_updated = self.update_outer_list();
        let updated = match self.inner_skin {
            None => outer_updated == Some(true),
            Some(skin) => outer_updated.is_some() && self.update_inner_list(skin),
        };
        if updated {
            self.listing_number.1 += 1;
            if self.inner_skin.is_none() && !self.pairs.is_long() {
                // The speed of the disks is checked as for a new list.
                self.prune_lists(self.prunes);
            }
        }
        updated
    }

    /// Updates the disks that are fast in the outer list. Returns whether there were any; none if the update is
    /// impossible.
    fn update_outer_list(&mut self) -> Option<bool> {
        let portions: Vec<usize> = self.fast_portions_of_outer().collect();
        let disks = self.fast_disks_of(&portions, &self.outer_at_build, self.skin)?;
        if disks.is_empty() {
            return Some(false);
        }
        self.fast_disks.set(disks, self.order.len());
        let mut room = std::mem::take(&mut self.list_room);
        let mut pairs = std::mem::take(&mut self.pairs);
        let updated = room.note_updated(&self.disks(), &self.fast_disks, self.len() / self.tuning().updated_one_of)
            && self.insert_missing((&self.outer_at_build, self.skin), &mut room, &mut pairs);
        (self.pairs, self.list_room) = (pairs, room);
        if !updated {
            return None;
        }
        for &disk in self.fast_disks.disks() {
            self.outer_at_build[disk as usize] = self.displacements[disk as usize];
        }
        match self.inner_skin {
            Some(_) => self.tighten_bounds_before(&portions),
            None => self.tighten_bounds(portions),
        }
        Some(true)
    }

    /// The same for the inner list.
    fn update_inner_list(&mut self, skin: f64) -> bool {
        let portions: Vec<usize> = self.fast_portions().collect();
        let Some(disks) = self.fast_disks_of(&portions, &self.inner_at_build, skin).filter(|disks| !disks.is_empty())
        else {
            return false;
        };
        self.fast_disks.set(disks, self.order.len());
        let mut room = std::mem::take(&mut self.list_room);
        let mut pairs = std::mem::take(&mut self.inner_pairs);
        let updated = self.insert_missing((&self.inner_at_build, skin), &mut room, &mut pairs);
        (self.inner_pairs, self.list_room) = (pairs, room);
        if updated {
            for &disk in self.fast_disks.disks() {
                self.inner_at_build[disk as usize] = self.displacements[disk as usize];
            }
            self.tighten_bounds_before(&portions);
            self.tighten_bounds(portions);
        }
        updated
    }

    fn insert_missing(&self, listing: (&[Vector<D>], f64), room: &mut ListRoom<D>, pairs: &mut PairList<D>) -> bool {
        let law = self.law;
        insert_missing_pairs(&self.disks(), listing, &self.fast_disks, |a, b| law.coefficient(a, b), room, pairs)
    }

    /// Portions that may contain disks that are fast in the list in use.
    fn fast_portions(&self) -> impl Iterator<Item = usize> {
        let limit = self.tuning().fast_fraction * SKIN_FRACTION * self.skin();
        let bounds = self.bounds.portions.iter().enumerate();
        bounds.filter(move |(_, bound)| bound.total > limit).map(|(portion, _)| portion)
    }

    /// The same for the outer list.
    fn fast_portions_of_outer(&self) -> impl Iterator<Item = usize> {
        let limit = self.tuning().fast_fraction * SKIN_FRACTION * self.skin;
        let before = self.bounds_before.iter().copied().chain(std::iter::repeat(0.0));
        let bounds = self.bounds.portions.iter().zip(before).map(|(bound, before)| before + bound.total);
        bounds.enumerate().filter(move |(_, displacement)| *displacement > limit).map(|(portion, _)| portion)
    }

    /// The disks of some portions that are far from their reference positions; none if they are too many.
    fn fast_disks_of(&self, portions: &[usize], listed: &[Vector<D>], skin: f64) -> Option<Vec<u32>> {
        let limit = self.tuning().fast_fraction * SKIN_FRACTION * skin;
        let disks = portions.iter().flat_map(|&portion| self.bounds.disks_of(portion));
        let is_fast = |disk: &usize| {
            let displacement = difference(self.displacements[*disk], listed[*disk]);
            dot(displacement, displacement) > limit * limit
        };
        let fast: Vec<u32> = disks.filter(is_fast).map(|disk| disk as u32).collect();
        (fast.len() <= self.len() / FAST_ONE_OF).then_some(fast)
    }

    /// Computes the displacements of the disks of some portions, in place of their bounds.
    pub(crate) fn tighten_bounds(&mut self, portions: Vec<usize>) {
        for portion in portions {
            let disks = self.bounds.disks_of(portion);
            self.bounds.portions[portion].total =
                longest(&self.displacements[disks.clone()], &self.reference_displacements()[disks]);
        }
    }

    /// The same for the displacements in the outer list up to the build of the inner list.
    fn tighten_bounds_before(&mut self, portions: &[usize]) {
        for &portion in portions {
            let disks = self.bounds.disks_of(portion);
            self.bounds_before[portion] = longest(&self.inner_at_build[disks.clone()], &self.outer_at_build[disks]);
        }
    }

    /// Effective displacement since `from` that wears out the inner list. Displacements of fast disks count less, by
    /// the ratio of the costs of an update and of pruning. For large lists all count more, because pruning takes longer
    /// there.
    pub(crate) fn effective_displacement(&self, from: &[Vector<D>]) -> f64 {
        let longest = self.largest_displacement_since(from);
        if self.pairs.reserves_blocks {
            LARGE_LIST_FACTOR * (self.common_displacement(from) + self.tuning().update_cost * longest)
        } else {
            longest
        }
    }

    /// The displacement since `from` that all mobile disks but a few, which can be updated, do not exceed \[length\].
    pub(crate) fn common_displacement(&self, from: &[Vector<D>]) -> f64 {
        if !self.pairs.reserves_blocks || self.mobile_count == 0 {
            return self.largest_displacement_since(from);
        }
        let mobile = self.displacements[..self.mobile_count].iter().zip(from);
        let mut squares: Vec<f64> = mobile
            .step_by((self.mobile_count / SAMPLE_SIZE).max(1))
            .map(|(&now, &before)| {
                let displacement = difference(now, before);
                dot(displacement, displacement)
            })
            .collect();
        let place = squares.len() - 1 - squares.len() / EXCEPTED_ONE_OF;
        squares.select_nth_unstable_by(place, f64::total_cmp).1.sqrt()
    }
}

fn longest<const D: usize>(now: &[Vector<D>], before: &[Vector<D>]) -> f64 {
    longest_difference_squared(now, before).sqrt()
}
