//! [`Solution`]: the accuracy of the refined solution of a linear system.

/// Backward error above which a solution is refused \[1\]; a Cholesky factor gives 10⁻¹⁶ to 10⁻¹⁵.
pub const ACCURACY: f64 = 1e-13;

/// Accuracy of a solution.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// ‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖), maximum norms: x solves exactly a system perturbed by this much \[1\].
    pub backward_error: f64,
    /// Number of refinements that reduced it.
    pub refinement_count: usize,
}
