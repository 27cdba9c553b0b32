//! The descent by FIRE: checks, restarts and steps.
//!
//! Stops by [`Monitor::check`], the step limit, a failed restart, or a runaway.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::convergence::Monitor;
use crate::relax::fire::run::Run;
use crate::relax::fire::settings::{Fire, Precision};
use crate::relax::fire::state::State;
use crate::relax::outcome::{Cost, Outcome, Stop};
use crate::relax::relaxer::Relaxer;
use crate::relax::trace::Trace;

impl Relaxer for Fire {
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let start = Instant::now();
        let mut assembly = Assembly::with_incremental_updates(&packing, law)?;
        let mut monitor = Monitor::new(self.limit, &assembly);
        let (stop, cost) = self.run(&mut assembly, &mut monitor, trace)?;
        Ok(monitor.outcome(assembly, packing, (stop, cost), start))
    }

    fn for_intermediate_states(&self, limit: f64) -> Option<Self> {
        self.limit.loosened(limit).map(|limit| Fire { limit, ..*self })
    }
}

impl Fire {
    /// Moves an assembly until the monitor stops it or the steps are used up.
    pub(crate) fn run<const D: usize>(
        &self,
        assembly: &mut Assembly<D>,
        monitor: &mut Monitor,
        trace: &mut dyn Trace,
    ) -> Result<(Stop, Cost), PackingError> {
        assembly.set_pruning(true);
        let ended = self.run_from_rest(assembly, monitor, trace);
        assembly.set_pruning(false);
        ended
    }

    fn run_from_rest<const D: usize>(
        &self,
        assembly: &mut Assembly<D>,
        monitor: &mut Monitor,
        trace: &mut dyn Trace,
    ) -> Result<(Stop, Cost), PackingError> {
        let mut state = State::new(assembly, self.precision == Precision::Mixed);
        let mut run = Run::new(self, assembly);
        let stop = run.descend(assembly, &mut state, monitor, trace)?;
        if state.is_single() {
            // The assembly keeps the final positions, with forces in double precision.
            state.write_displacements(assembly);
            assembly.evaluate();
            run.evaluation_count += 1;
        }
        Ok((stop, run.cost()))
    }
}

impl Run<'_> {
    fn descend<const D: usize>(
        &mut self,
        assembly: &mut Assembly<D>,
        state: &mut State<D>,
        monitor: &mut Monitor,
        trace: &mut dyn Trace,
    ) -> Result<Stop, PackingError> {
        loop {
            let (totals, mut sums) = self.evaluate(assembly, state);
            let uphill = sums.power <= 0.0 && self.step_count > 0;
            if let Some(totals) = &totals
                && let Some(stop) = self.check(assembly, state, monitor, (totals, &sums), trace)?
            {
                return Ok(stop);
            }
            if self.step_count >= self.settings.step_limit {
                return Ok(Stop::StepLimit);
            }
            self.check_bound(assembly, state);
            if uphill {
                match self.restart(assembly, state, monitor, (totals, &sums), trace)? {
                    ControlFlow::Continue(rested) => sums = rested,
                    ControlFlow::Break(stop) => return Ok(stop),
                }
            } else {
                self.grow_step();
            }
            let rebuilt = self.advance(assembly, state, monitor, &sums)?;
            if rebuilt && monitor.ran_away(assembly) {
                return Ok(Stop::NoMinimum);
            }
        }
    }
}
