//! The hot loop in single precision, for disks that are far from rest.
//!
//! ```text
//! u = b + m      r = D_b + (m_i − m_j)      δ = δ_b − (m_i − m_j)·(D_b + r) / (|r| + |D_b|)
//! ```
//!
//! b, the base, are displacements in double precision; D_b and δ_b, separations and overlaps there, are found in double precision and then
//! rounded. Only the offsets m from the base, small ones, and what follows from them have 24 bits: a force is known to 2⁻²⁴ of itself and of what
//! a relative offset m_i − m_j changes it by. A net force is so much less exact than a contact force, so this
//! is for residuals well above 10⁻⁷. Half of the bytes are moved, and twice as many pairs fit in a vector; the formulas are those of [`crate::forces::elastic`].
//!
//! Units are powers of two near a radius and the force of its overlap, so that no number leaves the range of single precision, whatever
//! units the packing has. Every operation is rounded as IEEE 754 has it, the same on any vectors.

use std::ops::Range;

use pulp::Simd;

use crate::forces::advance::{Advanced, Movers, Reach, advance};
use crate::forces::assembly::Assembly;
use crate::forces::elastic::{Across, Kernel, all_tiles};
use crate::law::kernel::{LawKernel, dispatch};
use crate::law::pair_law::PairLaw;
use crate::neighbours::block::BLOCK;
use crate::neighbours::pair_list::PairList;
use crate::neighbours::rows::{gather, prefetch_rows};
use crate::neighbours::single_precision::{Factors, SingleBlock, SingleBlocks};
use crate::parallel::{self, PIECE};
use crate::simd::components;
use crate::simd::prefetch::Cache;
use crate::simd::roots::positive_part_in_single;
use crate::vector::{Vector, larger, longest_difference_squared};

/// How far ahead the list is asked for: its memory is so many blocks of arithmetic away, and the first cache has no room for more than
/// one, beside what else it holds \[blocks\].
fn blocks_ahead(cache: Cache) -> usize {
    match cache {
        Cache::Second => 4,
        Cache::First => 1,
    }
}

/// Units of numbers in single precision, powers of two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// Of lengths; the power is even, so that its root is one too \[length\].
    pub length: f64,
    /// Of forces \[force\].
    pub force: f64,
    /// Of times, for masses 1 \[time\].
    pub time: f64,
}

impl Units {
    /// Those of disks of this radius, which press on each other with this force; none if these are out of all proportion.
    fn of(radius: f64, force: f64) -> Option<Self> {
        let (length, force) = (exponent(radius)? & !1, exponent(force)?);
        Some(Units {
            length: power_of_two(length),
            force: power_of_two(force),
            time: power_of_two((length - force).div_euclid(2)),
        })
    }

    /// Of velocities \[length / time\].
    pub fn speed(&self) -> f64 {
        self.length / self.time
    }
}

/// The exponent of two in a number whose square has one too.
fn exponent(value: f64) -> Option<i32> {
    let exponent = ((value.abs().to_bits() >> 52) & 0x7ff) as i32 - 1023;
    (exponent.abs() < 500).then_some(exponent)
}

fn power_of_two(exponent: i32) -> f64 {
    2f64.powi(exponent)
}

/// Disks in single precision, beside an [`Assembly`] that keeps their base. Holds as long as its displacements are
/// not changed by others; who does that calls [`Single::forget`].
#[derive(Debug, Clone)]
pub struct Single<const D: usize> {
    units: Units,
    blocks: SingleBlocks<D>,
    base: Vec<Vector<D>>,
    offsets: Vec<[f32; D]>,
    /// Forces of the last evaluation, all disks \[`Units::force`\].
    pub forces: Vec<[f32; D]>,
    across: Across<f32, D>,
    /// The list whose pairs are in `blocks`, as [`Assembly::listing_number`] has it; none if the base is not good any more.
    listing: Option<(usize, usize)>,
}

