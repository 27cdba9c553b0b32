//! The pairs that may touch, laid out for the hot loop: columns, cut into rows, blocks and tiles.
//!
//! ```text
//! row    the pairs of one first disk, at most LONGEST_ROW of them
//! block  at most BLOCK pairs: whole rows, the short ones first
//! tile   a fixed number of disks in working order; first the blocks within it, then those across its border
//! ```
//!
//! Rows of one length lie side by side, so the loop over a row has a fixed number of turns: the first disk is read and
//! written once a row, and no branch is guessed wrong. A tile writes forces on its own disks only; what pairs across its
//! border do to the disks of other tiles is kept apart and added afterwards, tile by tile. So tiles can be
//! worked on side by side, and the order of every sum is that of one thread.

use std::ops::Range;

use crate::packing::PackingError;
use crate::side_by_side;
use crate::vector::Vector;

/// Most pairs of a block; its columns stay in the nearest cache.
pub const BLOCK: usize = 128;

/// Most pairs of a row; a disk with more has several rows.
pub const LONGEST_ROW: usize = 8;

/// Fewest disks of a tile: packings of up to so many have no border.
const LEAST_TILE: usize = 8192;

/// Pairs that may touch, as parallel columns.
#[derive(Debug, Clone, Default)]
pub struct PairList<const D: usize> {
    /// First disk of each pair.
    pub first: Vec<u32>,
    /// Second disk of each pair.
    pub second: Vec<u32>,
    /// From the anchor of the second to that of the first along the nearest image, D \[length\].
    pub separation: Vec<Vector<D>>,
    /// Distance of the anchors, |D| \[length\].
    pub distance: Vec<f64>,
    /// Overlap at the anchors, R_i + R_j − |D|, rounded once only; negative for a pair apart \[length\].
    pub overlap: Vec<f64>,
    /// Coefficient of the contact law for this pair \[force / length^(α−1)\].
    pub coefficient: Vec<f64>,
    /// First disk of each row.
    pub(super) rows: Vec<u32>,
    pub(super) blocks: Vec<Block>,
    pub(super) tiles: Vec<Tile>,
    /// Disks of a tile.
    pub(super) tile_size: usize,
    arranger: Arranger,
    /// Tiles made side by side, until they are put one after the other.
    parts: Vec<PairList<D>>,
}

/// A block: where its pairs and rows begin, and how many rows of each length it has.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub pairs: usize,
    pub pair_count: usize,
    pub rows: usize,
    pub row_counts: [u8; LONGEST_ROW],
}

/// A tile: its blocks, and what comes to its disks from others.
#[derive(Debug, Clone, Default)]
pub(super) struct Tile {
    /// Blocks of pairs within the tile.
    pub inner: Range<usize>,
    /// Blocks of pairs whose second disk is in another tile.
    pub border: Range<usize>,
    /// Pairs of `border`.
    pub border_pairs: Range<usize>,
    /// Disk of this tile, the tile that has the pair, and the pair's place among the border pairs there.
    pub incoming: Vec<(u32, u32, u32)>,
}

/// What finds the pairs of a tile, disk by disk, and measures them, block by block.
pub(super) trait Search<const D: usize> {
    /// Adds the second disks of the pairs of a first one.
    fn find(&mut self, first: usize, seconds: &mut Vec<u32>);

    /// Measures the pairs of a block; columns beyond them are not used.
    fn measure(&self, first: &[u32], second: &[u32], measured: &mut Measured<D>);
}

/// What a block of pairs has at the anchors, column by column; see [`PairList`].
pub(super) struct Measured<const D: usize> {
    pub separation: [Vector<D>; BLOCK],
    pub distance: [f64; BLOCK],
    pub overlap: [f64; BLOCK],
    pub coefficient: [f64; BLOCK],
}

/// Rows waiting for their block or for the end of their tile.
#[derive(Debug, Clone, Default)]
struct Arranger {
    block: Waiting,
    border: Waiting,
}

impl Arranger {
    /// Of the pairs of a first disk, which wait from `begin` on, sets those apart whose second disk is in another tile.
    fn set_border_apart(&mut self, first: u32, begin: usize, disks: &Range<usize>) {
        let Arranger { block: Waiting { seconds, .. }, border } = self;
        let inside = |second: u32| disks.contains(&(second as usize));
        if seconds[begin..].iter().all(|&second| inside(second)) {
            return;
        }
        let begin_across = border.seconds.len();
        border.seconds.extend(seconds[begin..].iter().filter(|&&second| !inside(second)));
        let mut kept = begin;
        for place in begin..seconds.len() {
            seconds[kept] = seconds[place];
            kept += usize::from(inside(seconds[place]));
        }
        seconds.truncate(kept);
        for part in (begin_across..border.seconds.len()).step_by(LONGEST_ROW) {
            border.rows.push((first, part, LONGEST_ROW.min(border.seconds.len() - part)));
        }
    }
}

