//! Pairs added to a list for the few disks that went far, so that it lasts for the others.
//!
//! ```text
//! |x_i − x_j| < R_i + R_j + s     x: where a disk was listed last;  complete while no disk is farther than s/2 from there
//! ```
//!
//! In a large packing some disks in a thousand go far at every time, rattlers mostly, and a list would end with the fastest of them. In place
//! of that it gets the pairs they lack where they are now, which becomes where they were listed. Tiles keep places for such pairs: a
//! few blocks that are empty to begin with.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::neighbours::block::{BLOCK, Block};
use crate::neighbours::fast_disks::FastDisks;
use crate::neighbours::pair_block::PairBlock;
use crate::neighbours::pair_list::{PairList, Source};
use crate::neighbours::tiles::connect;

/// Fewest disks of a list that keeps places: a list of fewer is made quickly, and has few disks that go far.
const FEWEST: usize = 4096;

/// Blocks of a tile that are empty to begin with: within it, and across its border.
const INNER: usize = 4;
const BORDER: usize = 2;

impl<const D: usize> PairList<D> {
    /// Whether a list of so many disks keeps places for pairs to come.
    pub(crate) fn keeps_places(disk_count: usize) -> bool {
        disk_count >= FEWEST
    }

    /// Adds the empty blocks within a tile, whose rows are counted from disk `origin`.
    pub(crate) fn add_inner_places(&mut self, origin: u32) {
        self.add_places(origin, INNER);
    }

    /// Adds the empty blocks across the border of a tile.
    pub(crate) fn add_border_places(&mut self) {
        self.add_places(0, BORDER);
    }

    fn add_places(&mut self, origin: u32, count: usize) {
        for _ in 0..count {
            self.begin_block(Block { row_length: 1, origin, ..Block::default() });
            self.rows.resize(self.rows.len() + BLOCK, 0);
            self.pair_blocks.push(PairBlock::default());
        }
    }

    /// First and second disks of the pairs that have one of these as the first.
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

    /// Adds pairs the list lacks, in the order given, of a source that names each by its second disk. Nothing is done, and false returned,
    /// where there are not places enough.
    pub(crate) fn amend(&mut self, missing: &[(u32, u32)], source: &mut impl Source<D>) -> bool {
        // The block each of them goes to, before anything is written.
        let mut taken = BTreeMap::new();
        let mut places = Vec::with_capacity(missing.len());
        for &pair in missing {
            let (tile, inside) = self.place_of(pair);
            let mut blocks = if inside {
                places_of(&self.tiles[tile].inner, INNER)
            } else {
                places_of(&self.tiles[tile].border, BORDER)
            };
            let free = |place: &usize| self.blocks[*place].pair_count + taken.get(place).unwrap_or(&0) < BLOCK;
            let Some(place) = blocks.find(free) else { return false };
            *taken.entry(place).or_insert(0) += 1;
            places.push(place);
        }
        let mut measured = PairBlock::default();
        for (missing, places) in missing.chunks(BLOCK).zip(places.chunks(BLOCK)) {
            let (first, second): (Vec<u32>, Vec<u32>) = missing.iter().copied().unzip();
            source.measure(&first, &second, &mut measured);
            for (k, (&pair, &place)) in missing.iter().zip(places).enumerate() {
                self.put(pair, place, (&measured, k));
            }
        }
        if !missing.iter().all(|&pair| self.place_of(pair).1) {
            self.connect();
        }
        true
    }

    /// The tile that has a pair, and whether within it.
    fn place_of(&self, (first, second): (u32, u32)) -> (usize, bool) {
        let tile = first as usize / self.tile_size;
        (tile, tile == second as usize / self.tile_size)
    }

    /// Puts a pair in a block that has a place for it.
    fn put(&mut self, (first, second): (u32, u32), block: usize, measured: (&PairBlock<D>, usize)) {
        let block = &mut self.blocks[block];
        let (place, row) = (block.pairs + block.pair_count, block.rows + block.row_count);
        block.pair_count += 1;
        block.row_count += 1;
        let origin = block.origin;
        (self.first[place], self.second[place]) = (first, second);
        (self.rows[row], self.ends[place]) = (first - origin, second - origin);
        self.pair_blocks[place / BLOCK].copy(place % BLOCK, measured);
    }

    /// Blocks that amending may have filled.
    pub(crate) fn blocks_with_insertions(&self) -> impl Iterator<Item = usize> {
        self.tiles.iter().flat_map(|tile| places_of(&tile.inner, INNER).chain(places_of(&tile.border, BORDER)))
    }

    /// Finds what comes to each tile from others.
    pub(crate) fn connect(&mut self) {
        connect(&mut self.tiles, self.tile_size, &self.blocks, (&self.first, &self.second));
        self.schedule.take(&self.tiles, |pair| {
            let second = self.second[pair] as usize;
            (second < self.first_count).then_some(second / self.tile_size)
        });
    }
}

/// The last ones of the blocks of a tile, which were empty to begin with.
fn places_of(blocks: &Range<usize>, count: usize) -> Range<usize> {
    blocks.end - count..blocks.end
}
