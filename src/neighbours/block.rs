//! Blocks of pairs: how many pairs, and where their rows begin.

use std::ops::Range;

/// Most pairs of a block; its columns stay in the nearest cache.
pub const BLOCK: usize = 128;

/// Most pairs of a row; a disk with more has several rows.
pub const LONGEST_ROW: usize = 8;

/// Where the pairs and rows of a block begin, how many rows it has, and how many pairs each of them.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Block {
    pub pairs: usize,
    pub pair_count: usize,
    pub rows: usize,
    pub row_count: usize,
    pub row_length: usize,
    /// Disk from which rows and ends are counted: the first of the tile if all of them are in one, so that the loop subtracts nothing.
    pub origin: u32,
}

impl Block {
    /// Its pairs.
    pub fn pairs(&self) -> Range<usize> {
        self.pairs..self.pairs + self.pair_count
    }
}
