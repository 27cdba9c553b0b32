//! Tiles of a pair list, and what lies between them.

use std::ops::Range;

use crate::neighbours::block::Block;
use crate::parallel;

/// A tile: its blocks, and what comes to its disks from others.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tile {
    /// Blocks of pairs within the tile.
    pub inner: Range<usize>,
    /// Blocks of pairs whose second disk is in another tile.
    pub border: Range<usize>,
    /// Pairs of `border`.
    pub border_pairs: Range<usize>,
    /// Disks of the tile, counted from its first one, that no pair across its border touches: the longest run of them.
    pub interior: Range<usize>,
    /// Disk of this tile, the tile that has the pair, and the pair's place among the border pairs there.
    pub incoming: Vec<(u32, u32, u32)>,
}

/// Finds what comes to each tile from others, and what lies inside of it.
///
/// # Shape
/// `blocks`, `first` and `second` are those of the list; tiles know their own.
pub(crate) fn connect(tiles: &mut [Tile], tile_size: usize, blocks: &[Block], (first, second): (&[u32], &[u32])) {
    tiles.iter_mut().for_each(|tile| tile.incoming.clear());
    for tile in 0..tiles.len() {
        let begin = tiles[tile].border_pairs.start;
        for pair in blocks[tiles[tile].border.clone()].iter().flat_map(Block::pairs) {
            let second = second[pair];
            tiles[second as usize / tile_size].incoming.push((second, tile as u32, (pair - begin) as u32));
        }
    }
    parallel::each(tiles.iter_mut().enumerate(), |(place, tile)| {
        let own = blocks[tile.border.clone()].iter().flat_map(Block::pairs).map(|pair| &first[pair]);
        let mut is_touched = vec![false; tile_size];
        for disk in own.chain(tile.incoming.iter().map(|(disk, ..)| disk)) {
            is_touched[*disk as usize - place * tile_size] = true;
        }
        let mut begin = 0;
        tile.interior = 0..0;
        for run in is_touched.split(|&touched| touched) {
            if run.len() > tile.interior.len() {
                tile.interior = begin..begin + run.len();
            }
            begin += run.len() + 1;
        }
    });
}
