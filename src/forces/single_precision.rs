//! The hot loop in single precision, for packings far from equilibrium.
//!
//! ```text
//! u = b + m      r = D_b + (m_i − m_j)      δ = δ_b − (m_i − m_j)·(D_b + r) / (|r| + |D_b|)
//! ```
//!
//! The base b holds displacements in double precision. D_b and δ_b are separations and overlaps at the base, computed
//! in double precision and then rounded. Only the small offsets m from the base, and results derived from them, have 24
//! bits. A contact force has a relative error of 2⁻²⁴, plus the error of its change by the relative offset m_i − m_j. A
//! net force has a larger relative error, so this loop serves for residuals well above 10⁻⁷. It moves half of the
//! bytes, and twice as many pairs fit in a vector. The formulas are those of [`crate::forces::elastic`].
//!
//! Units are powers of two near a radius and the force of such an overlap. No number leaves the range of single
//! precision, in any units of the packing. Every operation is rounded as in IEEE 754, for every vector width.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use crate::forces::advance::{Advanced, Movers, Reach, advance};
use crate::forces::assembly::Assembly;
use crate::forces::elastic::{BorderForces, Kernel, all_tiles};
use crate::law::pair_law::PairLaw;
use crate::neighbours::block::BLOCK;
use crate::neighbours::list_keeper::ListNumber;
use crate::neighbours::pair_list::PairList;
use crate::neighbours::rows::{gather, prefetch_rows};
use crate::neighbours::single_precision::{Factors, SingleBlock, SingleBlocks};
use crate::parallel::{self, PIECE};
use crate::processor;
use crate::simd::components;
use crate::simd::prefetch::Cache;
use crate::simd::roots::positive_part_in_single;
use crate::vector::{Vector, larger, longest_difference_squared};

/// Distance of the list prefetch \[blocks\]. The latency of the memory is about this many blocks of arithmetic. The
/// first-level cache has space for one block only.
fn blocks_ahead(cache: Cache) -> usize {
    match cache {
        Cache::Second => 4,
        Cache::First => 1,
    }
}

/// Units of single-precision numbers, powers of two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// Length; the exponent is even, so the square root is also a power of two \[length\].
    pub length: f64,
    /// Force \[force\].
    pub force: f64,
    /// Time, for masses 1 \[time\].
    pub time: f64,
}

impl Units {
    /// The units for disks of this radius that press on each other with this force; none if these are far out of
    /// proportion.
    fn of(radius: f64, force: f64) -> Option<Self> {
        let (length, force) = (exponent(radius)? & !1, exponent(force)?);
        Some(Units {
            length: power_of_two(length),
            force: power_of_two(force),
            time: power_of_two((length - force).div_euclid(2)),
        })
    }

    /// Unit of velocity \[length / time\].
    pub fn speed(&self) -> f64 {
        self.length / self.time
    }
}

/// Binary exponent of a number; none if its square could overflow or underflow.
fn exponent(value: f64) -> Option<i32> {
    let exponent = ((value.abs().to_bits() >> 52) & 0x7ff) as i32 - 1023;
    (exponent.abs() < 500).then_some(exponent)
}

fn power_of_two(exponent: i32) -> f64 {
    2f64.powi(exponent)
}

/// Disks in single precision, beside an [`Assembly`] that keeps their base. It is valid as long as only this type
/// changes the displacements. A caller that changes them must call [`Single::invalidate_base`].
#[derive(Debug, Clone)]
pub struct Single<const D: usize> {
    units: Units,
    blocks: SingleBlocks<D>,
    base: Vec<Vector<D>>,
    offsets: Vec<[f32; D]>,
    /// Forces of the last evaluation, all disks \[`Units::force`\].
    pub forces: Vec<[f32; D]>,
    /// Forces of pairs whose second disks are in other tiles.
    border_forces: BorderForces<f32, D>,
    /// The list whose pairs are in `blocks`, by [`Assembly::list_number`]; none if the base is no longer valid.
    listing: Option<ListNumber>,
}

impl<const D: usize> Single<D> {
    /// Single-precision state for the disks of an assembly. None for disks with sites or loads, for a law that is not a power of the
    /// overlap, or for numbers near the limits of double precision.
    pub fn new(assembly: &Assembly<D>) -> Option<Self> {
        if assembly.has_on_site_forces() || !assembly.law().is_power() {
            return None;
        }
        let radius = assembly.radii().iter().copied().fold(f64::INFINITY, f64::min);
        Some(Single {
            units: Units::of(radius, assembly.law().force_scale(radius))?,
            blocks: SingleBlocks::default(),
            base: Vec::new(),
            offsets: vec![[0.0; D]; assembly.len()],
            forces: vec![[0.0; D]; assembly.len()],
            border_forces: BorderForces::default(),
            listing: None,
        })
    }

