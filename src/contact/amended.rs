//! Pairs added to a list for the few disks that went far, so that it lasts for the others.
//!
//! ```text
//! |x_i − x_j| < R_i + R_j + s     x: where a disk was listed last;  complete while no disk is farther than s/2 from there
//! ```
//!
//! In a large packing some disks in a thousand go far at every time, rattlers mostly, and a list would end with the fastest of them. In place
//! of that it gets the pairs they lack where they are now, which becomes where they were listed. Tiles keep places for such pairs: a
//! few blocks that are empty to begin with.

use std::ops::Range;

use crate::contact::measured::Measured;
use crate::contact::pair_list::{BLOCK, Block, PairList, Source};
use crate::contact::tiles::connect;
use crate::side_by_side;
use crate::vector::{Vector, dot};

/// Fewest disks of a list that keeps places: a list of fewer is made quickly, and has few disks that go far.
const FEWEST: usize = 4096;

/// Blocks of a tile that are empty to begin with: within it, and across its border.
const INNER: usize = 4;
const BORDER: usize = 2;

/// A pair to be added: its disks, and how its source names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Lacking {
    pub first: u32,
    pub second: u32,
    pub name: u32,
}

impl<const D: usize> PairList<D> {
    /// Whether a list of so many disks keeps places for pairs to come.
    pub(super) fn keeps_places(disk_count: usize) -> bool {
        disk_count >= FEWEST
    }

    /// Adds the empty blocks within a tile, whose rows are counted from disk `origin`.
    pub(super) fn add_inner_places(&mut self, origin: u32) {
        self.add_places(origin, INNER);
    }

    /// Adds the empty blocks across the border of a tile.
    pub(super) fn add_border_places(&mut self) {
        self.add_places(0, BORDER);
    }

    fn add_places(&mut self, origin: u32, count: usize) {
        for _ in 0..count {
            self.begin_block(Block { row_length: 1, origin, ..Block::default() });
            self.rows.resize(self.rows.len() + BLOCK, 0);
            self.listed.push(&Measured::default(), &[0; BLOCK]);
        }
    }

    /// Pairs that have a marked disk.
    pub(super) fn pairs_of(&self, marked: &[bool]) -> Vec<Lacking> {
        let tiles = self.tiles.iter().zip(marked.chunks(self.tile_size));
        let of_tiles = side_by_side::each(tiles, |(tile, disks)| {
            // A pair is in the tile of its first disk; only those across a border have another disk elsewhere.
            let begin = if disks.contains(&true) { tile.inner.start } else { tile.border.start };
            let pairs = self.blocks[begin..tile.border.end].iter().flat_map(Block::pairs);
            let named =
                pairs.map(|pair| Lacking { first: self.first[pair], second: self.second[pair], name: pair as u32 });
            named.filter(|pair| marked[pair.first as usize] | marked[pair.second as usize]).collect::<Vec<_>>()
        });
        of_tiles.concat()
    }

    /// Of the pairs of a wider list that have a marked disk, those that this one lacks and that are nearer than reach + `skin` where their
    /// disks were `listed`.
    pub(super) fn lacking(
        &self,
        whole: &PairList<D>,
        marked: &[bool],
        (listed, skin): (&[Vector<D>], f64),
    ) -> Vec<Lacking> {
        let mut lacking = whole.pairs_of(marked);
        lacking.retain(|&Lacking { first, second, name }| {
            let (pair, a, b) = (name as usize, listed[first as usize], listed[second as usize]);
            let anchored = whole.separation(pair);
            let apart: Vector<D> = std::array::from_fn(|d| anchored[d] + (a[d] - b[d]));
            let range = whole.distance(pair) + whole.overlap(pair) + skin;
            dot(apart, apart) < range * range
        });
        without(&mut lacking, &mut self.pairs_of(marked));
        lacking
    }

    /// Adds pairs the list lacks, in the order given. Nothing is done, and false returned, where there are not places enough.
    pub(super) fn amend(&mut self, lacking: &[Lacking], source: &mut impl Source<D>) -> bool {
        // The block each of them goes to, before anything is written.
        let mut taken = vec![0; self.blocks.len()];
        let mut places = Vec::with_capacity(lacking.len());
        for &Lacking { first, second, .. } in lacking {
            let tile = first as usize / self.tile_size;
            let inside = tile == second as usize / self.tile_size;
            let tile = &self.tiles[tile];
            let mut blocks = if inside { places_of(&tile.inner, INNER) } else { places_of(&tile.border, BORDER) };
            let free = |&place: &usize| self.blocks[place].pair_count + taken[place] < BLOCK;
            let Some(place) = blocks.find(free) else { return false };
            taken[place] += 1;
            places.push(place);
        }
        let mut measured = Measured::default();
        for (lacking, places) in lacking.chunks(BLOCK).zip(places.chunks(BLOCK)) {
            let first: Vec<u32> = lacking.iter().map(|pair| pair.first).collect();
            let names: Vec<u32> = lacking.iter().map(|pair| pair.name).collect();
            source.measure(&first, &names, &mut measured);
            for (k, (pair, &place)) in lacking.iter().zip(places).enumerate() {
                self.put(*pair, place, (&measured, k), source.kind(pair.first, pair.name));
            }
        }
        self.connect();
        true
    }

    /// Puts a pair in a block that has a place for it.
    fn put(&mut self, pair: Lacking, block: usize, measured: (&Measured<D>, usize), kind: u8) {
        let block = &mut self.blocks[block];
        let (place, row) = (block.pairs + block.pair_count, block.rows + block.row_count);
        block.pair_count += 1;
        block.row_count += 1;
        let origin = block.origin;
        (self.first[place], self.second[place]) = (pair.first, pair.second);
        (self.rows[row], self.ends[place]) = (pair.first - origin, pair.second - origin);
        self.listed.put(place, measured, kind);
    }

    /// Blocks that amending may have filled.
    pub(super) fn amended_blocks(&self) -> impl Iterator<Item = usize> {
        self.tiles.iter().flat_map(|tile| places_of(&tile.inner, INNER).chain(places_of(&tile.border, BORDER)))
    }

    /// Finds what comes to each tile from others.
    pub(super) fn connect(&mut self) {
        connect(&mut self.tiles, self.tile_size, &self.blocks, (&self.first, &self.second));
        self.turns.take(&self.tiles, |pair| {
            let second = self.second[pair] as usize;
            (second < self.first_count).then_some(second / self.tile_size)
        });
    }
}

/// The last ones of the blocks of a tile, which were empty to begin with.
fn places_of(blocks: &Range<usize>, count: usize) -> Range<usize> {
    blocks.end - count..blocks.end
}

/// Takes pairs from others that are had already, and leaves each of the rest once, sorted.
pub(super) fn without(lacking: &mut Vec<Lacking>, had: &mut [Lacking]) {
    let disks = |pair: &Lacking| (pair.first, pair.second);
    had.sort_unstable();
    lacking.sort_unstable();
    lacking.dedup_by_key(|pair| disks(pair));
    lacking.retain(|pair| had.binary_search_by_key(&disks(pair), disks).is_err());
}
