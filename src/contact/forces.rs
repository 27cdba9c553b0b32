//! The hot loop: energy, forces and virial of all contacts in one pass.
//!
//! ```text
//! r_ij = D_ij + w     w = u_i − u_j     δ = δ⁰_ij − w·(2 D_ij + w) / (|r_ij| + |D_ij|)
//! f_i += F(δ) r_ij/|r_ij|,  f_j −= the same
//! ```
//!
//! D_ij is the separation of the anchors, u a displacement from them, δ⁰_ij the overlap at the anchors, known to full
//! relative accuracy. The overlap follows from its change, so it carries the rounding of the displacements (10⁻¹⁶ w) and of
//! itself, not that of the distance (10⁻¹⁶), nor that of positions in a box (10⁻¹⁴ and more). Pairs are taken in blocks of [`BLOCK`]: first the
//! relative displacements are gathered, then all arithmetic is done column by column (which the compiler turns into vector
//! instructions) and puts the force of each pair in the place of its displacement, then the forces are scattered. So gathering and
//! scattering, which know no vectors, move as little as they can. The order of every sum is fixed, so the bits do not
//! depend on the machine's vector width.

use crate::contact::law::PairLaw;
use crate::contact::pair_list::{BLOCK, Block, PairList, Tile};
use crate::contact::rows::{gather, rows_of, scatter};
use crate::contact::totals::{Tally, Totals};
use crate::side_by_side;
use crate::vector::{Vector, difference, scaled, sum};

/// One block of pairs, column by column.
pub(super) struct Columns<const D: usize> {
    /// Relative displacement of the pair, then the force on its first disk.
    pub pull: [Vector<D>; BLOCK],
    // What is kept only for who asks.
    pub apart: [Vector<D>; BLOCK],
    pub overlap: [f64; BLOCK],
    pub force: [f64; BLOCK],
    /// Force over distance.
    pub factor: [f64; BLOCK],
}

impl<const D: usize> Columns<D> {
    #[inline(always)]
    pub fn new() -> Self {
        Columns {
            pull: [[0.0; D]; BLOCK],
            apart: [[0.0; D]; BLOCK],
            overlap: [0.0; BLOCK],
            force: [0.0; BLOCK],
            factor: [0.0; BLOCK],
        }
    }
}

/// Forces of pairs across the border of a tile, for each tile: those on the first disks. Room that is kept between two
/// evaluations; what it holds before one does not matter.
#[derive(Debug, Clone, Default)]
pub struct Across<const D: usize>(Vec<Vec<Vector<D>>>);

impl<const D: usize> Across<D> {
    fn fit(&mut self, pairs: &PairList<D>) {
        self.0.resize(pairs.tiles.len(), Vec::new());
        for (room, tile) in self.0.iter_mut().zip(&pairs.tiles) {
            room.resize(tile.border_pairs.len(), [0.0; D]);
        }
    }
}

/// Forces on all disks; `forces` is overwritten, whatever it held.
///
/// # Shape
/// `displacements` and `forces` have one entry a disk.
///
/// # Accuracy
/// An overlap is known to a few units in the last place of itself and of the relative displacement w.
pub fn forces<const D: usize, L: PairLaw>(
    law: &L,
    pairs: &PairList<D>,
    displacements: &[Vector<D>],
    across: &mut Across<D>,
    forces: &mut [Vector<D>],
) {
    let _ = all_tiles::<D, L, false>(law, pairs, displacements, across, forces);
}

/// Forces as by [`forces`], with energy, virial, contact count and mean force in the same pass.
pub fn forces_and_totals<const D: usize, L: PairLaw>(
    law: &L,
    pairs: &PairList<D>,
    displacements: &[Vector<D>],
    across: &mut Across<D>,
    forces: &mut [Vector<D>],
) -> Totals<D> {
    all_tiles::<D, L, true>(law, pairs, displacements, across, forces)
}

