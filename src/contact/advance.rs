//! A step and the forces after it, tile by tile: what a tile moves is still in the near cache when its forces are summed, and its
//! forces are when the relaxer looks at them.
//!
//! The bits of positions, velocities and forces are those of the same work done array by array.

use std::iter::repeat_with;

use crate::contact::forces::{Across, Kernel, Task, add_incoming, sweep_border, sweep_inner};
use crate::contact::pair_list::PairList;
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
    let size = pairs.tile_size;
    // Tiles of held disks have no velocities.
    let arrays = displacements.chunks_mut(size).zip(forces.chunks_mut(size));
    let arrays = arrays.zip(velocities.chunks_mut(size).chain(repeat_with(Default::default)));
    let inside = side_by_side::each(pairs.tiles.iter().zip(arrays).enumerate(), |(place, (tile, arrays))| {
        let ((displacements, forces), velocities) = arrays;
        let mobile = velocities.len();
        let kicked = kick(&forces[..mobile], velocities, &mut displacements[..mobile]);
        let offset = (place * size) as u32;
        let task = Task { kernel, pairs, displacements: (displacements, offset), tile, offset };
        sweep_inner(&task, forces);
        let (begin, end) = (tile.interior.start.min(mobile), tile.interior.end.min(mobile));
        (kicked, look(&forces[begin..end], &velocities[begin..end]))
    });
    let (kicked, mut looked): (Vec<M>, Vec<P>) = inside.into_iter().unzip();
    if pairs.tiles.len() == 1 {
        return (kicked, looked);
    }
    across.fit(pairs);
    let displacements = &*displacements;
    let arrays = forces.chunks_mut(size).zip(&mut across.0);
    side_by_side::each(pairs.tiles.iter().zip(arrays).enumerate(), |(place, (tile, (forces, across)))| {
        let task = Task { kernel, pairs, displacements: (displacements, 0), tile, offset: (place * size) as u32 };
        sweep_border(&task, forces, across, &mut kernel.begin());
    });
    let arrays = forces.chunks_mut(size).zip(velocities.chunks(size).chain(repeat_with(Default::default)));
    let margins =
        side_by_side::each(pairs.tiles.iter().zip(arrays).enumerate(), |(place, (tile, (forces, velocities)))| {
            add_incoming(tile, place * size, across, forces);
            let mobile = velocities.len();
            let (begin, end) = (tile.interior.start.min(mobile), tile.interior.end.min(mobile));
            [look(&forces[..begin], &velocities[..begin]), look(&forces[end..mobile], &velocities[end..])]
        });
    looked.extend(margins.into_iter().flatten());
    (kicked, looked)
}
