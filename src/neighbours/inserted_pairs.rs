//! Insertion of the pairs of a few fast disks into a list, so that the list stays valid for the other disks.
//!
//! ```text
//! |x_i − x_j| < R_i + R_j + s     x: position at the last update of a disk;  complete while no disk is farther than
//! s/2 from x
//! ```
//!
//! In a large packing about one disk in a thousand is fast, usually a rattler. A list would expire with the fastest of
//! them. Instead, the pairs that such disks are missing at their present positions are inserted. The present position
//! then becomes their reference. Each tile reserves a few empty blocks for these pairs.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::neighbours::block::{BLOCK, Block};
use crate::neighbours::fast_disks::FastDisks;
use crate::neighbours::pair_block::PairBlock;
use crate::neighbours::pair_list::{PairList, Source};
use crate::neighbours::tiles::connect;

/// Fewest disks of a list with reserved blocks. A smaller list is built quickly and has few fast disks.
const FEWEST: usize = 4096;

/// Reserved blocks of a tile: for pairs within it, and for pairs across its border.
const INNER: usize = 4;
const BORDER: usize = 2;

impl<const D: usize> PairList<D> {
    /// Whether a list of so many disks reserves blocks for inserted pairs.
    pub(crate) fn reserves_blocks(disk_count: usize) -> bool {
        disk_count >= FEWEST
    }

    /// Adds the reserved blocks for pairs within a tile, whose rows are counted from disk `origin`.
    pub(crate) fn reserve_inner_blocks(&mut self, origin: u32) {
        self.reserve_blocks(origin, INNER);
    }

    /// Adds the reserved blocks for pairs across the border of a tile.
    pub(crate) fn reserve_border_blocks(&mut self) {
        self.reserve_blocks(0, BORDER);
    }

    fn reserve_blocks(&mut self, origin: u32, count: usize) {
        for _ in 0..count {
            self.begin_block(Block { row_length: 1, origin, ..Block::default() });
            self.rows.resize(self.rows.len() + BLOCK, 0);
            self.pair_blocks.push(PairBlock::default());
        }
    }

    /// First and second disks of the pairs whose first disk is in the set.
    pub(crate) fn pairs_of(&self, firsts: &FastDisks) -> Vec<(u32, u32)> {
        let mut found = Vec::new();
        for (place, tile) in self.tiles.iter().enumerate() {
            let origin = place * self.tile_size;
            if !firsts.any_of(origin..origin + self.tile_size) {
                continue;
            }
            let pairs = self.blocks[tile.inner.start..tile.border.end].iter().flat_map(Block::pairs);
            let of_firsts = pairs.filter(|&pair| firsts.contains(self.first[pair]));
            found.extend(of_firsts.map(|pair| (self.first[pair], self.second[pair])));
        }
        found
    }

    /// Inserts missing pairs in the given order; `source` identifies each pair by its second disk. Returns false,
    /// without any change, if the reserved blocks have too little space.
    pub(crate) fn insert_pairs(&mut self, missing: &[(u32, u32)], source: &mut impl Source<D>) -> bool {
        // The block of each pair is chosen before anything is written.
        let mut taken = BTreeMap::new();
        let mut places = Vec::with_capacity(missing.len());
        for &pair in missing {
            let (tile, inside) = self.place_of(pair);
            let mut blocks = if inside {
                reserved_blocks(&self.tiles[tile].inner, INNER)
            } else {
                reserved_blocks(&self.tiles[tile].border, BORDER)
            };
            let free = |place: &usize| self.blocks[*place].pair_count + taken.get(place).unwrap_or(&0) < BLOCK;
            let Some(place) = blocks.find(free) else { return false };
            *taken.entry(place).or_insert(0) += 1;
            places.push(place);
        }
        let mut pair_block = PairBlock::default();
        for (missing, places) in missing.chunks(BLOCK).zip(places.chunks(BLOCK)) {
            let (first, second): (Vec<u32>, Vec<u32>) = missing.iter().copied().unzip();
            source.measure(&first, &second, &mut pair_block);
            for (k, (&pair, &place)) in missing.iter().zip(places).enumerate() {
                self.put(pair, place, (&pair_block, k));
            }
        }
        if !missing.iter().all(|&pair| self.place_of(pair).1) {
            self.connect();
        }
        true
    }

    /// The tile that stores a pair, and whether both disks are in that tile.
    fn place_of(&self, (first, second): (u32, u32)) -> (usize, bool) {
        let tile = first as usize / self.tile_size;
        (tile, tile == second as usize / self.tile_size)
    }

    /// Writes a pair to a block with free space.
    fn put(&mut self, (first, second): (u32, u32), block: usize, pair_block: (&PairBlock<D>, usize)) {
        let block = &mut self.blocks[block];
        let (place, row) = (block.pairs + block.pair_count, block.rows + block.row_count);
        block.pair_count += 1;
        block.row_count += 1;
        let origin = block.origin;
        (self.first[place], self.second[place]) = (first, second);
        (self.rows[row], self.ends[place]) = (first - origin, second - origin);
        self.pair_blocks[place / BLOCK].copy(place % BLOCK, pair_block);
    }

    /// Blocks that may hold inserted pairs.
    pub(crate) fn blocks_with_insertions(&self) -> impl Iterator<Item = usize> {
        self.tiles
            .iter()
            .flat_map(|tile| reserved_blocks(&tile.inner, INNER).chain(reserved_blocks(&tile.border, BORDER)))
    }

    /// Finds the pairs that act on each tile from other tiles.
    pub(crate) fn connect(&mut self) {
        connect(&mut self.tiles, self.tile_size, &self.blocks, (&self.first, &self.second));
        self.schedule.take(&self.tiles, |pair| {
            let second = self.second[pair] as usize;
            (second < self.first_count).then_some(second / self.tile_size)
        });
    }
}

/// The reserved blocks of a tile: the last ones of this range.
fn reserved_blocks(blocks: &Range<usize>, count: usize) -> Range<usize> {
    blocks.end - count..blocks.end
}
