//! What a list has of its pairs, in single precision where the base is: packed as the list is ([`crate::neighbours::block_storage`]), or each pair's own.

use pulp::Simd;

use crate::neighbours::pair_block::Measured;
use crate::neighbours::pair_list::{BLOCK, PairList};
use crate::neighbours::pair_types::Kinds;
use crate::neighbours::rows::gather;
use crate::parallel;
use crate::processor;
use crate::simd::ahead::{Cache, LINE};
use crate::simd::table::{self, look_up_in_single};
use crate::vector::Vector;

/// Blocks of pairs rounded by one thread at a time.
const PORTION: usize = 64;

/// Blocks of pairs, packed if those of the list are.
#[derive(Debug, Clone, Default)]
pub(crate) struct Rounded<const D: usize> {
    each: Vec<Each<D>>,
    packed: Vec<Packed<D>>,
    kinds: KindsInSingle,
}

/// A block; a place without a pair is written by none, and read in vain.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(crate) struct Each<const D: usize> {
    pub separation: [[f32; BLOCK]; D],
    pub distance: [f32; BLOCK],
    pub overlap: [f32; BLOCK],
    pub coefficient: [f32; BLOCK],
}

/// A packed block.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(crate) struct Packed<const D: usize> {
    pub separation: [[f32; BLOCK]; D],
    pub overlap: [f32; BLOCK],
    pub kind: [u8; BLOCK],
}

/// [`Kinds`], rounded.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct KindsInSingle {
    pub reach: [f32; table::LENGTH],
    pub coefficient: [f32; table::LENGTH],
}

/// Factors on lengths and on coefficients.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Factors {
    pub length: f64,
    pub coefficient: f64,
}

impl Factors {
    fn kinds(self, kinds: &Kinds) -> KindsInSingle {
        KindsInSingle {
            reach: kinds.reach.map(|reach| (self.length * reach) as f32),
            coefficient: kinds.coefficient.map(|coefficient| (self.coefficient * coefficient) as f32),
        }
    }
}

/// A block, for the arithmetic: the k-th vectors of its columns.
pub(crate) trait InSingle<const D: usize>: Copy {
    fn separation(&self) -> &[[f32; BLOCK]; D];

    fn overlap(&self) -> &[f32; BLOCK];

    /// The coefficient of all pairs that have one.
    fn one_coefficient(&self) -> f32;

    /// Distances, from overlaps.
    fn distance<S: Simd>(&self, simd: S, k: usize, overlap: S::f32s) -> S::f32s;

    fn coefficient<S: Simd>(&self, simd: S, k: usize) -> S::f32s;

    /// Asks for the columns of the block as many further on, from this place on; for coefficients if all are not the same.
    fn ask(&self, cache: Cache, blocks: usize, first: usize, coefficients: bool);
}

impl<const D: usize> InSingle<D> for &Each<D> {
    #[inline(always)]
    fn separation(&self) -> &[[f32; BLOCK]; D] {
        &self.separation
    }

    #[inline(always)]
    fn overlap(&self) -> &[f32; BLOCK] {
        &self.overlap
    }

    #[inline(always)]
    fn one_coefficient(&self) -> f32 {
        self.coefficient[0]
    }

    #[inline(always)]
    fn distance<S: Simd>(&self, _simd: S, k: usize, _overlap: S::f32s) -> S::f32s {
        S::as_simd_f32s(&self.distance).0[k]
    }

    #[inline(always)]
    fn coefficient<S: Simd>(&self, _simd: S, k: usize) -> S::f32s {
        S::as_simd_f32s(&self.coefficient).0[k]
    }

    #[inline(always)]
    fn ask(&self, cache: Cache, blocks: usize, first: usize, coefficients: bool) {
        let next = blocks * size_of::<Each<D>>() / size_of::<f32>() + first;
        for column in &self.separation {
            cache.ask(column, next);
        }
        cache.ask(&self.distance, next);
        cache.ask(&self.overlap, next);
        if coefficients {
            cache.ask(&self.coefficient, next);
        }
    }
}

impl<const D: usize> InSingle<D> for (&Packed<D>, &KindsInSingle) {
    #[inline(always)]
    fn separation(&self) -> &[[f32; BLOCK]; D] {
        &self.0.separation
    }

