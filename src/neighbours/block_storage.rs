//! What a list has of its pairs at the anchors, block by block: packed where it is read from memory, the disks have few radii and the
//! machine has vectors of 512 bits. Where it has not, the list has the same numbers, pair by pair.
//!
//! ```text
//! kind → R_i + R_j, coefficient        |D| = R_i + R_j − δ⁰
//! ```
//!
//! In a plane that is 25 bytes a pair in place of 40. |D| is off by half a unit in the last place of itself, as where it is listed, and by
//! half a one of δ⁰; an overlap away from the anchors by that times (|r| − |D|)/(|r| + |D|): no more than u of the way between, or of a
//! deep overlap itself.

use pulp::Simd;

use crate::neighbours::pair_block::Measured;
use crate::neighbours::pair_list::{BLOCK, PairList};
use crate::neighbours::pair_types::{KINDS, Kinds};
use crate::parallel;
use crate::simd::ahead::{Cache, LINE};
use crate::simd::table::look_up;
use crate::vector::{Vector, dot};

/// Blocks of pairs at their anchors, each as [`Measured`] or all as [`Packed`].
#[derive(Debug, Clone, Default)]
pub(crate) struct Listed<const D: usize> {
    /// What is known of the kinds of its pairs, if they have any.
    pub kinds: Option<Kinds>,
    each: Vec<Measured<D>>,
    /// Kinds of the pairs in `each`.
    kind: Vec<[u8; BLOCK]>,
    packed: Vec<Packed<D>>,
}

/// A block of pairs at their anchors, as [`Measured`] but for what follows from their kinds.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(crate) struct Packed<const D: usize> {
    pub separation: [[f64; BLOCK]; D],
    pub overlap: [f64; BLOCK],
    pub kind: [u8; BLOCK],
}

impl<const D: usize> Packed<D> {
    /// Distance of the anchors of a pair.
    #[inline(always)]
    fn distance(&self, kinds: &Kinds, place: usize) -> f64 {
        kinds.distance(self.kind[place], self.overlap[place])
    }

    #[inline(always)]
    fn coefficient(&self, kinds: &Kinds, place: usize) -> f64 {
        kinds.coefficient[usize::from(self.kind[place]) % KINDS]
    }
}

/// A block of a list.
#[derive(Debug, Clone, Copy)]
pub(crate) enum OfBlock<'a, const D: usize> {
    Each(&'a Measured<D>),
    Packed(&'a Packed<D>, &'a Kinds),
}

/// A block of a list, for the arithmetic: the k-th vectors of its columns.
pub(crate) trait AtAnchors<const D: usize>: Copy {
    /// What it takes of memory \[bytes\].
    const SIZE: usize;

    fn separation(&self) -> &[[f64; BLOCK]; D];

    fn overlap(&self) -> &[f64; BLOCK];

    /// The coefficient of all pairs that have one.
    fn one_coefficient(&self) -> f64;

    /// Distances, from overlaps.
    fn distance<S: Simd>(&self, simd: S, k: usize, overlap: S::f64s) -> S::f64s;

    fn coefficient<S: Simd>(&self, simd: S, k: usize) -> S::f64s;

    /// Asks for what distances are taken from: the place `first` of the block as many further on.
    fn ask_for_distance(&self, cache: Cache, blocks: usize, first: usize);

    /// The same for coefficients, unless that is what distances are taken from.
    fn ask_for_coefficient(&self, cache: Cache, blocks: usize, first: usize);
}

impl<const D: usize> AtAnchors<D> for &Measured<D> {
    const SIZE: usize = size_of::<Measured<D>>();

    #[inline(always)]
    fn separation(&self) -> &[[f64; BLOCK]; D] {
        &self.separation
    }

    #[inline(always)]
    fn overlap(&self) -> &[f64; BLOCK] {
        &self.overlap
    }

    #[inline(always)]
    fn one_coefficient(&self) -> f64 {
        self.coefficient[0]
    }

    #[inline(always)]
    fn distance<S: Simd>(&self, _simd: S, k: usize, _overlap: S::f64s) -> S::f64s {
        S::as_simd_f64s(&self.distance).0[k]
    }

    #[inline(always)]
    fn coefficient<S: Simd>(&self, _simd: S, k: usize) -> S::f64s {
        S::as_simd_f64s(&self.coefficient).0[k]
    }

