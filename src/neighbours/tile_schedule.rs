//! The order in which one thread takes up tiles in a step: what lies at a border is done while both sides are still in a cache.

use crate::neighbours::tiles::Tile;

/// What is done with a tile once in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Stage {
    /// It moves, and the pairs within it are summed.
    Inside,
    /// Its pairs across the border are summed: both sides have moved.
    Border,
    /// Forces from other tiles are added: all of them are known.
    Margins,
}

/// One stage of one tile, when so many tiles have moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Step {
    last_moved: u32,
    stage: Stage,
    place: u32,
}

/// Every stage of every tile, in an order in which each finds what it needs; of a single tile the first stage alone.
#[derive(Debug, Clone, Default)]
pub(crate) struct TileSchedule(Vec<Step>);

impl TileSchedule {
    /// The schedule of these tiles. `moving` tells in which tile the second disk of a pair is, if it moves.
    pub fn take(&mut self, tiles: &[Tile], moving: impl Fn(usize) -> Option<usize>) {
        let TileSchedule(schedule) = self;
        let places = 0..tiles.len() as u32;
        schedule.clear();
        schedule.extend(places.clone().map(|place| Step { last_moved: place, stage: Stage::Inside, place }));
        if tiles.len() == 1 {
            return;
        }
        for (tile, place) in tiles.iter().zip(places.clone()) {
            let seconds = tile.border_pairs.clone().filter_map(&moving).map(|tile| tile as u32);
            schedule.push(Step { last_moved: seconds.fold(place, u32::max), stage: Stage::Border, place });
        }
        for (tile, place) in tiles.iter().zip(places) {
            let known = |place: u32| schedule[tiles.len() + place as usize].last_moved;
            let last_moved = tile.incoming.iter().fold(known(place), |last, &(_, from, _)| last.max(known(from)));
            schedule.push(Step { last_moved, stage: Stage::Margins, place });
        }
        schedule.sort_unstable();
    }

    /// Stages and places of the tiles, one after the other.
    pub fn iter(&self) -> impl Iterator<Item = (Stage, usize)> {
        self.0.iter().map(|turn| (turn.stage, turn.place as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of tiles, each with pairs to the next, the last one of disks that do not move; pairs of tile t are 10 t to 10 t + 9.
    fn ring(count: usize) -> Vec<Tile> {
        let tile = |place: usize| {
            let before = (place + count - 1) % count;
            let border_pairs = if place + 1 < count { 10 * place..10 * place + 10 } else { 0..0 };
            Tile { border_pairs, incoming: vec![(0, before as u32, 0)], ..Tile::default() }
        };
        (0..count).map(tile).collect()
    }

    #[test]
    fn every_stage_finds_what_it_needs_and_comes_soon() {
        let count = 9;
        let tiles = ring(count);
        let next = |pair: usize| Some(pair / 10 + 1).filter(|&next| next + 1 < count);
        let mut schedule = TileSchedule::default();
        schedule.take(&tiles, next);
        let order: Vec<_> = schedule.iter().collect();
        assert_eq!(order.len(), 3 * count);
        let at =
            |stage, place| order.iter().position(|&turn| turn == (stage, place)).expect("every stage of every tile");
        for place in 0..count {
            assert!(at(Stage::Inside, place) < at(Stage::Border, place));
            assert!(at(Stage::Border, place) < at(Stage::Margins, place));
            if place + 2 < count {
                assert!(at(Stage::Inside, place + 1) < at(Stage::Border, place));
                assert!(at(Stage::Border, place) < at(Stage::Margins, place + 1));
            }
            if place + 3 < count {
                assert!(at(Stage::Border, place) < at(Stage::Inside, place + 2), "soon: no tile later than it must");
            }
        }
        schedule.take(&ring(1), |_| None);
        assert_eq!(schedule.iter().collect::<Vec<_>>(), [(Stage::Inside, 0)]);
    }
}
