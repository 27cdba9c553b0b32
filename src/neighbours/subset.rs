//! Subset of the pairs of a list, stored as a list with other disk numbers.

use crate::neighbours::block::BLOCK;
use crate::neighbours::pair_block::PairBlock;
use crate::neighbours::pair_list::{PairList, Search, Source};

impl<const D: usize> PairList<D> {
    /// Overwrites the list by a subset of the pairs of another list, with other disk numbers.
    ///
    /// # Shape
    /// `starts` has one entry per disk and one more: where its pairs begin in `seconds`. Each entry of `seconds` is the
    /// second disk of a pair and the place of the pair in `whole`.
    pub(crate) fn select(&mut self, whole: &PairList<D>, starts: &[u32], seconds: &[(u32, u32)]) {
        let disk_count = starts.len() - 1;
        // `whole` has no coincident centres.
        let _ = self.fill((disk_count, disk_count), false, || Selected { whole, starts, seconds });
    }
}

/// See [`PairList::select`].
struct Selected<'a, const D: usize> {
    whole: &'a PairList<D>,
    starts: &'a [u32],
    seconds: &'a [(u32, u32)],
}

impl<const D: usize> Search<D> for Selected<'_, D> {
    fn find(&mut self, first: usize, pairs: &mut Vec<u32>) {
        pairs.extend(self.starts[first]..self.starts[first + 1]);
    }
}

impl<const D: usize> Source<D> for Selected<'_, D> {
    /// The index of a pair is its place in `seconds`.
    fn second(&self, pair: u32) -> u32 {
        self.seconds[pair as usize].0
    }

    fn measure(&mut self, _first: &[u32], pairs: &[u32], pair_block: &mut PairBlock<D>) {
        for (place, &pair) in pairs.iter().enumerate() {
            let there = self.seconds[pair as usize].1 as usize;
            pair_block.copy(place, (&self.whole.pair_blocks[there / BLOCK], there % BLOCK));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forces::assembly::Assembly;
    use crate::forces::elastic::{BorderForces, forces};
    use crate::io::read_packing;
    use crate::law::power_laws::Hertzian;
    use crate::packing::{Mixture, Packing};
    use crate::preparation::random_points;
    use crate::vector::{Vector, difference, norm};

    #[test]
    fn every_other_pair_under_numbers_from_the_end_pulls_as_it_did() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N1000_p100.xyz");
        // Sums of forces of up to 10⁴, and of up to 10⁵, in different orders. Overlaps at the anchors are known to a
        // few units in the last place of a radius.
        check(&read_packing::<2>(file).expect("a stored packing"), 1e-10);
        check(&random_points::<2>(20_000, &Mixture::default(), 0.9, 5).expect("possible"), 1e-8);
    }

    fn check(packing: &Packing<2>, tolerance: f64) {
        let law = Hertzian::default();
        let assembly = Assembly::new(packing, &law).expect("no coincidence");
        let (whole, count) = (assembly.pairs(), assembly.len());
        // Every second pair from `begin` on, with disk numbers mapped by `number`.
        let selected = |begin: usize, number: &dyn Fn(u32) -> u32| {
            let pair = |pair: usize| (number(whole.first[pair]), number(whole.second[pair]), pair as u32);
            let mut found: Vec<(u32, u32, u32)> = whole.numbers().skip(begin).step_by(2).map(pair).collect();
            found.sort_unstable();
            let start = |disk: u32| found.partition_point(|&(first, ..)| first < disk) as u32;
            let starts: Vec<u32> = (0..=count as u32).map(start).collect();
            let seconds: Vec<(u32, u32)> = found.iter().map(|&(_, second, pair)| (second, pair)).collect();
            let mut pairs = PairList::default();
            pairs.select(whole, &starts, &seconds);
            pairs
        };
        let half = selected(0, &|disk| count as u32 - 1 - disk);
        assert_eq!(half.len(), whole.len().div_ceil(2));
        // The remaining pairs give the rest of the forces.
        let rest = selected(1, &|disk| disk);
        let of = |pairs: &PairList<2>| {
            let mut pulls = vec![[0.0; 2]; count];
            forces(&law, pairs, &vec![[0.0; 2]; count], &mut BorderForces::default(), &mut pulls);
            pulls
        };
        let (all, half, rest): (Vec<Vector<2>>, Vec<Vector<2>>, Vec<Vector<2>>) = (of(whole), of(&half), of(&rest));
        let mut largest = 0.0f64;
        for disk in 0..count {
            let missing = difference(all[disk], half[count - 1 - disk]);
            assert!(norm(difference(missing, rest[disk])) < tolerance, "disk {disk}");
            largest = largest.max(norm(rest[disk]));
        }
        assert!(largest > 10.0, "{largest}");
        // The pairs of the first disks of a long list make a list with one tile.
        let mut few = PairList::default();
        let numbered = |pair: usize| (whole.first[pair], whole.second[pair], pair as u32);
        let mut found: Vec<(u32, u32, u32)> = whole.numbers().map(numbered).filter(|pair| pair.1 < 500).collect();
        found.sort_unstable();
        let starts: Vec<u32> = (0..=500).map(|disk| found.partition_point(|pair| pair.0 < disk) as u32).collect();
        few.select(whole, &starts, &found.iter().map(|&(_, second, pair)| (second, pair)).collect::<Vec<_>>());
        for place in few.numbers() {
            let (first, second) = (few.first[place], few.second[place]);
            let pair =
                found.iter().find(|pair| (pair.0, pair.1) == (first, second)).expect("a pair of the whole").2 as usize;
            assert_eq!((few.separation(place), few.distance(place)), (whole.separation(pair), whole.distance(pair)));
            assert_eq!((few.overlap(place), few.coefficient(place)), (whole.overlap(pair), whole.coefficient(pair)));
        }
        assert_eq!(few.len(), found.len());
    }
}
