//! The few disks that go far while the others hardly move: they are listed anew, so that a list lasts for the others.
//!
//! What is done for them is done where they are: portions whose bound says that none went far are not looked at.

use std::ops::Range;

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::neighbours::displacement_bounds::LISTED;
use crate::neighbours::missing_pairs::insert_missing_pairs;
use crate::neighbours::pair_list::PairList;
use crate::neighbours::verlet_list::ListRoom;
use crate::vector::{Vector, difference, dot, longest_difference_squared};

/// Disks of which one may go far at once.
const ONE_OF: usize = 128;

/// What is best for lists of one tile, which are near the processor and quickly made, is not for long ones. Changes speed only.
pub(crate) struct Tuning {
    /// A disk has gone far if it went this share of the way for which its list holds \[1\].
    far: f64,
    /// Disks of which one may have been listed anew since a list was made.
    updated_one_of: usize,
    /// Time of amending near pairs over that of picking them \[1\].
    amending: f64,
    /// Widest skin of near pairs over that of the list in use \[1\]. A twelfth of a radius lasts some 70 steps where it is the best; picking the
    /// pairs of large packings costs two to three evaluations more than PICKING says.
    pub widest_near: f64,
}

const SHORT: Tuning = Tuning { far: 0.5, updated_one_of: 64, amending: 0.4, widest_near: 0.16 };
const LONG: Tuning = Tuning { far: 0.7, updated_one_of: 8, amending: 0.1, widest_near: 0.3 };

/// Time of picking near pairs of large lists over what it gains, over that of small ones \[1\].
const PICKING: f64 = 3.5;

/// Disks of which one may go farther than the way that is common to the others.
const COMMON_BUT_ONE_OF: usize = 512;

/// Disks that are asked for that way at least, if there are so many: some 250 of them go farther.
const ASKED: usize = 1 << 17;