    #[inline(always)]
    fn overlap(&self) -> &[f32; BLOCK] {
        &self.0.overlap
    }

    #[inline(always)]
    fn one_coefficient(&self) -> f32 {
        self.1.coefficient[0]
    }

    #[inline(always)]
    fn distance<S: Simd>(&self, simd: S, k: usize, overlap: S::f32s) -> S::f32s {
        simd.sub_f32s(look_up_in_single(simd, &self.1.reach, &self.0.kind[k * S::F32_LANES..]), overlap)
    }

    #[inline(always)]
    fn coefficient<S: Simd>(&self, simd: S, k: usize) -> S::f32s {
        look_up_in_single(simd, &self.1.coefficient, &self.0.kind[k * S::F32_LANES..])
    }

    #[inline(always)]
    fn ask(&self, cache: Cache, blocks: usize, first: usize, _coefficients: bool) {
        let next = blocks * size_of::<Packed<D>>() / size_of::<f32>() + first;
        for column in &self.0.separation {
            cache.ask(column, next);
        }
        cache.ask(&self.0.overlap, next);
        if first.is_multiple_of(LINE) {
            cache.ask(&self.0.kind, blocks * size_of::<Packed<D>>() + first);
        }
    }
}

/// A block of a list.
#[derive(Debug, Clone, Copy)]
pub(crate) enum OfBlockInSingle<'a, const D: usize> {
    Each(&'a Each<D>),
    Packed(&'a Packed<D>, &'a KindsInSingle),
}

impl<const D: usize> Rounded<D> {
    /// A block as it is.
    #[inline(always)]
    pub fn of_block(&self, block: usize) -> OfBlockInSingle<'_, D> {
        match self.packed.get(block) {
            Some(packed) => OfBlockInSingle::Packed(packed, &self.kinds),
            None => OfBlockInSingle::Each(&self.each[block]),
        }
    }

    /// Rounds all pairs of a list where displacements are `base`.
    pub fn round_all(&mut self, pairs: &PairList<D>, base: &[Vector<D>], factors: Factors) {
        let (count, Rounded { each, packed, kinds }) = (pairs.blocks.len(), self);
        *kinds = pairs.listed.kinds.map_or(KindsInSingle::default(), |kinds| factors.kinds(&kinds));
        let task = Task { pairs, base, factors, kinds };
        if pairs.listed.kinds.is_some_and(|kinds| kinds.packs) {
            each.clear();
            packed.resize(count, Packed::default());
            in_portions(packed, |block, packed| task.pack(block, packed));
        } else {
            packed.clear();
            each.resize(count, Each::default());
            in_portions(each, |block, each| task.round(block, each));
        }
    }

    /// Rounds the pairs of some blocks anew.
    pub fn round_again(
        &mut self,
        blocks: impl Iterator<Item = usize>,
        pairs: &PairList<D>,
        base: &[Vector<D>],
        factors: Factors,
    ) {
        let task = Task { pairs, base, factors, kinds: &self.kinds };
        for block in blocks {
            match self.packed.get_mut(block) {
                Some(packed) => task.pack(block, packed),
                None => task.round(block, &mut self.each[block]),
            }
        }
    }
}

/// Overwrites each block by what is made of its number, perhaps side by side.
fn in_portions<T: Send>(blocks: &mut [T], make: impl Fn(usize, &mut T) + Send + Sync) {
    parallel::each(blocks.chunks_mut(PORTION).enumerate(), |(portion, blocks)| {
        for (place, block) in blocks.iter_mut().enumerate() {
            make(portion * PORTION + place, block);
        }
    });
}

impl<const D: usize> Default for Each<D> {
    fn default() -> Self {
        Each { separation: [[1.0; BLOCK]; D], distance: [1.0; BLOCK], overlap: [0.0; BLOCK], coefficient: [0.0; BLOCK] }
    }
}

impl<const D: usize> Default for Packed<D> {
    fn default() -> Self {
        Packed { separation: [[1.0; BLOCK]; D], overlap: [0.0; BLOCK], kind: [0; BLOCK] }
    }
}

