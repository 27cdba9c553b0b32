//! The few disks that go far while the others hardly move: they are listed anew, so that a list lasts for the others.

use crate::contact::assembly::Assembly;
use crate::contact::assembly::upkeep::LISTED;
use crate::contact::law::PairLaw;
use crate::contact::neighbours::amend_pairs;
use crate::contact::ways::{Ways, is_within};
use crate::vector::{Vector, difference, dot};

/// A disk has gone far if it went this share of the way for which its list holds \[1\].
const FAR: f64 = 0.5;

/// Disks of which one may go far at once, and one may have been listed anew since a list was made.
const ONE_OF: usize = 128;
const ROAMING_ONE_OF: usize = 64;

/// Most of the latter: each that goes far is compared with all of them.
const MOST_ROAMING: usize = 4096;

/// Time of amending near pairs over that of picking them \[1\].
const AMENDING: f64 = 0.4;

/// Time of picking near pairs of large lists over what it gains, over that of small ones \[1\].
const PICKING: f64 = 3.5;

/// Disks of which one may go farther than the way that is common to the others.
const COMMON_BUT_ONE_OF: usize = 512;

/// Disks that are asked for that way at least, if there are so many: some 250 of them go farther.
const ASKED: usize = 1 << 17;

impl<const D: usize, L: PairLaw> Assembly<D, L> {
    /// Lists the disks that went far anew, if they are few, and adds the pairs that the list in use lacks then. False if that cannot be: near
    /// pairs are not good any more then, and the list of all pairs is as it was.
    pub(super) fn amend(&mut self) -> bool {
        let Some(skin) = self.near_skin else {
            let ways = self.ways.clone();
            let amended = self.amend_all(&ways);
            if amended {
                self.begin_list();
            }
            self.take_ways();
            return amended;
        };
        let ways = self.ways_from(&self.listed);
        let mut moved = ways.longest();
        if moved > FAR * LISTED * self.skin {
            if !self.amend_all(&ways) {
                return false;
            }
            moved = self.longest_way(&self.listed);
        }
        // Near pairs are looked for in the list of all pairs, so they must be nearer in that one too. It listed the far disk where it was no
        // farther from here than the longest way, and another one no farther from where it is near than that and half a near skin.
        if 2.0 * moved + 1.5 * skin > self.skin {
            return false;
        }
        let Some(far) = self.far_from((&self.near_listed, &self.ways), skin) else { return false };
        for &disk in &far {
            self.near_listed[disk as usize] = self.displacements[disk as usize];
        }
        let marked = self.marked(&far);
        self.take_ways();
        self.near_pairs.amend_from(&self.pairs, &marked, (&self.near_listed, skin))
    }

    /// The same for the list of all pairs, from which portions of disks have gone so far.
    fn amend_all(&mut self, ways: &Ways) -> bool {
        let Some(far) = self.far_from((&self.listed, ways), self.skin) else { return false };
        let (mut listed, mut roaming) = (self.listed.clone(), self.roaming.clone());
        for &disk in &far {
            listed[disk as usize] = self.displacements[disk as usize];
        }
        roaming.extend(&far);
        roaming.sort_unstable();
        roaming.dedup();
        if roaming.len() > MOST_ROAMING.min(self.len() / ROAMING_ONE_OF) {
            return false;
        }
        let marked = self.marked(&far);
        let law = self.law;
        let coefficient = |a, b| law.coefficient(a, b);
        let mut pairs = std::mem::take(&mut self.pairs);
        let (listing, who) = ((&self.disks(), listed.as_slice()), (roaming.as_slice(), marked.as_slice()));
        let amended = amend_pairs(listing, who, self.skin, coefficient, &self.list_room, &mut pairs);
        self.pairs = pairs;
        if amended {
            (self.listed, self.roaming) = (listed, roaming);
        }
        amended
    }

    /// The mobile disks that went far from where they were, if they are few and the list may be amended. `ways` are bounds on how far
    /// portions of them went.
    fn far_from(&self, (listed, ways): (&[Vector<D>], &Ways), skin: f64) -> Option<Vec<u32>> {
        if !self.pairs.keeps_places {
            return None;
        }
        let limit = FAR * LISTED * skin;
        let mut far = Vec::new();
        for portion in ways.portions(self.mobile_count, self.pairs.tile_size).filter(|(_, way)| !is_within(*way, limit))
        {
            let first = portion.0.start;
            for (place, (&now, &before)) in
                self.displacements[portion.0.clone()].iter().zip(&listed[portion.0]).enumerate()
            {
                let way = difference(now, before);
                if dot(way, way) > limit * limit {
                    far.push((first + place) as u32);
                }
            }
        }
        (far.len() <= self.len() / ONE_OF).then_some(far)
    }

    fn marked(&self, disks: &[u32]) -> Vec<bool> {
        let mut marked = vec![false; self.len()];
        disks.iter().for_each(|&disk| marked[disk as usize] = true);
        marked
    }

    /// The way from where they were by which disks wear near pairs out: as much less by those that roam as amending takes less than
    /// picking; for large lists more, as picking takes longer there.
    pub(super) fn felt_way(&self, from: &[Vector<D>]) -> f64 {
        let longest = self.longest_way(from);
        if self.pairs.keeps_places { PICKING * (self.common_way(from) + AMENDING * longest) } else { longest }
    }

    /// The way from where they were that all mobile disks but a few, which may roam, did not exceed \[length\].
    pub(super) fn common_way(&self, from: &[Vector<D>]) -> f64 {
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