#[derive(Debug, Clone, Default)]
struct Waiting {
    seconds: Vec<u32>,
    /// First disk, where its pairs begin, and how many there are.
    rows: Vec<(u32, usize, usize)>,
}

impl Waiting {
    fn clear(&mut self) {
        self.seconds.clear();
        self.rows.clear();
    }
}

impl<const D: usize> PairList<D> {
    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.first.len()
    }

    /// Whether no pair may touch.
    pub fn is_empty(&self) -> bool {
        self.first.is_empty()
    }

    /// Empties the list and fills it with what `search`, made anew for each tile, finds: each pair is named by one of its disks only.
    /// Disks from `first_count` on are never first.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(super) fn fill<S: Search<D>>(
        &mut self,
        disk_count: usize,
        first_count: usize,
        search: impl Fn() -> S + Sync,
    ) -> Result<(), PackingError> {
        self.clear();
        // Sixteen layers of disks: few pairs cross its border.
        let layer = (disk_count as f64).powf(1.0 - 1.0 / D as f64);
        self.tile_size = LEAST_TILE.max(16 * layer as usize);
        let tile_size = self.tile_size;
        self.tiles.resize(disk_count.div_ceil(tile_size), Tile::default());
        let mut tiles = std::mem::take(&mut self.tiles);
        let disks = |place: usize| place * tile_size..disk_count.min((place + 1) * tile_size);
        if side_by_side::is_shared(tiles.len()) {
            let mut parts = std::mem::take(&mut self.parts);
            parts.resize(tiles.len(), PairList::default());
            side_by_side::each(tiles.iter_mut().zip(&mut parts).enumerate(), |(place, (tile, part))| {
                part.clear();
                part.add_tile(disks(place), first_count, search(), tile);
            });
            self.join(&parts, &mut tiles);
            self.parts = parts;
        } else {
            for (place, tile) in tiles.iter_mut().enumerate() {
                self.add_tile(disks(place), first_count, search(), tile);
            }
        }
        self.tiles = tiles;
        let together = self.distance.iter().enumerate().filter(|&(_, &distance)| distance == 0.0);
        // The first two in the order of the disks, wherever they lie in the list.
        if let Some((first, second)) = together.map(|(pair, _)| (self.first[pair], self.second[pair])).min() {
            return Err(PackingError::CoincidentCentres { first: first as usize, second: second as usize });
        }
        for tile in 0..self.tiles.len() {
            for (place, pair) in self.tiles[tile].border_pairs.clone().enumerate() {
                let second = self.second[pair];
                self.tiles[second as usize / self.tile_size].incoming.push((second, tile as u32, place as u32));
            }
        }
        Ok(())
    }

    /// Adds the blocks of the next tile.
    fn add_tile(&mut self, disks: Range<usize>, first_count: usize, mut search: impl Search<D>, tile: &mut Tile) {
        let mut arranger = std::mem::take(&mut self.arranger);
        let inner = self.blocks.len();
        for first in disks.start..disks.end.min(first_count) {
            let begin = arranger.block.seconds.len();
            search.find(first, &mut arranger.block.seconds);
            arranger.set_border_apart(first as u32, begin, &disks);
            self.add_rows(first as u32, begin, &mut arranger.block, &search);
        }
        let waiting = arranger.block.seconds.len();
        self.close_block(&mut arranger.block, waiting, &search);
        let (border, border_pairs) = (self.blocks.len(), self.len());
        for &(first, begin, count) in &arranger.border.rows {
            let place = arranger.block.seconds.len();
            arranger.block.seconds.extend_from_slice(&arranger.border.seconds[begin..begin + count]);
            self.add_rows(first, place, &mut arranger.block, &search);
        }
        let waiting = arranger.block.seconds.len();
        self.close_block(&mut arranger.block, waiting, &search);
        arranger.border.clear();
        (tile.inner, tile.border) = (inner..border, border..self.blocks.len());
        tile.border_pairs = border_pairs..self.first.len();
        tile.incoming.clear();
        self.arranger = arranger;
    }

    /// Puts lists of one tile each one after the other.
    fn join(&mut self, parts: &[PairList<D>], tiles: &mut [Tile]) {
        let (mut pairs, mut blocks) = (0, 0);
        for (part, tile) in parts.iter().zip(tiles) {
            let rows = self.rows.len();
            self.rows.extend_from_slice(&part.rows);
            let moved = |block: &Block| Block { pairs: block.pairs + pairs, rows: block.rows + rows, ..*block };
            self.blocks.extend(part.blocks.iter().map(moved));
            let moved = |range: &Range<usize>, by: usize| range.start + by..range.end + by;
            (tile.inner, tile.border) = (moved(&tile.inner, blocks), moved(&tile.border, blocks));
            tile.border_pairs = moved(&tile.border_pairs, pairs);
            (pairs, blocks) = (pairs + part.len(), self.blocks.len());
        }
        join_column(&mut self.first, 0, parts, |part| &part.first);
        join_column(&mut self.second, 0, parts, |part| &part.second);
        join_column(&mut self.separation, [0.0; D], parts, |part| &part.separation);
        join_column(&mut self.distance, 0.0, parts, |part| &part.distance);
        join_column(&mut self.overlap, 0.0, parts, |part| &part.overlap);
        join_column(&mut self.coefficient, 0.0, parts, |part| &part.coefficient);
    }

    fn clear(&mut self) {
        self.first.clear();
        self.second.clear();
        self.separation.clear();
        self.distance.clear();
        self.overlap.clear();
        self.coefficient.clear();
        self.rows.clear();
        self.blocks.clear();
        self.arranger.block.clear();
        self.arranger.border.clear();
    }

    /// Makes rows of the pairs of a first disk, which wait from `begin` on; a block that has no place for one is closed before it.
    fn add_rows(&mut self, first: u32, begin: usize, block: &mut Waiting, search: &impl Search<D>) {
        let mut begin = begin;
        while begin < block.seconds.len() {
            let mut end = block.seconds.len().min(begin + LONGEST_ROW);
            if end > BLOCK {
                self.close_block(block, begin, search);
                (begin, end) = (0, end - begin);
            }
            block.rows.push((first, begin, end - begin));
            begin = end;
        }
    }

    /// Writes the rows that wait, with their `count` pairs, as a block, the short ones first.
    fn close_block(&mut self, block: &mut Waiting, count: usize, search: &impl Search<D>) {
        if block.rows.is_empty() {
            return;
        }
        let mut row_counts = [0u8; LONGEST_ROW];
        for &(_, _, length) in &block.rows {
            row_counts[length - 1] += 1;
        }
        let (rows, pairs) = (self.rows.len(), self.len());
        self.blocks.push(Block { pairs, pair_count: count, rows, row_counts });
        // Where the next row of each length goes, and its pairs.
        let (mut row, mut pair) = ([0; LONGEST_ROW], [0; LONGEST_ROW]);
        for length in 1..LONGEST_ROW {
            let shorter = usize::from(row_counts[length - 1]);
            row[length] = row[length - 1] + shorter;
            pair[length] = pair[length - 1] + shorter * length;
        }
        self.rows.resize(rows + block.rows.len(), 0);
        self.first.resize(pairs + count, 0);
        self.second.resize(pairs + count, 0);
        let (of_rows, first, second) = (&mut self.rows[rows..], &mut self.first[pairs..], &mut self.second[pairs..]);
        for &(disk, begin, length) in &block.rows {
            let (row, pair) = (&mut row[length - 1], &mut pair[length - 1]);
            of_rows[*row] = disk;
            *row += 1;
            // Three pairs in the mean: a copy by a call takes longer.
            for place in 0..length {
                first[*pair + place] = disk;
                second[*pair + place] = block.seconds[begin + place];
            }
            *pair += length;
        }
        let mut measured = Measured {
            separation: [[0.0; D]; BLOCK],
            distance: [0.0; BLOCK],
            overlap: [0.0; BLOCK],
            coefficient: [0.0; BLOCK],
        };
        search.measure(first, second, &mut measured);
        self.separation.extend_from_slice(&measured.separation[..count]);
        self.distance.extend_from_slice(&measured.distance[..count]);
        self.overlap.extend_from_slice(&measured.overlap[..count]);
        self.coefficient.extend_from_slice(&measured.coefficient[..count]);
        block.rows.clear();
        block.seconds.drain(..count);
    }
}

/// The column of every part, one after the other.
fn join_column<const D: usize, T: Copy + Send + Sync>(
    column: &mut Vec<T>,
    filler: T,
    parts: &[PairList<D>],
    of_part: impl Fn(&PairList<D>) -> &Vec<T>,
) {
    column.resize(parts.iter().map(PairList::len).sum(), filler);
    let mut rest = column.as_mut_slice();
    let pieces = parts.iter().map(|part| {
        let source = of_part(part);
        let (piece, after) = std::mem::take(&mut rest).split_at_mut(source.len());
        rest = after;
        (piece, source)
    });
    side_by_side::each(pieces, |(piece, source)| piece.copy_from_slice(source));
}
