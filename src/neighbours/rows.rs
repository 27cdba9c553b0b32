//! Rows of pairs of equal length: relative displacements are gathered and forces scattered with a constant trip count
//! per row.
//!
//! Neither uses vector instructions. A row reads and writes its first disk once.

use crate::neighbours::block::{BLOCK, Block, LONGEST_ROW};
use crate::neighbours::pair_list::PairList;
use crate::vector::{Number, difference, sum};

/// First disks of the rows of a block, counted from its origin.
#[inline(always)]
pub(crate) fn rows_of<'a, const D: usize>(pairs: &'a PairList<D>, block: &Block) -> &'a [u32] {
    &pairs.rows[block.rows..block.rows + block.row_count]
}

/// Second disks of the pairs of a block, counted from its origin.
#[inline(always)]
fn ends_of<'a, const D: usize>(pairs: &'a PairList<D>, block: &Block) -> &'a [u32] {
    &pairs.ends[block.pairs..block.pairs + block.pair_count]
}

/// Calls a function with the row length of a block as a constant.
macro_rules! with_length {
    ($block:expr, $call:ident($($argument:expr),*)) => {
        match $block.row_length {
            1 => $call::<T, _, 1>($($argument),*),
            2 => $call::<T, _, 2>($($argument),*),
            3 => $call::<T, _, 3>($($argument),*),
            4 => $call::<T, _, 4>($($argument),*),
            5 => $call::<T, _, 5>($($argument),*),
            6 => $call::<T, _, 6>($($argument),*),
            7 => $call::<T, _, 7>($($argument),*),
            _ => $call::<T, _, LONGEST_ROW>($($argument),*),
        }
    };
}

/// Distance of the prefetch of rows and second disks \[blocks\].
const AHEAD: usize = 2;

/// Prefetches the rows and second disks of a later block, if the list is long; otherwise gathering would wait for
/// memory.
#[inline(always)]
pub(crate) fn prefetch_rows<const D: usize>(pairs: &PairList<D>, block: &Block) {
    if let Some(cache) = pairs.prefetches() {
        cache.prefetch_all(&pairs.ends, block.pairs + AHEAD * BLOCK, BLOCK);
        cache.prefetch_all(&pairs.rows, block.rows + AHEAD * block.row_count, block.row_count);
    }
}

/// Gathers the relative displacements of the pairs of a block; the array begins with disk `begin`.
pub(crate) fn gather<T: Number, const D: usize>(
    moved: &mut [[T; D]; BLOCK],
    pairs: &PairList<D>,
    block: &Block,
    (displacements, begin): (&[[T; D]], u32),
) {
    let (rows, ends) = (rows_of(pairs, block), ends_of(pairs, block));
    let displacements = &displacements[(block.origin - begin) as usize..];
    with_length!(block, gather_rows(moved, (rows, ends), displacements));
}

#[inline(always)]
fn gather_rows<T: Number, const D: usize, const LENGTH: usize>(
    moved: &mut [[T; D]; BLOCK],
    (rows, ends): (&[u32], &[u32]),
    displacements: &[[T; D]],
) {
    // Equal lengths and a plain index, so that the compiler inlines the loop; chained iterators are not always inlined.
    let count = rows.len();
    let moved = &mut moved.as_chunks_mut::<LENGTH>().0[..count];
    let ends = &ends.as_chunks::<LENGTH>().0[..count];
    for row in 0..count {
        let a = displacements[rows[row] as usize];
        for k in 0..LENGTH {
            moved[row][k] = difference(a, displacements[ends[row][k] as usize]);
        }
    }
}

/// Adds the force of each pair of a block to its first disk and subtracts it from the second; the array begins with
/// disk `begin`.
pub(crate) fn scatter<T: Number, const D: usize>(
    pair_forces: &[[T; D]; BLOCK],
    pairs: &PairList<D>,
    block: &Block,
    forces: (&mut [[T; D]], u32),
) {
    scatter_with(pair_forces, pairs, block, forces, difference);
}

/// Adds the value of each pair of a block to its first disk. The second disk gets `on_second`(its value, value of the
/// pair).
#[inline(always)]
pub(crate) fn scatter_with<T: Number, const D: usize, const N: usize>(
    of_pairs: &[[T; N]; BLOCK],
    pairs: &PairList<D>,
    block: &Block,
    (of_disks, begin): (&mut [[T; N]], u32),
    on_second: impl Fn([T; N], [T; N]) -> [T; N],
) {
    let (rows, ends) = (rows_of(pairs, block), ends_of(pairs, block));
    let of_disks = &mut of_disks[(block.origin - begin) as usize..];
    with_length!(block, scatter_rows(of_pairs, (rows, ends), of_disks, &on_second));
}

#[inline(always)]
fn scatter_rows<T: Number, const N: usize, const LENGTH: usize>(
    of_pairs: &[[T; N]; BLOCK],
    (rows, ends): (&[u32], &[u32]),
    of_disks: &mut [[T; N]],
    on_second: &impl Fn([T; N], [T; N]) -> [T; N],
) {
    let count = rows.len();
    let of_pairs = &of_pairs.as_chunks::<LENGTH>().0[..count];
    let ends = &ends.as_chunks::<LENGTH>().0[..count];
    for row in 0..count {
        let first = rows[row] as usize;
        let mut total = of_disks[first];
        for k in 0..LENGTH {
            let of_pair = of_pairs[row][k];
            total = sum(total, of_pair);
            let other = &mut of_disks[ends[row][k] as usize];
            *other = on_second(*other, of_pair);
        }
        of_disks[first] = total;
    }
}
