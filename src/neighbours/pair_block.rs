//! Geometry of the pairs of a block at their anchors, in contiguous memory, column by column. The loop reads the list
//! as one stream.

use crate::neighbours::block::BLOCK;
use crate::vector::{Vector, dot};

/// Separation in a vacant place: no displacement closes the gap, and its square is finite.
const VACANT_GAP: f64 = 1e100;

/// A block of pairs at their anchors. A vacant place has a gap that no displacement closes.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(crate) struct PairBlock<const D: usize> {
    /// From the anchor of the second disk to that of the first along the nearest image, D \[length\].
    pub separation: [[f64; BLOCK]; D],
    /// Distance of the anchors, |D| \[length\].
    pub distance: [f64; BLOCK],
    /// Overlap at the anchors, R_i + R_j − |D|, with a single rounding; negative for a gap \[length\].
    pub overlap: [f64; BLOCK],
    /// Coefficient of the contact law for this pair \[force / length^(α−1)\].
    pub coefficient: [f64; BLOCK],
}

impl<const D: usize> Default for PairBlock<D> {
    /// A block without pairs.
    fn default() -> Self {
        PairBlock {
            separation: [[VACANT_GAP; BLOCK]; D],
            distance: [VACANT_GAP * (D as f64).sqrt(); BLOCK],
            overlap: [-VACANT_GAP * (D as f64).sqrt(); BLOCK],
            coefficient: [1.0; BLOCK],
        }
    }
}

impl<const D: usize> PairBlock<D> {
    /// Copies the pair at a place of another block.
    #[inline(always)]
    pub fn copy(&mut self, place: usize, (other, there): (&Self, usize)) {
        for (column, from) in self.separation.iter_mut().zip(&other.separation) {
            column[place] = from[there];
        }
        self.distance[place] = other.distance[there];
        self.overlap[place] = other.overlap[there];
        self.coefficient[place] = other.coefficient[there];
    }

    /// The places of pairs with coincident centres.
    pub fn coincident(&self) -> impl Iterator<Item = usize> + use<'_, D> {
        let squared = |place: usize| {
            let apart: Vector<D> = self.separation.each_ref().map(|column| column[place]);
            dot(apart, apart)
        };
        (0..BLOCK).filter(move |&place| squared(place) == 0.0)
    }

    /// Marks all places from `first` on as vacant.
    pub fn vacate(&mut self, first: usize) {
        for column in &mut self.separation {
            column[first..].fill(VACANT_GAP);
        }
        self.distance[first..].fill(VACANT_GAP * (D as f64).sqrt());
        self.overlap[first..].fill(-VACANT_GAP * (D as f64).sqrt());
        self.coefficient[first..].fill(1.0);
    }
}
