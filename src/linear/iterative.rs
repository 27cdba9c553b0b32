//! Conjugate gradients, for matrices whose factor does not fit in memory. They need only memory for the matrix itself.
//!
//! ```text
//! M = L Lᵀ ≈ A + α diag A,  L with the pattern of A        A x = b  by conjugate gradients on M⁻¹ A
//! ```
//!
//! The incomplete factor may not exist although A is positive definite; α is then raised until it does. If the factor
//! fits in memory, [`Analysis`](crate::linear::Analysis) is much faster in two dimensions. In three dimensions the
//! time of a factor grows as N², the number of iterations as N^(1/3): [`is_faster`] has the number of spheres from which
//! they take less (`cargo run --release --features measurements --example sphere_factors`). Newton's method uses them
//! from there on. They do not count negative eigenvalues, so responses, moduli, modes, certificates and implicit steps
//! need a factor.
//!
//! # Source
//! Hestenes, Stiefel (1952), J. Res. Natl. Bur. Stand. 49, 409; Meijerink, van der Vorst (1977), Math. Comput. 31, 148
//! (incomplete factors); Manteuffel (1980), Math. Comput. 34, 473 (the shift).

use crate::linear::error::LinearError;
use crate::sparse::SymmetricMatrix;
use crate::vector::larger;

/// Spheres from which conjugate gradients solve one system in less time than a factor and one solution: packings of
/// 1000 to 64000 spheres, from about 1000 on at p = 1000 and from 4000 on at p = 10; more iterations are needed the closer
/// to jamming (`benches/NOTES.md`, *Factors of spheres*).
const FASTER_FROM: usize = 6_000;

/// Whether conjugate gradients solve a single system with the matrix of a packing faster than a factor. Never in two
/// dimensions; for several systems a factor is the better, the more of them it serves.
pub fn is_faster<const D: usize>(disk_count: usize) -> bool {
    D == 3 && disk_count >= FASTER_FROM
}

/// An incomplete Cholesky factor, with columns as in the matrix.
#[derive(Debug, Clone)]
pub struct IncompleteFactor {
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
    shift: f64,
}

/// First shift tried if no factor exists without a shift, relative to the diagonal; doubled from there.
const FIRST_SHIFT: f64 = 1e-3;

impl IncompleteFactor {
    /// The incomplete factor of a matrix with a positive diagonal.
    ///
    /// # Errors
    /// A diagonal entry that is not positive, so that the matrix is not positive definite.
    pub fn new(matrix: &SymmetricMatrix) -> Result<Self, LinearError> {
        let dimension = matrix.dimension();
        if (0..dimension).any(|row| not_positive(matrix.values()[matrix.column_starts()[row]])) {
            return Err(LinearError::NotPositiveDefinite { dimension });
        }
        let mut factor = IncompleteFactor {
            starts: matrix.column_starts().to_vec(),
            rows: matrix.rows().to_vec(),
            values: Vec::new(),
            shift: 0.0,
        };
        while !factor.made_of(matrix) {
            factor.shift = (2.0 * factor.shift).max(FIRST_SHIFT);
            if !factor.shift.is_finite() {
                return Err(LinearError::NotPositiveDefinite { dimension });
            }
        }
        Ok(factor)
    }

    /// α, the share of the diagonal that is added \[1\]; usually 0.
    pub fn shift(&self) -> f64 {
        self.shift
    }

    /// Computes the factor column by column; false if a pivot is not positive.
    fn made_of(&mut self, matrix: &SymmetricMatrix) -> bool {
        self.values.clear();
        self.values.extend_from_slice(matrix.values());
        let dimension = matrix.dimension();
        for column in 0..dimension {
            self.values[self.starts[column]] *= 1.0 + self.shift;
        }
        for column in 0..dimension {
            let (start, end) = (self.starts[column], self.starts[column + 1]);
            let pivot = self.values[start];
            if not_positive(pivot) {
                return false;
            }
            let root = pivot.sqrt();
            self.values[start] = root;
            self.values[start + 1..end].iter_mut().for_each(|value| *value /= root);
            for first in start + 1..end {
                let (target, factor) = (self.rows[first], self.values[first]);
                let (begin, finish) = (self.starts[target], self.starts[target + 1]);
                // Both lists of rows are ascending, so a single pass finds their common rows.
                let mut place = begin;
                for second in first..end {
                    let row = self.rows[second];
                    while place < finish && self.rows[place] < row {
                        place += 1;
                    }
                    if place < finish && self.rows[place] == row {
                        self.values[place] -= factor * self.values[second];
                    }
                }
            }
        }
        true
    }

    /// `x ← (L Lᵀ)⁻¹ x`.
    fn solve(&self, x: &mut [f64]) {
        let dimension = x.len();
        for column in 0..dimension {
            let (start, end) = (self.starts[column], self.starts[column + 1]);
            let value = x[column] / self.values[start];
            x[column] = value;
            for (&row, factor) in self.rows[start + 1..end].iter().zip(&self.values[start + 1..end]) {
                x[row] -= factor * value;
            }
        }
        for column in (0..dimension).rev() {
            let (start, end) = (self.starts[column], self.starts[column + 1]);
            let below = self.rows[start + 1..end].iter().zip(&self.values[start + 1..end]);
            let sum = below.fold(0.0, |sum, (&row, factor)| sum + factor * x[row]);
            x[column] = (x[column] - sum) / self.values[start];
        }
    }
}

