//! The hot loop: energy, forces and virial of all contacts in one pass.
//!
//! ```text
//! r_ij = D_ij + w     w = u_i − u_j     δ = δ⁰_ij − w·(D_ij + r_ij) / (|r_ij| + |D_ij|)
//! f_i += F(δ) r_ij/|r_ij|,  f_j −= the same
//! ```
//!
//! D_ij is the separation of the anchors, u a displacement from them, δ⁰_ij the overlap at the anchors, known to full
//! relative accuracy. The overlap follows from its change, so it carries the rounding of the displacements (10⁻¹⁶ w) and of
//! itself, not that of the distance (10⁻¹⁶), nor that of positions in a box (10⁻¹⁴ and more). Pairs are taken in blocks of [`BLOCK`]: first the
//! relative displacements are gathered, then all arithmetic is done on whole vectors of pairs, column by column, and puts the force of each pair in the place of its displacement, then the forces are scattered. So gathering and
//! scattering, which know no vectors, move as little as they can. The order of every sum is fixed and every operation rounded as
//! IEEE 754 has it (`src/roots.rs`), so the bits do not depend on the width of the machine's vectors.

use crate::contact::law::PairLaw;
use crate::contact::pair_list::{BLOCK, Block, PairList, Tile};
use crate::contact::rows::{gather, rows_of, scatter};
use crate::contact::totals::{Tally, Totals};
use crate::roots::{positive_part, reciprocal};
use crate::side_by_side;
use crate::vector::{Vector, difference, sum};

/// One block of pairs, column by column, each component of a vector in a column of its own.
#[repr(align(64))]
pub(super) struct Columns<const D: usize> {
    /// Relative displacement of the pair, then the force on its first disk.
    pub pull: [[f64; BLOCK]; D],
    // What is kept only for who asks.
    pub apart: [[f64; BLOCK]; D],
    pub overlap: [f64; BLOCK],
    pub force: [f64; BLOCK],
    /// Force over distance.
    pub factor: [f64; BLOCK],
}

impl<const D: usize> Columns<D> {
    #[inline(always)]
    pub fn new() -> Self {
        Columns {
            pull: [[0.0; BLOCK]; D],
            apart: [[0.0; BLOCK]; D],
            overlap: [0.0; BLOCK],
            force: [0.0; BLOCK],
            factor: [0.0; BLOCK],
        }
    }
}

/// Forces of pairs across the border of a tile, for each tile: those on the first disks. Room that is kept between two
/// evaluations; what it holds before one does not matter.
#[derive(Debug, Clone, Default)]
pub struct Across<const D: usize>(pub(super) Vec<Vec<Vector<D>>>);

