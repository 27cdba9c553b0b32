//! Inner list: the nearest pairs of a Verlet list, stored as a second list with a narrower skin (dual pair list).
//!
//! ```text
//! |r_ij| < R_i + R_j + s        time per step ∼ 1 + c s/R_min + P/n,  n = s/(2 v) steps until some disk has moved by s/2
//! s = √(2 P v R_min/c)
//! ```
//!
//! A list with a wide skin lasts long, but holds many pairs without contact. While disks move slowly, only the pairs
//! within a narrow skin s can touch. These pairs are copied, with their geometry at the anchors, at the cost of a few
//! force evaluations. The loop runs over them until a disk has moved by s/2; then they are selected again. The outer
//! list is rebuilt only when it expires itself. v is the displacement of the fastest disk per step, R_min the smallest
//! radius, c the share of pairs that a skin of one radius adds, P the cost of pruning in force evaluations.
//!
//! # Source
//! Dual pair list with dynamic pruning: Páll et al. (2020), J. Chem. Phys. 153, 134110, §IV.

use crate::neighbours::block::{BLOCK, Block, LONGEST_ROW};
use crate::neighbours::pair_block::PairBlock;
use crate::neighbours::pair_list::{Arranger, PairList, Source};
use crate::neighbours::rows::{gather, rows_of};
use crate::processor;
use crate::vector::Vector;

/// Relative number of pairs that a skin of one radius adds to those in contact \[1\]. A tenth of a radius adds 8 %, a
/// quarter 15 %.
const PAIRS_PER_RADIUS: f64 = 0.75;

/// Time to prune a list over the time of one force evaluation \[1\].
const PRUNING_COST: f64 = 4.0;

/// Time to build a list over the time of one force evaluation \[1\].
const BUILD_COST: f64 = 25.0;

/// Narrowest skin over the smallest radius \[1\]. It adds 0.4 % of pairs and is far above rounding.
const NARROWEST: f64 = 1e-3;

/// The inner skin with the lowest cost per step, if the fastest disk moves by `displacement` per step \[length\].
pub(crate) fn best_inner_skin(radius: f64, displacement: f64) -> f64 {
    best_for(PRUNING_COST, radius, displacement).max(NARROWEST * radius)
}

/// The outer skin with the lowest cost per step, if most disks move by `displacement` per step. The list can be updated
/// for the others \[length\].
pub(crate) fn best_outer_skin(radius: f64, displacement: f64) -> f64 {
    best_for(BUILD_COST, radius, displacement)
}

fn best_for(cost: f64, radius: f64, displacement: f64) -> f64 {
    (2.0 * cost / PAIRS_PER_RADIUS * displacement * radius).sqrt()
}

impl<const D: usize> PairList<D> {
    /// Overwrites the list by the pairs of another one closer than R_i + R_j + `skin`.
    pub(crate) fn prune(&mut self, whole: &PairList<D>, displacements: &[Vector<D>], skin: f64) {
        self.first_count = whole.first_count;
        self.reserves_blocks = whole.reserves_blocks;
        self.fill_tiles(whole.tiles.len(), whole.tile_size, |list, place, tile| {
            let blocks = &whole.tiles[place];
            list.add_blocks(
                (tile, place * whole.tile_size),
                &mut Pruned { whole, displacements, skin },
                |list, arranger, near| near.select_pairs(&whole.blocks[blocks.inner.clone()], list, arranger),
                |list, arranger, near| near.select_pairs(&whole.blocks[blocks.border.clone()], list, arranger),
            );
        });
    }
}

/// Pruning of the list `whole`; pairs keep their indices.
struct Pruned<'a, const D: usize> {
    whole: &'a PairList<D>,
    displacements: &'a [Vector<D>],
    skin: f64,
}

impl<const D: usize> Pruned<'_, D> {
    /// Adds the pairs of these blocks within the skin to the arranger, row by row.
    fn select_pairs(&mut self, blocks: &[Block], list: &mut PairList<D>, arranger: &mut Arranger<D>) {
        let mut moved = [[0.0; D]; BLOCK];
        let mut excess = [0.0; BLOCK];
        for block in blocks {
            let first_pair = block.pairs;
            gather(&mut moved, self.whole, block, (self.displacements, 0));
            let excess = &mut excess[..block.pair_count];
            let listed = &self.whole.pair_blocks[first_pair / BLOCK];
            processor::dispatch(Excess { listed, skin: self.skin, moved: &moved, excess });
            let mut pair = first_pair as u32;
            for (&row, excess) in rows_of(self.whole, block).iter().zip(excess.chunks_exact(block.row_length)) {
                // The outcome is unpredictable, so pairs are selected without a branch. NaN counts as near.
                let (mut near, mut near_count) = ([0; LONGEST_ROW], 0);
                for &excess in excess {
                    near[near_count % LONGEST_ROW] = pair;
                    let outside = excess > 0.0;
                    near_count += usize::from(!outside);
                    pair += 1;
                }
                let begin = arranger.group.pairs.len();
                arranger.group.pairs.extend(near.iter().take(near_count));
                list.add_rows(block.origin + row, begin, arranger, self);
            }
        }
    }
}

