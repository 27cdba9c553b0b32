//! One step and the forces after it, tile by tile. Positions are still
//! in cache when their forces are summed, and forces are still in cache when the relaxer reads them. On one thread the
//! border pairs follow as soon as both sides have moved.
//!
//! Whether the list is still complete is checked after the disks have moved, so the list never shortens a step. If the
//! list has expired, all disks are moved and no forces are evaluated.
//!
//! Positions, velocities and forces have the same bits as if each array were processed as a whole.

use std::iter::repeat_with;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::forces::elastic::{BorderForces, Kernel, Task, add_incoming, sweep, sweep_border};
use crate::neighbours::displacement_bounds::{Bound, DisplacementBounds, PORTION, is_within};
use crate::neighbours::pair_list::PairList;
use crate::neighbours::tile_schedule::Stage;
use crate::parallel;

/// Arrays of a step: velocities, displacements and forces.
pub(crate) struct Movers<'a, T, const D: usize> {
    /// Velocities of the mobile disks \[length / time\].
    pub velocities: &'a mut [[T; D]],
    /// Displacements of all disks \[length\].
    pub displacements: &'a mut [[T; D]],
    /// Forces on all disks, before the step and then after it \[force\].
    pub forces: &'a mut [[T; D]],
}

/// Forces, velocities and displacements of the same disks; held disks have no velocities.
type Moving<'a, T, const D: usize> = (&'a mut [[T; D]], &'a mut [[T; D]], &'a mut [[T; D]]);

/// Result of a step by tiles.
#[derive(Debug, Clone, PartialEq)]
pub enum Advanced<P> {
    /// Nothing was done: the law has sites, or the list must be checked after this step.
    Not,
    /// The disks have moved, but the list is no longer complete.
    Moved,
    /// The disks have moved and their forces are evaluated. The observations of all parts of the disks.
    Evaluated(Vec<P>),
}

impl<P> Advanced<P> {
    pub(crate) fn of(looked: Option<Vec<P>>) -> Self {
        looked.map_or(Advanced::Moved, Advanced::Evaluated)
    }
}

/// Range of validity of the list.
pub(crate) struct Reach<'a, F> {
    /// Displacement up to which the list is complete \[length\].
    pub limit: f64,
    /// Displacement bounds since the list was built.
    pub bounds: &'a mut DisplacementBounds,
    /// Computes, from displacements of consecutive disks beginning with this one, the largest displacement since the
    /// list was built \[length\].
    pub longest: F,
}

