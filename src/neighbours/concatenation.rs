//! Concatenation of the pair lists of several tiles, and reservation of memory.

use std::ops::Range;

use crate::neighbours::block::Block;
use crate::neighbours::pair_list::PairList;
use crate::neighbours::tiles::Tile;
use crate::parallel;

impl<const D: usize> PairList<D> {
    /// Reserves memory for `tiles` further tiles, estimated from the `done` tiles. Without it a growing column is
    /// copied repeatedly.
    pub(crate) fn reserve(&mut self, tiles: usize, done: usize) {
        // A reserve of 1/16, for tiles with more pairs than the others.
        let more = |count: usize| (count + count / 16) * tiles / done;
        let (pairs, rows, blocks) = (more(self.place_count()), more(self.rows.len()), more(self.blocks.len()));
        for column in [&mut self.first, &mut self.second, &mut self.ends] {
            column.reserve(pairs);
        }
        self.rows.reserve(rows);
        self.blocks.reserve(blocks);
        self.pair_blocks.reserve(blocks);
    }

    /// Overwrites the list by the concatenation of lists of one tile each.
    pub(crate) fn concatenate(&mut self, parts: &[PairList<D>], tiles: &mut [Tile]) {
        self.rows.clear();
        self.blocks.clear();
        let (mut pairs, mut blocks) = (0, 0);
        for (part, tile) in parts.iter().zip(tiles) {
            let rows = self.rows.len();
            self.rows.extend_from_slice(&part.rows);
            let moved = |block: &Block| Block { pairs: block.pairs + pairs, rows: block.rows + rows, ..*block };
            self.blocks.extend(part.blocks.iter().map(moved));
            let moved = |range: &Range<usize>, by: usize| range.start + by..range.end + by;
            (tile.inner, tile.border) = (moved(&tile.inner, blocks), moved(&tile.border, blocks));
            tile.border_pairs = moved(&tile.border_pairs, pairs);
            (pairs, blocks) = (pairs + part.place_count(), self.blocks.len());
        }
        concatenate_column(&mut self.first, parts, |part| &part.first);
        concatenate_column(&mut self.second, parts, |part| &part.second);
        concatenate_column(&mut self.ends, parts, |part| &part.ends);
        let begins = parts.iter().scan(0, |blocks, part| {
            *blocks += part.blocks.len();
            Some(*blocks - part.blocks.len())
        });
        let begins: Vec<usize> = begins.collect();
        parallel::fill(&mut self.pair_blocks, self.blocks.len(), |block| {
            let part = begins.partition_point(|&begin| begin <= block) - 1;
            parts[part].pair_blocks[block - begins[part]].clone()
        });
    }
}

/// Overwrites a column by the concatenated columns of all parts.
fn concatenate_column<const D: usize, T: Copy + Default + Send + Sync>(
    column: &mut Vec<T>,
    parts: &[PairList<D>],
    of_part: impl Fn(&PairList<D>) -> &Vec<T>,
) {
    let count = parts.iter().map(PairList::place_count).sum();
    if column.capacity() < count {
        // The operating system supplies zero pages on first access, so each copying thread is the first to access its
        // part. The reserve of a quarter is for the next list.
        *column = vec![T::default(); count + count / 4];
    }
    column.resize(count, T::default());
    let mut rest = column.as_mut_slice();
    let pieces = parts.iter().map(|part| {
        let source = of_part(part);
        let (piece, after) = std::mem::take(&mut rest).split_at_mut(source.len());
        rest = after;
        (piece, source)
    });
    parallel::each(pieces, |(piece, source)| piece.copy_from_slice(source));
}
