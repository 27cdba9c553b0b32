//! Iteration over every pair of a list at the present positions, for tasks that do not need a block loop of their own.

use crate::neighbours::block::BLOCK;
use crate::neighbours::pair_block::PairBlock;
use crate::neighbours::pair_list::PairList;
use crate::neighbours::rows::gather;
use crate::processor;
use crate::vector::{Vector, vector_at};

/// A listed pair at the present positions, by the formula of [`geometry`](crate::forces::elastic::geometry).
#[derive(Debug, Clone, Copy)]
pub struct MovedPair<const D: usize> {
    /// Index of the pair.
    pub pair: usize,
    /// The two disks.
    pub ends: (u32, u32),
    /// Separation, from the second disk to the first \[length\].
    pub separation: Vector<D>,
    /// Length of the separation \[length\].
    pub distance: f64,
    /// Overlap; negative for a gap \[length\].
    pub overlap: f64,
    /// Coefficient of the contact law \[force / length^(α−1)\].
    pub coefficient: f64,
}

/// Calls `look` for every listed pair, in the order of their indices.
pub fn for_each_pair<const D: usize>(
    pairs: &PairList<D>,
    displacements: &[Vector<D>],
    look: &mut dyn FnMut(&MovedPair<D>),
) {
    let mut moved = [[0.0; D]; BLOCK];
    let mut at = At { apart: [[0.0; BLOCK]; D], distance: [0.0; BLOCK], overlap: [0.0; BLOCK] };
    for block in &pairs.blocks {
        let (numbers, listed) = (block.pairs(), &pairs.pair_blocks[block.pairs / BLOCK]);
        gather(&mut moved, pairs, block, (displacements, 0));
        processor::dispatch(Measure { count: block.pair_count, listed, moved: &moved, at: &mut at });
        for (place, pair) in numbers.enumerate() {
            look(&MovedPair {
                pair,
                ends: (pairs.first[pair], pairs.second[pair]),
                separation: vector_at(&at.apart, place),
                distance: at.distance[place],
                overlap: at.overlap[place],
                coefficient: listed.coefficient[place],
            });
        }
    }
}

/// Geometry of the pairs of a block at the present positions.
struct At<const D: usize> {
    apart: [[f64; BLOCK]; D],
    distance: [f64; BLOCK],
    overlap: [f64; BLOCK],
}

struct Measure<'a, const D: usize> {
    count: usize,
    listed: &'a PairBlock<D>,
    moved: &'a [Vector<D>; BLOCK],
    at: &'a mut At<D>,
}

impl<const D: usize> pulp::WithSimd for Measure<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) {
        let Measure { count, listed, moved, at } = self;
        let count = count.min(BLOCK);
        let (anchored_distance, anchored_overlap) = (&listed.distance[..count], &listed.overlap[..count]);
        let moved = &moved[..count];
        let (distance, overlap) = (&mut at.distance[..count], &mut at.overlap[..count]);
        for k in 0..count {
            let (mut squared, mut change) = (0.0, 0.0);
            for d in 0..D {
                let along = listed.separation[d][k] + moved[k][d];
                squared += along * along;
                change += moved[k][d] * (listed.separation[d][k] + along);
                at.apart[d][k] = along;
            }
            let length = f64::sqrt(squared);
            let inverse = 1.0 / (length * (length + anchored_distance[k]));
            distance[k] = length;
            overlap[k] = anchored_overlap[k] - change * (length * inverse);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forces::assembly::Assembly;
    use crate::forces::elastic::geometry;
    use crate::io::read_packing;
    use crate::law::power_laws::Hertzian;

    #[test]
    fn every_pair_is_met_once_with_the_bits_of_its_geometry() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N5548_p100.xyz");
        let packing = read_packing::<2>(file).expect("a stored packing");
        let mut assembly = Assembly::new(&packing, &Hertzian::default()).expect("no coincidence");
        for (disk, displacement) in assembly.displacements.iter_mut().enumerate() {
            *displacement = [1e-2 * (3.0 * disk as f64).sin(), 1e-2 * (5.0 * disk as f64).cos()];
        }
        let pairs = assembly.pairs();
        let mut met = Vec::new();
        for_each_pair(pairs, &assembly.displacements, &mut |at| {
            let (separation, distance, overlap) = geometry(pairs, at.pair, &assembly.displacements);
            assert_eq!((at.separation, at.distance, at.overlap), (separation, distance, overlap), "pair {}", at.pair);
            assert_eq!(at.ends, (pairs.first[at.pair], pairs.second[at.pair]));
            assert_eq!(at.coefficient, pairs.coefficient(at.pair));
            met.push(at.pair);
        });
        assert_eq!(met, pairs.numbers().collect::<Vec<_>>());
    }
}
