//! Lanczos iteration with full reorthogonalisation: the largest eigenvalues of a symmetric operator in the orthogonal
//! complement of known vectors.
//!
//! ```text
//! A V = V T + β v eᵀ        T tridiagonal,  T s = θ s        y = V s        ‖A y − θ y‖ = β |s_last|
//! ```
//!
//! # Source
//! Parlett (1998), The Symmetric Eigenvalue Problem (Lanczos iteration; reorthogonalisation twice).

use faer::{Mat, Side};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::linear::error::LinearError;

/// ‖A y − θ y‖/θ below which a pair counts as converged \[1\]: about a hundred times the rounding of a solution.
const FOUND: f64 = 1e-14;

/// Largest number of steps: per pair, and additional ones.
const STEPS: (usize, usize) = (30, 300);

/// Steps between two checks of the tridiagonal matrix: at least the first number, and a share of the steps so far. The
/// cost of a check grows as the third power of the steps.
const CHECK_EVERY: (usize, usize) = (8, 8);

/// Unit vectors near eigenvectors, those of the largest eigenvalues first, from one random start.
///
/// Of a degenerate eigenvalue only one vector is found; another run with it in `known` finds the next.
pub(super) fn largest(
    dimension: usize,
    known: &[Vec<f64>],
    wanted: usize,
    seed: u64,
    mut apply: impl FnMut(&[f64], &mut [f64]) -> Result<(), LinearError>,
) -> Result<Vec<Vec<f64>>, LinearError> {
    let room = dimension - known.len();
    let step_limit = room.min(STEPS.0 * wanted + STEPS.1);
    let mut generator = Pcg64::seed_from_u64(seed);
    let mut next: Vec<f64> = (0..dimension).map(|_| generator.random::<f64>() - 0.5).collect();
    make_orthogonal(&mut next, known, &[]);
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let (mut diagonal, mut beside): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut check_at = wanted + CHECK_EVERY.0;
    loop {
        let length = norm(&next);
        next.iter_mut().for_each(|value| *value /= length);
        basis.push(next);
        let last = &basis[basis.len() - 1];
        let mut product = vec![0.0; dimension];
        apply(last, &mut product)?;
        diagonal.push(dot(last, &product));
        make_orthogonal(&mut product, known, &basis);
        next = product;
        let left = norm(&next);
        let size = diagonal.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        // The rest is the rounding of the solution: the vectors span an invariant subspace. NaN ends the run as well.
        let closed = left.is_nan() || left <= FOUND * size || basis.len() == room;
        if closed || basis.len() >= check_at || basis.len() == step_limit {
            check_at = basis.len() + CHECK_EVERY.0.max(basis.len() / CHECK_EVERY.1);
            let found = pairs(&diagonal, &beside, if closed { 0.0 } else { left });
            if closed || basis.len() == step_limit || found.len() >= wanted {
                return Ok(found.iter().map(|weights| combined(&basis, weights)).collect());
            }
        }
        beside.push(left);
    }
}

/// Converged eigenvectors of the tridiagonal matrix, in sequence from the largest eigenvalue.
fn pairs(diagonal: &[f64], beside: &[f64], left: f64) -> Vec<Vec<f64>> {
    let count = diagonal.len();
    let matrix = Mat::from_fn(count, count, |row, column| match row.abs_diff(column) {
        0 => diagonal[row],
        1 => beside[row.min(column)],
        _ => 0.0,
    });
    let Ok(eigen) = matrix.self_adjoint_eigen(Side::Lower) else { return Vec::new() };
    let (values, vectors) = (eigen.S().column_vector(), eigen.U());
    let found = (0..count).rev().take_while(|&k| left * vectors[(count - 1, k)].abs() <= FOUND * values[k].abs());
    found.map(|k| (0..count).map(|row| vectors[(row, k)]).collect()).collect()
}

fn combined(basis: &[Vec<f64>], weights: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; basis[0].len()];
    for (vector, &weight) in basis.iter().zip(weights) {
        sum.iter_mut().zip(vector).for_each(|(total, value)| *total += weight * value);
    }
    let length = norm(&sum);
    sum.iter_mut().for_each(|value| *value /= length);
    sum
}

/// Removes the components of a vector along orthonormal vectors, twice.
fn make_orthogonal(vector: &mut [f64], known: &[Vec<f64>], basis: &[Vec<f64>]) {
    for _ in 0..2 {
        for other in known.iter().chain(basis) {
            let along = dot(vector, other);
            vector.iter_mut().zip(other).for_each(|(value, part)| *value -= along * part);
        }
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

pub(super) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
