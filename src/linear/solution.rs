//! [`Factorisation`]: what a factorised matrix tells, and the refined solution of its systems.

use crate::linear::{Analysis, LinearError};
use crate::sparse::SymmetricMatrix;
use crate::vector::larger;

/// Backward error above which a solution is refused \[1\]: a Cholesky factor gives 10⁻¹⁶ to 10⁻¹⁵.
pub const ACCURACY: f64 = 1e-13;

/// Refinements tried; the first removes what growth of L D Lᵀ has cost, the second shows that nothing is left.
const REFINEMENT_LIMIT: usize = 5;

/// A factorised matrix.
#[derive(Debug)]
pub struct Factorisation<'a> {
    pub(super) analysis: &'a mut Analysis,
    pub(super) matrix: &'a SymmetricMatrix,
    pub(super) definite: bool,
    pub(super) negative_count: usize,
    pub(super) pivot_ratio: f64,
    pub(super) norm: f64,
}

/// What is known of a solution.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// ‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖), largest norms: x solves a system that is off by this much exactly \[1\].
    pub backward_error: f64,
    /// Refinements that lowered it.
    pub refinement_count: usize,
}

impl Factorisation<'_> {
    /// Whether the matrix is positive definite, as told by a Cholesky factor; [`Analysis::indefinite`] makes none.
    pub fn is_cholesky(&self) -> bool {
        self.definite
    }

    /// Number of negative eigenvalues: that of the negative pivots.
    pub fn negative_eigenvalue_count(&self) -> usize {
        self.negative_count
    }

    /// Smallest over largest size of a pivot \[1\]. The inverse condition number of a definite matrix lies below it.
    pub fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }

    /// Solves A x = b; `solution` holds x afterwards, whatever it held.
    ///
    /// # Errors
    /// The backward error stays above [`ACCURACY`].
    ///
    /// # Panics
    /// If a length differs from the dimension.
    pub fn solve(&mut self, right_side: &[f64], solution: &mut [f64]) -> Result<Solution, LinearError> {
        let dimension = self.matrix.dimension();
        assert!(right_side.len() == dimension && solution.len() == dimension, "one number a row");
        solution.copy_from_slice(right_side);
        self.analysis.solve_in_place(self.definite, solution);
        let mut residual = std::mem::take(&mut self.analysis.residual);
        let mut kept = std::mem::take(&mut self.analysis.kept);
        let mut backward_error = self.residual(right_side, solution, &mut residual);
        let mut refinement_count = 0;
        while backward_error > f64::EPSILON && refinement_count < REFINEMENT_LIMIT {
            self.analysis.solve_in_place(self.definite, &mut residual);
            kept.clone_from_slice(solution);
            solution.iter_mut().zip(&residual).for_each(|(x, step)| *x += step);
            let refined = self.residual(right_side, solution, &mut residual);
            if refined.is_nan() || refined >= backward_error {
                solution.clone_from_slice(&kept);
                break;
            }
            // More than half of it is left: from here on it is rounding.
            let last = refined > 0.5 * backward_error;
            (backward_error, refinement_count) = (refined, refinement_count + 1);
            if last {
                break;
            }
        }
        self.analysis.kept = kept;
        self.analysis.residual = residual;
        // Written so that NaN is refused.
        if backward_error <= ACCURACY {
            Ok(Solution { backward_error, refinement_count })
        } else {
            Err(LinearError::NotAccurate { backward_error, refinement_count })
        }
    }

    /// Solves A x = b with the factor alone: backward error of a Cholesky factor, not told.
    ///
    /// # Panics
    /// If a length differs from the dimension.
    pub(crate) fn solve_unrefined(&mut self, right_side: &[f64], solution: &mut [f64]) {
        solution.copy_from_slice(right_side);
        self.analysis.solve_in_place(self.definite, solution);
    }

    /// b − A x, and the backward error; 0 for x = b = 0.
    fn residual(&self, right_side: &[f64], solution: &[f64], residual: &mut [f64]) -> f64 {
        self.matrix.multiply(solution, residual);
        residual.iter_mut().zip(right_side).for_each(|(r, b)| *r = b - *r);
        let largest = |column: &[f64]| column.iter().fold(0.0, |most, value| larger(value.abs(), most));
        let scale = self.norm * largest(solution) + largest(right_side);
        if scale == 0.0 { 0.0 } else { largest(residual) / scale }
    }
}
