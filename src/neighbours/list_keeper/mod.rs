//! [`ListKeeper`]: the Verlet list of moving disks, checked, pruned, updated and rebuilt as they move.
//!
//! The *outer list* holds all pairs within a skin. While disks move slowly, an *inner list* with a narrower skin is used
//! in its place. A list is complete until some disk has moved by half its skin since the list was built. The keeper owns
//! the lists; the disks belong to the caller.

mod incremental_update;

use std::ops::RangeInclusive;

use crate::neighbours::displacement_bounds::{DisplacementBounds, PORTION, SKIN_FRACTION, is_within};
use crate::neighbours::fast_disks::FastDisks;
use crate::neighbours::inner_list::{best_inner_skin, best_outer_skin};
use crate::neighbours::pair_list::PairList;
use crate::neighbours::verlet_list::{Disks, ListWorkspace, build_pairs};
use crate::packing::PackingError;
use crate::parallel;
use crate::vector::{Vector, larger, longest_difference_squared};

/// Number of steps before the first check of the disks' speed. The number doubles for each further check.
const FIRST_CHECK: usize = 16;

/// Force coefficient of a pair with these radii.
pub(crate) type Coefficient<'a> = &'a (dyn Fn(f64, f64) -> f64 + Sync);

/// The lists of some disks, and how far the disks have moved since the lists were built.
#[derive(Debug, Clone)]
pub(crate) struct ListKeeper<const D: usize> {
    outer: PairList<D>,
    /// Inner list, in use while `inner_skin` is set.
    inner: PairList<D>,
    inner_skin: Option<f64>,
    /// Whether an inner list may be used.
    prunes: bool,
    /// Number of steps since the speed checks were restarted: since the list in use was built, since a short outer list
    /// was updated, or since [`ListKeeper::set_pruning`].
    age: usize,
    /// Value of `age` at which the speed of the disks is checked.
    next_check: usize,
    /// Displacements at the last speed check, and the value of `age` then.
    checked_displacements: Vec<Vector<D>>,
    checked_at: usize,
    workspace: ListWorkspace<D>,
    smallest_radius: f64,
    /// Skin of the outer list.
    skin: f64,
    /// Narrowest and widest skin of the outer list.
    skins: RangeInclusive<f64>,
    /// Displacements at the build of the outer list, or at the last update of a disk in it; the same for the inner
    /// list.
    outer_at_build: Vec<Vector<D>>,
    inner_at_build: Vec<Vector<D>>,
    /// The fast disks of the present update.
    fast_disks: FastDisks,
    /// Displacement bounds since the list in use was built.
    bounds: DisplacementBounds,
    /// Bound on the displacements in the outer list up to the build of the inner list, for each portion; empty if the
    /// inner list is not in use.
    bounds_before: Vec<f64>,
    list_number: ListNumber,
    build_count: usize,
}

/// Identifies a list in use and its state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct ListNumber {
    /// Number of lists used so far.
    pub list: usize,
    /// Number of incremental updates of the present list.
    pub update_count: usize,
}

impl ListNumber {
    /// The next list, without updates.
    fn following(self) -> Self {
        ListNumber { list: self.list + 1, update_count: 0 }
    }
}

/// What became of the list in use after a step.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kept {
    /// It is still complete.
    Unchanged,
    /// It was updated, or replaced by another one.
    Changed,
    /// The outer list has expired. The caller must call [`ListKeeper::build`] and then [`ListKeeper::prune_to`] with
    /// this skin.
    Expired {
        /// The best skin of an inner list \[length\].
        best_inner_skin: f64,
    },
}

impl<const D: usize> ListKeeper<D> {
    /// A keeper without a list; [`ListKeeper::build`] makes the first one.
    pub(crate) fn new(smallest_radius: f64, skins: RangeInclusive<f64>) -> Self {
        ListKeeper {
            outer: PairList::default(),
            inner: PairList::default(),
            inner_skin: None,
            prunes: false,
            age: 0,
            next_check: 0,
            checked_displacements: Vec::new(),
            checked_at: 0,
            workspace: ListWorkspace::default(),
            smallest_radius,
            skin: *skins.start(),
            skins,
            outer_at_build: Vec::new(),
            inner_at_build: Vec::new(),
            fast_disks: FastDisks::default(),
            bounds: DisplacementBounds::default(),
            bounds_before: Vec::new(),
            list_number: ListNumber::default(),
            build_count: 0,
        }
    }

    /// The list in use.
    pub(crate) fn in_use(&self) -> &PairList<D> {
        if self.inner_skin.is_some() { &self.inner } else { &self.outer }
    }