fn all_tiles<const D: usize, L: PairLaw, const TOTALS: bool>(
    law: &L,
    pairs: &PairList<D>,
    displacements: &[Vector<D>],
    across: &mut Across<D>,
    forces: &mut [Vector<D>],
) -> Totals<D> {
    if let [tile] = pairs.tiles.as_slice() {
        let mut totals = Totals::ZERO;
        let task = Task { law, pairs, displacements, tile, offset: 0 };
        sweep::<D, L, TOTALS>(&task, forces, &mut [], &mut totals);
        return totals;
    }
    across.fit(pairs);
    let room = forces.chunks_mut(pairs.tile_size).zip(&mut across.0);
    let parts = side_by_side::each(pairs.tiles.iter().zip(room).enumerate(), |(place, (tile, (forces, across)))| {
        let mut totals = Totals::ZERO;
        let offset = (place * pairs.tile_size) as u32;
        let task = Task { law, pairs, displacements, tile, offset };
        sweep::<D, L, TOTALS>(&task, forces, across, &mut totals);
        totals
    });
    let tiles = pairs.tiles.iter().zip(forces.chunks_mut(pairs.tile_size)).enumerate();
    side_by_side::each(tiles, |(place, (tile, forces))| {
        for &(disk, from, pair) in &tile.incoming {
            let force = &mut forces[disk as usize - place * pairs.tile_size];
            *force = difference(*force, across.0[from as usize][pair as usize]);
        }
    });
    let mut totals = Totals::ZERO;
    if TOTALS {
        for part in &parts {
            totals.add(part);
        }
    }
    totals
}

/// What the loop over a tile reads.
struct Task<'a, const D: usize, L> {
    law: &'a L,
    pairs: &'a PairList<D>,
    displacements: &'a [Vector<D>],
    tile: &'a Tile,
    /// First disk of the tile.
    offset: u32,
}

/// Forces of the pairs of a tile: on its disks, and across its border.
fn sweep<const D: usize, L: PairLaw, const TOTALS: bool>(
    task: &Task<'_, D, L>,
    forces: &mut [Vector<D>],
    across: &mut [Vector<D>],
    totals: &mut Totals<D>,
) {
    forces.fill([0.0; D]);
    let mut columns = Columns::<D>::new();
    let blocks = &task.pairs.blocks;
    for block in &blocks[task.tile.inner.clone()] {
        let seconds = evaluate_block(task, block, &mut columns, TOTALS.then_some(&mut *totals));
        scatter(&columns.pull, block, (rows_of(task.pairs, block), seconds, task.offset), forces);
    }
    for block in &blocks[task.tile.border.clone()] {
        let _ = evaluate_block(task, block, &mut columns, TOTALS.then_some(&mut *totals));
        let first = &task.pairs.first[block.pairs..block.pairs + block.pair_count];
        let room = &mut across[block.pairs - task.tile.border_pairs.start..];
        scatter_to_border(&columns.pull, (first, task.offset), room, forces);
    }
}

/// Fills the columns of a block and adds to the totals, if they are asked for; its second disks are returned.
fn evaluate_block<'a, const D: usize, L: PairLaw>(
    task: &Task<'a, D, L>,
    block: &Block,
    columns: &mut Columns<D>,
    totals: Option<&mut Totals<D>>,
) -> &'a [u32] {
    let Task { law, pairs, displacements, .. } = *task;
    let Some(totals) = totals else { return fill::<D, L, false>(law, pairs, displacements, block, columns) };
    let second = fill::<D, L, true>(law, pairs, displacements, block, columns);
    pulp::Arch::new().dispatch(Tally { law, columns, count: block.pair_count, totals });
    second
}

/// Fills the columns of a block, all of them or only the forces of the pairs; its second disks are returned.
pub(super) fn fill<'a, const D: usize, L: PairLaw, const KEEP: bool>(
    law: &L,
    pairs: &'a PairList<D>,
    displacements: &[Vector<D>],
    block: &Block,
    columns: &mut Columns<D>,
) -> &'a [u32] {
    let range = block.pairs..block.pairs + block.pair_count;
    let second = &pairs.second[range.clone()];
    gather(&mut columns.pull, block, rows_of(pairs, block), second, displacements);
    let whole = block.pairs..block.pairs + BLOCK;
    let arch = pulp::Arch::new();
    let listed = (
        pairs.separation.get(whole.clone()),
        pairs.distance.get(whole.clone()),
        pairs.overlap.get(whole.clone()),
        pairs.coefficient.get(whole),
    );
    if let (Some(separation), Some(distance), Some(overlap), Some(coefficient)) = listed {
        // A block that is not full goes on into the next one; what comes of that is not used.
        let anchors = Anchors { separation, distance, overlap, coefficient };
        arch.dispatch(Arithmetic::<D, L, KEEP> { law, columns, anchors });
    } else {
        let padded = |column: &[f64]| {
            let mut whole = [1.0; BLOCK];
            whole[..block.pair_count].copy_from_slice(&column[range.clone()]);
            whole
        };
        let mut separation = [[1.0; D]; BLOCK];
        separation[..block.pair_count].copy_from_slice(&pairs.separation[range.clone()]);
        let (distance, overlap) = (&padded(&pairs.distance), &padded(&pairs.overlap));
        let coefficient = &padded(&pairs.coefficient);
        let anchors = Anchors { separation: &separation, distance, overlap, coefficient };
        arch.dispatch(Arithmetic::<D, L, KEEP> { law, columns, anchors });
    }
    second
}