impl<const D: usize> Across<D> {
    pub(super) fn fit(&mut self, pairs: &PairList<D>) {
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
        let task = Task { law, pairs, displacements: (displacements, 0), tile, offset: 0 };
        sweep_inner::<D, L, TOTALS>(&task, forces, &mut totals);
        return totals;
    }
    across.fit(pairs);
    let room = forces.chunks_mut(pairs.tile_size).zip(&mut across.0);
    let parts = side_by_side::each(pairs.tiles.iter().zip(room).enumerate(), |(place, (tile, (forces, across)))| {
        let mut totals = Totals::ZERO;
        let offset = (place * pairs.tile_size) as u32;
        let task = Task { law, pairs, displacements: (displacements, 0), tile, offset };
        sweep_inner::<D, L, TOTALS>(&task, forces, &mut totals);
        sweep_border::<D, L, TOTALS>(&task, forces, across, &mut totals);
        totals
    });
    let tiles = pairs.tiles.iter().zip(forces.chunks_mut(pairs.tile_size)).enumerate();
    side_by_side::each(tiles, |(place, (tile, forces))| {
        add_incoming(tile, place * pairs.tile_size, across, forces);
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
pub(super) struct Task<'a, const D: usize, L> {
    pub law: &'a L,
    pub pairs: &'a PairList<D>,
    /// Displacements from this disk on.
    pub displacements: (&'a [Vector<D>], u32),
    pub tile: &'a Tile,
    /// First disk of the tile.
    pub offset: u32,
}

/// Forces of the pairs within a tile on its disks, which are overwritten.
pub(super) fn sweep_inner<const D: usize, L: PairLaw, const TOTALS: bool>(
    task: &Task<'_, D, L>,
    forces: &mut [Vector<D>],
    totals: &mut Totals<D>,
) {
    forces.fill([0.0; D]);
    let mut columns = Columns::<D>::new();
    for block in &task.pairs.blocks[task.tile.inner.clone()] {
        let seconds = evaluate_block(task, block, &mut columns, TOTALS.then_some(&mut *totals));
        scatter(&columns.pull, block, (rows_of(task.pairs, block), seconds, task.offset), forces);
    }
}

/// Adds the forces of the pairs across the border of a tile to its disks; those on the first disks are kept for the others.
pub(super) fn sweep_border<const D: usize, L: PairLaw, const TOTALS: bool>(
    task: &Task<'_, D, L>,
    forces: &mut [Vector<D>],
    across: &mut [Vector<D>],
    totals: &mut Totals<D>,
) {
    let mut columns = Columns::<D>::new();
    for block in &task.pairs.blocks[task.tile.border.clone()] {
        let _ = evaluate_block(task, block, &mut columns, TOTALS.then_some(&mut *totals));
        let first = &task.pairs.first[block.pairs..block.pairs + block.pair_count];
        let room = &mut across[block.pairs - task.tile.border_pairs.start..];
        scatter_to_border(&columns.pull, (first, task.offset), room, forces);
    }
}

/// Adds the forces of pairs of other tiles to the disks of a tile, which begins with disk `offset`.
pub(super) fn add_incoming<const D: usize>(tile: &Tile, offset: usize, across: &Across<D>, forces: &mut [Vector<D>]) {
    for &(disk, from, pair) in &tile.incoming {
        let force = &mut forces[disk as usize - offset];
        *force = difference(*force, across.0[from as usize][pair as usize]);
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
    (displacements, offset): (&[Vector<D>], u32),
    block: &Block,
    columns: &mut Columns<D>,
) -> &'a [u32] {
    let range = block.pairs..block.pairs + block.pair_count;
    let second = &pairs.second[range.clone()];
    gather(&mut columns.pull, block, (rows_of(pairs, block), second, offset), displacements);
    let whole = block.pairs..block.pairs + BLOCK;
    let arch = pulp::Arch::new();
    if whole.end <= pairs.len() {
        // A block that is not full goes on into the next one; what comes of that is not used.
        let anchors = Anchors {
            separation: pairs.separation.columns().map(|column| &column[whole.clone()]),
            distance: &pairs.distance[whole.clone()],
            overlap: &pairs.overlap[whole.clone()],
            coefficient: &pairs.coefficient[whole],
        };
        arch.dispatch(Arithmetic::<D, L, KEEP> { law, columns, anchors });
    } else {
        let padded = |column: &[f64]| {
            let mut whole = [1.0; BLOCK];
            whole[..block.pair_count].copy_from_slice(&column[range.clone()]);
            whole
        };
        let separation = pairs.separation.columns().map(padded);
        let (distance, overlap) = (&padded(&pairs.distance), &padded(&pairs.overlap));
        let coefficient = &padded(&pairs.coefficient);
        let separation = separation.each_ref().map(|column| &column[..]);
        let anchors = Anchors { separation, distance, overlap, coefficient };
        arch.dispatch(Arithmetic::<D, L, KEEP> { law, columns, anchors });
    }
    second
}

/// What the list has of each pair of a block.
struct Anchors<'a, const D: usize> {
    separation: [&'a [f64]; D],
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
    fn with_simd<S: pulp::Simd>(self, simd: S) {
        evaluate::<S, D, L, KEEP>(simd, self.law, self.columns, &self.anchors);
    }
}

#[inline(always)]
fn evaluate<S: pulp::Simd, const D: usize, L: PairLaw, const KEEP: bool>(
    simd: S,
    law: &L,
    columns: &mut Columns<D>,
    anchors: &Anchors<'_, D>,
) {
    // As many turns as a block has places, known beforehand: no check.
    let count = BLOCK / S::F64_LANES;
    let read = |column| &S::as_simd_f64s(column).0[..count];
    let anchor_separation = anchors.separation.map(read);
    let (anchor_distance, anchor_overlap) = (read(anchors.distance), read(anchors.overlap));
    let coefficient = read(anchors.coefficient);
    let pull = columns.pull.each_mut().map(|column| S::as_mut_simd_f64s(column).0);
    let aparts = columns.apart.each_mut().map(|column| S::as_mut_simd_f64s(column).0);
    let (overlaps, _) = S::as_mut_simd_f64s(&mut columns.overlap);
    let (forces, _) = S::as_mut_simd_f64s(&mut columns.force);
    let (factors, _) = S::as_mut_simd_f64s(&mut columns.factor);
    let zero = simd.splat_f64s(0.0);
    for k in 0..count {
        let mut apart = [zero; D];
        let (mut squared, mut change) = (zero, zero);
        for d in 0..D {
            let (anchored, moved) = (anchor_separation[d][k], pull[d][k]);
            apart[d] = simd.add_f64s(anchored, moved);
            squared = simd.add_f64s(squared, simd.mul_f64s(apart[d], apart[d]));
            change = simd.add_f64s(change, simd.mul_f64s(moved, simd.add_f64s(anchored, apart[d])));
        }
        let distance = simd.sqrt_f64s(squared);
        let both = simd.add_f64s(distance, anchor_distance[k]);
        // One reciprocal for change / both and 1 / distance: divisions and roots are what the loop waits for.
        let inverse = reciprocal(simd, simd.mul_f64s(distance, both));
        let change = simd.mul_f64s(change, simd.mul_f64s(distance, inverse));
        let gap = simd.sub_f64s(anchor_overlap[k], change);
        let overlap = positive_part(simd, gap);
        let force = law.forces(simd, coefficient[k], overlap);
        let factor = simd.mul_f64s(force, simd.mul_f64s(both, inverse));
        for d in 0..D {
            pull[d][k] = simd.mul_f64s(factor, apart[d]);
        }
        if KEEP {
            for d in 0..D {
                aparts[d][k] = apart[d];
            }
            overlaps[k] = overlap;
            forces[k] = force;
            factors[k] = factor;
        }
    }
}

/// Few pairs: no rows of fixed length here.
fn scatter_to_border<const D: usize>(
    pull: &[[f64; BLOCK]; D],
    (first, offset): (&[u32], u32),
    across: &mut [Vector<D>],
    forces: &mut [Vector<D>],
) {
    for (k, (&i, across)) in first.iter().zip(across).enumerate() {
        *across = std::array::from_fn(|d| pull[d][k]);
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
    let anchored = pairs.separation.of(pair);
    let mut apart = [0.0; D];
    let mut squared = 0.0;
    let mut change = 0.0;
    for d in 0..D {
        let moved = a[d] - b[d];
        apart[d] = anchored[d] + moved;
        squared += apart[d] * apart[d];
        change += moved * (anchored[d] + apart[d]);
    }
    let distance = squared.sqrt();
    let inverse = 1.0 / (distance * (distance + pairs.distance[pair]));
    (apart, distance, pairs.overlap[pair] - change * (distance * inverse))
}