    #[cfg(test)]
    pub(crate) fn inner_list_is_used(&self) -> bool {
        self.inner_skin.is_some()
    }

    #[cfg(test)]
    pub(crate) fn outer(&self) -> &PairList<D> {
        &self.outer
    }

    /// Number of builds of the outer list.
    pub(crate) fn build_count(&self) -> usize {
        self.build_count
    }

    /// Identifies the list in use.
    pub(crate) fn list_number(&self) -> ListNumber {
        self.list_number
    }

    /// Builds the outer list for the present positions.
    ///
    /// # Errors
    /// As [`build_pairs`].
    pub(crate) fn build(&mut self, disks: &Disks<'_, D>, coefficient: Coefficient<'_>) -> Result<(), PackingError> {
        build_pairs(disks, self.skin, coefficient, &mut self.workspace, &mut self.outer)?;
        self.inner_skin = None;
        self.bounds_before.clear();
        self.outer_at_build.clear();
        self.outer_at_build.extend_from_slice(disks.displacements);
        self.list_number = self.list_number.following();
        self.reset_bounds_and_checks(disks);
        self.build_count += 1;
        Ok(())
    }

    /// Sets whether an inner list is used while disks move slowly.
    pub(crate) fn set_pruning(&mut self, disks: &Disks<'_, D>, prunes: bool) {
        self.prunes = prunes;
        self.restart_speed_checks(disks);
    }

    /// Restarts the speed checks from the present displacements.
    fn restart_speed_checks(&mut self, disks: &Disks<'_, D>) {
        if self.prunes {
            self.checked_displacements.clear();
            self.checked_displacements.extend_from_slice(disks.displacements);
        }
        (self.age, self.checked_at, self.next_check) = (0, 0, FIRST_CHECK);
    }

    /// The list in use, the reference displacements of its disks, its limit, and the displacement bounds.
    pub(crate) fn listing(&mut self) -> (&PairList<D>, &[Vector<D>], f64, &mut DisplacementBounds) {
        let limit = SKIN_FRACTION * self.skin();
        let (pairs, reference) = match self.inner_skin {
            Some(_) => (&self.inner, &self.inner_at_build),
            None => (&self.outer, &self.outer_at_build),
        };
        (pairs, reference, limit, &mut self.bounds)
    }

    /// Whether the next step ends with a check of the disks' speed, however small their displacements are.
    pub(crate) fn checks_next(&self) -> bool {
        self.prunes && self.age + 1 == self.next_check
    }

    /// Width of the skin of the list in use \[length\].
    pub(crate) fn skin(&self) -> f64 {
        self.inner_skin.unwrap_or(self.skin)
    }

    /// Displacement that every disk can still make, at least, before the list expires \[length\].
    pub(crate) fn remaining_displacement(&self) -> f64 {
        SKIN_FRACTION * self.skin() - self.bounds.longest()
    }

    /// Records a step in which no disk moved by more than `bound`.
    pub(crate) fn add_step(&mut self, bound: f64) {
        self.bounds.add(bound);
    }

    /// Checks the list after a step whose displacements are recorded, and changes it if necessary.
    pub(crate) fn keep(&mut self, disks: &Disks<'_, D>, coefficient: Coefficient<'_>) -> Kept {
        self.age += 1;
        let checks = self.prunes && self.age == self.next_check;
        let limit = SKIN_FRACTION * self.skin();
        if is_within(self.bounds.longest(), limit) && !checks {
            return Kept::Unchanged;
        }
        let bounds = self.bounds.portions.iter().enumerate();
        let portions = bounds.filter(|(_, bound)| !is_within(bound.total, limit)).map(|(portion, _)| portion);
        self.tighten_bounds(disks, portions.collect());
        let longest = self.bounds.longest();
        if longest.is_nan() {
            // The displacement is NaN, so the forces are NaN too, and the relaxer stops.
            return Kept::Unchanged;
        }
        if longest > limit {
            return self.replace_list(disks, coefficient);
        }
        if checks && self.check_speed(disks) { Kept::Changed } else { Kept::Unchanged }
    }

    /// Checks the speed of the disks, and prunes the list if they are slow. Returns whether it did.
    fn check_speed(&mut self, disks: &Disks<'_, D>) -> bool {
        let displacement =
            self.effective_displacement(disks, &self.checked_displacements) / (self.age - self.checked_at) as f64;
        self.checked_displacements.clear();
        self.checked_displacements.extend_from_slice(disks.displacements);
        (self.checked_at, self.next_check) = (self.age, 2 * self.age);
        self.try_prune(disks, best_inner_skin(self.smallest_radius, displacement), self.skin())
    }

