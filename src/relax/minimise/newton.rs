//! Newton's method on the energy of a packing, made safe far from its minimum.
//!
//! ```text
//! (K + S) s = F        u ← u + a s        S ≥ 0 diagonal, → 0 near a minimum;  a ≤ 1
//! ```
//!
//! K is the [`Hessian`](crate::linear::hessian::Hessian). Where K + S has no Cholesky factor S is raised, so s always points
//! downhill. The whole step is tried first; where contacts that close on the way make it climb, the lowest point along it is
//! sought. A step counts if the energy has fallen by a share of what the forces promise; where that is less than energies can
//! tell apart, the work of the forces along the step decides. How well the quadratic model predicted the fall sets S for the
//! next step.
//!
//! Near a minimum the residual is squared at each step, as long as no contact opens or closes. Rattlers do not spoil that:
//! the stiffness of their contacts is the one that opens them in one step, see the book.
//!
//! # Source
//! Nocedal, Wright (2006), Numerical Optimization, 2nd ed., §3.4 (modified Hessian), §3.1 (sufficient decrease). The shift
//! by rows of the prestress: this module.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::convergence::Monitor;
use crate::relax::force_limit::ForceLimit;
use crate::relax::minimise::newton_descent::{Descent, End, Patience, WATCH};
use crate::relax::outcome::{Outcome, Stop};
use crate::relax::relaxer::Relaxer;
use crate::relax::trace::Trace;

/// Newton's method with sparse Cholesky factors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Newton {
    /// When the packing counts as at rest. Changes results.
    pub limit: ForceLimit,
    /// Factorisations allowed, those of matrices that turn out indefinite included.
    pub step_limit: usize,
    /// Longest way of a disk in one step over its radius \[1\]. Changes results far from a minimum.
    pub largest_step: f64,
}

impl Default for Newton {
    fn default() -> Self {
        Newton { limit: ForceLimit::default(), step_limit: 1000, largest_step: 0.1 }
    }
}

impl Relaxer for Newton {
    fn relax<const D: usize, L: PairLaw>(
        &self,
        packing: Packing<D>,
        law: &L,
        trace: &mut impl Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let start = Instant::now();
        let mut assembly = Assembly::new(&packing, *law)?;
        let mut monitor = Monitor::with(self.limit, WATCH, &assembly);
        let mut descent = Descent::new(self.largest_step, self.step_limit, Patience::Endless);
        let stop = match descent.run(&mut assembly, &mut monitor, trace)? {
            End::Stop(stop) => stop,
            End::Stalled => Stop::StepLimit,
        };
        Ok(monitor.outcome(assembly, packing, (stop, descent.cost), start))
    }

    fn passing(&self, limit: f64) -> Option<Self> {
        self.limit.loosened(limit).map(|limit| Newton { limit, ..*self })
    }
}
