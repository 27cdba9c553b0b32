//! Tiles of a pair list, and the pairs between them.

use std::ops::Range;

use crate::neighbours::block::Block;
use crate::parallel;

/// A tile: its blocks, and the border pairs of other tiles that act on its disks.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tile {
    /// Blocks of pairs within the tile.
    pub inner: Range<usize>,
    /// Blocks of pairs whose second disk is in another tile.
    pub border: Range<usize>,
    /// Places of the pairs in `border`.
    pub border_pairs: Range<usize>,
    /// Longest run of disks that no pair across the border touches, counted from the first disk of the tile.
    pub interior: Range<usize>,
    /// Disk of this tile, tile that stores the pair, and index of the pair among the border pairs there.
    pub incoming: Vec<(u32, u32, u32)>,
}

/// Finds, for each tile, the border pairs of other tiles that act on it, and its interior.
///
/// # Shape
/// `blocks`, `first` and `second` are those of the list; tiles hold their own ranges.
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