/// What blocks are rounded from.
struct Task<'a, const D: usize> {
    pairs: &'a PairList<D>,
    base: &'a [Vector<D>],
    factors: Factors,
    kinds: &'a KindsInSingle,
}

impl<const D: usize> Task<'_, D> {
    fn round(&self, block: usize, rounded: &mut Each<D>) {
        let (mut moved, mut room) = ([[0.0; D]; BLOCK], Measured::default());
        let listed = self.pairs.listed.unpacked(block, &mut room);
        let kinds = self.pairs.listed.kinds_of_block(block);
        let block = &self.pairs.blocks[block];
        gather(&mut moved, self.pairs, block, (self.base, 0));
        let (count, factors) = (block.pair_count, self.factors);
        processor::dispatch(Round { listed, count, moved: &moved, factors, rounded });
        if let Some(kinds) = kinds {
            // The numbers of a packed list, whether it is packed or not.
            for place in 0..count {
                let reach = self.kinds.reach[usize::from(kinds[place]) % table::LENGTH];
                rounded.distance[place] = reach - rounded.overlap[place];
            }
        }
    }

    fn pack(&self, block: usize, packed: &mut Packed<D>) {
        let mut rounded = Each::default();
        self.round(block, &mut rounded);
        (packed.separation, packed.overlap) = (rounded.separation, rounded.overlap);
        if let Some(kinds) = self.pairs.listed.kinds_of_block(block) {
            packed.kind = *kinds;
        }
    }
}

/// Pairs of a block where the disks are, by the formula of [`geometry`](crate::forces::elastic::geometry), rounded.
struct Round<'a, const D: usize> {
    listed: &'a Measured<D>,
    count: usize,
    moved: &'a [Vector<D>; BLOCK],
    factors: Factors,
    rounded: &'a mut Each<D>,
}

impl<const D: usize> pulp::WithSimd for Round<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let Round { listed, count, moved, factors, rounded } = self;
        let separation = listed.separation.each_ref().map(|column| &column[..count]);
        let (distances, overlaps) = (&listed.distance[..count], &listed.overlap[..count]);
        let coefficients = &listed.coefficient[..count];
        let moved = &moved[..count];
        let apart = rounded.separation.each_mut().map(|column| &mut column[..count]);
        let (distance, overlap) = (&mut rounded.distance[..count], &mut rounded.overlap[..count]);
        let coefficient = &mut rounded.coefficient[..count];
        for k in 0..count {
            let (mut squared, mut change) = (0.0, 0.0);
            for d in 0..D {
                let along = separation[d][k] + moved[k][d];
                squared += along * along;
                change += moved[k][d] * (separation[d][k] + along);
                apart[d][k] = (factors.length * along) as f32;
            }
            let length = f64::sqrt(squared);
            distance[k] = (factors.length * length) as f32;
            overlap[k] = (factors.length * (overlaps[k] - change / (length + distances[k]))) as f32;
            coefficient[k] = (factors.coefficient * coefficients[k]) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::forces::assembly::Assembly;
    use crate::forces::single::Single;
    use crate::law::pair_law::Hertzian;
    use crate::packing::Mixture;
    use crate::preparation::random_points;

    #[test]
    fn forces_have_the_same_bits_packed_or_not() {
        let packing = random_points::<2>(20_000, &Mixture::default(), 0.9, 11).expect("possible");
        let forces = [true, false].map(|packs| {
            let mut assembly = Assembly::new(&packing, Hertzian::default()).expect("no coincidence");
            assembly.pack(packs);
            for (disk, displacement) in assembly.displacements.iter_mut().enumerate() {
                *displacement = [1e-3 * (3.0 * disk as f64).sin(), 1e-3 * (5.0 * disk as f64).cos()];
            }
            let pair_size = assembly.pairs().pair_size();
            let mut single = Single::new(&assembly).expect("a law without sites");
            single.evaluate(&assembly);
            (pair_size, single.forces.as_flattened().iter().map(|force| force.to_bits()).collect::<Vec<_>>())
        });
        assert!(forces[0].0 < forces[1].0);
        assert!(forces[0].1 == forces[1].1);
    }
}
