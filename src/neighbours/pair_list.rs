//! Neighbour list, laid out for the hot loop: columns, divided into rows, blocks and tiles.
//!
//! ```text
//! row    pairs with the same first disk, at most LONGEST_ROW
//! block  at most BLOCK pairs, in rows of equal length
//! tile   a fixed number of disks in working order; blocks within it first, then the blocks across its border
//! ```
//!
//! Rows are sorted by length within groups of up to GROUP pairs. So all rows of a block have equal length, and the
//! inner loop has a constant trip count. The first disk is read and written once per row, and no branch is
//! mispredicted. A tile writes forces only on its own disks. Forces of border pairs on disks of other tiles are stored
//! separately and added afterwards, tile by tile. So tiles can be processed in parallel, and every sum has the order of
//! one thread.

use std::ops::Range;

use crate::neighbours::block::{BLOCK, Block, LONGEST_ROW};
use crate::neighbours::pair_block::PairBlock;
use crate::neighbours::tile_schedule::TileSchedule;
use crate::neighbours::tiles::Tile;
use crate::packing::PackingError;
use crate::parallel;
use crate::simd::prefetch::Cache;
use crate::vector::Vector;

/// Largest number of pairs in a group: few blocks are partly filled, and the disks of a group stay in the second-level
/// cache.
const GROUP: usize = 8192;

/// Fewest disks of a tile. Packings of up to this size have no border.
const LEAST_TILE: usize = 8192;

/// Layers of disks in a tile of a large packing. Few pairs cross its border, and there are enough tiles for many
/// threads.
const fn layers(dimension: usize) -> usize {
    if dimension == 2 { 32 } else { 16 }
}

/// Pairs that may touch. The index of a pair is its place: each block has [`BLOCK`] places, of which the last may be
/// vacant.
#[derive(Debug, Clone, Default)]
pub struct PairList<const D: usize> {
    /// First disk of each pair; disk 0 in a vacant place.
    pub first: Vec<u32>,
    /// Second disk of each pair; disk 0 in a vacant place.
    pub second: Vec<u32>,
    /// The pairs of each block at their anchors.
    pub(crate) pair_blocks: Vec<PairBlock<D>>,
    /// First disk of each row and second disk of each pair, counted from the origin of the block.
    pub(crate) rows: Vec<u32>,
    pub(crate) ends: Vec<u32>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) tiles: Vec<Tile>,
    /// Number of disks in a tile.
    pub(crate) tile_size: usize,
    /// Number of disks that can be first in a pair; later disks are held.
    pub(crate) first_count: usize,
    /// Whether tiles reserve blocks for inserted pairs.
    pub(crate) reserves_blocks: bool,
    /// The order in which one thread processes the tiles in a step.
    pub(crate) schedule: TileSchedule,
    arranger: Box<Arranger<D>>,
    /// Lists of single tiles built in parallel, before they are concatenated.
    parts: Vec<PairList<D>>,
}

/// A source of pairs, each identified by an index of its own.
pub(crate) trait Source<const D: usize> {
    /// Second disk of a pair.
    fn second(&self, pair: u32) -> u32;

    /// Computes the geometry of the pairs of a block; places beyond them are not used.
    fn measure(&mut self, first: &[u32], pairs: &[u32], pair_block: &mut PairBlock<D>);
}

/// Search for the pairs of a tile, disk by disk.
pub(crate) trait Search<const D: usize>: Source<D> {
    /// Appends the pairs of a first disk.
    fn find(&mut self, first: usize, pairs: &mut Vec<u32>);
}

/// Rows that are not stored yet, until their group or tile is complete.
#[derive(Debug, Clone, Default)]
pub(crate) struct Arranger<const D: usize> {
    pub group: Waiting,
    border: Waiting,
    /// Work space for the rows of the group that is closed, and for its block.
    by_length: Vec<Row>,
    pair_block: PairBlock<D>,
    /// Origin of the next blocks.
    origin: u32,
}