impl<const D: usize, L: PairLaw> Assembly<D, L> {
    pub(crate) fn tuning(&self) -> &'static Tuning {
        if self.pairs.is_long() { &LONG } else { &SHORT }
    }

    /// Whether lists are amended before they are spent: a step that spends one need not be made without it then.
    fn looks_ahead(&self) -> bool {
        self.prunes && self.pairs.is_long()
    }

    /// Amends the list in use if a step like the last one may spend it. True if that was done.
    pub(crate) fn amend_ahead(&mut self) -> bool {
        let limit = LISTED * self.skin();
        let nearly: Vec<usize> = self.bounds.nearly_spent(limit).collect();
        if !self.looks_ahead() || nearly.is_empty() {
            return false;
        }
        self.measure_portions(nearly);
        self.bounds.nearly_spent(limit).next().is_some() && self.amend()
    }

    /// The disks that [`Assembly::keep`] looks at after a step that did not spend the list.
    pub(crate) fn disks_to_see(&self) -> Vec<Range<usize>> {
        let limit = LISTED * self.skin();
        if !self.looks_ahead() || self.bounds.nearly_spent(limit).next().is_none() {
            return Vec::new();
        }
        let mut portions: Vec<usize> = self.bounds.nearly_spent(limit).collect();
        portions.extend(self.far_portions());
        portions.extend(self.far_portions_of_all());
        portions.sort_unstable();
        portions.dedup();
        portions.into_iter().map(|portion| self.bounds.disks_of(portion)).collect()
    }

    /// Lists the disks that went far anew, if they are few, and adds the pairs that the list in use lacks then. False if that cannot be: then
    /// it is as it was, and that of all pairs holds for as far as it did.
    pub(crate) fn amend(&mut self) -> bool {
        if !self.pairs.keeps_places {
            return false;
        }
        // Disks that go far in near pairs are looked for in the cells of the list of all pairs, and must not be far from there.
        let of_all = self.amend_all();
        let amended = match self.inner_skin {
            None => of_all == Some(true),
            Some(skin) => of_all.is_some() && self.amend_near(skin),
        };
        if amended {
            self.listing_number.1 += 1;
            if self.inner_skin.is_none() && !self.pairs.is_long() {
                // How fast disks are is looked at as for a new list.
                self.prune_lists(self.prunes);
            }
        }
        amended
    }

    /// Lists the disks anew that went far in the list of all pairs. Whether there were any; none if that cannot be.
    fn amend_all(&mut self) -> Option<bool> {
        let portions: Vec<usize> = self.far_portions_of_all().collect();
        let disks = self.far_of(&portions, &self.listed, self.skin)?;
        if disks.is_empty() {
            return Some(false);
        }
        self.far.set(disks, self.order.len());
        let mut room = std::mem::take(&mut self.list_room);
        let mut pairs = std::mem::take(&mut self.pairs);
        let amended = room.note_updated(&self.disks(), &self.far, self.len() / self.tuning().updated_one_of)
            && self.amend_list((&self.listed, self.skin), &mut room, &mut pairs);
        (self.pairs, self.list_room) = (pairs, room);
        if !amended {
            return None;
        }
        for &disk in self.far.disks() {
            self.listed[disk as usize] = self.displacements[disk as usize];
        }
        match self.inner_skin {
            Some(_) => self.measure_portions_before(&portions),
            None => self.measure_portions(portions),
        }
        Some(true)
    }

    /// The same of near pairs.
    fn amend_near(&mut self, skin: f64) -> bool {
        let portions: Vec<usize> = self.far_portions().collect();
        let Some(disks) = self.far_of(&portions, &self.inner_at_build, skin).filter(|disks| !disks.is_empty()) else {
            return false;
        };
        self.far.set(disks, self.order.len());
        let mut room = std::mem::take(&mut self.list_room);
        let mut pairs = std::mem::take(&mut self.inner_pairs);
        let amended = self.amend_list((&self.inner_at_build, skin), &mut room, &mut pairs);
        (self.inner_pairs, self.list_room) = (pairs, room);
        if amended {
            for &disk in self.far.disks() {
                self.inner_at_build[disk as usize] = self.displacements[disk as usize];
            }
            self.measure_portions_before(&portions);
            self.measure_portions(portions);
        }
        amended
    }

    fn amend_list(&self, listing: (&[Vector<D>], f64), room: &mut ListRoom<D>, pairs: &mut PairList<D>) -> bool {
        let law = self.law;
        insert_missing_pairs(&self.disks(), listing, &self.far, |a, b| law.coefficient(a, b), room, pairs)
    }

    /// Portions of which a disk may have gone far in the list in use.
    fn far_portions(&self) -> impl Iterator<Item = usize> {
        let limit = self.tuning().far * LISTED * self.skin();
        let bounds = self.bounds.portions.iter().enumerate();
        bounds.filter(move |(_, bound)| bound.total > limit).map(|(portion, _)| portion)
    }

    /// The same in the list of all pairs.
    fn far_portions_of_all(&self) -> impl Iterator<Item = usize> {
        let limit = self.tuning().far * LISTED * self.skin;
        let before = self.bounds_before.iter().copied().chain(std::iter::repeat(0.0));
        let bounds = self.bounds.portions.iter().zip(before).map(|(bound, before)| before + bound.total);
        bounds.enumerate().filter(move |(_, way)| *way > limit).map(|(portion, _)| portion)
    }

    /// The disks of some portions that went far from where they were listed, if they are few.
    fn far_of(&self, portions: &[usize], listed: &[Vector<D>], skin: f64) -> Option<Vec<u32>> {
        let limit = self.tuning().far * LISTED * skin;
        let disks = portions.iter().flat_map(|&portion| self.bounds.disks_of(portion));
        let is_far = |disk: &usize| {
            let way = difference(self.displacements[*disk], listed[*disk]);
            dot(way, way) > limit * limit
        };
        let far: Vec<u32> = disks.filter(is_far).map(|disk| disk as u32).collect();
        (far.len() <= self.len() / ONE_OF).then_some(far)
    }

    /// Takes how far the disks of some portions have gone since they were listed, in place of bounds on it.
    pub(crate) fn measure_portions(&mut self, portions: Vec<usize>) {
        for portion in portions {
            let disks = self.bounds.disks_of(portion);
            self.bounds.portions[portion].total =
                longest(&self.displacements[disks.clone()], &self.listed_in_use()[disks]);
        }
    }

    /// The same for how far they had gone in the list of all pairs when they were listed in near pairs.
    fn measure_portions_before(&mut self, portions: &[usize]) {
        for &portion in portions {
            let disks = self.bounds.disks_of(portion);
            self.bounds_before[portion] = longest(&self.inner_at_build[disks.clone()], &self.listed[disks]);
        }
    }

    /// The way from where they were by which disks wear near pairs out: as much less by those that note_updated as amending takes less than
    /// picking; for large lists more, as picking takes longer there.
    pub(crate) fn effective_displacement(&self, from: &[Vector<D>]) -> f64 {
        let longest = self.longest_way(from);
        if self.pairs.keeps_places {
            PICKING * (self.common_displacement(from) + self.tuning().amending * longest)
        } else {
            longest
        }
    }

    /// The way from where they were that all mobile disks but a few, which may note_updated, did not exceed \[length\].
    pub(crate) fn common_displacement(&self, from: &[Vector<D>]) -> f64 {
        if !self.pairs.keeps_places || self.mobile_count == 0 {
            return self.longest_way(from);
        }
        let mobile = self.displacements[..self.mobile_count].iter().zip(from);
        let mut squares: Vec<f64> = mobile
            .step_by((self.mobile_count / ASKED).max(1))
            .map(|(&now, &before)| {
                let way = difference(now, before);
                dot(way, way)
            })
            .collect();
        let place = squares.len() - 1 - squares.len() / COMMON_BUT_ONE_OF;
        squares.select_nth_unstable_by(place, f64::total_cmp).1.sqrt()
    }
}

fn longest<const D: usize>(now: &[Vector<D>], before: &[Vector<D>]) -> f64 {
    longest_difference_squared(now, before).sqrt()
}