    /// Units of offsets, forces and velocities.
    pub fn units(&self) -> Units {
        self.units
    }

    /// Marks the base as outdated. The next step takes the assembly's displacements as its base, because they were
    /// written or changed by others.
    pub fn invalidate_base(&mut self) {
        self.listing = None;
    }

    /// Copies the forces of the assembly's last evaluation.
    pub fn take_forces(&mut self, assembly: &Assembly<D>) {
        let unit = 1.0 / self.units.force;
        let pieces = self.forces.chunks_mut(PIECE).zip(assembly.forces.chunks(PIECE));
        parallel::each(pieces, |(to, from)| {
            for (to, from) in to.as_flattened_mut().iter_mut().zip(from.as_flattened()) {
                *to = (unit * from) as f32;
            }
        });
    }

    /// Writes the present positions into the assembly.
    pub fn write_displacements(&self, assembly: &mut Assembly<D>) {
        if self.listing.is_none_or(|known| known.list != assembly.list_number().list) {
            // Before a new list was built, the displacements were written. The anchors may have changed since.
            return;
        }
        let places =
            assembly.displacements.chunks_mut(PIECE).zip(self.base.chunks(PIECE)).zip(self.offsets.chunks(PIECE));
        let unit = self.units.length;
        parallel::each(places, |((to, base), offsets)| place(unit, (base, offsets), to));
    }

    /// The same for some of the disks.
    fn write_some_displacements(&self, assembly: &mut Assembly<D>, disks: Range<usize>) {
        let from = (&self.base[disks.clone()], &self.offsets[disks.clone()]);
        place(self.units.length, from, &mut assembly.displacements[disks]);
    }

    /// Makes the assembly's displacements the base if the base is outdated, and rounds the pairs of the list. Pairs
    /// inserted into a long list are rounded at the present base.
    fn prepare(&mut self, assembly: &Assembly<D>) {
        let number = assembly.list_number();
        let known = self.listing.replace(number);
        if known == self.listing {
            return;
        }
        let pairs = assembly.pairs();
        let law = assembly.law();
        let coefficient = libm::pow(self.units.length, law.exponent() - 1.0) / self.units.force;
        let factors = Factors { length: 1.0 / self.units.length, coefficient };
        if pairs.is_long() && known.is_some_and(|known| known.list == number.list) {
            self.blocks.round_again(pairs.blocks_with_insertions(), pairs, &self.base, factors);
            return;
        }
        self.base.clone_from(&assembly.displacements);
        self.offsets.fill([0.0; D]);
        self.blocks.round_all(pairs, &self.base, factors);
    }

    /// Moves all mobile disks and evaluates the forces at their new positions, like [`Assembly::advance`]. `kick` takes
    /// (forces, velocities, offsets) of some disks and returns a bound on their displacements \[length\].
    pub fn advance<P: Send>(
        &mut self,
        assembly: &mut Assembly<D>,
        velocities: &mut [[f32; D]],
        kick: impl Fn(&[[f32; D]], &mut [[f32; D]], &mut [[f32; D]]) -> f64 + Sync,
        observe: impl Fn(&[[f32; D]], &[[f32; D]]) -> P + Send + Sync,
    ) -> Advanced<P> {
        if !assembly.may_advance() {
            return Advanced::Not;
        }
        self.prepare(assembly);
        let (law, unit, base) = (assembly.shared_law(), self.units.length, self.base.as_slice());
        let (pairs, at_build, limit, bounds) = assembly.listing();
        let longest = |first: usize, offsets: &[[f32; D]]| {
            let disks = first..first + offsets.len();
            longest_offset(unit, (&base[disks.clone()], offsets), &at_build[disks])
        };
        let kernel = Pressed { law: law.as_ref(), pairs, blocks: &self.blocks };
        let movers = Movers { velocities, displacements: &mut self.offsets, forces: &mut self.forces };
        let reach = Reach { limit, bounds, longest };
        let advanced = Advanced::of(advance(&kernel, pairs, (movers, &mut self.border_forces), reach, kick, observe));
        if matches!(advanced, Advanced::Moved) || assembly.checks_next() {
            // The assembly checks its displacements.
            self.write_displacements(assembly);
        } else {
            for disks in assembly.disks_to_check() {
                self.write_some_displacements(assembly, disks);
            }
        }
        advanced
    }

    /// Evaluates the forces at the present positions.
    pub fn evaluate(&mut self, assembly: &Assembly<D>) {
        self.prepare(assembly);
        let pairs = assembly.pairs();
        let kernel = Pressed { law: assembly.law(), pairs, blocks: &self.blocks };
        let _ = all_tiles(&kernel, pairs, &self.offsets, &mut self.border_forces, &mut self.forces);
    }

