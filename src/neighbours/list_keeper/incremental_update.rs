//! Incremental update: a few fast disks get their present positions as reference, so that a list lasts for the slow
//! disks.
//!
//! The cost depends on the number of fast disks: portions whose bound excludes fast disks are not checked.

use std::ops::Range;

use crate::neighbours::displacement_bounds::SKIN_FRACTION;
use crate::neighbours::list_keeper::{Coefficient, ListKeeper};
use crate::neighbours::missing_pairs::insert_missing_pairs;
use crate::neighbours::verlet_list::Disks;
use crate::vector::{Vector, difference, dot, longest_difference_squared};

/// At most one disk in so many may be fast.
const FAST_ONE_OF: usize = 128;

/// Parameters that differ between lists of one tile, which stay in cache and are built quickly, and long lists. They
/// change speed only.
pub(super) struct Tuning {
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

impl<const D: usize> ListKeeper<D> {
    pub(super) fn tuning(&self) -> &'static Tuning {
        if self.outer.is_long() { &LONG } else { &SHORT }
    }

    /// Whether lists are updated before they expire. A step by tiles is then never interrupted by an expired list.
    fn updates_ahead(&self) -> bool {
        self.prunes && self.outer.is_long()
    }

    /// Updates the list in use if a step like the last one may exceed its limit. Returns whether it did.
    pub(crate) fn update_ahead(&mut self, disks: &Disks<'_, D>, coefficient: Coefficient<'_>) -> bool {
        let limit = SKIN_FRACTION * self.skin();
        let nearly: Vec<usize> = self.bounds.nearly_expired(limit).collect();
        if !self.updates_ahead() || nearly.is_empty() {
            return false;
        }
        self.tighten_bounds(disks, nearly);
        self.bounds.nearly_expired(limit).next().is_some() && self.update_fast_disks(disks, coefficient)
    }

    /// The disks that [`ListKeeper::keep`] and [`ListKeeper::update_ahead`] check after a step for which the list was complete.
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
    pub(super) fn update_fast_disks(&mut self, disks: &Disks<'_, D>, coefficient: Coefficient<'_>) -> bool {
        if !self.outer.reserves_blocks {
            return false;
        }
        // Disks that are fast in the inner list are searched in the cells of the outer list, so they must not be far
        // from those cells.
        let outer_updated = self.update_outer_list(disks, coefficient);
        let updated = match self.inner_skin {
            None => outer_updated == Some(true),
            Some(skin) => outer_updated.is_some() && self.update_inner_list(disks, coefficient, skin),
        };
        if updated {
            self.list_number.update_count += 1;
            if self.inner_skin.is_none() && !self.outer.is_long() {
                // The speed of the disks is checked as for a new list.
                self.restart_speed_checks(disks);
            }
        }
        updated
    }

    /// Updates the disks that are fast in the outer list. Returns whether there were any; none if the update is
    /// impossible.
    fn update_outer_list(&mut self, disks: &Disks<'_, D>, coefficient: Coefficient<'_>) -> Option<bool> {
        let portions: Vec<usize> = self.fast_portions_of_outer().collect();
        let fast = self.fast_disks_of(disks, &portions, &self.outer_at_build, self.skin)?;
        if fast.is_empty() {
            return Some(false);
        }
        self.fast_disks.set(fast, disks.radii.len());
        let most = disks.radii.len() / self.tuning().updated_one_of;
        let ListKeeper { outer, workspace, fast_disks, outer_at_build, skin, .. } = self;
        let updated = workspace.note_updated(disks, fast_disks, most)
            && insert_missing_pairs(disks, (outer_at_build, *skin), fast_disks, coefficient, workspace, outer);
        if !updated {
            return None;
        }
        for &disk in fast_disks.disks() {
            outer_at_build[disk as usize] = disks.displacements[disk as usize];
        }
        match self.inner_skin {
            Some(_) => self.tighten_bounds_before(&portions),
            None => self.tighten_bounds(disks, portions),
        }
        Some(true)
    }

    /// The same for the inner list.
    fn update_inner_list(&mut self, disks: &Disks<'_, D>, coefficient: Coefficient<'_>, skin: f64) -> bool {
        let portions: Vec<usize> = self.fast_portions().collect();
        let fast = self.fast_disks_of(disks, &portions, &self.inner_at_build, skin);
        let Some(fast) = fast.filter(|fast| !fast.is_empty()) else { return false };
        self.fast_disks.set(fast, disks.radii.len());
        let ListKeeper { inner, workspace, fast_disks, inner_at_build, .. } = self;
        if !insert_missing_pairs(disks, (inner_at_build, skin), fast_disks, coefficient, workspace, inner) {
            return false;
        }
        for &disk in fast_disks.disks() {
            inner_at_build[disk as usize] = disks.displacements[disk as usize];
        }
        self.tighten_bounds_before(&portions);
        self.tighten_bounds(disks, portions);
        true
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
    fn fast_disks_of(
        &self,
        disks: &Disks<'_, D>,
        portions: &[usize],
        reference: &[Vector<D>],
        skin: f64,
    ) -> Option<Vec<u32>> {
        let limit = self.tuning().fast_fraction * SKIN_FRACTION * skin;
        let candidates = portions.iter().flat_map(|&portion| self.bounds.disks_of(portion));
        let is_fast = |disk: &usize| {
            let displacement = difference(disks.displacements[*disk], reference[*disk]);
            dot(displacement, displacement) > limit * limit
        };
        let fast: Vec<u32> = candidates.filter(is_fast).map(|disk| disk as u32).collect();
        (fast.len() <= disks.radii.len() / FAST_ONE_OF).then_some(fast)
    }

    /// Computes the displacements of the disks of some portions, in place of their bounds.
    pub(super) fn tighten_bounds(&mut self, disks: &Disks<'_, D>, portions: Vec<usize>) {
        for portion in portions {
            let own = self.bounds.disks_of(portion);
            self.bounds.portions[portion].total =
                longest(&disks.displacements[own.clone()], &self.reference_displacements()[own]);
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
    pub(super) fn effective_displacement(&self, disks: &Disks<'_, D>, from: &[Vector<D>]) -> f64 {
        let longest = self.largest_displacement_since(disks, from);
        if self.outer.reserves_blocks {
            LARGE_LIST_FACTOR * (self.common_displacement(disks, from) + self.tuning().update_cost * longest)
        } else {
            longest
        }
    }

    /// The displacement since `from` that all mobile disks but a few, which can be updated, do not exceed \[length\].
    pub(super) fn common_displacement(&self, disks: &Disks<'_, D>, from: &[Vector<D>]) -> f64 {
        if !self.outer.reserves_blocks || disks.mobile_count == 0 {
            return self.largest_displacement_since(disks, from);
        }
        let mobile = disks.displacements[..disks.mobile_count].iter().zip(from);
        let mut squares: Vec<f64> = mobile
            .step_by((disks.mobile_count / SAMPLE_SIZE).max(1))
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