/// Limits of conjugate gradients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IterationLimits {
    /// Target of ‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖), maximum norms \[1\].
    pub backward_error: f64,
    /// Iterations allowed.
    pub iteration_count: usize,
}

impl Default for IterationLimits {
    /// 10⁻¹⁵, the accuracy of a refined factor.
    fn default() -> Self {
        IterationLimits { backward_error: 1e-15, iteration_count: 100_000 }
    }
}

/// The result of conjugate gradients.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IterativeSolution {
    /// ‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖), computed from x \[1\].
    pub backward_error: f64,
    /// Iterations; each takes one product with A and one solution with the incomplete factor.
    pub iteration_count: usize,
}

/// Iterations between two evaluations of the true residual, from which the recurrence drifts away.
const CHECK_EVERY: usize = 50;

/// Solves A x = b. The iteration starts from `solution` and overwrites it with x.
///
/// # Errors
/// A matrix found not to be positive definite; iterations used up, with the backward error reached.
///
/// # Panics
/// If a length differs from the dimension.
pub fn conjugate_gradients(
    matrix: &SymmetricMatrix,
    factor: &IncompleteFactor,
    right_side: &[f64],
    solution: &mut [f64],
    limits: &IterationLimits,
) -> Result<IterativeSolution, LinearError> {
    let dimension = matrix.dimension();
    assert!(right_side.len() == dimension && solution.len() == dimension, "one number a row");
    let norm = matrix.norm();
    let mut residual = vec![0.0; dimension];
    let mut product = vec![0.0; dimension];
    let mut backward_error = true_residual(matrix, norm, right_side, solution, &mut residual);
    let mut iteration_count = 0;
    // The recurrence restarts after every check: the accumulated drift becomes part of the new residual.
    while backward_error.is_nan() || backward_error > limits.backward_error {
        let mut conditioned = residual.clone();
        factor.solve(&mut conditioned);
        let mut direction = conditioned.clone();
        let mut energy = product_of(&residual, &conditioned);
        let restart_at = iteration_count + CHECK_EVERY.max(dimension.min(2000));
        loop {
            if iteration_count >= limits.iteration_count {
                let backward_error = true_residual(matrix, norm, right_side, solution, &mut residual);
                return Err(LinearError::IterationsUsedUp { iteration_count, backward_error });
            }
            matrix.multiply(&direction, &mut product);
            let curvature = product_of(&direction, &product);
            if not_positive(curvature) {
                // 0 for a direction that has vanished, at the rounding floor.
                let vanished = direction.iter().all(|&value| value == 0.0);
                if vanished {
                    break;
                }
                return Err(LinearError::NotPositiveDefinite { dimension });
            }
            let step = energy / curvature;
            for (x, d) in solution.iter_mut().zip(&direction) {
                *x += step * d;
            }
            for (r, a) in residual.iter_mut().zip(&product) {
                *r -= step * a;
            }
            iteration_count += 1;
            let scale = norm * largest(solution) + largest(right_side);
            if largest(&residual) <= limits.backward_error * scale || iteration_count >= restart_at {
                break;
            }
            conditioned.copy_from_slice(&residual);
            factor.solve(&mut conditioned);
            let next = product_of(&residual, &conditioned);
            let keep = next / energy;
            energy = next;
            for (d, z) in direction.iter_mut().zip(&conditioned) {
                *d = z + keep * *d;
            }
        }
        let before = backward_error;
        backward_error = true_residual(matrix, norm, right_side, solution, &mut residual);
        // At the rounding floor restarts do not help.
        if backward_error >= 0.9 * before && backward_error <= 16.0 * f64::EPSILON {
            break;
        }
    }
    Ok(IterativeSolution { backward_error, iteration_count })
}

/// Writes b − A x to `residual` and returns the backward error; 0 for x = b = 0.
fn true_residual(
    matrix: &SymmetricMatrix,
    norm: f64,
    right_side: &[f64],
    solution: &[f64],
    residual: &mut [f64],
) -> f64 {
    matrix.multiply(solution, residual);
    residual.iter_mut().zip(right_side).for_each(|(r, b)| *r = b - *r);
    let scale = norm * largest(solution) + largest(right_side);
    if scale == 0.0 { 0.0 } else { largest(residual) / scale }
}

fn largest(column: &[f64]) -> f64 {
    let most = column.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    // The maximum drops NaN, but the sum keeps it (or an infinity: both are refused).
    if column.iter().sum::<f64>().is_finite() {
        most
    } else {
        column.iter().fold(0.0, |most, value| larger(value.abs(), most))
    }
}

/// Whether a value is NaN or not positive.
fn not_positive(value: f64) -> bool {
    value.is_nan() || value <= 0.0
}

fn product_of(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_spheres_are_iterated_and_disks_never() {
        assert!(is_faster::<3>(FASTER_FROM) && !is_faster::<3>(FASTER_FROM - 1));
        assert!(!is_faster::<2>(1_000_000));
    }
}