impl<const D: usize> Source<D> for Pruned<'_, D> {
    fn second(&self, pair: u32) -> u32 {
        self.whole.second[pair as usize]
    }

    fn measure(&mut self, _first: &[u32], pairs: &[u32], pair_block: &mut PairBlock<D>) {
        for (place, &pair) in pairs.iter().enumerate() {
            pair_block.copy(place, (&self.whole.pair_blocks[pair as usize / BLOCK], pair as usize % BLOCK));
        }
    }
}

/// |r_ij|² − (R_i + R_j + s)² of the pairs of a block \[length²\].
struct Excess<'a, const D: usize> {
    listed: &'a PairBlock<D>,
    skin: f64,
    moved: &'a [Vector<D>; BLOCK],
    excess: &'a mut [f64],
}

impl<const D: usize> pulp::WithSimd for Excess<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) {
        let count = self.excess.len().min(BLOCK);
        let Excess { listed, skin, .. } = self;
        let (distance, overlap) = (&listed.distance[..count], &listed.overlap[..count]);
        let moved = &self.moved[..count];
        for k in 0..count {
            let mut squared = 0.0;
            for d in 0..D {
                let apart = listed.separation[d][k] + moved[k][d];
                squared += apart * apart;
            }
            // R_i + R_j = |D| + δ⁰ up to rounding, which is far below the tolerance of a skin.
            let range = distance[k] + overlap[k] + skin;
            self.excess[k] = squared - range * range;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forces::assembly::Assembly;
    use crate::io::read_packing;
    use crate::law::power_laws::Hertzian;
    use crate::vector::{difference, norm};

    /// Moves every disk by `displacement` per step, each in its own direction. Every tenth step compares energy,
    /// contacts and forces with those of a rebuilt list. Returns the fraction of steps with the inner list and the
    /// fraction with a rebuild of the outer list.
    fn move_disks(assembly: &mut Assembly<2>, displacement: f64, steps: usize) -> (f64, f64) {
        let mobile = assembly.mobile_count();
        let (mut near, made) = (0, assembly.build_count());
        for step in 0..steps {
            for disk in 0..mobile {
                let angle = (disk * (step / 40 + 1)) as f64;
                assembly.displacements[disk][0] += displacement * angle.cos();
                assembly.displacements[disk][1] += displacement * angle.sin();
            }
            assembly.update_list(displacement).expect("no coincidence");
            near += usize::from(assembly.lists().inner_list_is_used());
            let found = assembly.evaluate_totals();
            let forces = assembly.forces.clone();
            if step % 10 == 9 {
                let mut other = assembly.clone();
                other.reanchor().expect("no coincidence");
                let expected = other.evaluate_totals();
                assert_eq!(found.contact_count, expected.contact_count, "step {step}");
                // Sums of some 2200 terms in different orders.
                assert!((found.energy - expected.energy).abs() < 1e-12 * expected.energy, "step {step}");
                for (one, two) in forces.iter().zip(&other.forces) {
                    // Forces up to 10⁴ from overlaps known to 10⁻¹⁶ of a radius, stiffness 10⁵.
                    assert!(norm(difference(*one, *two)) < 1e-9, "step {step}: {one:?} {two:?}");
                }
            }
        }
        (near as f64 / steps as f64, (assembly.build_count() - made) as f64 / steps as f64)
    }

    #[test]
    fn no_contact_is_missed_while_disks_move_slowly_or_fast() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N1000_p100.xyz");
        let packing = read_packing::<2>(file).expect("a stored packing");
        let mut assembly = Assembly::new(&packing, &Hertzian::default()).expect("no coincidence");
        assembly.set_pruning(true);
        let radius = 0.5;
        let (near, made) = move_disks(&mut assembly, 1e-4 * radius, 400);
        assert!(near > 0.9 && made == 0.0, "slowly: {near} {made}");
        assert!(
            assembly.pairs().len() * 10 < assembly.lists().outer().len() * 9,
            "a tenth of the pairs and more left out"
        );
        let (near, made) = move_disks(&mut assembly, 2e-2 * radius, 200);
        assert!(near < 0.5 && made > 0.02, "fast: {near} {made}");
        let (near, _) = move_disks(&mut assembly, 1e-4 * radius, 400);
        assert!(near > 0.7, "slowly again: {near}");
        assembly.set_pruning(false);
        let (near, _) = move_disks(&mut assembly, 1e-2 * radius, 100);
        assert!(near < 0.3, "not any more: {near}");
    }

    #[test]
    fn the_best_skin_is_where_a_step_costs_least() {
        let cost = |skin: f64| PAIRS_PER_RADIUS * skin / 0.5 + PRUNING_COST * 2.0 * 1e-4 / skin;
        let best = best_inner_skin(0.5, 1e-4);
        assert!(cost(best) < cost(0.9 * best) && cost(best) < cost(1.1 * best));
        assert_eq!(best_inner_skin(0.5, 0.0), 0.5 * NARROWEST, "disks at rest");
    }
}
