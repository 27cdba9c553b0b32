//! [`Fire`] far from the minimum, then [`Newton`](crate::relax::Newton).
//!
//! FIRE follows contacts that open and close, at the cost of one force evaluation per step. Newton's method squares the
//! residual once the contacts stay the same. FIRE hands over at a residual of `hand_over`. If Newton's method then
//! fails to reduce the residual, FIRE continues and hands over at a tenth of it. When the factorisations are used up,
//! or the factors do not fit in memory, FIRE finishes alone.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::convergence::Monitor;
use crate::relax::fire::settings::{Fire, Precision};
use crate::relax::force_limit::ForceLimit;
use crate::relax::minimise::newton_descent::{End, NEWTON_SCHEDULE, NewtonDescent, Patience};
use crate::relax::outcome::{Cost, Criterion, Outcome, Stop};
use crate::relax::relaxer::Relaxer;
use crate::relax::trace::{Check, Trace};

/// FIRE, then Newton's method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Staged {
    /// When the packing counts as at rest. Changes results.
    pub limit: ForceLimit,
    /// Relative residual at which FIRE hands over \[1\]. Changes results where minima lie close together.
    pub hand_over: f64,
    /// Steps of FIRE allowed.
    pub step_limit: usize,
    /// Factorisations allowed. After them FIRE finishes.
    pub factorisation_limit: usize,
    /// Longest displacement of a disk in one step of Newton over its radius \[1\].
    pub largest_step: f64,
    /// Precision of FIRE's steps. Changes results where minima lie close together.
    #[serde(skip_serializing_if = "Precision::is_double")]
    pub precision: Precision,
}

impl Default for Staged {
    fn default() -> Self {
        Staged {
            limit: ForceLimit::default(),
            hand_over: 1e-5,
            step_limit: Fire::default().step_limit,
            factorisation_limit: 300,
            largest_step: 0.1,
            precision: Precision::default(),
        }
    }
}

/// Factorisations without a fall of the residual to a tenth after which FIRE continues.
const PATIENCE: usize = 12;

impl Relaxer for Staged {
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let start = Instant::now();
        let mut assembly = Assembly::with_incremental_updates(&packing, law)?;
        let (stop, cost, monitor) = self.run(&mut assembly, trace)?;
        Ok(monitor.outcome(assembly, packing, (stop, cost), start))
    }

    fn for_intermediate_states(&self, limit: f64) -> Option<Self> {
        self.limit.loosened(limit).map(|limit| Staged { limit, ..*self })
    }
}

impl Staged {
    fn run<const D: usize>(
        &self,
        assembly: &mut Assembly<D>,
        trace: &mut dyn Trace,
    ) -> Result<(Stop, Cost, Monitor), PackingError> {
        let mut hand_over = self.hand_over;
        let mut cost = Cost::default();
        let mut fire_only = false;
        loop {
            let (limit, last) = match self.limit {
                limit if fire_only => (limit, true),
                ForceLimit::Relative(limit) if limit >= hand_over => (self.limit, true),
                _ => (ForceLimit::Relative(hand_over), false),
            };
            let mut monitor = Monitor::new(limit, assembly);
            let step_limit = self.step_limit.saturating_sub(cost.step_count);
            let fire = Fire { limit, step_limit, precision: self.precision, ..Fire::default() };
            let (stop, part) = fire.run(assembly, &mut monitor, &mut offset_trace(trace, cost.step_count))?;
            cost = cost.plus(Cost { energies: monitor.energies(), ..part });
            // An absolute limit may lie below the unjammed threshold.
            if matches!(
                (stop, self.limit, last),
                (Stop::Converged(Criterion::Unjammed), ForceLimit::Absolute(_), false)
            ) {
                fire_only = true;
                continue;
            }
            if last || stop != Stop::Converged(Criterion::RelativeForce) {
                return Ok((stop, cost, Monitor::new(self.limit, assembly)));
            }
            let mut monitor = Monitor::with(self.limit, NEWTON_SCHEDULE, assembly);
            let left = self.factorisation_limit.saturating_sub(cost.factorisation_count);
            let mut descent = NewtonDescent::new(self.largest_step, left, Patience::Factorisations(PATIENCE));
            let end = descent.run(assembly, &mut monitor, &mut offset_trace(trace, cost.step_count))?;
            cost = cost.plus(Cost { energies: monitor.energies(), ..descent.cost });
            match end {
                End::Stalled | End::Stop(Stop::NoDescent) => {}
                End::Stop(Stop::StepLimit | Stop::OutOfMemory) => fire_only = true,
                End::Stop(stop) => return Ok((stop, cost, monitor)),
            }
            hand_over = 0.1 * hand_over.min(monitor.residual().relative());
        }
    }
}

/// A trace whose step counts begin at `first`.
fn offset_trace(trace: &mut dyn Trace, first: usize) -> OffsetTrace<'_> {
    OffsetTrace { trace, first }
}

struct OffsetTrace<'a> {
    trace: &'a mut dyn Trace,
    first: usize,
}

impl Trace for OffsetTrace<'_> {
    fn is_active(&self) -> bool {
        self.trace.is_active()
    }

    fn checked(&mut self, check: &Check) {
        self.trace.checked(&Check { step_count: self.first + check.step_count, ..*check });
    }

    fn interrupted(&mut self) -> bool {
        self.trace.interrupted()
    }
}
