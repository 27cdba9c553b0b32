//! Minimum and interval of a function of one variable that may have several minima.

use argmin::core::{CostFunction, Error, Executor, State};
use argmin::solver::brent::BrentOpt;
use argmin::solver::goldensectionsearch::GoldenSectionSearch;

/// Brent needs 10 to 30 steps.
const STEP_LIMIT: u64 = 100;

/// Tolerance for the end of an interval: this share of a grid step, or this rise of the function.
const EDGE_TOLERANCE: f64 = 1e-7;

/// False position needs 6 to 10 steps.
const EDGE_STEPS: usize = 60;

/// Type-erased, so that each solver is compiled once.
struct Cost<'a>(&'a dyn Fn(f64) -> f64);

impl CostFunction for Cost<'_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, at: &f64) -> Result<f64, Error> {
        Ok((self.0)(*at))
    }
}

/// The minimum of the function between two points, by golden-section search.
pub(super) fn golden(low: f64, high: f64, tolerance: f64, function: &dyn Fn(f64) -> f64) -> f64 {
    let middle = 0.5 * (low + high);
    let Ok(solver) = GoldenSectionSearch::new(low, high).and_then(|solver| solver.with_tolerance(tolerance)) else {
        return middle;
    };
    Executor::new(Cost(function), solver)
        .configure(|state| state.param(middle).max_iters(STEP_LIMIT))
        .run()
        .ok()
        .and_then(|result| result.state().get_best_param().copied())
        .unwrap_or(middle)
}

/// The refined minimum on a grid, and where the function has risen by `rise` on either side.
pub(super) struct Minimum {
    pub at: f64,
    pub value: f64,
    /// Lower end of the connected interval around the minimum in which the rise is below `rise`; none at the end of the
    /// grid.
    pub lower: Option<f64>,
    /// Upper end of this interval.
    pub upper: Option<f64>,
}

/// Minimum and interval on an ascending grid of at least three points.
pub(super) fn minimum(grid: &[f64], rise: f64, function: &dyn Fn(f64) -> f64) -> Minimum {
    let values: Vec<f64> = grid.iter().map(|&at| function(at)).collect();
    let found = GridMinimum::of(grid, &values, function);
    let [lower, upper] = found.ends(rise);
    Minimum { at: found.at, value: found.value, lower, upper }
}

/// The refined minimum on an ascending grid of at least three points, at which the values of the function are given.
#[derive(Clone, Copy)]
pub(super) struct GridMinimum<'a> {
    grid: &'a [f64],
    values: &'a [f64],
    function: &'a dyn Fn(f64) -> f64,
    pub at: f64,
    pub value: f64,
}

impl<'a> GridMinimum<'a> {
    pub fn of(grid: &'a [f64], values: &'a [f64], function: &'a dyn Fn(f64) -> f64) -> Self {
        let lowest = (0..grid.len()).fold(0, |best, i| if values[i] < values[best] { i } else { best });
        let (low, high) = (grid[lowest.saturating_sub(1)], grid[(lowest + 1).min(grid.len() - 1)]);
        let polished = Executor::new(Cost(function), BrentOpt::new(low, high).set_tolerance(1e-8, 1e-10))
            .configure(|state| state.max_iters(STEP_LIMIT))
            .run()
            .ok()
            .and_then(|result| result.state().get_best_param().copied())
            .map(|at| (at, function(at)))
            .filter(|&(_, value)| value < values[lowest]);
        let (at, value) = polished.unwrap_or((grid[lowest], values[lowest]));
        GridMinimum { grid, values, function, at, value }
    }

    /// The ends of the connected interval around the minimum in which the rise is below `rise`; none at an end of the
    /// grid.
    ///
    /// The interval ends where the function stays above; humps inside it are included.
    pub fn ends(&self, rise: f64) -> [Option<f64>; 2] {
        let GridMinimum { grid, values, function, at, value } = *self;
        let level = value + rise;
        let inside = |i: &usize| values[*i] <= level;
        let first = (0..grid.len()).find(inside).map_or(at, |i| grid[i]).min(at);
        let last = (0..grid.len()).rev().find(inside).map_or(at, |i| grid[i]).max(at);
        let lower = grid.iter().rev().find(|&&point| point < first).map(|&out| edge(out, first, level, function));
        let upper = grid.iter().find(|&&point| point > last).map(|&out| edge(out, last, level, function));
        [lower, upper]
    }
}

/// Where the function crosses `level` between a point above it and one not above it: false position, halving the value
/// of an end that does not move (Illinois method; Dowell, Jarratt (1971), BIT 11, 168).
fn edge(out: f64, inside: f64, level: f64, function: &dyn Fn(f64) -> f64) -> f64 {
    let excess = |at: f64| function(at) - level;
    let (mut high, mut low) = ((out, excess(out)), (inside, excess(inside)));
    let width = (out - inside).abs();
    for _ in 0..EDGE_STEPS {
        let share = low.1 / (low.1 - high.1);
        let at = low.0 + if share.is_finite() { share } else { 0.5 } * (high.0 - low.0);
        let value = excess(at);
        if (high.0 - low.0).abs() <= EDGE_TOLERANCE * width || value.abs() <= EDGE_TOLERANCE {
            return at;
        }
        if value > 0.0 {
            high = (at, value);
            low.1 *= 0.5;
        } else {
            low = (at, value);
            high.1 *= 0.5;
        }
    }
    0.5 * (high.0 + low.0)
}
