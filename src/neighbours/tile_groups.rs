//! A tile group by group: disks move just before the first group that has them and are looked at when no later one has, so that of a tile
//! that is larger than the second cache each part is read from farther away once a step.

use std::ops::Range;

use crate::neighbours::pair_list::Block;
use crate::neighbours::tiles::Tile;
use crate::parallel;

/// A group of pairs within a tile. Blocks and disks are counted from the first ones of the tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Pass {
    /// The block after its last one.
    pub end: usize,
    /// Disks from this one on are in no pair so far.
    pub begun: usize,
    /// Disks before this one are in no later pair, but for those that were added.
    pub done: usize,
}

impl Tile {
    /// Its passes, and what is left: the pairs that were added, and disks without a pair.
    pub fn all_passes(&self) -> impl Iterator<Item = Pass> {
        let rest = Pass { end: self.inner.len(), begun: usize::MAX, done: usize::MAX };
        self.passes.iter().copied().chain([rest])
    }

    /// Blocks of each group within the tile, and among which disks theirs are, the first of the tile being `origin`; last the pairs that were
    /// added, or all where there are no passes.
    pub fn groups(&self, origin: usize) -> impl Iterator<Item = (Range<usize>, Range<usize>)> {
        let (mut begin, mut least) = (self.inner.start, origin);
        self.all_passes().map(move |pass| {
            let end = self.inner.start + pass.end;
            let group = (begin..end, least..origin.saturating_add(pass.begun));
            // The last one, and the rest, may have any.
            (begin, least) = (end, if pass.done == usize::MAX { origin } else { origin + pass.done });
            group
        })
    }

    /// Blocks of pairs that were added.
    pub fn added(&self) -> Range<usize> {
        self.passes.last().map_or(0..0, |pass| self.inner.start + pass.end..self.inner.end)
    }

    /// These disks in runs, but for those of added pairs.
    pub fn runs(&self, disks: Range<usize>) -> impl Iterator<Item = Range<usize>> {
        let before = |end: usize| self.amended.partition_point(|&disk| (disk as usize) < end);
        let between = &self.amended[before(disks.start)..before(disks.end)];
        let ends = between.iter().map(|&disk| disk as usize).chain([disks.end]);
        let runs = ends.scan(disks.start, |begin, end| Some(std::mem::replace(begin, end + 1)..end));
        runs.filter(|run| !run.is_empty())
    }

    /// Those of these disks that are in added pairs.
    pub fn amended_of(&self, disks: Range<usize>) -> impl Iterator<Item = usize> {
        self.amended.iter().map(|&disk| disk as usize).filter(move |disk| disks.contains(disk))
    }
}

/// Finds the passes of tiles, if there are several.
///
/// # Shape
/// `blocks`, `first` and `second` are those of the list; tiles know their own.
pub(crate) fn find_passes(tiles: &mut [Tile], blocks: &[Block], (first, second): (&[u32], &[u32]), tile_size: usize) {
    let is_long = tiles.len() > 1;
    parallel::each(tiles.iter_mut().enumerate(), |(place, tile)| {
        tile.passes.clear();
        if !is_long {
            return;
        }
        let origin = place * tile_size;
        let mut end = 0;
        for group in blocks[tile.inner.clone()].chunk_by(|block, _| !block.ends_group) {
            end += group.len();
            if group.last().is_some_and(|block| block.ends_group) {
                let disks = group.iter().flat_map(Block::pairs).flat_map(|pair| [first[pair], second[pair]]);
                let (least, most) = disks.fold((u32::MAX, 0), |(least, most), disk| (least.min(disk), most.max(disk)));
                let begun = tile.passes.last().map_or(0, |pass| pass.begun).max(most as usize + 1 - origin);
                tile.passes.push(Pass { end, begun, done: least as usize - origin });
            }
        }
        // What a group has first is where those before it are done.
        let mut later = usize::MAX;
        for pass in tile.passes.iter_mut().rev() {
            (pass.done, later) = (later, later.min(pass.done));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_all_disks_but_those_of_added_pairs() {
        let tile = Tile { amended: vec![0, 3, 4, 9, 12], ..Tile::default() };
        for disks in [0..13, 0..0, 3..5, 5..9, 1..12, 12..13, 13..20] {
            let runs: Vec<Range<usize>> = tile.runs(disks.clone()).collect();
            assert!(runs.iter().all(|run| !run.is_empty()));
            let mut all: Vec<usize> = runs.into_iter().flatten().collect();
            assert!(all.is_sorted() && !all.iter().any(|&disk| tile.amended.contains(&(disk as u32))));
            all.extend(tile.amended_of(disks.clone()));
            all.sort_unstable();
            assert_eq!(all, disks.collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_pass_has_begun_what_it_needs_and_done_what_no_later_one_has() {
        // Two tiles of ten disks; in the first one three groups and a block of added pairs, in the second one nothing.
        let groups = [vec![(0, 2), (1, 4)], vec![(2, 3), (3, 4)], vec![(4, 9), (6, 7)], vec![(1, 8)]];
        let pairs: Vec<(u32, u32)> = groups.concat();
        let (first, second): (Vec<u32>, Vec<u32>) = pairs.into_iter().unzip();
        let mut blocks = Vec::new();
        for (number, group) in groups.iter().enumerate() {
            // A group has a block a pair.
            for last in 1..=group.len() {
                let ends_group = number < 3 && last == group.len();
                blocks.push(Block { pairs: blocks.len(), pair_count: 1, ends_group, ..Block::default() });
            }
        }
        let mut tiles = [Tile { inner: 0..7, ..Tile::default() }, Tile { inner: 7..7, ..Tile::default() }];
        find_passes(&mut tiles, &blocks, (&first, &second), 10);
        let expected = [(2, 5, 2), (4, 5, 4), (6, 10, usize::MAX)];
        assert_eq!(tiles[0].passes, expected.map(|(end, begun, done)| Pass { end, begun, done }));
        assert_eq!((tiles[0].added(), tiles[1].passes.as_slice(), tiles[1].added()), (6..7, [].as_slice(), 0..0));
        let groups: Vec<_> = tiles[0].groups(100).collect();
        assert_eq!(groups, [(0..2, 100..105), (2..4, 102..105), (4..6, 104..110), (6..7, 100..usize::MAX)]);
        for (of_group, disks) in groups {
            let pairs = blocks[of_group].iter().flat_map(Block::pairs);
            let with_disks = pairs.flat_map(|pair| [first[pair], second[pair]]);
            assert!(with_disks.map(|disk| disk as usize + 100).all(|disk| disks.contains(&disk)));
        }
        assert_eq!(tiles[1].groups(110).collect::<Vec<_>>(), [(7..7, 110..usize::MAX)]);
        find_passes(&mut tiles[..1], &blocks, (&first, &second), 10);
        assert_eq!(tiles[0].passes, []);
    }
}
