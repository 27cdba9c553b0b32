//! Rows of pairs of one length: relative displacements are gathered and forces scattered with a fixed number of turns a row.
//!
//! Both know no vectors; a row reads and writes its first disk once.

use crate::contact::pair_list::{BLOCK, Block, LONGEST_ROW, PairList};
use crate::vector::{Vector, difference, sum};

/// First disks of the rows of a block.
#[inline(always)]
pub(super) fn rows_of<'a, const D: usize>(pairs: &'a PairList<D>, block: &Block) -> &'a [u32] {
    let count: usize = block.row_counts.iter().map(|&count| usize::from(count)).sum();
    &pairs.rows[block.rows..block.rows + count]
}

/// Calls a function of the length of rows, as a constant, for the rows of each length: `$rows` and `$pairs` are where they are
/// in their block.
macro_rules! for_each_length {
    ($block:expr, |$rows:ident, $pairs:ident| $call:ident($($argument:expr),*)) => {{
        let (mut row, mut pair) = (0, 0);
        for (index, &count) in $block.row_counts.iter().enumerate() {
            let (count, length) = (usize::from(count), index + 1);
            let ($rows, $pairs) = (row..row + count, pair..pair + count * length);
            (row, pair) = ($rows.end, $pairs.end);
            match length {
                _ if count == 0 => {}
                1 => $call::<D, 1>($($argument),*),
                2 => $call::<D, 2>($($argument),*),
                3 => $call::<D, 3>($($argument),*),
                4 => $call::<D, 4>($($argument),*),
                5 => $call::<D, 5>($($argument),*),
                6 => $call::<D, 6>($($argument),*),
                7 => $call::<D, 7>($($argument),*),
                _ => $call::<D, LONGEST_ROW>($($argument),*),
            }
        }
    }};
}

/// Relative displacements of the pairs of a block; disks are counted from `offset`.
pub(super) fn gather<const D: usize>(
    moved: &mut [[f64; BLOCK]; D],
    block: &Block,
    (rows, second, offset): (&[u32], &[u32], u32),
    displacements: &[Vector<D>],
) {
    for_each_length!(block, |of_rows, of_pairs| gather_rows(
        moved.each_mut().map(|column| &mut column[of_pairs.clone()]),
        (&rows[of_rows], &second[of_pairs.clone()], offset),
        displacements
    ));
}

#[inline(always)]
fn gather_rows<const D: usize, const LENGTH: usize>(
    moved: [&mut [f64]; D],
    (rows, second, offset): (&[u32], &[u32], u32),
    displacements: &[Vector<D>],
) {
    // Columns of one length and a plain index: of chained iterators some stay calls.
    let count = rows.len();
    let moved = moved.map(|column| &mut column.as_chunks_mut::<LENGTH>().0[..count]);
    let second = &second.as_chunks::<LENGTH>().0[..count];
    for row in 0..count {
        let a = displacements[(rows[row] - offset) as usize];
        for k in 0..LENGTH {
            let apart = difference(a, displacements[(second[row][k] - offset) as usize]);
            for d in 0..D {
                moved[d][row][k] = apart[d];
            }
        }
    }
}

/// Adds the force of each pair of a block to its first disk and takes it from the second; disks are counted from `offset`.
pub(super) fn scatter<const D: usize>(
    pull: &[[f64; BLOCK]; D],
    block: &Block,
    (rows, second, offset): (&[u32], &[u32], u32),
    forces: &mut [Vector<D>],
) {
    for_each_length!(block, |of_rows, of_pairs| scatter_rows(
        pull.each_ref().map(|column| &column[of_pairs.clone()]),
        (&rows[of_rows], &second[of_pairs.clone()], offset),
        forces
    ));
}

#[inline(always)]
fn scatter_rows<const D: usize, const LENGTH: usize>(
    pull: [&[f64]; D],
    (rows, second, offset): (&[u32], &[u32], u32),
    forces: &mut [Vector<D>],
) {
    let count = rows.len();
    let pull = pull.map(|column| &column.as_chunks::<LENGTH>().0[..count]);
    let second = &second.as_chunks::<LENGTH>().0[..count];
    for row in 0..count {
        let first = (rows[row] - offset) as usize;
        let mut total = forces[first];
        for k in 0..LENGTH {
            let pull: Vector<D> = std::array::from_fn(|d| pull[d][row][k]);
            total = sum(total, pull);
            let other = &mut forces[(second[row][k] - offset) as usize];
            *other = difference(*other, pull);
        }
        forces[first] = total;
    }
}
