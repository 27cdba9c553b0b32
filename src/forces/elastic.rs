//! The hot loop: energy, forces and virial of all contacts in one pass.
//!
//! ```text
//! r_ij = D_ij + w     w = u_i − u_j     δ = δ⁰_ij − w·(D_ij + r_ij) / (|r_ij| + |D_ij|)
//! f_i += F(δ) r_ij/|r_ij|,  f_j −= the same
//! ```
//!
//! D_ij is the separation of the anchors, u a displacement from them. The overlap at the anchors δ⁰_ij is known to full
//! relative accuracy. The overlap follows from its change. Its error is the rounding of the displacements (10⁻¹⁶ w) and
//! of the overlap itself. It does not contain the rounding of the distance (10⁻¹⁶), nor that of positions in a box
//! (10⁻¹⁴ and more).
//!
//! Pairs are processed in blocks of [`BLOCK`]. First the relative displacements are gathered. Then all arithmetic is
//! done on whole vectors of pairs, column by column (`block_arithmetic`). It replaces the displacement of each pair by
//! its force. Finally the forces are scattered. Gathering and scattering use no vector instructions, so they move as
//! little data as possible. The order of every sum is fixed, and every operation is rounded as in IEEE 754
//! (`crate::simd`). So the bits do not depend on the vector width of the machine.

use std::ops::Range;

use crate::forces::block_arithmetic::{Anchors, Columns};
use crate::forces::totals::Totals;
use crate::law::pair_law::PairLaw;
use crate::neighbours::block::{BLOCK, Block};
use crate::neighbours::pair_list::PairList;
use crate::neighbours::rows::{gather, prefetch_rows, scatter};
use crate::neighbours::tiles::Tile;
use crate::parallel;
use crate::vector::{Number, Vector, difference, sum};

/// Forces on the first disks of border pairs, for each tile. The second disks of these pairs are in other tiles. The
/// buffer is reused between evaluations; its content before an evaluation is irrelevant.
#[derive(Debug, Clone, Default)]
pub struct BorderForces<T, const D: usize>(pub(crate) Vec<Vec<[T; D]>>);

impl<T: Number, const D: usize> BorderForces<T, D> {
    pub(crate) fn fit(&mut self, pairs: &PairList<D>) {
        self.0.resize(pairs.tiles.len(), Vec::new());
        for (forces, tile) in self.0.iter_mut().zip(&pairs.tiles) {
            forces.resize(tile.border_pairs.len(), [T::default(); D]);
        }
    }
}

/// Forces on all disks; `forces` is overwritten.
///
/// # Shape
/// `displacements` and `forces` have one entry a disk.
///
/// # Accuracy
/// The error of an overlap is a few units in the last place of itself and of the relative displacement w.
pub fn forces<const D: usize>(
    law: &dyn PairLaw,
    pairs: &PairList<D>,
    displacements: &[Vector<D>],
    border_forces: &mut BorderForces<f64, D>,
    forces: &mut [Vector<D>],
) {
    let _ = all_tiles(&Plain { law, pairs }, pairs, displacements, border_forces, forces);
}

/// Forces as in [`forces`], with energy, virial, contact count and mean force in the same pass.
pub fn forces_and_totals<const D: usize>(
    law: &dyn PairLaw,
    pairs: &PairList<D>,
    displacements: &[Vector<D>],
    border_forces: &mut BorderForces<f64, D>,
    forces: &mut [Vector<D>],
) -> Totals<D> {
    let mut totals = Totals::ZERO;
    for part in all_tiles(&Summed { law, pairs }, pairs, displacements, border_forces, forces) {
        totals.add(&part);
    }
    totals
}

/// The operation of the loop on a block of pairs.
pub(crate) trait Kernel<const D: usize>: Sync {
    /// Number type of the arithmetic.
    type Number: Number;
    /// Work space of a block.
    type Columns;
    /// Sums over a tile beside the forces.
    type Sums: Send;

    /// Work space and sums at the start of a tile.
    fn begin(&self) -> (Self::Columns, Self::Sums);

    /// The force of each pair of a block. The array of displacements begins with the given disk.
    fn pair_forces<'a>(
        &self,
        block: usize,
        displacements: (&[[Self::Number; D]], u32),
        workspace: &'a mut (Self::Columns, Self::Sums),
    ) -> &'a [[Self::Number; D]; BLOCK];
}

