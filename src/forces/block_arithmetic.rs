//! One block of pairs, column by column: separations, overlaps and forces, by the formulas of
//! [`crate::forces::elastic`].
//!
//! The arithmetic passes through the block several times, with a few operations each. The operations on one vector of
//! pairs depend on each other, and the processor must overlap those of many vectors. Short passes let it do so.
//! Meanwhile a later block of the list is prefetched.

use pulp::{Simd, WithSimd};

use crate::law::pair_law::PairLaw;
use crate::neighbours::block::{BLOCK, Block};
use crate::neighbours::pair_block::PairBlock;
use crate::neighbours::pair_list::PairList;
use crate::processor::{self, Processor};
use crate::simd::components;
use crate::simd::prefetch::Cache;
use crate::simd::roots::{positive_part, reciprocal, square_roots};
use crate::vector::Vector;

/// Distance of the list prefetch \[blocks\]. The latency of the memory is about this many blocks of arithmetic. The
/// first-level cache has space for one block only.
fn blocks_ahead(cache: Cache) -> usize {
    match cache {
        Cache::Second => 2,
        Cache::First => 1,
    }
}

/// The same distance as a number of entries of a column.
fn places_ahead<const D: usize>(cache: Cache) -> usize {
    blocks_ahead(cache) * size_of::<PairBlock<D>>() / size_of::<f64>()
}

/// One block of pairs, column by column.
#[repr(align(64))]
pub(crate) struct Columns<const D: usize> {
    /// Relative displacement of each pair, then the force on its first disk; stored as consecutive vectors.
    pub pair_vectors: [Vector<D>; BLOCK],
    /// Separation.
    pub separation: [[f64; BLOCK]; D],
    /// Overlap; 0 without contact.
    pub overlap: [f64; BLOCK],
    pub force: [f64; BLOCK],
    /// Reciprocal of the distance.
    pub inverse: [f64; BLOCK],
}

/// The stored columns of a block, and its number of pairs.
pub(crate) struct Anchors<'a, const D: usize> {
    pair_count: usize,
    block: &'a PairBlock<D>,
    /// Whether the law reads the column of coefficients.
    has_coefficients: bool,
}

impl<'a, const D: usize> Anchors<'a, D> {
    #[inline(always)]
    pub fn of(law: &dyn PairLaw, pairs: &'a PairList<D>, block: &Block) -> Self {
        Anchors {
            pair_count: block.pair_count,
            block: &pairs.pair_blocks[block.pairs / BLOCK],
            has_coefficients: !law.has_one_coefficient(),
        }
    }

    /// Number of pairs, rounded up to an even number of vectors of any width.
    fn place_count(&self) -> usize {
        self.pair_count.next_multiple_of(16).min(BLOCK)
    }

    /// Number of vectors of pairs, always even.
    #[inline(always)]
    fn vector_count<S: Simd>(&self) -> usize {
        (2 * self.pair_count.div_ceil(2 * S::F64_LANES)).min(BLOCK / S::F64_LANES)
    }
}

impl<const D: usize> Columns<D> {
    #[inline(always)]
    pub fn new() -> Self {
        Columns {
            pair_vectors: [[0.0; D]; BLOCK],
            separation: [[0.0; BLOCK]; D],
            overlap: [0.0; BLOCK],
            force: [0.0; BLOCK],
            inverse: [0.0; BLOCK],
        }
    }

    /// Computes separations, overlaps and reciprocal distances from the relative displacements.
    pub fn compute_overlaps(&mut self, anchors: &Anchors<'_, D>) {
        processor::dispatch(Overlaps { columns: self, anchors });
    }

    /// Computes the forces from the overlaps.
    pub fn compute_forces(&mut self, law: &dyn PairLaw, anchors: &Anchors<'_, D>) {
        let count = anchors.place_count();
        law.forces(&anchors.block.coefficient[..count], &self.overlap[..count], &mut self.force[..count]);
    }

    /// Computes the force on each first disk from the magnitudes, into `pair_vectors`.
    ///
    /// No other result is stored. Force over distance would have an address 4096 bytes from the separation that is read
    /// next. Processors that compare only the low 12 bits of addresses would then delay that read.
    pub fn resolve(&mut self, anchors: &Anchors<'_, D>) {
        processor::dispatch(Resolve { columns: self, anchors });
    }
}

