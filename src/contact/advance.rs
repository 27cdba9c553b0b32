//! A step and the forces after it, tile by tile: what a tile moves is still in the near cache when its forces are summed, and its
//! forces are when the relaxer looks at them. On one thread the pairs across a border follow as soon as both sides have moved.
//!
//! The bits of positions, velocities and forces are those of the same work done array by array.

use std::iter::repeat_with;

use crate::contact::forces::{Across, Kernel, Task, add_incoming, sweep_border, sweep_inner};
use crate::contact::pair_list::PairList;
use crate::contact::turns::Stage;
use crate::side_by_side;

/// What moves, and what acts on it.
pub struct Movers<'a, T, const D: usize> {
    /// Velocities of the mobile disks \[length / time\].
    pub velocities: &'a mut [[T; D]],
    /// Displacements of all disks \[length\].
    pub displacements: &'a mut [[T; D]],
    /// Forces on all disks, before the step and then after it \[force\].
    pub forces: &'a mut [[T; D]],
}

/// Moves all mobile disks by `kick` (forces, velocities, displacements of some of them) and evaluates the forces where they then
/// are; the list must hold there. What `kick` returned for each tile, and what `look` (forces, velocities) returned for each part of
/// the mobile disks, in a fixed order.
///
/// # Accuracy
/// The bits of `kick` on whole arrays and the forces of the kernel after it.
pub(super) fn advance<const D: usize, K: Kernel<D>, M: Send, P: Send>(
    kernel: &K,
    pairs: &PairList<D>,
    movers: Movers<'_, K::Number, D>,
    across: &mut Across<K::Number, D>,
    kick: impl Fn(&[[K::Number; D]], &mut [[K::Number; D]], &mut [[K::Number; D]]) -> M + Send + Sync,
    look: impl Fn(&[[K::Number; D]], &[[K::Number; D]]) -> P + Send + Sync,
) -> (Vec<M>, Vec<P>) {
    let Movers { velocities, displacements, forces } = movers;
    let (tiles, size) = (pairs.tiles.as_slice(), pairs.tile_size);
    let inside = |place: usize, displacements: &mut [[_; D]], forces: &mut [[_; D]], velocities: &mut [[_; D]]| {
        let (tile, mobile) = (&tiles[place], velocities.len());
        let kicked = kick(&forces[..mobile], velocities, &mut displacements[..mobile]);
        let offset = (place * size) as u32;
        let task = Task { kernel, pairs, displacements: (displacements, offset), tile, offset };
        sweep_inner(&task, forces);
        let (begin, end) = (tile.interior.start.min(mobile), tile.interior.end.min(mobile));
        (kicked, look(&forces[begin..end], &velocities[begin..end]))
    };
    let border = |place: usize, displacements: &[[_; D]], forces: &mut [[_; D]], across: &mut [[_; D]]| {
        let (tile, offset) = (&tiles[place], (place * size) as u32);
        let task = Task { kernel, pairs, displacements: (displacements, 0), tile, offset };
        sweep_border(&task, forces, across, &mut kernel.begin());
    };
    let margins = |place: usize, across: &Across<_, D>, forces: &mut [[_; D]], velocities: &[[_; D]]| {
        let (tile, mobile) = (&tiles[place], velocities.len());
        add_incoming(tile, place * size, across, forces);
        let (begin, end) = (tile.interior.start.min(mobile), tile.interior.end.min(mobile));
        [look(&forces[..begin], &velocities[..begin]), look(&forces[end..mobile], &velocities[end..])]
    };
    across.fit(pairs);
    let (mut insides, mut marginals) = (Vec::with_capacity(tiles.len()), Vec::new());
    if side_by_side::is_shared(tiles.len()) {
        // Tiles of held disks have no velocities.
        let arrays = displacements.chunks_mut(size).zip(forces.chunks_mut(size));
        let arrays = arrays.zip(velocities.chunks_mut(size).chain(repeat_with(Default::default)));
        insides = side_by_side::each(arrays.enumerate(), |(place, ((u, f), v))| inside(place, u, f, v));
        let displacements = &*displacements;
        let arrays = forces.chunks_mut(size).zip(&mut across.0);
        side_by_side::each(arrays.enumerate(), |(place, (f, across))| border(place, displacements, f, across));
        let (across, velocities) = (&*across, &*velocities);
        let arrays = forces.chunks_mut(size).zip(velocities.chunks(size).chain(repeat_with(Default::default)));
        marginals = side_by_side::each(arrays.enumerate(), |(place, (f, v))| Some(margins(place, across, f, v)));
    } else {
        let (disk_count, mobile_count) = (displacements.len(), velocities.len());
        marginals.resize_with(tiles.len(), || None);
        for (stage, place) in pairs.turns.iter() {
            let (begin, end) = (place * size, disk_count.min((place + 1) * size));
            let moving = begin.min(mobile_count)..end.min(mobile_count);
            let of_tile = &mut forces[begin..end];
            match stage {
                Stage::Inside => {
                    insides.push(inside(place, &mut displacements[begin..end], of_tile, &mut velocities[moving]));
                }
                Stage::Border => border(place, displacements, of_tile, &mut across.0[place]),
                Stage::Margins => marginals[place] = Some(margins(place, across, of_tile, &velocities[moving])),
            }
        }
    }
    let (kicked, mut looked): (Vec<M>, Vec<P>) = insides.into_iter().unzip();
    looked.extend(marginals.into_iter().flatten().flatten());
    (kicked, looked)
}