impl<const D: usize> Single<D> {
    /// For the disks of an assembly; none for a law with sites, and for numbers near the ends of what double precision has.
    pub fn new<L: PairLaw>(assembly: &Assembly<D, L>) -> Option<Self> {
        if assembly.law().has_sites() {
            return None;
        }
        let radius = assembly.radii().iter().copied().fold(f64::INFINITY, f64::min);
        Some(Single {
            units: Units::of(radius, assembly.law().force_scale(radius))?,
            blocks: SingleBlocks::default(),
            base: Vec::new(),
            offsets: vec![[0.0; D]; assembly.len()],
            forces: vec![[0.0; D]; assembly.len()],
            across: Across::default(),
            listing: None,
        })
    }

    /// Units of offsets, forces and velocities.
    pub fn units(&self) -> Units {
        self.units
    }

    /// The displacements of the assembly are to be the base of the next step: they are settled, or were changed by others.
    pub fn forget(&mut self) {
        self.listing = None;
    }

    /// Takes the forces of the assembly's last evaluation.
    pub fn take_forces<L: PairLaw>(&mut self, assembly: &Assembly<D, L>) {
        let unit = 1.0 / self.units.force;
        let pieces = self.forces.chunks_mut(PIECE).zip(assembly.forces.chunks(PIECE));
        parallel::each(pieces, |(to, from)| {
            for (to, from) in to.as_flattened_mut().iter_mut().zip(from.as_flattened()) {
                *to = (unit * from) as f32;
            }
        });
    }

    /// Puts the disks of the assembly where these are.
    pub fn settle<L: PairLaw>(&self, assembly: &mut Assembly<D, L>) {
        if self.listing.is_none_or(|(list, _)| list != assembly.listing_number().0) {
            // Where another list was made the disks were settled, and may have other anchors since.
            return;
        }
        let places =
            assembly.displacements.chunks_mut(PIECE).zip(self.base.chunks(PIECE)).zip(self.offsets.chunks(PIECE));
        let unit = self.units.length;
        parallel::each(places, |((to, base), offsets)| place(unit, (base, offsets), to));
    }

    /// The same for these disks.
    fn settle_some<L: PairLaw>(&self, assembly: &mut Assembly<D, L>, disks: Range<usize>) {
        let from = (&self.base[disks.clone()], &self.offsets[disks.clone()]);
        place(self.units.length, from, &mut assembly.displacements[disks]);
    }

    /// Makes the displacements of the assembly the base, if they are not and have to be, and rounds what its list has. Pairs that a long list
    /// was amended by are rounded from the base there is.
    fn prepare<L: PairLaw>(&mut self, assembly: &Assembly<D, L>) {
        let (list, amendments) = assembly.listing_number();
        let known = self.listing.replace((list, amendments));
        if known == self.listing {
            return;
        }
        let pairs = assembly.pairs();
        let law = assembly.law();
        let coefficient = libm::pow(self.units.length, law.exponent() - 1.0) / self.units.force;
        let factors = Factors { length: 1.0 / self.units.length, coefficient };
        if pairs.is_long() && known.is_some_and(|(same, _)| same == list) {
            self.blocks.round_again(pairs.blocks_with_insertions(), pairs, &self.base, factors);
            return;
        }
        self.base.clone_from(&assembly.displacements);
        self.offsets.fill([0.0; D]);
        self.blocks.round_all(pairs, &self.base, factors);
    }

