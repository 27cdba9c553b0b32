//! L-BFGS: Newton's direction, with an inverse stiffness matrix estimated from the last few steps.
//!
//! ```text
//! s = H F        H_(k+1) = (1 − ρ d yᵀ) H_k (1 − ρ y dᵀ) + ρ d dᵀ        d = a s,  y = F_old − F,  ρ = 1/(y·d)
//! ```
//!
//! H is never formed. The method keeps m pairs (d, y). The product H F takes 4 m n multiplications, from the initial
//! matrix (y·d / y·y) 1 of the last pair (two-loop recursion). The full step, a = 1, is tried first. A pair without
//! positive curvature y·d is left out, so H stays positive definite and s points downhill.
//!
//! # Source
//! Nocedal (1980), Math. Comput. 35, 773; Liu, Nocedal (1989), Math. Program. 45, 503; Nocedal, Wright (2006),
//! Numerical Optimization, 2nd ed., algorithm 7.4 and eq. (7.20).

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

/// L-BFGS.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct QuasiNewton {
    /// When the packing counts as at rest. Changes results.
    pub limit: ForceLimit,
    /// Steps allowed; most take one evaluation of the forces.
    pub step_limit: usize,
    /// Longest displacement of a disk in one step over its radius \[1\]. Changes results far from a minimum.
    pub largest_step: f64,
    /// Number of stored steps, m. Changes speed: more steps save a few evaluations and cost 4 m n multiplications a
    /// step.
    pub memory: usize,
    /// Slope along a direction, over the initial slope, below which a point is accepted \[1\]. Changes speed: with 0.9
    /// most directions take one evaluation. With 0.3 they take two, and there are hardly fewer directions.
    pub flatness: f64,
}

impl Default for QuasiNewton {
    fn default() -> Self {
        QuasiNewton { limit: ForceLimit::default(), step_limit: 1_000_000, largest_step: 0.1, memory: 5, flatness: 0.9 }
    }
}

impl Relaxer for QuasiNewton {
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let QuasiNewton { limit, step_limit, largest_step, memory, flatness } = *self;
        let descent = Descent { limit, step_limit, largest_step, flatness };
        descent.relax(StepMemory::new(memory), packing, law, trace)
    }

    fn for_intermediate_states(&self, limit: f64) -> Option<Self> {
        self.limit.loosened(limit).map(|limit| QuasiNewton { limit, ..*self })
    }
}

/// One stored step.
struct Pair {
    displacement: Vec<f64>,
    change: Vec<f64>,
    /// y·d.
    curvature: f64,
    /// Coefficient of the two-loop recursion.
    weight: f64,
}

/// The last steps, the newest at `newest`. The buffers grow by one with each of the first steps.
struct StepMemory {
    limit: usize,
    pairs: Vec<Pair>,
    newest: usize,
    count: usize,
    /// y·d / y·y of the newest step.
    scale: f64,
}

impl StepMemory {
    fn new(limit: usize) -> Self {
        StepMemory { limit, pairs: Vec::new(), newest: 0, count: 0, scale: 0.0 }
    }

    /// Index of the pair stored `age` steps before the newest.
    fn index(&self, age: usize) -> usize {
        (self.newest + self.pairs.len() - age) % self.pairs.len()
    }
}

impl DirectionRule for StepMemory {
    fn learn(&mut self, step: &Step<'_>) {
        let curvature = step.length * (step.slopes[0] - step.slopes[1]);
        if curvature.is_nan() || curvature <= 0.0 || self.limit == 0 {
            return;
        }
        if self.count == self.pairs.len() && self.count < self.limit {
            let column = || vec![0.0; step.direction.len()];
            // All buffers are in use and the oldest comes after the newest: insert the new one between them.
            self.newest = if self.count == 0 { 0 } else { self.newest + 1 };
            self.pairs.insert(self.newest, Pair { displacement: column(), change: column(), curvature, weight: 0.0 });
        } else {
            self.newest = (self.newest + 1) % self.pairs.len();
        }
        self.count = (self.count + 1).min(self.pairs.len());
        let pair = &mut self.pairs[self.newest];
        combine(0.0, &mut pair.displacement, step.length, step.direction);
        pair.change.copy_from_slice(step.forces[0]);
        combine(1.0, &mut pair.change, -1.0, step.forces[1]);
        pair.curvature = curvature;
        self.scale = curvature / dot_product(&pair.change, &pair.change);
    }

    fn next(&mut self, forces: &[f64], direction: &mut [f64]) -> Option<Direction> {
        if self.count == 0 {
            return None;
        }
        direction.copy_from_slice(forces);
        for age in 0..self.count {
            let index = self.index(age);
            let pair = &mut self.pairs[index];
            pair.weight = dot_product(&pair.displacement, direction) / pair.curvature;
            combine(1.0, direction, -pair.weight, &pair.change);
        }
        direction.iter_mut().for_each(|d| *d *= self.scale);
        for age in (0..self.count).rev() {
            let pair = &self.pairs[self.index(age)];
            let back = dot_product(&pair.change, direction) / pair.curvature;
            combine(1.0, direction, pair.weight - back, &pair.displacement);
        }
        let slope = dot_product(forces, direction);
        (slope > 0.0).then_some(Direction { slope, first: 1.0 })
    }

    fn forget(&mut self) {
        self.count = 0;
    }
}
