//! The elimination order of the unknowns of a packing, which determines the number of values of a factor.
//!
//! Both methods treat a disk as one vertex, coupled to the disks that it touches, and keep its D coordinates together.
//! [`minimum_degree`] uses the contacts alone; [`nested_dissection`] also uses the positions. A function returns the
//! row to eliminate at each place, for [`Analysis::in_order`](crate::linear::Analysis::in_order).
//! [`Analysis::of`](crate::linear::Analysis::of) uses [`best`].
//!
//! # Source
//! Amestoy, Davis, Duff (1996), SIAM J. Matrix Anal. Appl. 17, 886 (approximate minimum degree, as in faer 0.24);
//! George (1973), SIAM J. Numer. Anal. 10, 345 (nested dissection).

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use crate::linear::dissection;
use crate::linear::error::LinearError;
use crate::linear::hessian::Hessian;

/// The fastest order for jammed packings: minimum degree in two dimensions, nested dissection in three.
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

/// Nested dissection of the disks by their positions.
///
/// # Cost
/// N log N, N the number of disks.
pub fn nested_dissection<const D: usize>(hessian: &Hessian<D>) -> Vec<usize> {
    let order = dissection::nested_dissection(hessian.places(), &hessian.graph());
    unknowns::<D>(order.into_iter().map(|vertex| vertex as usize))
}

/// The D rows of each disk, in the given order of disks.
fn unknowns<const D: usize>(disks: impl Iterator<Item = usize>) -> Vec<usize> {
    disks.flat_map(|disk| (0..D).map(move |axis| D * disk + axis)).collect()
}
