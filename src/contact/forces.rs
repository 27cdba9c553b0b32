//! The hot loop: energy, forces and virial of all contacts in one pass.
//!
//! ```text
//! r_ij = D_ij + w     w = u_i − u_j     δ = δ⁰_ij − w·(D_ij + r_ij) / (|r_ij| + |D_ij|)
//! f_i += F(δ) r_ij/|r_ij|,  f_j −= the same
//! ```
//!
//! D_ij is the separation of the anchors, u a displacement from them, δ⁰_ij the overlap at the anchors, known to full
//! relative accuracy. The overlap follows from its change, so it carries the rounding of the displacements (10⁻¹⁶ w) and of
//! itself, not that of the distance (10⁻¹⁶), nor that of positions in a box (10⁻¹⁴ and more).
//!
//! Pairs are taken in blocks of [`BLOCK`]: first the relative displacements are gathered, then all arithmetic is done on whole vectors
//! of pairs, column by column (`columns.rs`), and puts the force of each pair in the place of its displacement, then the forces are
//! scattered. So gathering and scattering, which know no vectors, move as little as they can. The order of every sum is fixed and every
//! operation rounded as IEEE 754 has it (`src/simd`), so the bits do not depend on the width of the machine's vectors.

use crate::contact::columns::{Anchors, Columns, with_anchors};
use crate::contact::law::PairLaw;
use crate::contact::pair_list::{BLOCK, Block, PairList, Tile};
use crate::contact::rows::{gather, scatter};
use crate::contact::totals::{Tally, Totals};
use crate::side_by_side;
use crate::vector::{Vector, difference, sum};

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
        evaluate_block(task, block, &mut columns, TOTALS.then_some(&mut *totals));
        scatter(&columns.pull, task.pairs, block, (forces, task.offset));
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
        evaluate_block(task, block, &mut columns, TOTALS.then_some(&mut *totals));
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

/// Fills the columns of a block and adds to the totals, if they are asked for.
fn evaluate_block<const D: usize, L: PairLaw>(
    task: &Task<'_, D, L>,
    block: &Block,
    columns: &mut Columns<D>,
    totals: Option<&mut Totals<D>>,
) {
    fill(task.law, task.pairs, task.displacements, block, columns);
    if let Some(totals) = totals {
        pulp::Arch::new().dispatch(Tally { law: task.law, columns, count: block.pair_count, totals });
    }
}

/// Fills the columns of a block from displacements that begin with those of a disk.
pub(super) fn fill<const D: usize, L: PairLaw>(
    law: &L,
    pairs: &PairList<D>,
    displacements: (&[Vector<D>], u32),
    block: &Block,
    columns: &mut Columns<D>,
) {
    gather(&mut columns.pull, pairs, block, displacements);
    with_anchors(pairs, block, |anchors| pulp::Arch::new().dispatch(Arithmetic { law, columns, anchors }));
}

/// The arithmetic of a block as a job that is compiled for each vector width the machine may have, and started for the widest
/// it has. What only moves numbers is compiled once.
struct Arithmetic<'a, const D: usize, L> {
    law: &'a L,
    columns: &'a mut Columns<D>,
    anchors: Anchors<'a, D>,
}

impl<const D: usize, L: PairLaw> pulp::WithSimd for Arithmetic<'_, D, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) {
        self.columns.measure(simd, &self.anchors);
        self.columns.press(simd, self.law, &self.anchors);
        self.columns.resolve(simd);
    }
}

/// Few pairs: no rows of fixed length here.
fn scatter_to_border<const D: usize>(
    pull: &[Vector<D>; BLOCK],
    (first, offset): (&[u32], u32),
    across: &mut [Vector<D>],
    forces: &mut [Vector<D>],
) {
    for ((&pull, &i), across) in pull.iter().zip(first).zip(across) {
        *across = pull;
        let total = &mut forces[(i - offset) as usize];
        *total = sum(*total, pull);
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
