//! [`Factorisation`]: what a factorised matrix tells, and the refined solution of its systems.

/// Backward error above which a solution is refused \[1\]: a Cholesky factor gives 10⁻¹⁶ to 10⁻¹⁵.
pub const ACCURACY: f64 = 1e-13;

/// What is known of a solution.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// ‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖), largest norms: x solves a system that is off by this much exactly \[1\].
    pub backward_error: f64,
    /// Refinements that lowered it.
    pub refinement_count: usize,
}
