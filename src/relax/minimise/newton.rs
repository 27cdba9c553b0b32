//! Newton's method on the energy of a packing, with a shift and a line search far from the minimum.
//!
//! ```text
//! (K + S) s = F        u ← u + a s        S ≥ 0 diagonal, → 0 near a minimum;  a ≤ 1
//! ```
//!
//! K is the [`Hessian`](crate::linear::hessian::Hessian). If K + S has no Cholesky factor, S is raised, so s always
//! points downhill. The full step is tried first. If the energy rises because contacts close, a line search finds the
//! lowest point along the step. A step is accepted if the energy has fallen by a share of the predicted fall. Where
//! energies cannot resolve the fall, the work of the forces along the step decides. The ratio of the actual fall to
//! that of the quadratic model sets S for the next step.
//!
//! Near a minimum each step squares the residual, as long as no contact opens or closes. Rattlers do not change that:
//! the stiffness of their contacts is chosen to open them in one step, see the book.
//!
//! # Source
//! Nocedal, Wright (2006), Numerical Optimization, 2nd ed., §3.4 (modified Hessian), §3.1 (sufficient decrease). The
//! shift by rows of the prestress: this module.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::convergence::Monitor;
use crate::relax::force_limit::ForceLimit;
use crate::relax::minimise::newton_descent::{End, NEWTON_SCHEDULE, NewtonDescent, Patience};
use crate::relax::outcome::{Outcome, Stop};
use crate::relax::relaxer::Relaxer;
use crate::relax::trace::Trace;

/// Newton's method with sparse Cholesky factors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Newton {
    /// When the packing counts as at rest. Changes results.
    pub limit: ForceLimit,
    /// Factorisations allowed, including those of indefinite matrices.
    pub step_limit: usize,
    /// Longest displacement of a disk in one step over its radius \[1\]. Changes results far from a minimum.
    pub largest_step: f64,
}

impl Default for Newton {
    fn default() -> Self {
        Newton { limit: ForceLimit::default(), step_limit: 1000, largest_step: 0.1 }
    }
}

impl Relaxer for Newton {
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let start = Instant::now();
        let mut assembly = Assembly::new(&packing, law)?;
        let mut monitor = Monitor::with(self.limit, NEWTON_SCHEDULE, &assembly);
        let mut descent = NewtonDescent::new(self.largest_step, self.step_limit, Patience::Unlimited);
        let stop = match descent.run(&mut assembly, &mut monitor, trace)? {
            End::Stop(stop) => stop,
            End::Stalled => Stop::StepLimit,
        };
        Ok(monitor.outcome(assembly, packing, (stop, descent.cost), start))
    }

    fn for_intermediate_states(&self, limit: f64) -> Option<Self> {
        self.limit.loosened(limit).map(|limit| Newton { limit, ..*self })
    }
}
