//! How far disks may have gone since they were listed: a bound for each portion of them.
//!
//! Few disks are fast, so the bounds of most portions stay short, and a way itself is taken only of a portion whose bound does not do.

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
