//! Blocks of pairs: the number of pairs, and where their rows begin.

use std::ops::Range;

/// Largest number of pairs in a block. The columns of one block stay in the first-level cache.
pub const BLOCK: usize = 128;

/// Largest number of pairs in a row. A disk with more pairs has several rows.
pub const LONGEST_ROW: usize = 8;

/// Position of a block in the list: its first pair and first row, and the number and length of its rows.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Block {
    pub pairs: usize,
    pub pair_count: usize,
    pub rows: usize,
    pub row_count: usize,
    pub row_length: usize,
    /// Disk from which rows and ends are counted. It is the first disk of the tile if all disks are in one tile, so the
    /// loop subtracts nothing.
    pub origin: u32,
}

impl Block {
    /// The pairs of the block.
    pub fn pairs(&self) -> Range<usize> {
        self.pairs..self.pairs + self.pair_count
    }
}