    #[inline(always)]
    fn ask_for_distance(&self, cache: Cache, blocks: usize, first: usize) {
        cache.ask(&self.distance, blocks * Self::SIZE / size_of::<f64>() + first);
    }

    #[inline(always)]
    fn ask_for_coefficient(&self, cache: Cache, blocks: usize, first: usize) {
        cache.ask(&self.coefficient, blocks * Self::SIZE / size_of::<f64>() + first);
    }
}

impl<const D: usize> AtAnchors<D> for (&Packed<D>, &Kinds) {
    const SIZE: usize = size_of::<Packed<D>>();

    #[inline(always)]
    fn separation(&self) -> &[[f64; BLOCK]; D] {
        &self.0.separation
    }

    #[inline(always)]
    fn overlap(&self) -> &[f64; BLOCK] {
        &self.0.overlap
    }

    #[inline(always)]
    fn one_coefficient(&self) -> f64 {
        self.1.coefficient[0]
    }

    #[inline(always)]
    fn distance<S: Simd>(&self, simd: S, k: usize, overlap: S::f64s) -> S::f64s {
        simd.sub_f64s(look_up(simd, &self.1.reach, &self.0.kind[k * S::F64_LANES..]), overlap)
    }

    #[inline(always)]
    fn coefficient<S: Simd>(&self, simd: S, k: usize) -> S::f64s {
        look_up(simd, &self.1.coefficient, &self.0.kind[k * S::F64_LANES..])
    }

    #[inline(always)]
    fn ask_for_distance(&self, cache: Cache, blocks: usize, first: usize) {
        if first.is_multiple_of(LINE) {
            cache.ask(&self.0.kind, blocks * Self::SIZE + first);
        }
    }

    #[inline(always)]
    fn ask_for_coefficient(&self, _cache: Cache, _blocks: usize, _first: usize) {}
}

impl<const D: usize> Listed<D> {
    /// What is packed of it, if anything is.
    #[inline(always)]
    fn packs(&self) -> Option<&Kinds> {
        self.kinds.as_ref().filter(|kinds| kinds.packs)
    }

    /// Empties it; its pairs go on being packed or not.
    pub fn clear(&mut self) {
        self.each.clear();
        self.kind.clear();
        self.packed.clear();
    }

    /// Asks for room for so many blocks more.
    pub fn reserve(&mut self, blocks: usize) {
        match self.packs() {
            Some(_) => self.packed.reserve(blocks),
            None => self.each.reserve(blocks),
        }
    }

    /// Adds a block.
    pub fn push(&mut self, measured: &Measured<D>, kind: &[u8; BLOCK]) {
        let Measured { separation, overlap, .. } = measured;
        if self.packs().is_some() {
            self.packed.push(Packed { separation: *separation, overlap: *overlap, kind: *kind });
            return;
        }
        self.each.push(measured.clone());
        if self.kinds.is_some() {
            self.kind.push(*kind);
        }
    }

    /// Overwrites a place.
    pub fn put(&mut self, pair: usize, (measured, there): (&Measured<D>, usize), kind: u8) {
        let (block, place) = (pair / BLOCK, pair % BLOCK);
        if self.packs().is_none() {
            self.each[block].copy(place, (measured, there));
            if let Some(kinds) = self.kind.get_mut(block) {
                kinds[place] = kind;
            }
            return;
        }
        let packed = &mut self.packed[block];
        for (column, from) in packed.separation.iter_mut().zip(&measured.separation) {
            column[place] = from[there];
        }
        (packed.overlap[place], packed.kind[place]) = (measured.overlap[there], kind);
    }

