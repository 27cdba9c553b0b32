//! How far disks may have gone since they were listed: a bound for each portion of them.
//!
//! Few disks are fast, so the bounds of most portions stay short, and a way itself is taken only of a portion whose bound does not do.

use std::ops::Range;

use crate::vector::larger;

/// How far a disk may move after a list was built, over the width of the skin: half of it, less the rounding of the comparison.
pub(crate) const LISTED: f64 = 0.4999;

/// Disks of a portion.
pub(crate) const PORTION: usize = 1024;

/// The way of a step over that of the one before, at most \[1\]: where it is longer a list is spent a step too early.
const STEP_GROWTH: f64 = 1.25;

/// Bounds on how far the disks of a portion have gone \[length\].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Bound {
    /// Since they were listed.
    pub way: f64,
    /// In the last step.
    pub step: f64,
}

/// A bound for each portion of the mobile disks, tile by tile.
#[derive(Debug, Clone, Default)]
pub(crate) struct Ways {
    pub bounds: Vec<Bound>,
    /// Portions of a tile.
    pub of_tile: usize,
    mobile_count: usize,
    tile_size: usize,
}

impl Ways {
    /// None has moved.
    pub fn begin(&mut self, mobile_count: usize, tile_size: usize) {
        self.of_tile = tile_size.min(mobile_count).div_ceil(PORTION).max(1);
        (self.mobile_count, self.tile_size) = (mobile_count, tile_size);
        let (tiles, rest) = (mobile_count / tile_size, mobile_count % tile_size);
        self.bounds.clear();
        self.bounds.resize(tiles * self.of_tile + rest.div_ceil(PORTION), Bound::default());
    }

    /// The disks of a portion.
    pub fn disks_of(&self, portion: usize) -> Range<usize> {
        let tile = portion / self.of_tile * self.tile_size;
        let first = tile + portion % self.of_tile * PORTION;
        first..self.mobile_count.min(tile + self.tile_size).min(first + PORTION)
    }

    /// No disk has moved by more than this in one step more \[length\].
    pub fn add(&mut self, step: f64) {
        self.bounds.iter_mut().for_each(|bound| *bound = Bound { way: bound.way + step, step });
    }

    /// The longest of them; NaN if one is.
    pub fn longest(&self) -> f64 {
        self.bounds.iter().fold(0.0, |longest, bound| larger(longest, bound.way))
    }

    /// The portions whose bound may be longer than this after one step more.
    pub fn nearly_spent(&self, limit: f64) -> impl Iterator<Item = usize> {
        let portions = self.bounds.iter().enumerate();
        portions.filter(move |(_, bound)| bound.way + STEP_GROWTH * bound.step > limit).map(|(portion, _)| portion)
    }
}

/// Whether a disk that went no farther has listed all it may touch; not for NaN.
pub(crate) fn is_within(way: f64, limit: f64) -> bool {
    way <= limit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn portions_are_all_the_mobile_disks_tile_by_tile() {
        for mobile in [0, 1, 1024, 1025, 8191, 8192, 8193, 20_000, 24_576] {
            let mut ways = Ways::default();
            ways.begin(mobile, 8192 + 10);
            let disks: Vec<_> = (0..ways.bounds.len()).map(|portion| ways.disks_of(portion)).collect();
            assert_eq!(disks.iter().cloned().flatten().collect::<Vec<_>>(), (0..mobile).collect::<Vec<_>>());
            let within = |disks: &Range<usize>| !disks.is_empty() && disks.start / 8202 == (disks.end - 1) / 8202;
            assert!(disks.iter().all(|disks| within(disks) && disks.len() <= PORTION), "{mobile}");
        }
    }

    #[test]
    fn a_bound_that_is_no_number_is_not_within() {
        let mut ways = Ways::default();
        ways.begin(3000, 8192);
        ways.add(0.25);
        assert!(is_within(ways.longest(), 0.25) && !is_within(ways.longest(), 0.2));
        ways.bounds[1].way = f64::NAN;
        assert!(ways.longest().is_nan() && !is_within(ways.longest(), f64::INFINITY));
    }

    #[test]
    fn a_portion_is_nearly_spent_if_a_step_like_the_last_one_may_spend_it() {
        let mut ways = Ways::default();
        ways.begin(3000, 8192);
        ways.bounds = vec![Bound { way: 0.5, step: 0.2 }, Bound { way: 0.5, step: 0.1 }, Bound { way: 0.9, step: 0.0 }];
        assert_eq!(ways.nearly_spent(0.74).collect::<Vec<_>>(), [0, 2]);
        assert_eq!(ways.nearly_spent(0.95).count(), 0);
        ways.bounds[0].step = f64::NAN;
        assert_eq!(ways.nearly_spent(0.74).collect::<Vec<_>>(), [2], "that is not known");
    }
}
