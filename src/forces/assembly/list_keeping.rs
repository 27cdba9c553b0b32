//! Maintenance of the neighbour list while disks move: checks, pruning and rebuilds.

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::neighbours::displacement_bounds::{DisplacementBounds, LISTED, PORTION, is_within};
use crate::neighbours::inner_list::{best_skin, best_skin_of_all};
use crate::neighbours::pair_list::PairList;
use crate::packing::PackingError;
use crate::parallel;
use crate::vector::{Vector, larger, longest_difference_squared};

/// Number of calls of [`Assembly::keep_listed`] before the first check of the disks' speed. The number doubles for each
/// further check.
const FIRST_LOOK: usize = 16;

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
            self.seen.clone_from(&self.displacements);
        }
        (self.age, self.seen_at, self.look_at) = (0, 0, FIRST_LOOK);
    }

    /// Whether [`Assembly::advance`] does anything. It does not before a speed check of a short list: if the list is
    /// pruned then, the order of the force sums changes.
    pub(crate) fn may_advance(&self) -> bool {
        !self.law.has_sites() && (self.pairs().is_long() || !self.looks_next())
    }

    /// Identifies the list in use: its number, and the number of its incremental updates.
    pub(crate) fn listing_number(&self) -> (usize, usize) {
        self.listing_number
    }

    /// The list in use, the reference displacements of its disks, its limit, and the displacement bounds.
    pub(crate) fn listing(&mut self) -> (&PairList<D>, &[Vector<D>], f64, &mut DisplacementBounds) {
        let limit = LISTED * self.skin();
        let (pairs, listed) = match self.inner_skin {
            Some(_) => (&self.inner_pairs, &self.inner_at_build),
            None => (&self.pairs, &self.listed),
        };
        (pairs, listed, limit, &mut self.bounds)
    }

    /// Computes the displacements since the list was built, in place of their bounds.
    fn measure_all_portions(&mut self) {
        let bounds = self.longest_displacements_from(self.listed_in_use());
        self.bounds.portions.iter_mut().zip(bounds).for_each(|(bound, way)| bound.total = way);
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
    pub(crate) fn looks_next(&self) -> bool {
        self.prunes && self.age + 1 == self.look_at
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
        Ok(self.change()? || self.amend_ahead())
    }

    fn change(&mut self) -> Result<bool, PackingError> {
        self.age += 1;
        let looks = self.prunes && self.age == self.look_at;
        let limit = LISTED * self.skin();
        if is_within(self.bounds.longest(), limit) && !looks {
            return Ok(false);
        }
        let bounds = self.bounds.portions.iter().enumerate();
        self.measure_portions(
            bounds.filter(|(_, bound)| !is_within(bound.total, limit)).map(|(portion, _)| portion).collect(),
        );
        let longest = self.bounds.longest();
        if longest.is_nan() {
            // The displacement is NaN, so the forces are NaN too, and the relaxer stops.
            return Ok(false);
        }
        if longest > limit {
            return self.renew().map(|()| true);
        }
        Ok(looks && self.look())
    }

    /// Checks the speed of the disks, and prunes the list if they are slow. Returns whether it did.
    fn look(&mut self) -> bool {
        let way = self.effective_displacement(&self.seen) / (self.age - self.seen_at) as f64;
        self.seen.clone_from(&self.displacements);
        (self.seen_at, self.look_at) = (self.age, 2 * self.age);
        self.picks(best_skin(self.smallest_radius, way), self.skin())
    }

    /// Replaces an expired list.
    fn renew(&mut self) -> Result<(), PackingError> {
        if self.prunes && self.amend() {
            return Ok(());
        }
        let way = if self.prunes {
            self.effective_displacement(self.listed_in_use()) / self.age as f64
        } else {
            f64::INFINITY
        };
        let best = best_skin(self.smallest_radius, way);
        if self.inner_skin.is_none() || self.longest_way(&self.listed) > LISTED * self.skin {
            self.choose_skin();
            self.rebuild()?;
            self.picks(best, self.skin);
        } else if !self.picks(best, self.skin) {
            // While the outer list is still complete, it is used itself.
            self.inner_skin = None;
            self.bounds_before.clear();
            self.listing_number = (self.listing_number.0 + 1, 0);
            self.measure_all_portions();
        }
        Ok(())
    }

    /// Chooses the skin of the next outer list, if most disks keep their speed.
    fn choose_skin(&mut self) {
        let (narrowest, widest) = (*self.skins.start(), *self.skins.end());
        if narrowest < widest {
            // If the inner list is in use, the disks are slow.
            let way =
                if self.inner_skin.is_none() { self.common_displacement(&self.listed) / self.age as f64 } else { 0.0 };
            self.skin = best_skin_of_all(self.smallest_radius, way).clamp(narrowest, widest);
        }
    }

    /// Prunes the outer list to this skin, or to the widest skin for which the outer list is complete, if that costs
    /// less than a list with the skin `other`. Returns whether it did.
    fn picks(&mut self, best: f64, other: f64) -> bool {
        if best >= self.tuning().widest_near * other {
            return false;
        }
        // If disks have moved by at most w since the list was built, the outer list of skin S contains all pairs within
        // S − 2 w.
        let longest = self.skin - self.longest_way(&self.listed) / LISTED;
        if best >= 2.0 * longest {
            return false;
        }
        let skin = best.min(longest);
        self.inner_pairs.prune(&self.pairs, &self.displacements, skin);
        self.inner_skin = Some(skin);
        self.inner_at_build.clone_from(&self.displacements);
        self.bounds_before = self.longest_displacements_from(&self.listed);
        self.listing_number = (self.listing_number.0 + 1, 0);
        self.begin_list();
        true
    }

    /// The largest displacement of a mobile disk since `from` \[length\]; NaN if any is NaN.
    pub(crate) fn longest_way(&self, from: &[Vector<D>]) -> f64 {
        self.longest_displacements_from(from).into_iter().fold(0.0, larger)
    }

    /// Resets the state after a build of the outer list.
    pub(crate) fn begin_all(&mut self) {
        self.inner_skin = None;
        self.bounds_before.clear();
        self.listed.clone_from(&self.displacements);
        self.listing_number = (self.listing_number.0 + 1, 0);
        self.begin_list();
    }

    /// Resets the state after a change of the list in use.
    pub(crate) fn begin_list(&mut self) {
        self.bounds.begin(self.mobile_count, self.pairs().tile_size);
        self.prune_lists(self.prunes);
    }

    /// Reference displacements of the list in use: those at its build, or at the last update of a disk.
    pub(crate) fn listed_in_use(&self) -> &[Vector<D>] {
        if self.inner_skin.is_some() { &self.inner_at_build } else { &self.listed }
    }

    /// Width of the skin of the list in use \[length\].
    pub fn skin(&self) -> f64 {
        self.inner_skin.unwrap_or(self.skin)
    }

    /// Displacement that every disk can still make, at least, before the list expires \[length\].
    pub fn listed_way(&self) -> f64 {
        LISTED * self.skin() - self.bounds.longest()
    }
}
