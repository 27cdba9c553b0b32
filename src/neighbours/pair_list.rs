//! The pairs that may touch, laid out for the hot loop: columns, cut into rows, blocks and tiles.
//!
//! ```text
//! row    the pairs of one first disk, at most LONGEST_ROW of them
//! block  at most BLOCK pairs: rows of one length
//! tile   a fixed number of disks in working order; first the blocks within it, then those across its border
//! ```
//!
//! Rows are sorted by length over groups of up to GROUP pairs, so the loop over the rows of a block has a fixed number of schedule: the
//! first disk is read and written once a row, and no branch is guessed wrong. A tile writes forces on its own disks only; what pairs across its
//! border do to the disks of other tiles is kept apart and added afterwards, tile by tile. So tiles can be
//! worked on side by side, and the order of every sum is that of one thread.

use std::ops::Range;

use crate::neighbours::block::{BLOCK, Block, LONGEST_ROW};
use crate::neighbours::pair_block::PairBlock;
use crate::neighbours::tile_schedule::TileSchedule;
use crate::neighbours::tiles::Tile;
use crate::packing::PackingError;
use crate::parallel;
use crate::simd::prefetch::Cache;
use crate::vector::Vector;

/// Most pairs of a group: few blocks are not full, and its disks stay in the second cache.
const GROUP: usize = 8192;

/// Fewest disks of a tile: packings of up to so many have no border.
const LEAST_TILE: usize = 8192;

/// Layers of disks in a tile of a large packing: few pairs cross its border, and there is a tile for each of many threads.
const fn layers(dimension: usize) -> usize {
    if dimension == 2 { 32 } else { 16 }
}

/// Pairs that may touch. A pair bears the number of its place: block after block has [`BLOCK`] of them, the last of which may be vacant.
#[derive(Debug, Clone, Default)]
pub struct PairList<const D: usize> {
    /// First disk of each pair; the first of all in a vacant place.
    pub first: Vec<u32>,
    /// Second disk of each pair; the first of all in a vacant place.
    pub second: Vec<u32>,
    /// The pairs of each block at their anchors.
    pub(crate) pair_blocks: Vec<PairBlock<D>>,
    /// First disk of each row and second disk of each pair, counted from the origin of the block.
    pub(crate) rows: Vec<u32>,
    pub(crate) ends: Vec<u32>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) tiles: Vec<Tile>,
    /// Disks of a tile.
    pub(crate) tile_size: usize,
    /// Disks from this one on are never first: they do not move.
    pub(crate) first_count: usize,
    /// Whether tiles have places for pairs to come.
    pub(crate) keeps_places: bool,
    /// What one thread does with the tiles in a step.
    pub(crate) schedule: TileSchedule,
    arranger: Box<Arranger<D>>,
    /// Tiles made side by side, until they are put one after the other.
    parts: Vec<PairList<D>>,
}

/// Where pairs come from, each under a number of its own.
pub(crate) trait Source<const D: usize> {
    /// Second disk of a pair.
    fn second(&self, pair: u32) -> u32;

    /// Measures the pairs of a block; columns beyond them are not used.
    fn measure(&mut self, first: &[u32], pairs: &[u32], measured: &mut PairBlock<D>);
}

/// What finds the pairs of a tile, disk by disk.
pub(crate) trait Search<const D: usize>: Source<D> {
    /// Adds the pairs of a first disk.
    fn find(&mut self, first: usize, pairs: &mut Vec<u32>);
}

/// Rows waiting for the end of their group or of their tile.
#[derive(Debug, Clone, Default)]
pub(crate) struct Arranger<const D: usize> {
    pub group: Waiting,
    border: Waiting,
    /// Room for the rows of the group that is being closed, and for its block.
    by_length: Vec<Row>,
    measured: PairBlock<D>,
    /// Origin of the blocks that are made.
    origin: u32,
}

impl<const D: usize> Arranger<D> {
    /// Of the pairs of a first disk, which wait from `begin` on, sets those apart whose second disk is in another tile.
    fn set_border_apart(&mut self, first: u32, begin: usize, inside: impl Fn(u32) -> bool) {
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

/// A row that waits.
#[derive(Debug, Clone, Copy, Default)]
struct Row {
    first: u32,
    /// Where its pairs wait.
    begin: usize,
    length: usize,
}

#[derive(Debug, Clone, Default)]
pub(crate) struct Waiting {
    /// As their source numbers them.
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
    /// Number of places; a column with one entry a pair is as long.
    pub fn place_count(&self) -> usize {
        self.first.len()
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.blocks.iter().map(|block| block.pair_count).sum()
    }

    /// Whether there is no pair.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What the loop reads of a pair, its second disk included \[bytes\].
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

    /// Overlap at the anchors, R_i + R_j − |D|, rounded once only; negative for a pair apart \[length\].
    #[inline(always)]
    pub fn overlap(&self, pair: usize) -> f64 {
        self.pair_blocks[pair / BLOCK].overlap[pair % BLOCK]
    }

    /// Coefficient of the contact law for a pair \[force / length^(α−1)\].
    #[inline(always)]
    pub fn coefficient(&self, pair: usize) -> f64 {
        self.pair_blocks[pair / BLOCK].coefficient[pair % BLOCK]
    }

    /// The places that have a pair.
    pub fn numbers(&self) -> impl Iterator<Item = usize> + use<'_, D> {
        self.blocks.iter().flat_map(Block::pairs)
    }

    /// Whether it has several tiles: then it is far from the processor, and read once a step.
    #[inline(always)]
    pub(crate) fn is_long(&self) -> bool {
        self.tiles.len() > 1
    }

    /// Where a later block is asked to while one is worked on, if the list is long.
    #[inline(always)]
    pub(crate) fn prefetches(&self) -> Option<Cache> {
        self.is_long().then(Cache::here)
    }

    /// Empties the list and fills it with what `search`, made anew for each tile, finds: each pair is named by one of its disks only.
    /// Disks from `first_count` on are never first. A list that `keeps_places` may be amended.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(crate) fn fill<S: Search<D>>(
        &mut self,
        (disk_count, first_count): (usize, usize),
        keeps_places: bool,
        search: impl Fn() -> S + Sync,
    ) -> Result<(), PackingError> {
        self.first_count = first_count;
        self.keeps_places = keeps_places;
        let tile_size = Self::tile_size(disk_count);
        let disks = |place: usize| place * tile_size..disk_count.min((place + 1) * tile_size);
        self.fill_tiles(disk_count.div_ceil(tile_size), tile_size, |list, place, tile| {
            list.add_tile(disks(place), first_count, search(), tile);
        });
        // The first two in the order of the disks, wherever they lie in the list.
        let blocks = self.pair_blocks.iter().enumerate();
        let coincident = blocks.flat_map(|(block, pairs)| pairs.coincident().map(move |place| BLOCK * block + place));
        if let Some((first, second)) = coincident.map(|pair| (self.first[pair], self.second[pair])).min() {
            return Err(PackingError::CoincidentCentres { first: first as usize, second: second as usize });
        }
        Ok(())
    }