    /// Moves all mobile disks by `kick`, without an evaluation of forces.
    pub fn kick<K>(
        &mut self,
        assembly: &Assembly<D>,
        velocities: &mut [[f32; D]],
        kick: impl FnOnce(&[[f32; D]], &mut [[f32; D]], &mut [[f32; D]]) -> K,
    ) -> K {
        self.prepare(assembly);
        let mobile = assembly.mobile_count();
        kick(&self.forces[..mobile], velocities, &mut self.offsets[..mobile])
    }
}

/// Positions of disks at base + offset.
fn place<const D: usize>(unit: f64, (base, offsets): (&[Vector<D>], &[[f32; D]]), places: &mut [Vector<D>]) {
    let from = base.as_flattened().iter().zip(offsets.as_flattened());
    for (place, (base, offset)) in places.as_flattened_mut().iter_mut().zip(from) {
        *place = base + unit * f64::from(*offset);
    }
}

/// The largest displacement since the list was built, for disks at base + offset, with the rounding of written
/// positions.
fn longest_offset<const D: usize>(
    unit: f64,
    (base, offsets): (&[Vector<D>], &[[f32; D]]),
    listed: &[Vector<D>],
) -> f64 {
    let mut places = [[0.0; D]; 64];
    let pieces = base.chunks(64).zip(offsets.chunks(64)).zip(listed.chunks(64));
    let squares = pieces.map(|((base, offsets), listed)| {
        let places = &mut places[..base.len()];
        place(unit, (base, offsets), places);
        longest_difference_squared(places, listed)
    });
    squares.fold(0.0, larger).sqrt()
}

/// Kernel for the force of each pair of a block.
struct Pressed<'a, const D: usize> {
    law: &'a dyn PairLaw,
    pairs: &'a PairList<D>,
    blocks: &'a SingleBlocks<D>,
}

impl<const D: usize> Kernel<D> for Pressed<'_, D> {
    type Number = f32;
    type Columns = Columns<D>;
    type Sums = ();

    fn begin(&self) -> (Columns<D>, ()) {
        (Columns::new(), ())
    }

    fn pair_forces<'a>(
        &self,
        block: usize,
        offsets: (&[[f32; D]], u32),
        (columns, ()): &'a mut (Columns<D>, ()),
    ) -> &'a [[f32; D]; BLOCK] {
        prefetch_rows(self.pairs, &self.pairs.blocks[block]);
        gather(&mut columns.pair_vectors, self.pairs, &self.pairs.blocks[block], offsets);
        let (of_pairs, pair_count) = (self.blocks.block(block), self.pairs.blocks[block].pair_count);
        columns.compute_forces(self.law, of_pairs, pair_count, self.pairs.prefetches());
        &columns.pair_vectors
    }
}

/// One block of pairs, column by column, as in [`crate::forces::block_arithmetic`].
#[repr(align(64))]
struct Columns<const D: usize> {
    /// Relative offset of each pair, then the force on its first disk.
    pair_vectors: [[f32; D]; BLOCK],
    separation: [[f32; BLOCK]; D],
    /// Change of the squared distance, then the overlap.
    overlap: [f32; BLOCK],
    force: [f32; BLOCK],
    /// Distance, then its reciprocal.
    inverse: [f32; BLOCK],
}

impl<const D: usize> Columns<D> {
    fn new() -> Self {
        Columns {
            pair_vectors: [[0.0; D]; BLOCK],
            separation: [[0.0; BLOCK]; D],
            overlap: [0.0; BLOCK],
            force: [0.0; BLOCK],
            inverse: [0.0; BLOCK],
        }
    }

    /// Computes the forces on the first disks of a block of pairs from their relative offsets. A later block is
    /// prefetched into the given cache.
    fn compute_forces(
        &mut self,
        law: &dyn PairLaw,
        block: &SingleBlock<D>,
        pair_count: usize,
        prefetches: Option<Cache>,
    ) {
        let has_coefficients = !law.has_one_coefficient();
        processor::dispatch(Overlaps { block, columns: self, pair_count, prefetches, has_coefficients });
        let count = pair_count.next_multiple_of(16).min(BLOCK);
        law.forces_in_single(&block.coefficient[..count], &self.overlap[..count], &mut self.force[..count]);
        processor::dispatch(Resolve { columns: self, pair_count });
    }
}

/// Separations, overlaps and reciprocal distances of a block.
struct Overlaps<'a, const D: usize> {
    block: &'a SingleBlock<D>,
    columns: &'a mut Columns<D>,
    pair_count: usize,
    /// Cache for the prefetch of a later block, if the list is long.
    prefetches: Option<Cache>,
    /// Whether the law reads the column of coefficients.
    has_coefficients: bool,
}