    /// Overwrites it by blocks of others, each of which is the one with the number `of` it in one of them; they are packed alike.
    pub fn join<'a>(&mut self, count: usize, of: impl Fn(usize) -> (&'a Listed<D>, usize) + Sync) {
        self.clear();
        if self.packs().is_some() {
            parallel::fill(&mut self.packed, count, |block| {
                let (part, there) = of(block);
                part.packed[there].clone()
            });
            return;
        }
        parallel::fill(&mut self.each, count, |block| {
            let (part, there) = of(block);
            part.each[there].clone()
        });
        if self.kinds.is_some() {
            parallel::fill(&mut self.kind, count, |block| {
                let (part, there) = of(block);
                part.kind[there]
            });
        }
    }

    /// A block as it is.
    #[inline(always)]
    pub fn of_block(&self, block: usize) -> OfBlock<'_, D> {
        match self.packs() {
            Some(kinds) => OfBlock::Packed(&self.packed[block], kinds),
            None => OfBlock::Each(&self.each[block]),
        }
    }

    /// A block, in `room` if it is packed.
    pub fn unpacked<'a>(&'a self, block: usize, room: &'a mut Measured<D>) -> &'a Measured<D> {
        match self.of_block(block) {
            OfBlock::Each(measured) => measured,
            OfBlock::Packed(packed, kinds) => {
                (room.separation, room.overlap) = (packed.separation, packed.overlap);
                for place in 0..BLOCK {
                    room.distance[place] = packed.distance(kinds, place);
                    room.coefficient[place] = packed.coefficient(kinds, place);
                }
                room
            }
        }
    }

    /// Takes over in `measured` what a pair has.
    #[inline(always)]
    pub fn take(&self, pair: usize, (measured, place): (&mut Measured<D>, usize)) {
        match self.of_block(pair / BLOCK) {
            OfBlock::Each(block) => measured.copy(place, (block, pair % BLOCK)),
            OfBlock::Packed(packed, kinds) => {
                for (column, from) in measured.separation.iter_mut().zip(&packed.separation) {
                    column[place] = from[pair % BLOCK];
                }
                measured.overlap[place] = packed.overlap[pair % BLOCK];
                measured.distance[place] = packed.distance(kinds, pair % BLOCK);
                measured.coefficient[place] = packed.coefficient(kinds, pair % BLOCK);
            }
        }
    }

    /// The kind of a pair, 0 if it has none.
    #[inline(always)]
    pub fn kind(&self, pair: usize) -> u8 {
        self.kinds_of_block(pair / BLOCK).map_or(0, |kinds| kinds[pair % BLOCK])
    }

    /// The kinds of the pairs of a block, if they have any.
    #[inline(always)]
    pub fn kinds_of_block(&self, block: usize) -> Option<&[u8; BLOCK]> {
        match self.of_block(block) {
            OfBlock::Each(_) => self.kind.get(block),
            OfBlock::Packed(packed, _) => Some(&packed.kind),
        }
    }

    /// Pairs of disks with the same centre. A distance that follows from an overlap is 0 below the rounding of this, and does not tell.
    pub fn together(&self) -> impl Iterator<Item = usize> {
        let each = self.each.iter().map(|block| &block.separation);
        let blocks = each.chain(self.packed.iter().map(|block| &block.separation));
        let squares = blocks.flat_map(|columns| {
            (0..BLOCK).map(|place| {
                let apart: Vector<D> = columns.each_ref().map(|column| column[place]);
                dot(apart, apart)
            })
        });
        squares.enumerate().filter(|&(_, squared)| squared == 0.0).map(|(pair, _)| pair)
    }
}

impl<const D: usize> PairList<D> {
    /// What the loop reads of a pair, its second disk included \[bytes\].
    pub fn pair_size(&self) -> usize {
        let block = match self.listed.packs() {
            Some(_) => size_of::<Packed<D>>(),
            None => size_of::<Measured<D>>(),
        };
        block / BLOCK + size_of::<u32>()
    }

    /// From the anchor of the second disk to that of the first along the nearest image, D \[length\].
    #[inline(always)]
    pub fn separation(&self, pair: usize) -> Vector<D> {
        let columns = match self.listed.of_block(pair / BLOCK) {
            OfBlock::Each(block) => &block.separation,
            OfBlock::Packed(block, _) => &block.separation,
        };
        columns.each_ref().map(|column| column[pair % BLOCK])
    }

    /// Distance of the anchors, |D| \[length\].
    #[inline(always)]
    pub fn distance(&self, pair: usize) -> f64 {
        match self.listed.of_block(pair / BLOCK) {
            OfBlock::Each(block) => block.distance[pair % BLOCK],
            OfBlock::Packed(block, kinds) => block.distance(kinds, pair % BLOCK),
        }
    }

