//! Sums of stiffness over the contacts of each disk, by the blocks and tiles of the hot loop.

use crate::contact::columns::Columns;
use crate::contact::forces::fill;
use crate::contact::law::PairLaw;
use crate::contact::pair_list::{BLOCK, PairList};
use crate::contact::tiles::Tile;
use crate::side_by_side;
use crate::vector::Vector;

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
        let pairs = self.pairs;
        row.fill(0.0);
        let mut across = Vec::with_capacity(tile.border_pairs.len());
        let mut columns = Columns::<D>::new();
        let stiffness = &mut [0.0; BLOCK];
        for block in tile.inner.start..tile.border.end {
            let border = tile.border.contains(&block);
            let block = &pairs.blocks[block];
            fill(self.law, pairs, (self.displacements, 0), block, &mut columns);
            pulp::Arch::new().dispatch(Stiffnesses { law: self.law, columns: &columns, stiffness });
            for (k, &stiffness) in stiffness[..block.pair_count].iter().enumerate() {
                let pair = block.pairs + k;
                let touches = columns.overlap[k] > 0.0;
                let value = if touches { (self.weight)(pair, columns.overlap[k], stiffness) } else { 0.0 };
                let (i, j) = (pairs.first[pair] as usize, pairs.second[pair] as usize);
                let both = j < self.mobile_count;
                row[i - offset] += if both { 2.0 * value } else { value };
                let of_second = if both { 2.0 * value } else { 0.0 };
                if border {
                    across.push(of_second);
                } else {
                    row[j - offset] += of_second;
                }
            }
        }
        across
    }
}

/// Stiffness of the pairs of a block, of any value where they do not touch.
struct Stiffnesses<'a, const D: usize, L> {
    law: &'a L,
    columns: &'a Columns<D>,
    stiffness: &'a mut [f64; BLOCK],
}

impl<const D: usize, L: PairLaw> pulp::WithSimd for Stiffnesses<'_, D, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) {
        for k in 0..BLOCK {
            self.stiffness[k] = self.law.stiffness(self.columns.force[k], self.columns.overlap[k]);
        }
    }
}
