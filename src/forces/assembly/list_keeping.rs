//! Maintenance of the neighbour list while disks move: checks, pruning and rebuilds.

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::neighbours::displacement_bounds::{DisplacementBounds, PORTION, SKIN_FRACTION, is_within};
use crate::neighbours::inner_list::{best_inner_skin, best_outer_skin};
use crate::neighbours::pair_list::PairList;
use crate::packing::PackingError;
use crate::parallel;
use crate::vector::{Vector, larger, longest_difference_squared};

/// Number of calls of [`Assembly::keep_listed`] before the first check of the disks' speed. The number doubles for each
/// further check.
const FIRST_CHECK: usize = 16;

impl<const D: usize, L: PairLaw> Assembly<D, L> {
    #[cfg(test)]
    pub(crate) fn inner_list_is_used(&self) -> bool {
        self.inner_skin.is_some()
    }

    #[cfg(test)]
    pub(crate) fn all_pairs(&self) -> &PairList<D> {
        &self.pairs
    }

    /// Sets whether an inner list is used while disks move slowly. The caller must call [`Assembly::keep_listed`] once
    /// per evaluation. Data that the caller keeps for each pair must be rebuilt whenever that call returns true.
    pub fn prune_lists(&mut self, prunes: bool) {
        self.prunes = prunes;
        if prunes {
            self.checked_displacements.clone_from(&self.displacements);
        }
        (self.age, self.checked_at, self.next_check) = (0, 0, FIRST_CHECK);
    }

    /// Whether [`Assembly::advance`] does anything. It does not before a speed check of a short list: if the list is
    /// pruned then, the order of the force sums changes.
    pub(crate) fn may_advance(&self) -> bool {
        !self.law.has_sites() && (self.pairs().is_long() || !self.checks_next())
    }

    /// Identifies the list in use: its number, and the number of its incremental updates.
    pub(crate) fn listing_number(&self) -> (usize, usize) {
        self.listing_number
    }

    /// The list in use, the reference displacements of its disks, its limit, and the displacement bounds.
    pub(crate) fn listing(&mut self) -> (&PairList<D>, &[Vector<D>], f64, &mut DisplacementBounds) {
        let limit = SKIN_FRACTION * self.skin();
        let (pairs, listed) = match self.inner_skin {
            Some(_) => (&self.inner_pairs, &self.inner_at_build),
            None => (&self.pairs, &self.outer_at_build),
        };
        (pairs, listed, limit, &mut self.bounds)
    }

    /// Computes the displacements since the list was built, in place of their bounds.
    fn tighten_all_bounds(&mut self) {
        let bounds = self.longest_displacements_from(self.reference_displacements());
        self.bounds.portions.iter_mut().zip(bounds).for_each(|(bound, displacement)| bound.total = displacement);
    }

    /// Upper bound on the displacement since `before` for each portion of disks \[length\].
    fn longest_displacements_from(&self, before: &[Vector<D>]) -> Vec<f64> {
        let mobile = self.mobile_count;
        let tiles = self.displacements[..mobile].chunks(self.pairs.tile_size);
        let tiles = tiles.zip(before[..mobile].chunks(self.pairs.tile_size));
        let longest = |(now, before): (&[_], &[_])| longest_difference_squared(now, before).sqrt();
        let bounds = parallel::each(tiles, |(now, before)| {
            now.chunks(PORTION).zip(before.chunks(PORTION)).map(longest).collect::<Vec<_>>()
        });
        bounds.concat()
    }

    /// Whether the next call of [`Assembly::keep_listed`] checks the speed of the disks, however small their
    /// displacements are.
    pub(crate) fn checks_next(&self) -> bool {
        self.prunes && self.age + 1 == self.next_check
    }

