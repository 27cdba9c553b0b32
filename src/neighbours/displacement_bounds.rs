//! Displacement bounds: how far disks may have moved since the list was built, one bound for each portion of disks.
//!
//! Few disks are fast, so the bounds of most portions stay small. Exact displacements are computed only for portions
//! whose bound exceeds the limit.

use std::ops::Range;

use crate::vector::larger;

/// Displacement up to which a list is complete, over the width of the skin: one half, less the rounding of the
/// comparison.
pub(crate) const SKIN_FRACTION: f64 = 0.4999;

/// Number of disks in a portion.
pub(crate) const PORTION: usize = 1024;

/// Largest expected ratio of the displacement in a step to that in the step before \[1\]. If it is exceeded, the list
/// expires one step too early.
const STEP_GROWTH: f64 = 1.25;

/// Bounds on the displacements of the disks of a portion \[length\].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Bound {
    /// Since the list was built, or since the disk was updated.
    pub total: f64,
    /// In the last step.
    pub step: f64,
}

/// One bound for each portion of the mobile disks, tile by tile.
#[derive(Debug, Clone, Default)]
pub(crate) struct DisplacementBounds {
    pub portions: Vec<Bound>,
    /// Number of portions in a tile.
    pub of_tile: usize,
    mobile_count: usize,
    tile_size: usize,
}

impl DisplacementBounds {
    /// Resets all bounds to zero.
    pub fn begin(&mut self, mobile_count: usize, tile_size: usize) {
        self.of_tile = tile_size.min(mobile_count).div_ceil(PORTION).max(1);
        (self.mobile_count, self.tile_size) = (mobile_count, tile_size);
        let (tiles, rest) = (mobile_count / tile_size, mobile_count % tile_size);
        self.portions.clear();
        self.portions.resize(tiles * self.of_tile + rest.div_ceil(PORTION), Bound::default());
    }

    /// The disks of a portion.
    pub fn disks_of(&self, portion: usize) -> Range<usize> {
        let tile = portion / self.of_tile * self.tile_size;
        let first = tile + portion % self.of_tile * PORTION;
        first..self.mobile_count.min(tile + self.tile_size).min(first + PORTION)
    }

    /// Adds a step in which no disk moved by more than `step` \[length\].
    pub fn add(&mut self, step: f64) {
        self.portions.iter_mut().for_each(|bound| *bound = Bound { total: bound.total + step, step });
    }

    /// The largest bound; NaN if any bound is NaN.
    pub fn longest(&self) -> f64 {
        self.portions.iter().fold(0.0, |longest, bound| larger(longest, bound.total))
    }

    /// The portions whose bound may exceed the limit after one more step.
    pub fn nearly_expired(&self, limit: f64) -> impl Iterator<Item = usize> {
        let portions = self.portions.iter().enumerate();
        portions.filter(move |(_, bound)| bound.total + STEP_GROWTH * bound.step > limit).map(|(portion, _)| portion)
    }
}

/// Whether a displacement is within the limit; false for NaN.
pub(crate) fn is_within(displacement: f64, limit: f64) -> bool {
    displacement <= limit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn portions_are_all_the_mobile_disks_tile_by_tile() {
        for mobile in [0, 1, 1024, 1025, 8191, 8192, 8193, 20_000, 24_576] {
            let mut bounds = DisplacementBounds::default();
            bounds.begin(mobile, 8192 + 10);
            let disks: Vec<_> = (0..bounds.portions.len()).map(|portion| bounds.disks_of(portion)).collect();
            assert_eq!(disks.iter().cloned().flatten().collect::<Vec<_>>(), (0..mobile).collect::<Vec<_>>());
            let within = |disks: &Range<usize>| !disks.is_empty() && disks.start / 8202 == (disks.end - 1) / 8202;
            assert!(disks.iter().all(|disks| within(disks) && disks.len() <= PORTION), "{mobile}");
        }
    }

    #[test]
    fn a_bound_that_is_no_number_is_not_within() {
        let mut bounds = DisplacementBounds::default();
        bounds.begin(3000, 8192);
        bounds.add(0.25);
        assert!(is_within(bounds.longest(), 0.25) && !is_within(bounds.longest(), 0.2));
        bounds.portions[1].total = f64::NAN;
        assert!(bounds.longest().is_nan() && !is_within(bounds.longest(), f64::INFINITY));
    }

    #[test]
    fn a_portion_is_nearly_expired_if_a_step_like_the_last_one_may_exceed_its_limit() {
        let mut bounds = DisplacementBounds::default();
        bounds.begin(3000, 8192);
        bounds.portions =
            vec![Bound { total: 0.5, step: 0.2 }, Bound { total: 0.5, step: 0.1 }, Bound { total: 0.9, step: 0.0 }];
        assert_eq!(bounds.nearly_expired(0.74).collect::<Vec<_>>(), [0, 2]);
        assert_eq!(bounds.nearly_expired(0.95).count(), 0);
        bounds.portions[0].step = f64::NAN;
        assert_eq!(bounds.nearly_expired(0.74).collect::<Vec<_>>(), [2], "that is not known");
    }
}
