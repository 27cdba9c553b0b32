//! Times of a factor by an order of elimination.

use std::error::Error;
use std::time::Instant;

use jamscope::linear::ordering::{minimum_degree, nested_dissection};
use jamscope::linear::{Analysis, Hessian};

/// The orders of elimination.
pub const ORDERS: [&str; 3] = ["minimum degree on rows", "minimum degree", "nested dissection"];

/// One order, analysis, factorisation and refined solution.
pub struct Elimination {
    /// Values in the factor.
    pub value_count: usize,
    /// Times of the order, the analysis, L Lᵀ and the solution \[ms\].
    pub laps: [f64; 4],
    /// Backward error of the solution.
    pub backward_error: f64,
}

impl Elimination {
    /// By an order of this name in [`ORDERS`].
    pub fn of<const D: usize>(hessian: &Hessian<D>, right: &[f64], name: &str) -> Result<Self, Box<dyn Error>> {
        let (matrix, mut solution) = (hessian.matrix(), right.to_vec());
        let mut clock = Clock::start();
        let order = match name {
            "minimum degree" => Some(minimum_degree(hessian)?),
            "nested dissection" => Some(nested_dissection(hessian)),
            _ => None,
        };
        let ordered = clock.lap();
        // On rows the order is part of the analysis.
        let mut analysis = match order {
            Some(order) => Analysis::in_order(matrix, &order)?,
            None => Analysis::new(matrix)?,
        };
        let analysed = clock.lap();
        let value_count = analysis.factor_count();
        let mut factorisation = analysis.cholesky(matrix)?;
        let factorised = clock.lap();
        let backward_error = factorisation.solve(right, &mut solution)?.backward_error;
        Ok(Elimination { value_count, laps: [ordered, analysed, factorised, clock.lap()], backward_error })
    }
}

/// Milliseconds since the last lap.
pub struct Clock(Instant);

impl Clock {
    pub fn start() -> Self {
        Clock(Instant::now())
    }

    pub fn lap(&mut self) -> f64 {
        let seconds = self.0.elapsed().as_secs_f64();
        self.0 = Instant::now();
        1e3 * seconds
    }
}