    /// Records that no disk has moved by more than `bound` since the last call, and changes the list if necessary.
    /// Returns whether the list has changed.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn keep_listed(&mut self, bound: f64) -> Result<bool, PackingError> {
        self.bounds.add(bound);
        self.change()
    }

    /// Changes the list if necessary, after a step whose displacements [`Assembly::advance`] has recorded. It also
    /// updates a list that the next step may exceed. Returns whether the list has changed.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn keep(&mut self) -> Result<bool, PackingError> {
        Ok(self.change()? || self.update_ahead())
    }

    fn change(&mut self) -> Result<bool, PackingError> {
        self.age += 1;
        let checks = self.prunes && self.age == self.next_check;
        let limit = SKIN_FRACTION * self.skin();
        if is_within(self.bounds.longest(), limit) && !checks {
            return Ok(false);
        }
        let bounds = self.bounds.portions.iter().enumerate();
        self.tighten_bounds(
            bounds.filter(|(_, bound)| !is_within(bound.total, limit)).map(|(portion, _)| portion).collect(),
        );
        let longest = self.bounds.longest();
        if longest.is_nan() {
            // The displacement is NaN, so the forces are NaN too, and the relaxer stops.
            return Ok(false);
        }
        if longest > limit {
            return self.replace_list().map(|()| true);
        }
        Ok(checks && self.check_speed())
    }

    /// Checks the speed of the disks, and prunes the list if they are slow. Returns whether it did.
    fn check_speed(&mut self) -> bool {
        let displacement =
            self.effective_displacement(&self.checked_displacements) / (self.age - self.checked_at) as f64;
        self.checked_displacements.clone_from(&self.displacements);
        (self.checked_at, self.next_check) = (self.age, 2 * self.age);
        self.try_prune(best_inner_skin(self.smallest_radius, displacement), self.skin())
    }

    /// Replaces an expired list.
    fn replace_list(&mut self) -> Result<(), PackingError> {
        if self.prunes && self.update_fast_disks() {
            return Ok(());
        }
        let displacement = if self.prunes {
            self.effective_displacement(self.reference_displacements()) / self.age as f64
        } else {
            f64::INFINITY
        };
        let best = best_inner_skin(self.smallest_radius, displacement);
        if self.inner_skin.is_none()
            || self.largest_displacement_since(&self.outer_at_build) > SKIN_FRACTION * self.skin
        {
            self.choose_skin();
            self.rebuild()?;
            self.try_prune(best, self.skin);
        } else if !self.try_prune(best, self.skin) {
            // While the outer list is still complete, it is used itself.
            self.inner_skin = None;
            self.bounds_before.clear();
            self.listing_number = (self.listing_number.0 + 1, 0);
            self.tighten_all_bounds();
        }
        Ok(())
    }

    /// Chooses the skin of the next outer list, if most disks keep their speed.
    fn choose_skin(&mut self) {
        let (narrowest, widest) = (*self.skins.start(), *self.skins.end());
        if narrowest < widest {
            // If the inner list is in use, the disks are slow.
            let displacement = if self.inner_skin.is_none() {
                self.common_displacement(&self.outer_at_build) / self.age as f64
            } else {
                0.0
            };
            self.skin = best_outer_skin(self.smallest_radius, displacement).clamp(narrowest, widest);
        }
    }

    /// Prunes the outer list to this skin, or to the widest skin for which the outer list is complete, if that costs
    /// less than a list with the skin `other`. Returns whether it did.
    fn try_prune(&mut self, best: f64, other: f64) -> bool {
        if best >= self.tuning().widest_inner * other {
            return false;
        }
        // If disks have moved by at most w since the list was built, the outer list of skin S contains all pairs within
        // S − 2 w.
        let longest = self.skin - self.largest_displacement_since(&self.outer_at_build) / SKIN_FRACTION;
        if best >= 2.0 * longest {
            return false;
        }
        let skin = best.min(longest);
        self.inner_pairs.prune(&self.pairs, &self.displacements, skin);
        self.inner_skin = Some(skin);
        self.inner_at_build.clone_from(&self.displacements);
        self.bounds_before = self.longest_displacements_from(&self.outer_at_build);
        self.listing_number = (self.listing_number.0 + 1, 0);
        self.begin_list();
        true
    }

    /// The largest displacement of a mobile disk since `from` \[length\]; NaN if any is NaN.
    pub(crate) fn largest_displacement_since(&self, from: &[Vector<D>]) -> f64 {
        self.longest_displacements_from(from).into_iter().fold(0.0, larger)
    }

    /// Resets the state after a build of the outer list.
    pub(crate) fn begin_outer_list(&mut self) {
        self.inner_skin = None;
        self.bounds_before.clear();
        self.outer_at_build.clone_from(&self.displacements);
        self.listing_number = (self.listing_number.0 + 1, 0);
        self.begin_list();
    }

    /// Resets the state after a change of the list in use.
    pub(crate) fn begin_list(&mut self) {
        self.bounds.begin(self.mobile_count, self.pairs().tile_size);
        self.prune_lists(self.prunes);
    }

    /// Reference displacements of the list in use: those at its build, or at the last update of a disk.
    pub(crate) fn reference_displacements(&self) -> &[Vector<D>] {
        if self.inner_skin.is_some() { &self.inner_at_build } else { &self.outer_at_build }
    }

    /// Width of the skin of the list in use \[length\].
    pub fn skin(&self) -> f64 {
        self.inner_skin.unwrap_or(self.skin)
    }

    /// Displacement that every disk can still make, at least, before the list expires \[length\].
    pub fn listed_way(&self) -> f64 {
        SKIN_FRACTION * self.skin() - self.bounds.longest()
    }
}