    /// Moves all mobile disks and evaluates the forces where they then are, as [`Assembly::advance`] does; `kick` gets (forces, velocities,
    /// offsets) of some of them and returns a bound on how far it moved any \[length\].
    pub fn advance<L: PairLaw, P: Send>(
        &mut self,
        assembly: &mut Assembly<D, L>,
        velocities: &mut [[f32; D]],
        kick: impl Fn(&[[f32; D]], &mut [[f32; D]], &mut [[f32; D]]) -> f64 + Sync,
        look: impl Fn(&[[f32; D]], &[[f32; D]]) -> P + Send + Sync,
    ) -> Advanced<P> {
        if !assembly.may_advance() {
            return Advanced::Not;
        }
        self.prepare(assembly);
        let (law, unit, base) = (*assembly.law(), self.units.length, self.base.as_slice());
        let (pairs, at_build, limit, bounds) = assembly.listing();
        let longest = |first: usize, offsets: &[[f32; D]]| {
            let disks = first..first + offsets.len();
            longest_offset(unit, (&base[disks.clone()], offsets), &at_build[disks])
        };
        let kernel = Pressed { law: &law, pairs, blocks: &self.blocks };
        let movers = Movers { velocities, displacements: &mut self.offsets, forces: &mut self.forces };
        let reach = Reach { limit, bounds, longest };
        let advanced = Advanced::of(advance(&kernel, pairs, (movers, &mut self.across), reach, kick, look));
        if matches!(advanced, Advanced::Moved) || assembly.looks_next() {
            // The assembly looks at its disks.
            self.settle(assembly);
        } else {
            for disks in assembly.disks_to_see() {
                self.settle_some(assembly, disks);
            }
        }
        advanced
    }

    /// Forces where the disks are.
    pub fn evaluate<L: PairLaw>(&mut self, assembly: &Assembly<D, L>) {
        self.prepare(assembly);
        let pairs = assembly.pairs();
        let kernel = Pressed { law: assembly.law(), pairs, blocks: &self.blocks };
        let _ = all_tiles(&kernel, pairs, &self.offsets, &mut self.across, &mut self.forces);
    }

    /// Moves all mobile disks by `kick` alone.
    pub fn kick<L: PairLaw, K>(
        &mut self,
        assembly: &Assembly<D, L>,
        velocities: &mut [[f32; D]],
        kick: impl FnOnce(&[[f32; D]], &mut [[f32; D]], &mut [[f32; D]]) -> K,
    ) -> K {
        self.prepare(assembly);
        let mobile = assembly.mobile_count();
        kick(&self.forces[..mobile], velocities, &mut self.offsets[..mobile])
    }
}

/// Where disks at base + offset are.
fn place<const D: usize>(unit: f64, (base, offsets): (&[Vector<D>], &[[f32; D]]), places: &mut [Vector<D>]) {
    let from = base.as_flattened().iter().zip(offsets.as_flattened());
    for (place, (base, offset)) in places.as_flattened_mut().iter_mut().zip(from) {
        *place = base + unit * f64::from(*offset);
    }
}

/// The longest offset from where disks were listed, of those at base + offset, as they are settled.
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

/// The force of each pair of a block.
struct Pressed<'a, const D: usize, L> {
    law: &'a L,
    pairs: &'a PairList<D>,
    blocks: &'a SingleBlocks<D>,
}

impl<const D: usize, L: PairLaw> Kernel<D> for Pressed<'_, D, L> {
    type Number = f32;
    type Columns = Columns<D>;
    type Sums = ();

    fn begin(&self) -> (Columns<D>, ()) {
        (Columns::new(), ())
    }

    fn pull<'a>(
        &self,
        block: usize,
        offsets: (&[[f32; D]], u32),
        (columns, ()): &'a mut (Columns<D>, ()),
    ) -> &'a [[f32; D]; BLOCK] {
        prefetch_rows(self.pairs, &self.pairs.blocks[block]);
        gather(&mut columns.pull, self.pairs, &self.pairs.blocks[block], offsets);
        let (of_pairs, pair_count) = (self.blocks.block(block), self.pairs.blocks[block].pair_count);
        dispatch(self.law, Arithmetic { block: of_pairs, columns, pair_count, prefetches: self.pairs.prefetches() });
        &columns.pull
    }
}

/// One block of pairs, column by column, as in [`crate::forces::block_arithmetic`].
#[repr(align(64))]
struct Columns<const D: usize> {
    pull: [[f32; D]; BLOCK],
    apart: [[f32; BLOCK]; D],
    change: [f32; BLOCK],
    distance: [f32; BLOCK],
}

