//! Nonlinear conjugate gradients: each direction is the force plus a multiple of the last direction.
//!
//! ```text
//! s ← F + β s        u ← u + a s,  a where F·s ≈ 0        β = max(0, F·(F − F_old) / F_old²)
//! ```
//!
//! On a quadratic energy the directions are conjugate, and n of them reach the minimum of n coordinates. The first
//! trial length is that of zero slope if the curvature of the energy stays that of the last direction. If a direction
//! does not lead down, or the energy was not convex along the last one, β = 0.
//!
//! # Source
//! Polak, Ribière (1969), Rev. Fr. Inform. Rech. Opér. 16, 35; β ≥ 0: Gilbert, Nocedal (1992), SIAM J. Optim. 2, 21.

use serde::{Deserialize, Serialize};

use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::column_operations::combine;
use crate::relax::force_limit::ForceLimit;
use crate::relax::minimise::line_descent::{Descent, Direction, DirectionRule, Step};
use crate::relax::outcome::Outcome;
use crate::relax::relaxer::Relaxer;
use crate::relax::trace::Trace;
use crate::simd::lanes::dot_product;

/// Nonlinear conjugate gradients.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NonlinearConjugateGradients {
    /// When the packing counts as at rest. Changes results.
    pub limit: ForceLimit,
    /// Steps allowed; each takes one to three evaluations of the forces.
    pub step_limit: usize,
    /// Longest displacement of a disk in one step over its radius \[1\]. Changes results far from a minimum.
    pub largest_step: f64,
    /// Slope along a direction, over the initial slope, below which a point counts as the lowest \[1\]. Changes speed:
    /// 0.03 to 0.1 take the fewest evaluations.
    pub flatness: f64,
}

impl Default for NonlinearConjugateGradients {
    fn default() -> Self {
        NonlinearConjugateGradients {
            limit: ForceLimit::default(),
            step_limit: 1_000_000,
            largest_step: 0.1,
            flatness: 0.05,
        }
    }
}

impl Relaxer for NonlinearConjugateGradients {
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let NonlinearConjugateGradients { limit, step_limit, largest_step, flatness } = *self;
        let descent = Descent { limit, step_limit, largest_step, flatness };
        descent.relax(Conjugate { last: None }, packing, law, trace)
    }

    fn for_intermediate_states(&self, limit: f64) -> Option<Self> {
        self.limit.loosened(limit).map(|limit| NonlinearConjugateGradients { limit, ..*self })
    }
}

/// What the next direction needs from the last step.
#[derive(Debug, Clone, Copy)]
struct Last {
    /// β.
    bend: f64,
    /// s·K s / s·s along the last direction.
    curvature: f64,
}

struct Conjugate {
    last: Option<Last>,
}

impl DirectionRule for Conjugate {
    fn learn(&mut self, step: &Step<'_>) {
        let [old, new] = step.forces;
        let bend = (dot_product(new, new) - dot_product(old, new)) / dot_product(old, old);
        let curvature = (step.slopes[0] - step.slopes[1]) / (step.length * dot_product(step.direction, step.direction));
        // The comparisons fail for NaN, which resets the directions.
        self.last = (bend > 0.0 && curvature > 0.0).then_some(Last { bend, curvature });
    }

    fn next(&mut self, forces: &[f64], direction: &mut [f64]) -> Option<Direction> {
        let last = self.last?;
        combine(last.bend, direction, 1.0, forces);
        let slope = dot_product(forces, direction);
        let size = dot_product(direction, direction);
        (slope > 0.0).then_some(Direction { slope, first: slope / (last.curvature * size) })
    }

    fn forget(&mut self) {
        self.last = None;
    }
}
