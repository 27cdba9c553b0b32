//! The near pairs of a list as a list of its own, and how near they are to be.
//!
//! ```text
//! |r_ij| < R_i + R_j + s        time of a step ∼ 1 + a s/R + P/n,  n = s/(2 v) steps until some disk has gone s/2
//! s = √(2 P v R/a)
//! ```
//!
//! A list with a wide skin lasts long and holds many pairs apart. While disks move little (v a step, the fastest), those nearer
//! than a narrow skin s are all that can touch: they are copied out, anchors and all, in a few evaluations' time, and the
//! loop runs over them until a disk has moved by s/2. Then they are picked again, and the wide list is made anew only when
//! it is spent itself.
//!
//! # Source
//! Pruned pair lists: Páll et al. (2020), J. Chem. Phys. 153, 134110, §IV.

use crate::neighbours::block::{BLOCK, Block, LONGEST_ROW};
use crate::neighbours::pair_block::PairBlock;
use crate::neighbours::pair_list::{Arranger, PairList, Source};
use crate::neighbours::rows::{gather, rows_of};
use crate::processor;
use crate::vector::Vector;

/// Pairs that a skin of one radius adds, over those that touch: 8 in 100 for a tenth of a radius, 15 for a quarter \[1\].
const PAIRS_A_RADIUS: f64 = 0.75;

/// Time of picking near pairs over that of an evaluation of the loop \[1\].
const PICKING: f64 = 4.0;

/// Time of making a list over that \[1\].
const MAKING: f64 = 25.0;

/// Narrowest skin over the smallest radius: it adds 4 pairs in 1000, and rounding is far below it \[1\].
const NARROWEST: f64 = 1e-3;

/// The skin of near pairs for which steps cost least when the fastest disk moves by `way` a step \[length\].
pub(crate) fn best_skin(radius: f64, way: f64) -> f64 {
    best_for(PICKING, radius, way).max(NARROWEST * radius)
}

/// The same for the list of all pairs, when most disks move by `way` a step and it can be amended for the others \[length\].
pub(crate) fn best_skin_of_all(radius: f64, way: f64) -> f64 {
    best_for(MAKING, radius, way)
}

fn best_for(cost: f64, radius: f64, way: f64) -> f64 {
    (2.0 * cost / PAIRS_A_RADIUS * way * radius).sqrt()
}

impl<const D: usize> PairList<D> {
    /// Empties the list and fills it with the pairs of another one whose disks are nearer than reach + `skin`.
    pub(crate) fn prune(&mut self, whole: &PairList<D>, displacements: &[Vector<D>], skin: f64) {
        self.first_count = whole.first_count;
        self.keeps_places = whole.keeps_places;
        self.fill_tiles(whole.tiles.len(), whole.tile_size, |list, place, tile| {
            let blocks = &whole.tiles[place];
            list.add_blocks(
                (tile, place * whole.tile_size),
                &mut Pruned { whole, displacements, skin },
                |list, arranger, near| near.line_up(&whole.blocks[blocks.inner.clone()], list, arranger),
                |list, arranger, near| near.line_up(&whole.blocks[blocks.border.clone()], list, arranger),
            );
        });
    }
}

/// Near pairs of `whole`, numbered as there.
struct Pruned<'a, const D: usize> {
    whole: &'a PairList<D>,
    displacements: &'a [Vector<D>],
    skin: f64,
}

