//! Single-precision blocks: the pairs of a list at a base near the present positions.

use pulp::Simd;

use crate::neighbours::block::BLOCK;
use crate::neighbours::pair_block::PairBlock;
use crate::neighbours::pair_list::PairList;
use crate::neighbours::rows::gather;
use crate::parallel;
use crate::processor;
use crate::simd::prefetch::Cache;
use crate::vector::Vector;

/// Number of blocks that one thread rounds at a time.
const PORTION: usize = 64;

/// Blocks of pairs in single precision.
#[derive(Debug, Clone, Default)]
pub(crate) struct SingleBlocks<const D: usize>(Vec<SingleBlock<D>>);

/// A single-precision block. A vacant place is read, but never written to a disk.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(crate) struct SingleBlock<const D: usize> {
    pub separation: [[f32; BLOCK]; D],
    pub distance: [f32; BLOCK],
    pub overlap: [f32; BLOCK],
    pub coefficient: [f32; BLOCK],
}

/// Factors applied to lengths and to coefficients.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Factors {
    pub length: f64,
    pub coefficient: f64,
}

impl<const D: usize> SingleBlock<D> {
    /// Prefetches the columns of the block that lies `blocks` ahead, from this place on; coefficients only if they
    /// differ.
    #[inline(always)]
    pub fn prefetch(&self, cache: Cache, blocks: usize, first: usize, coefficients: bool) {
        let next = blocks * size_of::<SingleBlock<D>>() / size_of::<f32>() + first;
        for column in &self.separation {
            cache.prefetch(column, next);
        }
        cache.prefetch(&self.distance, next);
        cache.prefetch(&self.overlap, next);
        if coefficients {
            cache.prefetch(&self.coefficient, next);
        }
    }
}

impl<const D: usize> SingleBlocks<D> {
    /// A block by its index.
    #[inline(always)]
    pub fn block(&self, block: usize) -> &SingleBlock<D> {
        &self.0[block]
    }

    /// Rounds all pairs of a list at the displacements `base`.
    pub fn round_all(&mut self, pairs: &PairList<D>, base: &[Vector<D>], factors: Factors) {
        let task = Task { pairs, base, factors };
        self.0.resize(pairs.blocks.len(), SingleBlock::default());
        in_portions(&mut self.0, |block, rounded| task.round(block, rounded));
    }

    /// Rounds the pairs of some blocks again.
    pub fn round_again(
        &mut self,
        blocks: impl Iterator<Item = usize>,
        pairs: &PairList<D>,
        base: &[Vector<D>],
        factors: Factors,
    ) {
        let task = Task { pairs, base, factors };
        blocks.for_each(|block| task.round(block, &mut self.0[block]));
    }
}

/// Overwrites each block by the result of `make` for its index, in parallel where possible.
fn in_portions<T: Send>(blocks: &mut [T], make: impl Fn(usize, &mut T) + Send + Sync) {
    parallel::each(blocks.chunks_mut(PORTION).enumerate(), |(portion, blocks)| {
        for (place, block) in blocks.iter_mut().enumerate() {
            make(portion * PORTION + place, block);
        }
    });
}

impl<const D: usize> Default for SingleBlock<D> {
    fn default() -> Self {
        SingleBlock {
            separation: [[1.0; BLOCK]; D],
            distance: [1.0; BLOCK],
            overlap: [0.0; BLOCK],
            coefficient: [0.0; BLOCK],
        }
    }
}

/// Data from which blocks are rounded.
struct Task<'a, const D: usize> {
    pairs: &'a PairList<D>,
    base: &'a [Vector<D>],
    factors: Factors,
}

impl<const D: usize> Task<'_, D> {
    fn round(&self, block: usize, rounded: &mut SingleBlock<D>) {
        let mut moved = [[0.0; D]; BLOCK];
        let listed = &self.pairs.pair_blocks[block];
        let block = &self.pairs.blocks[block];
        gather(&mut moved, self.pairs, block, (self.base, 0));
        let (count, factors) = (block.pair_count, self.factors);
        processor::dispatch(Round { listed, count, moved: &moved, factors, rounded });
    }
}

/// Pairs of a block at the present positions, by the formula of [`geometry`](crate::forces::elastic::geometry), rounded
/// to single precision.
struct Round<'a, const D: usize> {
    listed: &'a PairBlock<D>,
    count: usize,
    moved: &'a [Vector<D>; BLOCK],
    factors: Factors,
    rounded: &'a mut SingleBlock<D>,
}

impl<const D: usize> pulp::WithSimd for Round<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let Round { listed, count, moved, factors, rounded } = self;
        let count = count.min(BLOCK);
        let (distances, overlaps) = (&listed.distance[..count], &listed.overlap[..count]);
        let coefficients = &listed.coefficient[..count];
        let moved = &moved[..count];
        let (distance, overlap) = (&mut rounded.distance[..count], &mut rounded.overlap[..count]);
        let coefficient = &mut rounded.coefficient[..count];
        for k in 0..count {
            let (mut squared, mut change) = (0.0, 0.0);
            for d in 0..D {
                let along = listed.separation[d][k] + moved[k][d];
                squared += along * along;
                change += moved[k][d] * (listed.separation[d][k] + along);
                rounded.separation[d][k] = (factors.length * along) as f32;
            }
            let length = f64::sqrt(squared);
            distance[k] = (factors.length * length) as f32;
            overlap[k] = (factors.length * (overlaps[k] - change / (length + distances[k]))) as f32;
            coefficient[k] = (factors.coefficient * coefficients[k]) as f32;
        }
    }
}
