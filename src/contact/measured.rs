//! What a list has of the pairs of a block: one piece of memory, column by column, so that the loop reads the list as one stream.

use crate::contact::pair_list::{BLOCK, PairList};
use crate::vector::Vector;

/// Separation of no pair: a gap that no way closes, and whose square is a number.
const NOWHERE: f64 = 1e100;

/// A block of pairs at their anchors. A place without a pair has a gap that nothing closes.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(super) struct Measured<const D: usize> {
    /// From the anchor of the second to that of the first along the nearest image, D \[length\].
    pub separation: [[f64; BLOCK]; D],
    /// Distance of the anchors, |D| \[length\].
    pub distance: [f64; BLOCK],
    /// Overlap at the anchors, R_i + R_j − |D|, rounded once only; negative for a pair apart \[length\].
    pub overlap: [f64; BLOCK],
    /// Coefficient of the contact law for this pair \[force / length^(α−1)\].
    pub coefficient: [f64; BLOCK],
}

impl<const D: usize> Default for Measured<D> {
    /// A block without a pair.
    fn default() -> Self {
        Measured {
            separation: [[NOWHERE; BLOCK]; D],
            distance: [NOWHERE * (D as f64).sqrt(); BLOCK],
            overlap: [-NOWHERE * (D as f64).sqrt(); BLOCK],
            coefficient: [1.0; BLOCK],
        }
    }
}

impl<const D: usize> Measured<D> {
    /// Takes what another one has in a place.
    #[inline(always)]
    pub fn copy(&mut self, place: usize, (other, there): (&Self, usize)) {
        for (column, from) in self.separation.iter_mut().zip(&other.separation) {
            column[place] = from[there];
        }
        self.distance[place] = other.distance[there];
        self.overlap[place] = other.overlap[there];
        self.coefficient[place] = other.coefficient[there];
    }

    /// Empties the places from this one on.
    pub fn vacate(&mut self, first: usize) {
        for column in &mut self.separation {
            column[first..].fill(NOWHERE);
        }
        self.distance[first..].fill(NOWHERE * (D as f64).sqrt());
        self.overlap[first..].fill(-NOWHERE * (D as f64).sqrt());
        self.coefficient[first..].fill(1.0);
    }
}

impl<const D: usize> PairList<D> {
    /// The block a pair is in, and its place there.
    #[inline(always)]
    pub(super) fn of_pair(&self, pair: usize) -> (&Measured<D>, usize) {
        (&self.measured[pair / BLOCK], pair % BLOCK)
    }

    /// From the anchor of the second disk to that of the first along the nearest image, D \[length\].
    #[inline(always)]
    pub fn separation(&self, pair: usize) -> Vector<D> {
        let (block, place) = self.of_pair(pair);
        block.separation.each_ref().map(|column| column[place])
    }

    /// Distance of the anchors, |D| \[length\].
    #[inline(always)]
    pub fn distance(&self, pair: usize) -> f64 {
        let (block, place) = self.of_pair(pair);
        block.distance[place]
    }

    /// Overlap at the anchors, R_i + R_j − |D|, rounded once only; negative for a pair apart \[length\].
    #[inline(always)]
    pub fn overlap(&self, pair: usize) -> f64 {
        let (block, place) = self.of_pair(pair);
        block.overlap[place]
    }

    /// Coefficient of the contact law for a pair \[force / length^(α−1)\].
    #[inline(always)]
    pub fn coefficient(&self, pair: usize) -> f64 {
        let (block, place) = self.of_pair(pair);
        block.coefficient[place]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Hertzian;
    use crate::contact::assembly::Assembly;
    use crate::contact::forces::geometry;
    use crate::io::read_packing;

    #[test]
    fn places_without_a_pair_are_gaps_that_nothing_closes() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N5548_p100.xyz");
        let packing = read_packing::<2>(file).expect("a stored packing");
        let mut assembly = Assembly::new(&packing, Hertzian::default()).expect("no coincidence");
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