impl<const D: usize> Arranger<D> {
    /// Separates, from the pairs of a first disk at `begin` and after, those whose second disk is in another tile.
    fn separate_border_pairs(&mut self, first: u32, begin: usize, inside: impl Fn(u32) -> bool) {
        let Arranger { group: Waiting { pairs, .. }, border, .. } = self;
        if pairs[begin..].iter().all(|&pair| inside(pair)) {
            return;
        }
        let begin_across = border.pairs.len();
        border.pairs.extend(pairs[begin..].iter().filter(|&&pair| !inside(pair)));
        let mut kept = begin;
        for place in begin..pairs.len() {
            pairs[kept] = pairs[place];
            kept += usize::from(inside(pairs[place]));
        }
        pairs.truncate(kept);
        for part in (begin_across..border.pairs.len()).step_by(LONGEST_ROW) {
            border.rows.push(Row { first, begin: part, length: LONGEST_ROW.min(border.pairs.len() - part) });
        }
    }
}

/// A row that is not stored yet.
#[derive(Debug, Clone, Copy, Default)]
struct Row {
    first: u32,
    /// Index of its first pair among the waiting pairs.
    begin: usize,
    length: usize,
}

#[derive(Debug, Clone, Default)]
pub(crate) struct Waiting {
    /// Indices of the pairs in their source.
    pub pairs: Vec<u32>,
    rows: Vec<Row>,
}

impl Waiting {
    fn clear(&mut self) {
        self.pairs.clear();
        self.rows.clear();
    }
}

impl<const D: usize> PairList<D> {
    /// Number of places, which is the length of a column with one entry per place.
    pub fn place_count(&self) -> usize {
        self.first.len()
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.blocks.iter().map(|block| block.pair_count).sum()
    }

    /// Whether the list has no pair.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Memory that the loop reads per pair, including its second disk \[bytes\].
    pub fn pair_size(&self) -> usize {
        size_of::<PairBlock<D>>() / BLOCK + size_of::<u32>()
    }

    /// From the anchor of the second disk to that of the first along the nearest image, D \[length\].
    #[inline(always)]
    pub fn separation(&self, pair: usize) -> Vector<D> {
        self.pair_blocks[pair / BLOCK].separation.each_ref().map(|column| column[pair % BLOCK])
    }

    /// Distance of the anchors, |D| \[length\].
    #[inline(always)]
    pub fn distance(&self, pair: usize) -> f64 {
        self.pair_blocks[pair / BLOCK].distance[pair % BLOCK]
    }

    /// Overlap at the anchors, R_i + R_j − |D|, with a single rounding; negative for a gap \[length\].
    #[inline(always)]
    pub fn overlap(&self, pair: usize) -> f64 {
        self.pair_blocks[pair / BLOCK].overlap[pair % BLOCK]
    }

    /// Coefficient of the contact law for a pair \[force / length^(α−1)\].
    #[inline(always)]
    pub fn coefficient(&self, pair: usize) -> f64 {
        self.pair_blocks[pair / BLOCK].coefficient[pair % BLOCK]
    }