/// Separations, overlaps and reciprocal distances of a block.
struct Overlaps<'a, const D: usize> {
    columns: &'a mut Columns<D>,
    anchors: &'a Anchors<'a, D>,
}

impl<const D: usize> WithSimd for Overlaps<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Overlaps { columns, anchors } = self;
        let (count, block) = (anchors.vector_count::<S>(), anchors.block);
        let cache = Cache::here();
        let ahead = places_ahead::<D>(cache);
        let read = |column| &S::as_simd_f64s(column).0[..count];
        let anchor_overlap = read(&block.overlap);
        let moved = &S::as_simd_f64s(columns.pair_vectors.as_flattened()).0[..D * count];
        let overlap = &mut S::as_mut_simd_f64s(&mut columns.overlap).0[..count];
        let inverse = &mut S::as_mut_simd_f64s(&mut columns.inverse).0[..count];
        let anchor_distance = read(&block.distance);
        let (zero, roots) = (simd.splat_f64s(0.0), Processor::here().roots());
        for k in (0..count).step_by(2) {
            let mut squares = [zero; 2];
            for half in 0..2 {
                let k = k + half;
                let moved = components::split::<S, D>(simd, &moved[D * k..D * (k + 1)]);
                let mut change = zero;
                for d in 0..D {
                    let anchored = S::as_simd_f64s(&block.separation[d]).0[k];
                    let along = simd.add_f64s(anchored, moved[d]);
                    let squared = simd.mul_f64s(along, along);
                    let changed = simd.mul_f64s(moved[d], simd.add_f64s(anchored, along));
                    // The first term is not added to zero, because the compiler may not omit that addition.
                    (squares[half], change) = match d {
                        0 => (squared, changed),
                        _ => (simd.add_f64s(squares[half], squared), simd.add_f64s(change, changed)),
                    };
                    S::as_mut_simd_f64s(&mut columns.separation[d]).0[k] = along;
                    cache.prefetch(&block.separation[d], ahead + k * S::F64_LANES);
                }
                overlap[k] = change;
            }
            [inverse[k], inverse[k + 1]] = square_roots(simd, roots, squares);
        }
        for k in 0..count {
            let distance = inverse[k];
            let both = simd.add_f64s(distance, anchor_distance[k]);
            // One reciprocal serves for change / both and 1 / distance, because divisions and roots limit the speed of
            // the loop.
            let of_both = reciprocal(simd, roots, simd.mul_f64s(distance, both));
            let change = simd.mul_f64s(overlap[k], simd.mul_f64s(distance, of_both));
            overlap[k] = positive_part(simd, simd.sub_f64s(anchor_overlap[k], change));
            inverse[k] = simd.mul_f64s(both, of_both);
            cache.prefetch(&block.distance, ahead + k * S::F64_LANES);
            cache.prefetch(&block.overlap, ahead + k * S::F64_LANES);
            if anchors.has_coefficients {
                cache.prefetch(&block.coefficient, ahead + k * S::F64_LANES);
            }
        }
    }
}

/// The force on each first disk of a block.
struct Resolve<'a, const D: usize> {
    columns: &'a mut Columns<D>,
    anchors: &'a Anchors<'a, D>,
}

impl<const D: usize> WithSimd for Resolve<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Resolve { columns, anchors } = self;
        let count = anchors.vector_count::<S>();
        let force = &S::as_simd_f64s(&columns.force).0[..count];
        let inverse = &S::as_simd_f64s(&columns.inverse).0[..count];
        let pair_forces = &mut S::as_mut_simd_f64s(columns.pair_vectors.as_flattened_mut()).0[..D * count];
        for k in 0..count {
            let factor = simd.mul_f64s(force[k], inverse[k]);
            let mut along = [factor; D];
            for d in 0..D {
                along[d] = simd.mul_f64s(factor, S::as_simd_f64s(&columns.separation[d]).0[k]);
            }
            components::join(simd, &along, &mut pair_forces[D * k..D * (k + 1)]);
        }
    }
}
