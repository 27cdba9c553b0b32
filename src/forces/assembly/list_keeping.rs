//! Keeping the neighbour list good while disks move: when it is looked at, pruned and made anew.

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::neighbours::displacement_bounds::{DisplacementBounds, LISTED, PORTION, is_within};
use crate::neighbours::inner_list::{best_skin, best_skin_of_all};
use crate::neighbours::pair_list::PairList;
use crate::packing::PackingError;
use crate::parallel;
use crate::vector::{Vector, larger, longest_difference_squared};

/// Calls of [`Assembly::keep_listed`] after which the way of the disks is looked at for the first time; then at twice as many.
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

    /// Whether, from now on, only near pairs are listed while disks move little. For who calls [`Assembly::keep_listed`] once an
    /// evaluation; what it keeps for each pair it must make anew whenever that says so.
    pub fn prune_lists(&mut self, prunes: bool) {
        self.prunes = prunes;
        if prunes {
            self.seen.clone_from(&self.displacements);
        }
        (self.age, self.seen_at, self.look_at) = (0, 0, FIRST_LOOK);
    }

    /// Whether [`Assembly::advance`] does anything. Before a look at a short list it does not: should near pairs be picked then, forces are
    /// summed in their order.
    pub(crate) fn may_advance(&self) -> bool {
        !self.law.has_sites() && (self.pairs().is_long() || !self.looks_next())
    }

    /// Tells lists apart: the number of the one in use, and how often it was amended.
    pub(crate) fn listing_number(&self) -> (usize, usize) {
        self.listing_number
    }

    /// The list in use, where it has the disks, the way it holds for, and what they have gone of it.
    pub(crate) fn listing(&mut self) -> (&PairList<D>, &[Vector<D>], f64, &mut DisplacementBounds) {
        let limit = LISTED * self.skin();
        let (pairs, listed) = match self.inner_skin {
            Some(_) => (&self.inner_pairs, &self.inner_at_build),
            None => (&self.pairs, &self.listed),
        };
        (pairs, listed, limit, &mut self.bounds)
    }

    /// Takes how far disks have moved since they were listed, in place of bounds on it.
    fn measure_all_portions(&mut self) {
        let bounds = self.longest_displacements_from(self.listed_in_use());
        self.bounds.portions.iter_mut().zip(bounds).for_each(|(bound, way)| bound.total = way);
    }

    /// How far the disks of each portion have moved from where they were, at most \[length\].
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

    /// Whether the way of the disks is looked at in the next call of [`Assembly::keep_listed`], however short it is.
    pub(crate) fn looks_next(&self) -> bool {
        self.prunes && self.age + 1 == self.look_at
    }

    /// Tells that no disk has moved by more than `bound` since the last call, and changes the list if it must be. True if it is
    /// another one.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn keep_listed(&mut self, bound: f64) -> Result<bool, PackingError> {
        self.bounds.add(bound);
        self.change()
    }

    /// Changes the list if it must be after a step of which [`Assembly::advance`] knows how far it went, or if the next one may spend it and it
    /// can be amended. True if it is another one.
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
            // Not a position any more: the forces are NaN too, and the relaxer stops on them.
            return Ok(false);
        }
        if longest > limit {
            return self.renew().map(|()| true);
        }
        Ok(looks && self.look())
    }

    /// Looks at how fast disks are, and picks near pairs if they are slow. True if that was done.
    fn look(&mut self) -> bool {
        let way = self.effective_displacement(&self.seen) / (self.age - self.seen_at) as f64;
        self.seen.clone_from(&self.displacements);
        (self.seen_at, self.look_at) = (self.age, 2 * self.age);
        self.picks(best_skin(self.smallest_radius, way), self.skin())
    }

    /// Another list for one that is spent.
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
            // As long as the list of all pairs lasts it is used itself.
            self.inner_skin = None;
            self.bounds_before.clear();
            self.listing_number = (self.listing_number.0 + 1, 0);
            self.measure_all_portions();
        }
        Ok(())
    }

    /// The skin for which the next list of all pairs lasts, if most disks go on as fast as they went in this one.
    fn choose_skin(&mut self) {
        let (narrowest, widest) = (*self.skins.start(), *self.skins.end());
        if narrowest < widest {
            // Disks whose near pairs are in use are slow.
            let way =
                if self.inner_skin.is_none() { self.common_displacement(&self.listed) / self.age as f64 } else { 0.0 };
            self.skin = best_skin_of_all(self.smallest_radius, way).clamp(narrowest, widest);
        }
    }

    /// Picks the pairs nearer than this skin, or than one for which the list of all pairs has them, in place of a list with that other
    /// skin, if it pays. True if that was done.
    fn picks(&mut self, best: f64, other: f64) -> bool {
        if best >= self.tuning().widest_near * other {
            return false;
        }
        // Where disks have gone a way w since they were listed, all pairs nearer than S - 2 w are in the list of all pairs, of width S.
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

    /// The longest way of a mobile disk from where it was \[length\]; NaN if one is.
    pub(crate) fn longest_way(&self, from: &[Vector<D>]) -> f64 {
        self.longest_displacements_from(from).into_iter().fold(0.0, larger)
    }

    /// The list of all pairs is new.
    pub(crate) fn begin_all(&mut self) {
        self.inner_skin = None;
        self.bounds_before.clear();
        self.listed.clone_from(&self.displacements);
        self.listing_number = (self.listing_number.0 + 1, 0);
        self.begin_list();
    }

    /// The list in use is new.
    pub(crate) fn begin_list(&mut self) {
        self.bounds.begin(self.mobile_count, self.pairs().tile_size);
        self.prune_lists(self.prunes);
    }

    /// Where the disks were when the list in use was made, or listed anew.
    pub(crate) fn listed_in_use(&self) -> &[Vector<D>] {
        if self.inner_skin.is_some() { &self.inner_at_build } else { &self.listed }
    }

    /// Width of the skin of the list in use \[length\].
    pub fn skin(&self) -> f64 {
        self.inner_skin.unwrap_or(self.skin)
    }

    /// How far every disk may go before the list must be made anew, at least \[length\].
    pub fn listed_way(&self) -> f64 {
        LISTED * self.skin() - self.bounds.longest()
    }
}