    /// The places that hold a pair.
    pub fn numbers(&self) -> impl Iterator<Item = usize> + use<'_, D> {
        self.blocks.iter().flat_map(Block::pairs)
    }

    /// Whether the list has several tiles. Such a list exceeds the cache and is read from memory once per step.
    #[inline(always)]
    pub(crate) fn is_long(&self) -> bool {
        self.tiles.len() > 1
    }

    /// The cache into which a later block is prefetched, if the list is long.
    #[inline(always)]
    pub(crate) fn prefetches(&self) -> Option<Cache> {
        self.is_long().then(Cache::here)
    }

    /// Overwrites the list by the pairs that a search finds; `search` makes a new one for each tile. Each pair is found
    /// from one of its disks only. Disks from `first_count` on are never first. With `reserves_blocks`, pairs can be
    /// inserted later.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(crate) fn fill<S: Search<D>>(
        &mut self,
        (disk_count, first_count): (usize, usize),
        reserves_blocks: bool,
        search: impl Fn() -> S + Sync,
    ) -> Result<(), PackingError> {
        self.first_count = first_count;
        self.reserves_blocks = reserves_blocks;
        let tile_size = Self::tile_size(disk_count);
        let disks = |place: usize| place * tile_size..disk_count.min((place + 1) * tile_size);
        self.fill_tiles(disk_count.div_ceil(tile_size), tile_size, |list, place, tile| {
            list.add_tile(disks(place), first_count, search(), tile);
        });
        // The first coincident pair in the order of the disks, independent of the storage order.
        let blocks = self.pair_blocks.iter().enumerate();
        let coincident = blocks.flat_map(|(block, pairs)| pairs.coincident().map(move |place| BLOCK * block + place));
        if let Some((first, second)) = coincident.map(|pair| (self.first[pair], self.second[pair])).min() {
            return Err(PackingError::CoincidentCentres { first: first as usize, second: second as usize });
        }
        Ok(())
    }

    /// Whether a list of so many disks has several tiles.
    pub(crate) fn are_long(disk_count: usize) -> bool {
        disk_count > Self::tile_size(disk_count)
    }

    /// Number of disks in a tile of a list of so many disks.
    fn tile_size(disk_count: usize) -> usize {
        let layer = libm::pow(disk_count as f64, 1.0 - 1.0 / D as f64);
        LEAST_TILE.max(layers(D) * layer as usize)
    }

    /// Overwrites the list tile by tile, in parallel where possible. `add` appends the blocks of one tile to a list.
    pub(crate) fn fill_tiles(
        &mut self,
        tile_count: usize,
        tile_size: usize,
        add: impl Fn(&mut PairList<D>, usize, &mut Tile) + Sync,
    ) {
        self.tile_size = tile_size;
        self.tiles.resize(tile_count, Tile::default());
        let mut tiles = std::mem::take(&mut self.tiles);
        if parallel::is_shared(tiles.len()) {
            let mut parts = std::mem::take(&mut self.parts);
            parts.resize(tiles.len(), PairList::default());
            parallel::each(tiles.iter_mut().zip(&mut parts).enumerate(), |(place, (tile, part))| {
                part.clear();
                part.reserves_blocks = self.reserves_blocks;
                add(part, place, tile);
            });
            self.concatenate(&parts, &mut tiles);
            self.parts = parts;
        } else {
            self.clear();
            for (place, tile) in tiles.iter_mut().enumerate() {
                add(self, place, tile);
                self.reserve(tile_count - place - 1, place + 1);
            }
        }
        self.tiles = tiles;
        self.connect();
    }

    /// Appends the blocks of a tile, whose first disk is `origin`. `inner` supplies the pairs within the tile, `border`
    /// the pairs across its border.
    pub(crate) fn add_blocks<S: Source<D>>(
        &mut self,
        (tile, origin): (&mut Tile, usize),
        source: &mut S,
        inner: impl FnOnce(&mut Self, &mut Arranger<D>, &mut S),
        border: impl FnOnce(&mut Self, &mut Arranger<D>, &mut S),
    ) {
        let mut arranger = std::mem::take(&mut self.arranger);
        let begin = self.blocks.len();
        arranger.origin = origin as u32;
        inner(self, &mut arranger, source);
        self.close_group(&mut arranger, source);
        if self.reserves_blocks {
            self.reserve_inner_blocks(arranger.origin);
        }
        let (middle, border_pairs) = (self.blocks.len(), self.place_count());
        arranger.origin = 0;
        border(self, &mut arranger, source);
        self.close_group(&mut arranger, source);
        if self.reserves_blocks {
            self.reserve_border_blocks();
        }
        (tile.inner, tile.border) = (begin..middle, middle..self.blocks.len());
        tile.border_pairs = border_pairs..self.place_count();
        self.arranger = arranger;
    }

    /// Appends the blocks of the next tile.
    fn add_tile<S: Search<D>>(&mut self, disks: Range<usize>, first_count: usize, mut search: S, tile: &mut Tile) {
        let firsts = disks.start..disks.end.min(first_count);
        let inner = |list: &mut Self, arranger: &mut Arranger<D>, search: &mut S| {
            for first in firsts {
                let begin = arranger.group.pairs.len();
                search.find(first, &mut arranger.group.pairs);
                let inside = |pair: u32| disks.contains(&(search.second(pair) as usize));
                arranger.separate_border_pairs(first as u32, begin, inside);
                list.add_rows(first as u32, begin, arranger, search);
            }
        };
        let border = |list: &mut Self, arranger: &mut Arranger<D>, search: &mut S| {
            let mut waiting = std::mem::take(&mut arranger.border);
            for &Row { first, begin, length } in &waiting.rows {
                let place = arranger.group.pairs.len();
                arranger.group.pairs.extend_from_slice(&waiting.pairs[begin..begin + length]);
                list.add_rows(first, place, arranger, search);
            }
            waiting.clear();
            arranger.border = waiting;
        };
        self.add_blocks((tile, disks.start), &mut search, inner, border);
    }

    fn clear(&mut self) {
        self.first.clear();
        self.second.clear();
        self.pair_blocks.clear();
        self.rows.clear();
        self.ends.clear();
        self.blocks.clear();
        self.arranger.group.clear();
        self.arranger.border.clear();
    }

    /// Makes rows from the pairs of a first disk, at `begin` and after. A group without space for a further row is
    /// closed first.
    pub(crate) fn add_rows(
        &mut self,
        first: u32,
        begin: usize,
        arranger: &mut Arranger<D>,
        source: &mut impl Source<D>,
    ) {
        let mut begin = begin;
        while begin < arranger.group.pairs.len() {
            let mut end = arranger.group.pairs.len().min(begin + LONGEST_ROW);
            if end > GROUP {
                self.close_group(arranger, source);
                (begin, end) = (0, end - begin);
            }
            arranger.group.rows.push(Row { first, begin, length: end - begin });
            begin = end;
        }
    }

    /// Stores the waiting rows as blocks, short rows first. Pairs that are not in a row yet stay waiting.
    fn close_group(&mut self, arranger: &mut Arranger<D>, source: &mut impl Source<D>) {
        let Arranger { group: Waiting { pairs, rows }, by_length, pair_block, origin, .. } = arranger;
        let Some(&Row { begin, length, .. }) = rows.last() else { return };
        sort_by_length(rows, by_length);
        let mut rest = by_length.as_slice();
        while !rest.is_empty() {
            let length = rest[0].length;
            let fits = |row: &&Row| row.length == length;
            let (block, later) = rest.split_at(rest.iter().take(BLOCK / length).take_while(fits).count());
            self.add_block((block, *origin), pairs, pair_block, source);
            rest = later;
        }
        rows.clear();
        pairs.drain(..begin + length);
    }

    /// Stores rows of equal length as a block.
    fn add_block(
        &mut self,
        (rows, origin): (&[Row], u32),
        waiting: &[u32],
        pair_block: &mut PairBlock<D>,
        source: &mut impl Source<D>,
    ) {
        let row_length = rows[0].length;
        let count = rows.len() * row_length;
        self.begin_block(Block { pair_count: count, row_count: rows.len(), row_length, origin, ..Block::default() });
        let (begin, first_row) = (self.first.len() - BLOCK, self.rows.len());
        self.rows.resize(first_row + rows.len(), 0);
        let (of_rows, first, second) =
            (&mut self.rows[first_row..], &mut self.first[begin..][..count], &mut self.second[begin..][..count]);
        let mut pair = 0;
        for (row, &Row { first: disk, begin, length }) in of_rows.iter_mut().zip(rows) {
            *row = disk - origin;
            // A row has three pairs on average, so a loop is faster than a call to copy.
            for place in 0..length {
                first[pair + place] = disk;
                second[pair + place] = waiting[begin + place];
            }
            pair += length;
        }
        source.measure(first, second, pair_block);
        pair_block.vacate(count);
        for (pair, end) in second.iter_mut().zip(&mut self.ends[begin..]) {
            *pair = source.second(*pair);
            *end = *pair - origin;
        }
        self.pair_blocks.push(pair_block.clone());
    }

    /// Begins a block with vacant places only. The caller appends its geometry.
    pub(crate) fn begin_block(&mut self, block: Block) {
        let pairs = self.first.len();
        self.blocks.push(Block { pairs, rows: self.rows.len(), ..block });
        for column in [&mut self.first, &mut self.second, &mut self.ends] {
            column.resize(pairs + BLOCK, 0);
        }
    }
}

/// Stable sort of the rows by length.
fn sort_by_length(rows: &[Row], sorted: &mut Vec<Row>) {
    let mut places = [0; LONGEST_ROW + 1];
    for row in rows {
        places[row.length] += 1;
    }
    for length in 1..=LONGEST_ROW {
        places[length] += places[length - 1];
    }
    sorted.clear();
    sorted.resize(rows.len(), Row::default());
    for &row in rows {
        let place = &mut places[row.length - 1];
        sorted[*place] = row;
        *place += 1;
    }
}
