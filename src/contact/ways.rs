//! How far disks may have gone since they were listed: a bound for each portion of them.
//!
//! Few disks are fast, so the bounds of most portions stay short, and a way itself is taken only of a portion whose bound does not do.

use std::ops::Range;

use crate::vector::larger;

/// Disks of a portion.
pub(super) const PORTION: usize = 1024;

/// A bound for each portion of the mobile disks, tile by tile \[length\].
#[derive(Debug, Clone, Default)]
pub(super) struct Ways {
    pub bounds: Vec<f64>,
    /// Portions of a tile.
    pub of_tile: usize,
}

impl Ways {
    /// None has moved.
    pub fn begin(&mut self, mobile_count: usize, tile_size: usize) {
        self.of_tile = tile_size.min(mobile_count).div_ceil(PORTION).max(1);
        let (tiles, rest) = (mobile_count / tile_size, mobile_count % tile_size);
        self.bounds.clear();
        self.bounds.resize(tiles * self.of_tile + rest.div_ceil(PORTION), 0.0);
    }

    /// The disks of each portion, and the bound of it.
    pub fn portions(&self, mobile_count: usize, tile_size: usize) -> impl Iterator<Item = (Range<usize>, f64)> {
        self.bounds.iter().enumerate().map(move |(portion, &bound)| {
            let tile = portion / self.of_tile * tile_size;
            let first = tile + portion % self.of_tile * PORTION;
            (first..mobile_count.min(tile + tile_size).min(first + PORTION), bound)
        })
    }

    /// No disk has moved by more than this \[length\].
    pub fn add(&mut self, bound: f64) {
        self.bounds.iter_mut().for_each(|way| *way += bound);
    }

    /// The longest of them; NaN if one is.
    pub fn longest(&self) -> f64 {
        self.bounds.iter().copied().fold(0.0, larger)
    }
}

/// Whether a disk that went no farther has listed all it may touch; not for NaN.
pub(super) fn is_within(way: f64, limit: f64) -> bool {
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
            let disks: Vec<_> = ways.portions(mobile, 8192 + 10).map(|(disks, _)| disks).collect();
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
        ways.bounds[1] = f64::NAN;
        assert!(ways.longest().is_nan() && !is_within(ways.longest(), f64::INFINITY));
    }
}