    /// Replaces an expired list.
    fn replace_list(&mut self, disks: &Disks<'_, D>, coefficient: Coefficient<'_>) -> Kept {
        if self.prunes && self.update_fast_disks(disks, coefficient) {
            return Kept::Changed;
        }
        let displacement = if self.prunes {
            self.effective_displacement(disks, self.reference_displacements()) / self.age as f64
        } else {
            f64::INFINITY
        };
        let best = best_inner_skin(self.smallest_radius, displacement);
        let outer_limit = SKIN_FRACTION * self.skin;
        if self.inner_skin.is_none() || self.largest_displacement_since(disks, &self.outer_at_build) > outer_limit {
            self.choose_skin(disks);
            return Kept::Expired { best_inner_skin: best };
        }
        if !self.try_prune(disks, best, self.skin) {
            // While the outer list is still complete, it is used itself.
            self.inner_skin = None;
            self.bounds_before.clear();
            self.list_number = self.list_number.following();
            let bounds = self.longest_displacements_from(disks, self.reference_displacements());
            self.bounds.portions.iter_mut().zip(bounds).for_each(|(bound, displacement)| bound.total = displacement);
        }
        Kept::Changed
    }

    /// Chooses the skin of the next outer list, if most disks keep their speed.
    fn choose_skin(&mut self, disks: &Disks<'_, D>) {
        let (narrowest, widest) = (*self.skins.start(), *self.skins.end());
        if narrowest < widest {
            // If the inner list is in use, the disks are slow.
            let displacement = if self.inner_skin.is_none() {
                self.common_displacement(disks, &self.outer_at_build) / self.age as f64
            } else {
                0.0
            };
            self.skin = best_outer_skin(self.smallest_radius, displacement).clamp(narrowest, widest);
        }
    }

    /// Prunes a new outer list to this skin, if that is worthwhile.
    pub(crate) fn prune_to(&mut self, disks: &Disks<'_, D>, best_inner_skin: f64) {
        self.try_prune(disks, best_inner_skin, self.skin);
    }

    /// Prunes the outer list to the skin `best`, or to the widest skin for which the outer list is complete, if that
    /// costs less than the alternative, a list of skin `alternative_skin`. Returns whether it did.
    fn try_prune(&mut self, disks: &Disks<'_, D>, best: f64, alternative_skin: f64) -> bool {
        if best >= self.tuning().widest_inner * alternative_skin {
            return false;
        }
        // If disks have moved by at most w since the list was built, the outer list of skin S contains all pairs within
        // S − 2 w.
        let widest = self.skin - self.largest_displacement_since(disks, &self.outer_at_build) / SKIN_FRACTION;
        // With less than half of the best skin, the inner list would expire in less than half of the best time.
        if best >= 2.0 * widest {
            return false;
        }
        let skin = best.min(widest);
        self.inner.prune(&self.outer, disks.displacements, skin);
        self.inner_skin = Some(skin);
        self.inner_at_build.clear();
        self.inner_at_build.extend_from_slice(disks.displacements);
        self.bounds_before = self.longest_displacements_from(disks, &self.outer_at_build);
        self.list_number = self.list_number.following();
        self.reset_bounds_and_checks(disks);
        true
    }

    /// Resets bounds and counters for another list in use.
    fn reset_bounds_and_checks(&mut self, disks: &Disks<'_, D>) {
        self.bounds.begin(disks.mobile_count, self.in_use().tile_size);
        self.restart_speed_checks(disks);
    }

    /// Reference displacements of the list in use: those at its build, or at the last update of a disk.
    fn reference_displacements(&self) -> &[Vector<D>] {
        if self.inner_skin.is_some() { &self.inner_at_build } else { &self.outer_at_build }
    }

    /// Upper bound on the displacement since `before` for each portion of disks \[length\].
    fn longest_displacements_from(&self, disks: &Disks<'_, D>, before: &[Vector<D>]) -> Vec<f64> {
        let mobile = disks.mobile_count;
        let tiles = disks.displacements[..mobile].chunks(self.outer.tile_size);
        let tiles = tiles.zip(before[..mobile].chunks(self.outer.tile_size));
        let longest = |(now, before): (&[_], &[_])| longest_difference_squared(now, before).sqrt();
        let bounds = parallel::each(tiles, |(now, before)| {
            now.chunks(PORTION).zip(before.chunks(PORTION)).map(longest).collect::<Vec<_>>()
        });
        bounds.concat()
    }

    /// The largest displacement of a mobile disk since `from` \[length\]; NaN if any is NaN.
    fn largest_displacement_since(&self, disks: &Disks<'_, D>, from: &[Vector<D>]) -> f64 {
        self.longest_displacements_from(disks, from).into_iter().fold(0.0, larger)
    }
}
