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

use std::ops::Range;

use crate::forces::block_arithmetic::{Anchors, Columns};
use crate::forces::totals::{Tally, Totals};
use crate::law::kernel::{LawKernel, dispatch};
use crate::law::pair_law::PairLaw;
use crate::neighbours::block::{BLOCK, Block};
use crate::neighbours::pair_list::PairList;
use crate::neighbours::rows::{gather, prefetch_rows, scatter};
use crate::neighbours::tiles::Tile;
use crate::parallel;
use crate::vector::{Number, Vector, difference, sum};

/// Forces of pairs across the border of a tile, for each tile: those on the first disks. Room that is kept between two
/// evaluations; what it holds before one does not matter.
#[derive(Debug, Clone, Default)]
pub struct Across<T, const D: usize>(pub(crate) Vec<Vec<[T; D]>>);

impl<T: Number, const D: usize> Across<T, D> {
    pub(crate) fn fit(&mut self, pairs: &PairList<D>) {
        self.0.resize(pairs.tiles.len(), Vec::new());
        for (room, tile) in self.0.iter_mut().zip(&pairs.tiles) {
            room.resize(tile.border_pairs.len(), [T::default(); D]);
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
    across: &mut Across<f64, D>,
    forces: &mut [Vector<D>],
) {
    let _ = all_tiles(&Plain { law, pairs }, pairs, displacements, across, forces);
}

/// Forces as by [`forces`], with energy, virial, contact count and mean force in the same pass.
pub fn forces_and_totals<const D: usize, L: PairLaw>(
    law: &L,
    pairs: &PairList<D>,
    displacements: &[Vector<D>],
    across: &mut Across<f64, D>,
    forces: &mut [Vector<D>],
) -> Totals<D> {
    let mut totals = Totals::ZERO;
    for part in all_tiles(&Summed { law, pairs }, pairs, displacements, across, forces) {
        totals.add(&part);
    }
    totals
}

/// What the loop does with a block of pairs.
pub(crate) trait Kernel<const D: usize>: Sync {
    /// What it reckons with.
    type Number: Number;
    /// Room for a block.
    type Columns;
    /// What is summed over a tile beside the forces.
    type Sums: Send;

    /// Room and sums to begin a tile with.
    fn begin(&self) -> (Self::Columns, Self::Sums);

    /// The force of each pair of a block, from displacements that begin with those of a disk.
    fn pull<'a>(
        &self,
        block: usize,
        displacements: (&[[Self::Number; D]], u32),
        room: &'a mut (Self::Columns, Self::Sums),
    ) -> &'a [[Self::Number; D]; BLOCK];
}

/// Forces alone.
pub(crate) struct Plain<'a, const D: usize, L> {
    pub law: &'a L,
    pub pairs: &'a PairList<D>,
}

impl<const D: usize, L: PairLaw> Kernel<D> for Plain<'_, D, L> {
    type Number = f64;
    type Columns = Columns<D>;
    type Sums = ();

    fn begin(&self) -> (Columns<D>, ()) {
        (Columns::new(), ())
    }

    fn pull<'a>(
        &self,
        block: usize,
        displacements: (&[Vector<D>], u32),
        (columns, ()): &'a mut (Columns<D>, ()),
    ) -> &'a [Vector<D>; BLOCK] {
        fill(self.law, self.pairs, displacements, &self.pairs.blocks[block], columns);
        &columns.pull
    }
}

/// Forces and totals.
struct Summed<'a, const D: usize, L> {
    law: &'a L,
    pairs: &'a PairList<D>,
}

impl<const D: usize, L: PairLaw> Kernel<D> for Summed<'_, D, L> {
    type Number = f64;
    type Columns = Columns<D>;
    type Sums = Totals<D>;

    fn begin(&self) -> (Columns<D>, Totals<D>) {
        (Columns::new(), Totals::ZERO)
    }

    fn pull<'a>(
        &self,
        block: usize,
        displacements: (&[Vector<D>], u32),
        (columns, totals): &'a mut (Columns<D>, Totals<D>),
    ) -> &'a [Vector<D>; BLOCK] {
        let block = &self.pairs.blocks[block];
        fill(self.law, self.pairs, displacements, block, columns);
        dispatch(self.law, Tally { columns: &*columns, count: block.pair_count, totals });
        &columns.pull
    }
}

