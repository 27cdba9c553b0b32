//! A step and the forces after it, tile by tile: what a tile moves is still in the near cache when its forces are summed, and its
//! forces are when the relaxer looks at them.
//!
//! The bits of positions, velocities and forces are those of the same work done array by array.

use std::iter::repeat_with;

use crate::contact::forces::{Across, Task, add_incoming, sweep_border, sweep_inner};
use crate::contact::law::PairLaw;
use crate::contact::pair_list::PairList;
use crate::contact::totals::Totals;
use crate::side_by_side;
use crate::vector::Vector;

/// What moves, and what acts on it.
pub struct Movers<'a, const D: usize> {
    /// Velocities of the mobile disks \[length / time\].
    pub velocities: &'a mut [Vector<D>],
    /// Displacements of all disks \[length\].
    pub displacements: &'a mut [Vector<D>],
    /// Forces on all disks, before the step and then after it \[force\].
    pub forces: &'a mut [Vector<D>],
}

/// Moves all mobile disks by `kick` (forces, velocities, displacements of some of them) and evaluates the forces where they then
/// are; the list must hold there. What `kick` returned for each tile, and what `look` (forces, velocities) returned for each part of
/// the mobile disks, in a fixed order.
///
/// # Accuracy
/// The bits of `kick` on whole arrays and [`forces`](super::forces::forces) after it.
pub fn advance<const D: usize, L: PairLaw, K: Send, P: Send>(
    law: &L,
    pairs: &PairList<D>,
    movers: Movers<'_, D>,
    across: &mut Across<D>,
    kick: impl Fn(&[Vector<D>], &mut [Vector<D>], &mut [Vector<D>]) -> K + Send + Sync,
    look: impl Fn(&[Vector<D>], &[Vector<D>]) -> P + Send + Sync,
) -> (Vec<K>, Vec<P>) {
    let Movers { velocities, displacements, forces } = movers;
    let size = pairs.tile_size;
    // Asked for by nobody.
    let totals = || Totals::ZERO;
    // Tiles of held disks have no velocities.
    let arrays = displacements.chunks_mut(size).zip(forces.chunks_mut(size));
    let arrays = arrays.zip(velocities.chunks_mut(size).chain(repeat_with(Default::default)));
    let inside = side_by_side::each(pairs.tiles.iter().zip(arrays).enumerate(), |(place, (tile, arrays))| {
        let ((displacements, forces), velocities) = arrays;
        let mobile = velocities.len();
        let kicked = kick(&forces[..mobile], velocities, &mut displacements[..mobile]);
        let offset = (place * size) as u32;
        let task = Task { law, pairs, displacements: (displacements, offset), tile, offset };
        sweep_inner::<D, L, false>(&task, forces, &mut totals());
        let (begin, end) = (tile.interior.start.min(mobile), tile.interior.end.min(mobile));
        (kicked, look(&forces[begin..end], &velocities[begin..end]))
    });
    let (kicked, mut looked): (Vec<K>, Vec<P>) = inside.into_iter().unzip();
    if pairs.tiles.len() == 1 {
        return (kicked, looked);
    }
    across.fit(pairs);
    let displacements = &*displacements;
    let arrays = forces.chunks_mut(size).zip(&mut across.0);
    side_by_side::each(pairs.tiles.iter().zip(arrays).enumerate(), |(place, (tile, (forces, across)))| {
        let task = Task { law, pairs, displacements: (displacements, 0), tile, offset: (place * size) as u32 };
        sweep_border::<D, L, false>(&task, forces, across, &mut totals());
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
