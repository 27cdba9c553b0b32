//! Sums of stiffness over the contacts of each disk, by the blocks and tiles of the hot loop.

use crate::contact::columns::{Anchors, Columns};
use crate::contact::law::PairLaw;
use crate::contact::pair_list::{BLOCK, Block, PairList};
use crate::contact::rows::{ask_for_later_rows, gather, scatter_with};
use crate::contact::tiles::Tile;
use crate::processor;
use crate::side_by_side;
use crate::vector::{Vector, sum};

/// Sums over the contacts of each disk: of the stiffness, or of what `weight` makes of (pair, overlap, stiffness).
///
/// The largest row sum bounds the largest eigenvalue of the stiffness matrix from above (Gershgorin): with masses 1,
/// `λ ≤ max_i Σ_j 2 F'(δ_ij)`, the prestress part being negative. A contact with a held disk counts once.
///
/// # Shape
/// `row` has one entry a disk and is overwritten.
pub fn stiffness_rows<const D: usize, L: PairLaw>(
    law: &L,
    pairs: &PairList<D>,
    displacements: &[Vector<D>],
    mobile_count: usize,
    weight: impl Fn(usize, f64, f64) -> f64 + Sync,
    row: &mut [f64],
) {
    let task = Task { law, pairs, displacements, mobile_count, weight };
    let tiles = pairs.tiles.iter().zip(row.chunks_mut(pairs.tile_size)).enumerate();
    let across = side_by_side::each(tiles, |(place, (tile, row))| task.of_tile(tile, place * pairs.tile_size, row));
    if pairs.tiles.len() > 1 {
        let tiles = pairs.tiles.iter().zip(row.chunks_mut(pairs.tile_size)).enumerate();
        side_by_side::each(tiles, |(place, (tile, row))| {
            for &(disk, from, pair) in &tile.incoming {
                row[disk as usize - place * pairs.tile_size] += across[from as usize][pair as usize];
            }
        });
    }
}

struct Task<'a, const D: usize, L, W> {
    law: &'a L,
    pairs: &'a PairList<D>,
    displacements: &'a [Vector<D>],
    mobile_count: usize,
    weight: W,
}

impl<const D: usize, L: PairLaw, W: Fn(usize, f64, f64) -> f64> Task<'_, D, L, W> {
    /// The rows of the disks of a tile, which begins with disk `offset`, from its own pairs; what the second disk of each pair
    /// across its border is due is returned.
    fn of_tile(&self, tile: &Tile, offset: usize, row: &mut [f64]) -> Vec<f64> {
        let (pairs, mobile) = (self.pairs, self.mobile_count);
        row.fill(0.0);
        let mut across = vec![0.0; tile.border_pairs.len()];
        let mut columns = Columns::<D>::new();
        let values = &mut [[0.0]; BLOCK];
        for place in tile.inner.start..tile.border.end {
            let block = &pairs.blocks[place];
            ask_for_later_rows(pairs, block);
            gather(&mut columns.pull, pairs, block, (self.displacements, 0));
            let (columns, anchors) = (&mut columns, Anchors::of(pairs, block));
            processor::dispatch(Arithmetic { task: self, block, columns, anchors, values });
            if tile.inner.contains(&place) {
                scatter_with(values, pairs, block, (row.as_chunks_mut::<1>().0, offset as u32), sum);
                continue;
            }
            for (&[value], pair) in values.iter().zip(block.pairs..block.pairs + block.pair_count) {
                row[pairs.first[pair] as usize - offset] += value;
                if (pairs.second[pair] as usize) < mobile {
                    across[pair - tile.border_pairs.start] = value;
                }
            }
        }
        let held = mobile.saturating_sub(offset).min(row.len());
        row[held..].fill(0.0);
        across
    }
}

/// What each pair of a block adds to the rows of its disks.
struct Arithmetic<'a, const D: usize, L, W> {
    task: &'a Task<'a, D, L, W>,
    block: &'a Block,
    columns: &'a mut Columns<D>,
    anchors: Anchors<'a, D>,
    values: &'a mut [[f64; 1]; BLOCK],
}

impl<const D: usize, L: PairLaw, W: Fn(usize, f64, f64) -> f64> pulp::WithSimd for Arithmetic<'_, D, L, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) {
        let Task { law, mobile_count, ref weight, pairs, .. } = *self.task;
        self.columns.measure(simd, &self.anchors);
        self.columns.press::<S, L, false>(simd, law, &self.anchors);
        let (begin, count) = (self.block.pairs, self.block.pair_count);
        let (overlap, force) = (&self.columns.overlap[..count], &self.columns.force[..count]);
        let second = &pairs.second[begin..begin + count];
        let values = &mut self.values[..count];
        for k in 0..count {
            let stiffness = law.stiffness(force[k], overlap[k]);
            let value = if overlap[k] > 0.0 { weight(begin + k, overlap[k], stiffness) } else { 0.0 };
            values[k] = [if (second[k] as usize) < mobile_count { 2.0 * value } else { value }];
        }
    }
}