/// Moves all mobile disks and evaluates the forces at their new positions. `kick` takes (forces, velocities,
/// displacements) of some mobile disks and returns a bound on their displacements. Returns the results of `observe`
/// (forces, velocities) for each part of the mobile disks, in a fixed order. Returns none if the list is no longer
/// complete; the forces are then undefined.
///
/// # Accuracy
/// The same bits as `kick` on whole arrays, followed by the forces of the kernel.
pub(crate) fn advance<const D: usize, K: Kernel<D>, P: Send>(
    kernel: &K,
    pairs: &PairList<D>,
    (movers, border_forces): (Movers<'_, K::Number, D>, &mut BorderForces<K::Number, D>),
    reach: Reach<'_, impl Fn(usize, &[[K::Number; D]]) -> f64 + Sync>,
    kick: impl Fn(&[[K::Number; D]], &mut [[K::Number; D]], &mut [[K::Number; D]]) -> f64 + Sync,
    observe: impl Fn(&[[K::Number; D]], &[[K::Number; D]]) -> P + Send + Sync,
) -> Option<Vec<P>> {
    let Movers { velocities, displacements, forces } = movers;
    let Reach { limit, bounds, longest } = reach;
    let (tiles, size) = (pairs.tiles.as_slice(), pairs.tile_size);
    let spent = AtomicBool::new(false);
    let is_expired = || spent.load(Ordering::Relaxed);
    // Moves disks of a portion, beginning with this one.
    let moves = |disk: usize, (forces, velocities, displacements): Moving<'_, _, D>, bound: &mut Bound| {
        bound.step = kick(forces, velocities, displacements);
        bound.total += bound.step;
        if !is_within(bound.total, limit) {
            bound.total = longest(disk, displacements);
            if !is_within(bound.total, limit) {
                spent.store(true, Ordering::Relaxed);
            }
        }
        forces.as_flattened_mut().fill(K::Number::default());
    };
    let inside = |place: usize, (forces, velocities, displacements): Moving<'_, _, D>, bounds: &mut [Bound]| {
        let (tile, mobile, first) = (&tiles[place], velocities.len(), place * size);
        let interior = tile.interior.start.min(mobile)..tile.interior.end.min(mobile);
        let mut workspace = kernel.begin();
        forces[mobile..].as_flattened_mut().fill(K::Number::default());
        for begin in (0..mobile).step_by(PORTION) {
            let disks = begin..mobile.min(begin + PORTION);
            let of_disks = (&mut forces[disks.clone()], &mut velocities[disks.clone()], &mut displacements[disks]);
            moves(first + begin, of_disks, &mut bounds[begin / PORTION]);
        }
        if is_expired() {
            return None;
        }
        let task = Task { kernel, pairs, displacements: (displacements, first as u32), tile, offset: first as u32 };
        sweep(&task, tile.inner.clone(), forces, &mut workspace);
        Some(observe(&forces[interior.clone()], &velocities[interior]))
    };
    let border = |place: usize, displacements: &[[_; D]], forces: &mut [[_; D]], border_forces: &mut [[_; D]]| {
        let (tile, offset) = (&tiles[place], (place * size) as u32);
        let task = Task { kernel, pairs, displacements: (displacements, 0), tile, offset };
        sweep_border(&task, forces, border_forces, &mut kernel.begin());
    };
    let margins = |place: usize, border_forces: &BorderForces<_, D>, forces: &mut [[_; D]], velocities: &[[_; D]]| {
        let (tile, mobile) = (&tiles[place], velocities.len());
        add_incoming(tile, place * size, border_forces, forces);
        let (begin, end) = (tile.interior.start.min(mobile), tile.interior.end.min(mobile));
        [observe(&forces[..begin], &velocities[..begin]), observe(&forces[end..mobile], &velocities[end..])]
    };
    border_forces.fit(pairs);
    let of_tile = bounds.of_tile;
    let (mut insides, mut marginals) = (Vec::with_capacity(tiles.len()), Vec::new());
    if parallel::is_shared(tiles.len()) {
        // Tiles of held disks have no velocities.
        let moving =
            velocities.chunks_mut(size).zip(bounds.portions.chunks_mut(of_tile)).chain(repeat_with(Default::default));
        let arrays = displacements.chunks_mut(size).zip(forces.chunks_mut(size)).zip(moving);
        insides = parallel::each(arrays.enumerate(), |(place, ((u, f), (v, bounds)))| inside(place, (f, v, u), bounds));
        if is_expired() {
            return None;
        }
        let displacements = &*displacements;
        let arrays = forces.chunks_mut(size).zip(&mut border_forces.0);
        parallel::each(arrays.enumerate(), |(place, (f, border_forces))| {
            border(place, displacements, f, border_forces)
        });
        let (border_forces, velocities) = (&*border_forces, &*velocities);
        let arrays = forces.chunks_mut(size).zip(velocities.chunks(size).chain(repeat_with(Default::default)));
        marginals = parallel::each(arrays.enumerate(), |(place, (f, v))| Some(margins(place, border_forces, f, v)));
    } else {
        let (disk_count, mobile_count) = (displacements.len(), velocities.len());
        marginals.resize_with(tiles.len(), || None);
        for (stage, place) in pairs.schedule.iter() {
            let (begin, end) = (place * size, disk_count.min((place + 1) * size));
            let moving = begin.min(mobile_count)..end.min(mobile_count);
            let forces = &mut forces[begin..end];
            match stage {
                Stage::Inside => {
                    let portions =
                        bounds.portions.len().min(place * of_tile)..bounds.portions.len().min((place + 1) * of_tile);
                    let disks = (forces, &mut velocities[moving], &mut displacements[begin..end]);
                    insides.push(inside(place, disks, &mut bounds.portions[portions]));
                }
                _ if is_expired() => {}
                Stage::Border => border(place, displacements, forces, &mut border_forces.0[place]),
                Stage::Margins => marginals[place] = Some(margins(place, border_forces, forces, &velocities[moving])),
            }
        }
    }
    if is_expired() {
        return None;
    }
    let mut looked: Vec<P> = insides.into_iter().flatten().collect();
    looked.extend(marginals.into_iter().flatten().flatten());
    Some(looked)
}