impl<const D: usize> Pruned<'_, D> {
    /// Puts the near pairs of blocks in line, row by row.
    fn line_up(&mut self, blocks: &[Block], list: &mut PairList<D>, arranger: &mut Arranger<D>) {
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
                // Which are near cannot be guessed: they are picked without a branch. NaN counts as near.
                let (mut near, mut near_count) = ([0; LONGEST_ROW], 0);
                for &excess in excess {
                    near[near_count % LONGEST_ROW] = pair;
                    let far = excess > 0.0;
                    near_count += usize::from(!far);
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

    fn measure(&mut self, _first: &[u32], pairs: &[u32], measured: &mut PairBlock<D>) {
        for (place, &pair) in pairs.iter().enumerate() {
            measured.copy(place, (&self.whole.pair_blocks[pair as usize / BLOCK], pair as usize % BLOCK));
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
        let count = self.excess.len();
        let Excess { listed, skin, .. } = self;
        let separation = listed.separation.each_ref().map(|column| &column[..count]);
        let (distance, overlap) = (&listed.distance[..count], &listed.overlap[..count]);
        let moved = &self.moved[..count];
        for k in 0..count {
            let mut squared = 0.0;
            for d in 0..D {
                let apart = separation[d][k] + moved[k][d];
                squared += apart * apart;
            }
            // R_i + R_j = |D| + δ⁰, to rounding: far less than a skin can spare.
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

    /// Every disk goes its own way, `way` long, for so many steps; after each, energy, contacts and forces are those of a list
    /// made on the spot. The shares of steps with near pairs and with a list of all pairs made anew.
    fn walk(assembly: &mut Assembly<2, Hertzian>, way: f64, steps: usize) -> (f64, f64) {
        let mobile = assembly.mobile_count();
        let (mut near, made) = (0, assembly.rebuild_count());
        for step in 0..steps {
            for disk in 0..mobile {
                let angle = (disk * (step / 40 + 1)) as f64;
                assembly.displacements[disk][0] += way * angle.cos();
                assembly.displacements[disk][1] += way * angle.sin();
            }
            assembly.keep_listed(way).expect("no coincidence");
            near += usize::from(assembly.inner_list_is_used());
            let found = assembly.evaluate_totals();
            let forces = assembly.forces.clone();
            if step % 10 == 9 {
                let mut other = assembly.clone();
                other.reanchor().expect("no coincidence");
                let expected = other.evaluate_totals();
                assert_eq!(found.contact_count, expected.contact_count, "step {step}");
                // Sums of some 2200 terms in another order.
                assert!((found.energy - expected.energy).abs() < 1e-12 * expected.energy, "step {step}");
                for (one, two) in forces.iter().zip(&other.forces) {
                    // Forces up to 10⁴ of overlaps known to 10⁻¹⁶ of a radius, stiffness 10⁵.
                    assert!(norm(difference(*one, *two)) < 1e-9, "step {step}: {one:?} {two:?}");
                }
            }
        }
        (near as f64 / steps as f64, (assembly.rebuild_count() - made) as f64 / steps as f64)
    }

    #[test]
    fn no_contact_is_missed_while_disks_move_slowly_or_fast() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N1000_p100.xyz");
        let packing = read_packing::<2>(file).expect("a stored packing");
        let mut assembly = Assembly::new(&packing, Hertzian::default()).expect("no coincidence");
        assembly.prune_lists(true);
        let radius = 0.5;
        let (near, made) = walk(&mut assembly, 1e-4 * radius, 400);
        assert!(near > 0.9 && made == 0.0, "slowly: {near} {made}");
        assert!(assembly.pairs().len() * 10 < assembly.all_pairs().len() * 9, "a tenth of the pairs and more left out");
        let (near, made) = walk(&mut assembly, 2e-2 * radius, 200);
        assert!(near < 0.5 && made > 0.02, "fast: {near} {made}");
        let (near, _) = walk(&mut assembly, 1e-4 * radius, 400);
        assert!(near > 0.7, "slowly again: {near}");
        assembly.prune_lists(false);
        let (near, _) = walk(&mut assembly, 1e-2 * radius, 100);
        assert!(near < 0.3, "not any more: {near}");
    }

    #[test]
    fn the_best_skin_is_where_a_step_costs_least() {
        let cost = |skin: f64| PAIRS_A_RADIUS * skin / 0.5 + PICKING * 2.0 * 1e-4 / skin;
        let best = best_skin(0.5, 1e-4);
        assert!(cost(best) < cost(0.9 * best) && cost(best) < cost(1.1 * best));
        assert_eq!(best_skin(0.5, 0.0), 0.5 * NARROWEST, "disks at rest");
    }
}
