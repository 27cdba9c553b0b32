//! In which order the unknowns of a packing are eliminated: what decides how many values a factor has.
//!
//! Both orders treat a disk as one vertex, coupled to those it touches, and keep its D coordinates together:
//! [`minimum_degree`] guesses from the contacts alone, [`nested_dissection`] knows where the disks are. A function here
//! gives the row to eliminate in each place, for [`Analysis::in_order`](crate::linear::Analysis::in_order);
//! [`Analysis::of`](crate::linear::Analysis::of) takes [`best`].
//!
//! # Source
//! Amestoy, Davis, Duff (1996), SIAM J. Matrix Anal. Appl. 17, 886 (approximate minimum degree, as in faer 0.24); George
//! (1973), SIAM J. Numer. Anal. 10, 345 (nested dissection).

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use crate::linear::dissection;
use crate::linear::error::LinearError;
use crate::linear::hessian::Hessian;

/// The order that is best here: minimum degree in two dimensions, nested dissection in three.
///
/// In two dimensions both take the same time to factorise to 12 %, and dissection leaves 11 to 20 % more values (jammed
/// packings of 5548 to 88768 disks). In three it takes a half to two thirds of the time and 72 to 79 % of the values (2000
/// and 8000 balls). `cargo run --release --features measurements --example orderings`.
///
/// # Errors
/// Not enough memory.
pub fn best<const D: usize>(hessian: &Hessian<D>) -> Result<Vec<usize>, LinearError> {
    if D == 2 { minimum_degree(hessian) } else { Ok(nested_dissection(hessian)) }
}

/// Approximate minimum degree on the disks.
///
/// # Errors
/// Not enough memory.
pub fn minimum_degree<const D: usize>(hessian: &Hessian<D>) -> Result<Vec<usize>, LinearError> {
    let graph = hessian.graph();
    let count = graph.vertex_count();
    let out_of_memory = LinearError::OutOfMemory { dimension: D * count };
    // The upper triangle is enough, columns in ascending order.
    let (mut starts, mut rows) = (vec![0], Vec::new());
    for vertex in 0..count as u32 {
        let begin = rows.len();
        rows.extend(graph.neighbours(vertex).iter().filter(|&&other| other < vertex).map(|&other| other as usize));
        rows[begin..].sort_unstable();
        starts.push(rows.len());
    }
    let pattern = SymbolicSparseColMatRef::new_checked(count, count, &starts, None, &rows);
    let mut memory =
        MemBuffer::try_new(amd::order_scratch::<usize>(count, rows.len())).map_err(|_| out_of_memory.clone())?;
    let (mut order, mut place) = (vec![0; count], vec![0; count]);
    amd::order(&mut order, &mut place, pattern, Default::default(), MemStack::new(&mut memory))
        .map_err(|_| out_of_memory)?;
    Ok(unknowns::<D>(order.into_iter()))
}

/// Nested dissection of the disks where they are.
///
/// # Cost
/// N log N in disks.
pub fn nested_dissection<const D: usize>(hessian: &Hessian<D>) -> Vec<usize> {
    let order = dissection::nested_dissection(hessian.places(), &hessian.graph());
    unknowns::<D>(order.into_iter().map(|vertex| vertex as usize))
}

/// The D rows of each disk in turn.
fn unknowns<const D: usize>(disks: impl Iterator<Item = usize>) -> Vec<usize> {
    disks.flat_map(|disk| (0..D).map(move |axis| D * disk + axis)).collect()
}