    /// Overlap at the anchors, R_i + R_j − |D|, rounded once only; negative for a pair apart \[length\].
    #[inline(always)]
    pub fn overlap(&self, pair: usize) -> f64 {
        match self.listed.of_block(pair / BLOCK) {
            OfBlock::Each(block) => block.overlap[pair % BLOCK],
            OfBlock::Packed(block, _) => block.overlap[pair % BLOCK],
        }
    }

    /// Coefficient of the contact law for a pair \[force / length^(α−1)\].
    #[inline(always)]
    pub fn coefficient(&self, pair: usize) -> f64 {
        match self.listed.of_block(pair / BLOCK) {
            OfBlock::Each(block) => block.coefficient[pair % BLOCK],
            OfBlock::Packed(block, kinds) => block.coefficient(kinds, pair % BLOCK),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forces::assembly::Assembly;
    use crate::forces::elastic::{Across, forces, geometry};
    use crate::io::read_packing;
    use crate::law::pair_law::Hertzian;
    use crate::law::pair_law::PairLaw;
    use crate::neighbours::pair_types::Classes;
    use crate::neighbours::verlet_list::{Disks, ListRoom, build_pairs, spatial_order};
    use crate::packing::{Mixture, Packing, PackingError};
    use crate::preparation::random_points;
    use crate::vector::{difference, norm};

    /// The list of a packing whose disks are at their anchors, with kinds packed or not, or without; and in what order it has the disks.
    fn list_of<const D: usize>(
        packing: &Packing<D>,
        packs: Option<bool>,
    ) -> Result<(PairList<D>, Vec<u32>), PackingError> {
        let order = spatial_order(packing.domain(), packing.positions(), packing.radii(), packing.held());
        let anchors: Vec<Vector<D>> = order.iter().map(|&disk| packing.positions()[disk as usize]).collect();
        let radii: Vec<f64> = order.iter().map(|&disk| packing.radii()[disk as usize]).collect();
        let (displacements, law) = (vec![[0.0; D]; anchors.len()], Hertzian::default());
        let mut classes = Classes::of(&radii, &law).filter(|_| packs.is_some());
        if let (Some(classes), Some(packs)) = (&mut classes, packs) {
            classes.kinds.packs = packs;
        }
        let disks = Disks {
            domain: packing.domain(),
            anchors: &anchors,
            displacements: &displacements,
            radii: &radii,
            mobile_count: anchors.len(),
            classes: classes.as_ref(),
        };
        let mut pairs = PairList::default();
        build_pairs(&disks, 0.2, |a, b| law.coefficient(a, b), &mut ListRoom::default(), &mut pairs)?;
        Ok((pairs, order))
    }

    fn packed_is_the_same<const D: usize>(disk_count: usize, packing_fraction: f64) {
        let packing = random_points::<D>(disk_count, &Mixture::default(), packing_fraction, 7).expect("possible");
        let [(packed, order), (in_full, _), (plain, _)] =
            [Some(true), Some(false), None].map(|packs| list_of(&packing, packs).expect("no coincidence"));
        assert!(packed.pair_size() < plain.pair_size() && in_full.pair_size() == plain.pair_size());
        assert!(in_full.listed.kinds.is_some() && plain.listed.kinds.is_none());
        assert_eq!((&packed.first, &packed.second), (&plain.first, &plain.second));
        for pair in plain.numbers() {
            assert_eq!(packed.separation(pair), plain.separation(pair), "pair {pair}");
            assert_eq!(packed.overlap(pair), plain.overlap(pair), "pair {pair}");
            assert_eq!(packed.coefficient(pair), plain.coefficient(pair), "pair {pair}");
            assert_eq!(packed.distance(pair), in_full.distance(pair), "pair {pair}");
            assert_eq!(packed.listed.kind(pair), in_full.listed.kind(pair), "pair {pair}");
            // Both |D|, below 4, by half a unit in the last place, 2⁻⁵², and δ⁰, below 2, by 2⁻⁵³.
            let off = packed.distance(pair) - plain.distance(pair);
            assert!(off.abs() <= 3.0 * f64::EPSILON, "pair {pair}: {off}");
        }
        let wave = |i: u32| -> Vector<D> { std::array::from_fn(|d| 0.05 * ((3 + 4 * d) as f64 * f64::from(i)).sin()) };
        let moved: Vec<Vector<D>> = order.iter().map(|&disk| wave(disk)).collect();
        let law = Hertzian::default();
        let [of_packed, of_full, of_plain] = [&packed, &in_full, &plain].map(|pairs| {
            let mut found = vec![[0.0; D]; disk_count];
            forces(&law, pairs, &moved, &mut Across::default(), &mut found);
            found
        });
        assert_eq!(of_packed, of_full);
        let scale = law.force_scale(0.5);
        for (one, other) in of_packed.iter().zip(&of_plain) {
            // Some twenty pairs, overlaps off by an epsilon of a radius: the force of one is 2 δ^(3/2) and less of the scale.
            assert!(norm(difference(*one, *other)) < 200.0 * f64::EPSILON * scale, "{one:?} {other:?}");
        }
        // What goes pair by pair has the loop's numbers.
        let mut sums = vec![[0.0; D]; disk_count];
        for pair in packed.numbers() {
            let (apart, distance, overlap) = geometry(&packed, pair, &moved);
            let force = law.force(packed.coefficient(pair), overlap.max(0.0)) / distance;
            for d in 0..D {
                sums[packed.first[pair] as usize][d] += force * apart[d];
                sums[packed.second[pair] as usize][d] -= force * apart[d];
            }
        }
        for (one, other) in of_packed.iter().zip(&sums) {
            assert!(norm(difference(*one, *other)) < 200.0 * f64::EPSILON * scale, "{one:?} {other:?}");
        }
    }

    #[test]
    fn packed_pairs_are_the_pairs_they_were() {
        packed_is_the_same::<2>(20_000, 0.9);
        packed_is_the_same::<3>(20_000, 0.7);
    }

    #[test]
    fn disks_with_one_centre_are_found_in_a_packed_list() {
        let packing = random_points::<2>(20_000, &Mixture::default(), 0.9, 3).expect("possible");
        let mut positions = packing.positions().to_vec();
        positions[19_000] = positions[77];
        let packing = Packing::new(*packing.domain(), positions, packing.radii().to_vec()).expect("as before");
        let expected = PackingError::CoincidentCentres { first: 77, second: 19_000 };
        assert_eq!(Assembly::new(&packing, Hertzian::default()).err(), Some(expected));
        assert!(list_of(&packing, None).is_err(), "found in a list that is not packed as well");
        // Far nearer than the rounding of the sum of their radii, but not together.
        let mut positions = packing.positions().to_vec();
        (positions[77], positions[19_000]) = ([1e-20, 0.0], [0.0; 2]);
        let packing = Packing::new(*packing.domain(), positions, packing.radii().to_vec()).expect("as before");
        for packs in [Some(true), Some(false), None] {
            let (pairs, _) = list_of(&packing, packs).expect("no coincidence");
            let mut found = vec![[0.0; 2]; packing.len()];
            forces(&Hertzian::default(), &pairs, &vec![[0.0; 2]; packing.len()], &mut Across::default(), &mut found);
            assert!(found.as_flattened().iter().all(|force| force.is_finite()));
        }
    }

    #[test]
    fn places_without_a_pair_are_gaps_that_nothing_closes() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N5548_p100.xyz");
        check_vacant_places(&read_packing::<2>(file).expect("a stored packing"));
        check_vacant_places(&random_points::<2>(20_000, &Mixture::default(), 0.9, 3).expect("possible"));
    }

    fn check_vacant_places(packing: &Packing<2>) {
        let mut assembly = Assembly::new(packing, Hertzian::default()).expect("no coincidence");
        assembly.displacements[0] = [1e6; 2];
        let pairs = assembly.pairs();
        let mut has_pair = vec![false; pairs.place_count()];
        pairs.numbers().for_each(|pair| has_pair[pair] = true);
        assert_eq!(has_pair.iter().filter(|&&has| has).count(), pairs.len());
        // Its blocks are not all full, and it has places for pairs to come.
        assert!(pairs.len() + 6 * BLOCK < pairs.place_count());
        for place in (0..has_pair.len()).filter(|&place| !has_pair[place]) {
            let (_, distance, overlap) = geometry(pairs, place, &assembly.displacements);
            assert!(distance > 1e99 && overlap < -1e99, "place {place}: {distance} {overlap}");
        }
    }
}
