//! The checks of a run of FIRE: residual, precision, and the bound on the time step.

use crate::forces::assembly::Assembly;
use crate::forces::totals::Totals;
use crate::packing::PackingError;
use crate::relax::column_operations::Products;
use crate::relax::convergence::Monitor;
use crate::relax::fire::run::Run;
use crate::relax::fire::state::State;
use crate::relax::outcome::Stop;
use crate::relax::trace::{Check, Trace};

/// Steps between two computations of the bound on the time step.
const BOUND_INTERVAL: usize = 40;

/// Relative residual down to which steps may be in single precision \[1\]: about ten times the effect of its rounding.
const SINGLE_LIMIT: f64 = 1e-6;

/// Relative residual below which every check sets a new base \[1\], because displacements from the base change overlaps
/// with rounding errors.
const BASE_LIMIT: f64 = 1e-3;

impl Run<'_> {
    /// The products at the present state, and the totals if a check is due.
    pub(super) fn evaluate<const D: usize>(
        &mut self,
        assembly: &mut Assembly<D>,
        state: &mut State<D>,
    ) -> (Option<Totals<D>>, Products) {
        let totals = if self.due { Some(assembly.evaluate_totals()) } else { None };
        self.evaluation_count += 1;
        let mut sums = match self.present_products.take() {
            Some(sums) => sums,
            None if self.due => state.products(assembly),
            None => state.evaluate(assembly),
        };
        if state.is_single() && !sums.is_finite() {
            // Disks whose centres nearly coincide are out of the range of single precision.
            state.write_displacements(assembly);
            state.switch_to_double();
            sums = state.evaluate(assembly);
        }
        (totals, sums)
    }

    /// Checks the residual. Returns the reason why the run ends, if it does.
    pub(super) fn check<const D: usize>(
        &mut self,
        assembly: &mut Assembly<D>,
        state: &mut State<D>,
        monitor: &mut Monitor,
        (totals, sums): (&Totals<D>, &Products),
        trace: &mut dyn Trace,
    ) -> Result<Option<Stop>, PackingError> {
        let check = Check {
            step_count: self.step_count,
            energy: totals.energy,
            kinetic_energy: 0.5 * sums.speed_squared,
            residual: 0.0,
            time_step: self.time_step,
            restart: false,
        };
        let mobile = assembly.mobile_count();
        if let Some(stop) = monitor.check(assembly, &assembly.forces[..mobile], totals, check, trace) {
            return Ok(Some(stop));
        }
        if self.step_count == 0 {
            (self.rest_energy, self.rest_scale) = (totals.energy, totals.energy_scale());
            assembly.set_checkpoint();
        }
        if monitor.takes_new_anchors() {
            assembly.reanchor()?;
            state.invalidate_base();
        }
        let residual = monitor.residual().relative();
        if residual <= BASE_LIMIT {
            state.invalidate_base();
        }
        if residual <= SINGLE_LIMIT {
            state.switch_to_double();
        }
        Ok(None)
    }

    /// Recomputes the bound on the time step every [`BOUND_INTERVAL`] steps.
    pub(super) fn check_bound<const D: usize>(&mut self, assembly: &mut Assembly<D>, state: &State<D>) {
        if self.step_count.is_multiple_of(BOUND_INTERVAL) && self.step_count > 0 {
            state.write_displacements(assembly);
            self.set_largest_step(assembly);
            self.time_step = self.time_step.min(self.largest_step);
        }
    }
}