    /// Whether lists of so many disks are long.
    pub(crate) fn are_long(disk_count: usize) -> bool {
        disk_count > Self::tile_size(disk_count)
    }

    /// Disks of a tile of a list of so many.
    fn tile_size(disk_count: usize) -> usize {
        let layer = libm::pow(disk_count as f64, 1.0 - 1.0 / D as f64);
        LEAST_TILE.max(layers(D) * layer as usize)
    }

    /// Empties the list and fills it tile by tile, perhaps side by side: `add` adds the blocks of one to a list.
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
                part.keeps_places = self.keeps_places;
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

    /// Adds the blocks of a tile, which begins with disk `origin`: what `inner` puts in line within it, then what `border` puts in
    /// line across its border.
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
        if self.keeps_places {
            self.add_inner_places(arranger.origin);
        }
        let (middle, border_pairs) = (self.blocks.len(), self.place_count());
        arranger.origin = 0;
        border(self, &mut arranger, source);
        self.close_group(&mut arranger, source);
        if self.keeps_places {
            self.add_border_places();
        }
        (tile.inner, tile.border) = (begin..middle, middle..self.blocks.len());
        tile.border_pairs = border_pairs..self.place_count();
        self.arranger = arranger;
    }

    /// Adds the blocks of the next tile.
    fn add_tile<S: Search<D>>(&mut self, disks: Range<usize>, first_count: usize, mut search: S, tile: &mut Tile) {
        let firsts = disks.start..disks.end.min(first_count);
        let inner = |list: &mut Self, arranger: &mut Arranger<D>, search: &mut S| {
            for first in firsts {
                let begin = arranger.group.pairs.len();
                search.find(first, &mut arranger.group.pairs);
                let inside = |pair: u32| disks.contains(&(search.second(pair) as usize));
                arranger.set_border_apart(first as u32, begin, inside);
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

    /// Makes rows of the pairs of a first disk, which wait from `begin` on; a group that has no place for one is closed before it.
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

    /// Writes the rows that wait as blocks, the short ones first; pairs that are not in a row yet go on waiting.
    fn close_group(&mut self, arranger: &mut Arranger<D>, source: &mut impl Source<D>) {
        let Arranger { group: Waiting { pairs, rows }, by_length, measured, origin, .. } = arranger;
        let Some(&Row { begin, length, .. }) = rows.last() else { return };
        sort_by_length(rows, by_length);
        let mut rest = by_length.as_slice();
        while !rest.is_empty() {
            let length = rest[0].length;
            let fits = |row: &&Row| row.length == length;
            let (block, later) = rest.split_at(rest.iter().take(BLOCK / length).take_while(fits).count());
            self.add_block((block, *origin), pairs, measured, source);
            rest = later;
        }
        rows.clear();
        pairs.drain(..begin + length);
    }

    /// Writes rows of one length as a block.
    fn add_block(
        &mut self,
        (rows, origin): (&[Row], u32),
        waiting: &[u32],
        measured: &mut PairBlock<D>,
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
            // Three pairs in the mean: a copy by a call takes longer.
            for place in 0..length {
                first[pair + place] = disk;
                second[pair + place] = waiting[begin + place];
            }
            pair += length;
        }
        source.measure(first, second, measured);
        measured.vacate(count);
        for (pair, end) in second.iter_mut().zip(&mut self.ends[begin..]) {
            *pair = source.second(*pair);
            *end = *pair - origin;
        }
        self.pair_blocks.push(measured.clone());
    }

    /// Begins a block, all of whose places are vacant; what they have at the anchors is still to be added.
    pub(crate) fn begin_block(&mut self, block: Block) {
        let pairs = self.first.len();
        self.blocks.push(Block { pairs, rows: self.rows.len(), ..block });
        for column in [&mut self.first, &mut self.second, &mut self.ends] {
            column.resize(pairs + BLOCK, 0);
        }
    }
}

/// Rows in the order of their lengths, those of one length as they were.
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