/// Kernel for forces only.
pub(crate) struct Plain<'a, const D: usize> {
    pub law: &'a dyn PairLaw,
    pub pairs: &'a PairList<D>,
}

impl<const D: usize> Kernel<D> for Plain<'_, D> {
    type Number = f64;
    type Columns = Columns<D>;
    type Sums = ();

    fn begin(&self) -> (Columns<D>, ()) {
        (Columns::new(), ())
    }

    fn pair_forces<'a>(
        &self,
        block: usize,
        displacements: (&[Vector<D>], u32),
        (columns, ()): &'a mut (Columns<D>, ()),
    ) -> &'a [Vector<D>; BLOCK] {
        fill(self.law, self.pairs, displacements, &self.pairs.blocks[block], columns);
        &columns.pair_vectors
    }
}

/// Kernel for forces and totals.
struct Summed<'a, const D: usize> {
    law: &'a dyn PairLaw,
    pairs: &'a PairList<D>,
}

impl<const D: usize> Kernel<D> for Summed<'_, D> {
    type Number = f64;
    type Columns = Columns<D>;
    type Sums = Totals<D>;

    fn begin(&self) -> (Columns<D>, Totals<D>) {
        (Columns::new(), Totals::ZERO)
    }

    fn pair_forces<'a>(
        &self,
        block: usize,
        displacements: (&[Vector<D>], u32),
        (columns, totals): &'a mut (Columns<D>, Totals<D>),
    ) -> &'a [Vector<D>; BLOCK] {
        let block = &self.pairs.blocks[block];
        fill(self.law, self.pairs, displacements, block, columns);
        totals.add_block(self.law, columns, block.pair_count);
        &columns.pair_vectors
    }
}

/// Forces on all disks; returns the sums of each tile.
pub(crate) fn all_tiles<const D: usize, K: Kernel<D>>(
    kernel: &K,
    pairs: &PairList<D>,
    displacements: &[[K::Number; D]],
    border_forces: &mut BorderForces<K::Number, D>,
    forces: &mut [[K::Number; D]],
) -> Vec<K::Sums> {
    if let [tile] = pairs.tiles.as_slice() {
        let task = Task { kernel, pairs, displacements: (displacements, 0), tile, offset: 0 };
        return vec![sweep_inner(&task, forces).1];
    }
    border_forces.fit(pairs);
    let of_tiles = forces.chunks_mut(pairs.tile_size).zip(&mut border_forces.0);
    let sums =
        parallel::each(pairs.tiles.iter().zip(of_tiles).enumerate(), |(place, (tile, (forces, border_forces)))| {
            let offset = (place * pairs.tile_size) as u32;
            let task = Task { kernel, pairs, displacements: (displacements, 0), tile, offset };
            let mut workspace = sweep_inner(&task, forces);
            sweep_border(&task, forces, border_forces, &mut workspace);
            workspace.1
        });
    let tiles = pairs.tiles.iter().zip(forces.chunks_mut(pairs.tile_size)).enumerate();
    parallel::each(tiles, |(place, (tile, forces))| {
        add_incoming(tile, place * pairs.tile_size, border_forces, forces);
    });
    sums
}

/// Input of the loop over a tile.
pub(crate) struct Task<'a, const D: usize, K: Kernel<D>> {
    pub kernel: &'a K,
    pub pairs: &'a PairList<D>,
    /// Displacements, beginning with this disk.
    pub displacements: (&'a [[K::Number; D]], u32),
    pub tile: &'a Tile,
    /// First disk of the tile.
    pub offset: u32,
}

/// The blocks of this range that have pairs.
fn filled<'a, const D: usize>(
    pairs: &'a PairList<D>,
    blocks: &Range<usize>,
) -> impl Iterator<Item = usize> + use<'a, D> {
    blocks.clone().filter(|&block| pairs.blocks[block].pair_count > 0)
}

/// Forces of the pairs within a tile on its disks, which are overwritten.
pub(crate) fn sweep_inner<const D: usize, K: Kernel<D>>(
    task: &Task<'_, D, K>,
    forces: &mut [[K::Number; D]],
) -> (K::Columns, K::Sums) {
    forces.as_flattened_mut().fill(K::Number::default());
    let mut workspace = task.kernel.begin();
    sweep(task, task.tile.inner.clone(), forces, &mut workspace);
    workspace
}