impl<const D: usize> WithSimd for Overlaps<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Overlaps { block, columns, pair_count, prefetches, has_coefficients } = self;
        let count = pair_count.div_ceil(S::F32_LANES).min(BLOCK / S::F32_LANES);
        let read = |column| &S::as_simd_f32s(column).0[..count];
        let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
        let pair_vectors = &S::as_simd_f32s(columns.pair_vectors.as_flattened()).0[..D * count];
        let overlap = &mut S::as_mut_simd_f32s(&mut columns.overlap).0[..count];
        let inverse = &mut S::as_mut_simd_f32s(&mut columns.inverse).0[..count];
        let (anchor_distance, anchor_overlap) = (read(&block.distance), read(&block.overlap));
        for k in 0..count {
            let offset = components::split_single::<S, D>(simd, &pair_vectors[D * k..D * (k + 1)]);
            let (mut square, mut changed) = (zero, zero);
            for d in 0..D {
                let anchored = S::as_simd_f32s(&block.separation[d]).0[k];
                let along = simd.add_f32s(anchored, offset[d]);
                let squared = simd.mul_f32s(along, along);
                let change = simd.mul_f32s(offset[d], simd.add_f32s(anchored, along));
                (square, changed) = match d {
                    0 => (squared, change),
                    _ => (simd.add_f32s(square, squared), simd.add_f32s(changed, change)),
                };
                S::as_mut_simd_f32s(&mut columns.separation[d]).0[k] = along;
            }
            if let Some(cache) = prefetches {
                block.prefetch(cache, blocks_ahead(cache), k * S::F32_LANES, has_coefficients);
            }
            overlap[k] = changed;
            inverse[k] = simd.sqrt_f32s(square);
        }
        for k in 0..count {
            let distance = inverse[k];
            let both = simd.add_f32s(distance, anchor_distance[k]);
            let of_both = simd.div_f32s(one, simd.mul_f32s(distance, both));
            let change = simd.mul_f32s(overlap[k], simd.mul_f32s(distance, of_both));
            overlap[k] = positive_part_in_single(simd, simd.sub_f32s(anchor_overlap[k], change));
            inverse[k] = simd.mul_f32s(both, of_both);
        }
    }
}

/// The force on each first disk of a block.
struct Resolve<'a, const D: usize> {
    columns: &'a mut Columns<D>,
    pair_count: usize,
}

impl<const D: usize> WithSimd for Resolve<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Resolve { columns, pair_count } = self;
        let count = pair_count.div_ceil(S::F32_LANES).min(BLOCK / S::F32_LANES);
        let force = &S::as_simd_f32s(&columns.force).0[..count];
        let inverse = &S::as_simd_f32s(&columns.inverse).0[..count];
        let pair_vectors = &mut S::as_mut_simd_f32s(columns.pair_vectors.as_flattened_mut()).0[..D * count];
        for k in 0..count {
            let factor = simd.mul_f32s(force[k], inverse[k]);
            let mut along = [factor; D];
            for d in 0..D {
                along[d] = simd.mul_f32s(factor, S::as_simd_f32s(&columns.separation[d]).0[k]);
            }
            components::join_single(simd, &along, &mut pair_vectors[D * k..D * (k + 1)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::power_laws::Hertzian;
    use crate::processor::Processor;

    /// Computes the forces of a block with every vector width, with and without prefetch.
    #[test]
    fn the_bits_of_a_block_do_not_depend_on_the_width_of_vectors() {
        let wave = |by: f32, from: f32, size: f32| -> [f32; BLOCK] {
            std::array::from_fn(|k| from + size * (by * k as f32).sin())
        };
        let (separation, overlap) = ([wave(1.3, 0.4, 0.5), wave(2.7, 0.6, 0.3)], wave(1.9, 0.0, 0.2));
        let [x, y] = [wave(3.1, 0.0, 0.05), wave(0.9, 0.0, 0.05)];
        let offsets: [[f32; 2]; BLOCK] = std::array::from_fn(|k| [x[k], y[k]]);
        let block =
            &SingleBlock::<2> { separation, distance: wave(0.7, 1.0, 0.1), overlap, coefficient: wave(0.3, 2.0, 1.0) };
        let law = &Hertzian::default();
        let mut forces = Vec::new();
        for prefetches in [None, Some(Cache::First), Some(Cache::Second)] {
            for processor in Processor::all() {
                let columns = &mut Columns { pair_vectors: offsets, ..Columns::new() };
                processor.run(|| columns.compute_forces(law, block, BLOCK, prefetches));
                forces.push(columns.pair_vectors);
            }
        }
        let bits = |forces: &[[f32; 2]; BLOCK]| forces.map(|force| force.map(f32::to_bits));
        assert!(forces.iter().all(|one| bits(one) == bits(&forces[0])));
        let pressed = forces[0].iter().filter(|force| force[0] != 0.0).count();
        assert!((BLOCK / 4..BLOCK).contains(&pressed), "{pressed} pairs press");
    }
}