/// Forces on all disks; the sums of each tile.
pub(crate) fn all_tiles<const D: usize, K: Kernel<D>>(
    kernel: &K,
    pairs: &PairList<D>,
    displacements: &[[K::Number; D]],
    across: &mut Across<K::Number, D>,
    forces: &mut [[K::Number; D]],
) -> Vec<K::Sums> {
    if let [tile] = pairs.tiles.as_slice() {
        let task = Task { kernel, pairs, displacements: (displacements, 0), tile, offset: 0 };
        return vec![sweep_inner(&task, forces).1];
    }
    across.fit(pairs);
    let room = forces.chunks_mut(pairs.tile_size).zip(&mut across.0);
    let sums = parallel::each(pairs.tiles.iter().zip(room).enumerate(), |(place, (tile, (forces, across)))| {
        let offset = (place * pairs.tile_size) as u32;
        let task = Task { kernel, pairs, displacements: (displacements, 0), tile, offset };
        let mut room = sweep_inner(&task, forces);
        sweep_border(&task, forces, across, &mut room);
        room.1
    });
    let tiles = pairs.tiles.iter().zip(forces.chunks_mut(pairs.tile_size)).enumerate();
    parallel::each(tiles, |(place, (tile, forces))| {
        add_incoming(tile, place * pairs.tile_size, across, forces);
    });
    sums
}

/// What the loop over a tile reads.
pub(crate) struct Task<'a, const D: usize, K: Kernel<D>> {
    pub kernel: &'a K,
    pub pairs: &'a PairList<D>,
    /// Displacements from this disk on.
    pub displacements: (&'a [[K::Number; D]], u32),
    pub tile: &'a Tile,
    /// First disk of the tile.
    pub offset: u32,
}

/// Those of these blocks that have pairs.
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
    forces.fill([K::Number::default(); D]);
    let mut room = task.kernel.begin();
    sweep(task, task.tile.inner.clone(), forces, &mut room);
    room
}

/// Adds the forces of the pairs of blocks within a tile to its disks.
pub(crate) fn sweep<const D: usize, K: Kernel<D>>(
    task: &Task<'_, D, K>,
    blocks: Range<usize>,
    forces: &mut [[K::Number; D]],
    room: &mut (K::Columns, K::Sums),
) {
    for block in filled(task.pairs, &blocks) {
        let pull = task.kernel.pull(block, task.displacements, room);
        scatter(pull, task.pairs, &task.pairs.blocks[block], (forces, task.offset));
    }
}

/// Adds the forces of the pairs across the border of a tile to its disks; those on the first disks are kept for the others.
pub(crate) fn sweep_border<const D: usize, K: Kernel<D>>(
    task: &Task<'_, D, K>,
    forces: &mut [[K::Number; D]],
    across: &mut [[K::Number; D]],
    room: &mut (K::Columns, K::Sums),
) {
    for place in filled(task.pairs, &task.tile.border) {
        let pull = task.kernel.pull(place, task.displacements, room);
        let block = &task.pairs.blocks[place];
        let first = &task.pairs.first[block.pairs..block.pairs + block.pair_count];
        let across = &mut across[block.pairs - task.tile.border_pairs.start..];
        scatter_to_border(pull, (first, task.offset), across, forces);
    }
}

/// Adds the forces of pairs of other tiles to the disks of a tile, which begins with disk `offset`.
pub(crate) fn add_incoming<T: Number, const D: usize>(
    tile: &Tile,
    offset: usize,
    across: &Across<T, D>,
    forces: &mut [[T; D]],
) {
    for &(disk, from, pair) in &tile.incoming {
        let force = &mut forces[disk as usize - offset];
        *force = difference(*force, across.0[from as usize][pair as usize]);
    }
}

/// Fills the columns of a block from displacements that begin with those of a disk.
pub(crate) fn fill<const D: usize, L: PairLaw>(
    law: &L,
    pairs: &PairList<D>,
    displacements: (&[Vector<D>], u32),
    block: &Block,
    columns: &mut Columns<D>,
) {
    prefetch_rows(pairs, block);
    gather(&mut columns.pull, pairs, block, displacements);
    dispatch(law, Arithmetic { columns, anchors: Anchors::of(pairs, block) });
}

/// The arithmetic of a block, compiled for each law and each vector width the machine may have. What only moves numbers is compiled once.
struct Arithmetic<'a, const D: usize> {
    columns: &'a mut Columns<D>,
    anchors: Anchors<'a, D>,
}

impl<const D: usize> LawKernel for Arithmetic<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<S: pulp::Simd, L: PairLaw>(self, simd: S, law: &L) {
        self.columns.measure(simd, &self.anchors);
        self.columns.press::<S, L, true>(simd, law, &self.anchors);
    }
}

/// Few pairs: no rows of fixed length here.
fn scatter_to_border<T: Number, const D: usize>(
    pull: &[[T; D]; BLOCK],
    (first, offset): (&[u32], u32),
    across: &mut [[T; D]],
    forces: &mut [[T; D]],
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
    let anchored = pairs.separation(pair);
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
    let inverse = 1.0 / (distance * (distance + pairs.distance(pair)));
    (apart, distance, pairs.overlap(pair) - change * (distance * inverse))
}