/// Adds the forces of pairs within a tile, for these blocks, to its disks.
pub(crate) fn sweep<const D: usize, K: Kernel<D>>(
    task: &Task<'_, D, K>,
    blocks: Range<usize>,
    forces: &mut [[K::Number; D]],
    workspace: &mut (K::Columns, K::Sums),
) {
    for block in filled(task.pairs, &blocks) {
        let pair_forces = task.kernel.pair_forces(block, task.displacements, workspace);
        scatter(pair_forces, task.pairs, &task.pairs.blocks[block], (forces, task.offset));
    }
}

/// Adds the forces of the border pairs of a tile to its disks. The forces on the first disks are stored for the other
/// tiles.
pub(crate) fn sweep_border<const D: usize, K: Kernel<D>>(
    task: &Task<'_, D, K>,
    forces: &mut [[K::Number; D]],
    border_forces: &mut [[K::Number; D]],
    workspace: &mut (K::Columns, K::Sums),
) {
    for place in filled(task.pairs, &task.tile.border) {
        let pair_forces = task.kernel.pair_forces(place, task.displacements, workspace);
        let block = &task.pairs.blocks[place];
        let first = &task.pairs.first[block.pairs..block.pairs + block.pair_count];
        let border_forces = &mut border_forces[block.pairs - task.tile.border_pairs.start..];
        scatter_to_border(pair_forces, (first, task.offset), border_forces, forces);
    }
}

/// Adds the forces of pairs of other tiles to the disks of a tile, which begins with disk `offset`.
pub(crate) fn add_incoming<T: Number, const D: usize>(
    tile: &Tile,
    offset: usize,
    border_forces: &BorderForces<T, D>,
    forces: &mut [[T; D]],
) {
    for &(disk, from, pair) in &tile.incoming {
        let force = &mut forces[disk as usize - offset];
        *force = difference(*force, border_forces.0[from as usize][pair as usize]);
    }
}

/// Fills the columns of a block. The array of displacements begins with the given disk.
pub(crate) fn fill<const D: usize>(
    law: &dyn PairLaw,
    pairs: &PairList<D>,
    displacements: (&[Vector<D>], u32),
    block: &Block,
    columns: &mut Columns<D>,
) {
    prefetch_rows(pairs, block);
    gather(&mut columns.pair_vectors, pairs, block, displacements);
    let anchors = Anchors::of(law, pairs, block);
    columns.compute_overlaps(&anchors);
    columns.compute_forces(law, &anchors);
    columns.resolve(&anchors);
}

/// Scatters forces of border pairs. There are few, so rows of fixed length are not used.
fn scatter_to_border<T: Number, const D: usize>(
    pair_forces: &[[T; D]; BLOCK],
    (first, offset): (&[u32], u32),
    border_forces: &mut [[T; D]],
    forces: &mut [[T; D]],
) {
    for ((&force, &i), border_force) in pair_forces.iter().zip(first).zip(border_forces) {
        *border_force = force;
        let total = &mut forces[(i - offset) as usize];
        *total = sum(*total, force);
    }
}

/// Separation, distance and overlap of one listed pair, by the formula of the loop; a negative overlap is a gap.
#[inline(always)]
pub fn geometry<const D: usize>(
    pairs: &PairList<D>,
    pair: usize,
    displacements: &[Vector<D>],
) -> (Vector<D>, f64, f64) {
    let (a, b) = (displacements[pairs.first[pair] as usize], displacements[pairs.second[pair] as usize]);
    let anchored = pairs.separation(pair);
    let mut separation = [0.0; D];
    let mut squared = 0.0;
    let mut change = 0.0;
    for d in 0..D {
        let moved = a[d] - b[d];
        separation[d] = anchored[d] + moved;
        squared += separation[d] * separation[d];
        change += moved * (anchored[d] + separation[d]);
    }
    let distance = squared.sqrt();
    let inverse = 1.0 / (distance * (distance + pairs.distance(pair)));
    (separation, distance, pairs.overlap(pair) - change * (distance * inverse))
}
