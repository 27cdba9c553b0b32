//! Sums of stiffness over the contacts of each disk, with the blocks and tiles of the hot loop.

use crate::forces::block_arithmetic::{Anchors, Columns};
use crate::law::pair_law::PairLaw;
use crate::neighbours::block::BLOCK;
use crate::neighbours::pair_list::PairList;
use crate::neighbours::rows::{gather, prefetch_rows, scatter_with};
use crate::neighbours::tiles::Tile;
use crate::parallel;
use crate::vector::{Vector, sum};

/// Weight of a contact: a function of (pair, overlap, stiffness).
pub type Weight<'a> = dyn Fn(usize, f64, f64) -> f64 + Sync + 'a;

/// Sums over the contacts of each disk, of the stiffness or of a weight.
///
/// The largest row sum is an upper bound on the largest eigenvalue of the stiffness matrix (Gershgorin). With masses 1,
/// `λ ≤ max_i Σ_j 2 F'(δ_ij)`, because the prestress part is negative. A contact with a held disk counts once.
///
/// # Shape
/// `row` has one entry per disk and is overwritten.
pub fn stiffness_rows<const D: usize>(
    law: &dyn PairLaw,
    pairs: &PairList<D>,
    displacements: &[Vector<D>],
    mobile_count: usize,
    weight: Option<&Weight<'_>>,
    row: &mut [f64],
) {
    let task = Task { law, pairs, displacements, mobile_count, weight };
    let tiles = pairs.tiles.iter().zip(row.chunks_mut(pairs.tile_size)).enumerate();
    let border_values = parallel::each(tiles, |(place, (tile, row))| task.of_tile(tile, place * pairs.tile_size, row));
    if pairs.tiles.len() > 1 {
        let tiles = pairs.tiles.iter().zip(row.chunks_mut(pairs.tile_size)).enumerate();
        parallel::each(tiles, |(place, (tile, row))| {
            for &(disk, from, pair) in &tile.incoming {
                row[disk as usize - place * pairs.tile_size] += border_values[from as usize][pair as usize];
            }
        });
    }
}

struct Task<'a, const D: usize> {
    law: &'a dyn PairLaw,
    pairs: &'a PairList<D>,
    displacements: &'a [Vector<D>],
    mobile_count: usize,
    weight: Option<&'a Weight<'a>>,
}

impl<const D: usize> Task<'_, D> {
    /// Sums the rows of the disks of a tile, which begins with disk `offset`, over the pairs of the tile. Returns the
    /// terms for the second disks of its border pairs.
    fn of_tile(&self, tile: &Tile, offset: usize, row: &mut [f64]) -> Vec<f64> {
        let (pairs, mobile) = (self.pairs, self.mobile_count);
        row.fill(0.0);
        let mut border_values = vec![0.0; tile.border_pairs.len()];
        let mut columns = Columns::<D>::new();
        let mut values = [[0.0]; BLOCK];
        for place in tile.inner.start..tile.border.end {
            let block = &pairs.blocks[place];
            prefetch_rows(pairs, block);
            gather(&mut columns.pair_vectors, pairs, block, (self.displacements, 0));
            let anchors = Anchors::of(self.law, pairs, block);
            columns.compute_overlaps(&anchors);
            columns.compute_forces(self.law, &anchors);
            let count = block.pair_count;
            let values_of_pairs = &mut values.as_flattened_mut()[..count];
            self.law.stiffnesses(&columns.force[..count], &columns.overlap[..count], values_of_pairs);
            for ((pair, value), &overlap) in block.pairs().zip(&mut values).zip(&columns.overlap) {
                let weighted = match self.weight {
                    Some(weight) if overlap > 0.0 => weight(pair, overlap, value[0]),
                    None if overlap > 0.0 => value[0],
                    _ => 0.0,
                };
                value[0] = if (pairs.second[pair] as usize) < mobile { 2.0 * weighted } else { weighted };
            }
            if tile.inner.contains(&place) {
                scatter_with(&values, pairs, block, (row.as_chunks_mut::<1>().0, offset as u32), sum);
                continue;
            }
            for (&[value], pair) in values.iter().zip(block.pairs..block.pairs + block.pair_count) {
                row[pairs.first[pair] as usize - offset] += value;
                if (pairs.second[pair] as usize) < mobile {
                    border_values[pair - tile.border_pairs.start] = value;
                }
            }
        }
        let held = mobile.saturating_sub(offset).min(row.len());
        row[held..].fill(0.0);
        border_values
    }
}