impl<const D: usize> Columns<D> {
    fn new() -> Self {
        Columns { pull: [[0.0; D]; BLOCK], apart: [[0.0; BLOCK]; D], change: [0.0; BLOCK], distance: [0.0; BLOCK] }
    }
}

struct Arithmetic<'a, const D: usize> {
    block: &'a SingleBlock<D>,
    columns: &'a mut Columns<D>,
    pair_count: usize,
    /// Where a later block is asked to meanwhile, if the list is long.
    prefetches: Option<Cache>,
}

impl<const D: usize> LawKernel for Arithmetic<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd, L: PairLaw>(self, simd: S, law: &L) {
        let Arithmetic { block, columns, pair_count, prefetches } = self;
        let count = pair_count.div_ceil(S::F32_LANES).min(BLOCK / S::F32_LANES);
        let read = |column| &S::as_simd_f32s(column).0[..count];
        let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
        let pull = &mut S::as_mut_simd_f32s(columns.pull.as_flattened_mut()).0[..D * count];
        let apart = columns.apart.each_mut().map(|column| &mut S::as_mut_simd_f32s(column).0[..count]);
        let change = &mut S::as_mut_simd_f32s(&mut columns.change).0[..count];
        let distance = &mut S::as_mut_simd_f32s(&mut columns.distance).0[..count];
        let separation = block.separation.each_ref().map(|column| read(&column[..]));
        let (anchor_distance, anchor_overlap) = (read(&block.distance), read(&block.overlap));
        let (coefficients, one_coefficient) = (read(&block.coefficient), simd.splat_f32s(block.coefficient[0]));
        for k in 0..count {
            let offset = components::split_single::<S, D>(simd, &pull[D * k..D * (k + 1)]);
            let (mut square, mut changed) = (zero, zero);
            for d in 0..D {
                let along = simd.add_f32s(separation[d][k], offset[d]);
                let squared = simd.mul_f32s(along, along);
                let change = simd.mul_f32s(offset[d], simd.add_f32s(separation[d][k], along));
                (square, changed) = match d {
                    0 => (squared, change),
                    _ => (simd.add_f32s(square, squared), simd.add_f32s(changed, change)),
                };
                apart[d][k] = along;
            }
            if let Some(cache) = prefetches {
                block.prefetch(cache, blocks_ahead(cache), k * S::F32_LANES, !L::ONE_COEFFICIENT);
            }
            change[k] = changed;
            distance[k] = simd.sqrt_f32s(square);
        }
        for k in 0..count {
            let both = simd.add_f32s(distance[k], anchor_distance[k]);
            let inverse = simd.div_f32s(one, simd.mul_f32s(distance[k], both));
            let changed = simd.mul_f32s(change[k], simd.mul_f32s(distance[k], inverse));
            let overlap = positive_part_in_single(simd, simd.sub_f32s(anchor_overlap[k], changed));
            let coefficient = if L::ONE_COEFFICIENT { one_coefficient } else { coefficients[k] };
            let force = law.forces_in_single(simd, coefficient, overlap);
            let factor = simd.mul_f32s(force, simd.mul_f32s(both, inverse));
            let mut along = [factor; D];
            for d in 0..D {
                along[d] = simd.mul_f32s(factor, apart[d][k]);
            }
            components::join_single(simd, &along, &mut pull[D * k..D * (k + 1)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::power_laws::Hertzian;
    use crate::processor::Processor;

    /// The forces of a block, with every width of vectors, prefetched or not.
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
                let columns = &mut Columns { pull: offsets, ..Columns::new() };
                processor.run(|| dispatch(law, Arithmetic { block, columns, pair_count: BLOCK, prefetches }));
                forces.push(columns.pull);
            }
        }
        let bits = |forces: &[[f32; 2]; BLOCK]| forces.map(|force| force.map(f32::to_bits));
        assert!(forces.iter().all(|one| bits(one) == bits(&forces[0])));
        let pressed = forces[0].iter().filter(|force| force[0] != 0.0).count();
        assert!((BLOCK / 4..BLOCK).contains(&pressed), "{pressed} pairs press");
    }
}
