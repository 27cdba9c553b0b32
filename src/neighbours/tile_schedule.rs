//! Tile schedule: the order in which one thread processes the tiles in a step. A border is processed while both sides
//! are still in cache.

use crate::neighbours::tiles::Tile;

/// Stage of the work on a tile in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Stage {
    /// The disks of the tile move, and the forces of pairs within it are summed.
    Inside,
    /// Forces of pairs across the border are summed; both sides have moved.
    Border,
    /// Forces from other tiles are added; all of them have been computed.
    Margins,
}

/// One stage of one tile, and the last tile that must have moved before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Step {
    last_moved: u32,
    stage: Stage,
    place: u32,
}

/// Every stage of every tile, ordered by their dependencies; for a single tile only the first stage.
#[derive(Debug, Clone, Default)]
pub(crate) struct TileSchedule(Vec<Step>);

impl TileSchedule {
    /// Computes the schedule of these tiles. `moving` returns the tile of the second disk of a pair, if that disk is
    /// mobile.
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

    /// Stage and tile index, one after the other.
    pub fn iter(&self) -> impl Iterator<Item = (Stage, usize)> {
        self.0.iter().map(|step| (step.stage, step.place as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of tiles, each with pairs to the next one; the last tile has held disks only. Tile t has the pairs 10 t
    /// to 10 t + 9.
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
            |stage, place| order.iter().position(|&step| step == (stage, place)).expect("every stage of every tile");
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