/// What the list has of each pair of a block.
struct Anchors<'a, const D: usize> {
    separation: &'a [Vector<D>],
    distance: &'a [f64],
    overlap: &'a [f64],
    coefficient: &'a [f64],
}

/// The arithmetic of a block as a job that is compiled for each vector width the machine may have, and started for the widest
/// it has. What only moves numbers is compiled once.
struct Arithmetic<'a, const D: usize, L, const KEEP: bool> {
    law: &'a L,
    columns: &'a mut Columns<D>,
    anchors: Anchors<'a, D>,
}

impl<const D: usize, L: PairLaw, const KEEP: bool> pulp::WithSimd for Arithmetic<'_, D, L, KEEP> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) {
        evaluate::<D, L, KEEP>(self.law, self.columns, &self.anchors);
    }
}

#[inline(always)]
fn evaluate<const D: usize, L: PairLaw, const KEEP: bool>(law: &L, columns: &mut Columns<D>, anchors: &Anchors<'_, D>) {
    // As many turns as a column has places, known beforehand: whole vectors, and no check.
    let length = "columns as long as a block";
    let anchor_separation: &[Vector<D>; BLOCK] = anchors.separation.try_into().expect(length);
    let anchor_distance: &[f64; BLOCK] = anchors.distance.try_into().expect(length);
    let anchor_overlap: &[f64; BLOCK] = anchors.overlap.try_into().expect(length);
    let coefficient: &[f64; BLOCK] = anchors.coefficient.try_into().expect(length);
    let Columns { pull, apart: aparts, overlap: overlaps, force: forces, factor: factors } = columns;
    for k in 0..BLOCK {
        let moved = pull[k];
        let apart = sum(anchor_separation[k], moved);
        let mut squared = 0.0;
        let mut change = 0.0;
        for d in 0..D {
            squared += apart[d] * apart[d];
            // 2 D + w = (D + w) + D = 2 apart − moved.
            change += moved[d] * (2.0 * apart[d] - moved[d]);
        }
        let distance = squared.sqrt();
        let both = distance + anchor_distance[k];
        // One division for change / both and 1 / distance: divisions and roots are what the loop waits for.
        let inverse = 1.0 / (distance * both);
        let gap = anchor_overlap[k] - change * (distance * inverse);
        // Written so that NaN stays NaN.
        let overlap = if gap < 0.0 { 0.0 } else { gap };
        let force = law.force(coefficient[k], overlap);
        let factor = force * (both * inverse);
        pull[k] = scaled(factor, apart);
        if KEEP {
            aparts[k] = apart;
            overlaps[k] = overlap;
            forces[k] = force;
            factors[k] = factor;
        }
    }
}

/// Few pairs: no rows of fixed length here.
fn scatter_to_border<const D: usize>(
    pull: &[Vector<D>; BLOCK],
    (first, offset): (&[u32], u32),
    across: &mut [Vector<D>],
    forces: &mut [Vector<D>],
) {
    for (k, (&i, across)) in first.iter().zip(across).enumerate() {
        *across = pull[k];
        let total = &mut forces[(i - offset) as usize];
        *total = sum(*total, *across);
    }
}

/// Separation, distance and overlap of one listed pair, by the same formula as the loop; a negative overlap is a gap.
#[inline(always)]
pub fn geometry<const D: usize>(
    pairs: &PairList<D>,
    pair: usize,
    displacements: &[Vector<D>],
) -> (Vector<D>, f64, f64) {
    let (a, b) = (displacements[pairs.first[pair] as usize], displacements[pairs.second[pair] as usize]);
    let mut apart = [0.0; D];
    let mut squared = 0.0;
    let mut change = 0.0;
    for d in 0..D {
        let moved = a[d] - b[d];
        apart[d] = pairs.separation[pair][d] + moved;
        squared += apart[d] * apart[d];
        change += moved * (2.0 * apart[d] - moved);
    }
    let distance = squared.sqrt();
    let inverse = 1.0 / (distance * (distance + pairs.distance[pair]));
    (apart, distance, pairs.overlap[pair] - change * (distance * inverse))
}
