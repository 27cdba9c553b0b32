//! Restarts of FIRE: after an uphill step, all velocities are set to zero.

use std::ops::ControlFlow;

use crate::forces::assembly::Assembly;
use crate::forces::totals::Totals;
use crate::packing::PackingError;
use crate::relax::column_operations::Products;
use crate::relax::convergence::Monitor;
use crate::relax::fire::run::Run;
use crate::relax::fire::settings::Uphill;
use crate::relax::fire::state::State;
use crate::relax::outcome::Stop;
use crate::relax::rounding::ENERGY_ROUNDING;
use crate::relax::trace::{Check, Trace};

impl Run<'_> {
    /// Stops all disks; if the energy is higher than at the last restart, returns to that restart. Returns the products
    /// there, or the reason why the run ends.
    pub(super) fn restart<const D: usize>(
        &mut self,
        assembly: &mut Assembly<D>,
        state: &mut State<D>,
        monitor: &Monitor,
        (totals, sums): (Option<Totals<D>>, &Products),
        trace: &mut dyn Trace,
    ) -> Result<ControlFlow<Stop, Products>, PackingError> {
        state.write_displacements(assembly);
        state.invalidate_base();
        self.uphill += 1;
        if let Uphill::StepBack(back) = self.settings.uphill {
            if self.uphill > back.uphill_limit {
                let floor = monitor.near_the_floor();
                return Ok(ControlFlow::Break(if floor { Stop::RoundingFloor } else { Stop::NoDescent }));
            }
            state.step_back(assembly, self.time_step);
            assembly.update_list(0.5 * self.time_step * sums.speed_squared.sqrt())?;
        }
        let totals = match totals {
            Some(totals) if self.settings.uphill == Uphill::Restart => totals,
            _ => {
                self.evaluation_count += 1;
                assembly.evaluate_totals()
            }
        };
        let higher = self.is_higher(assembly, &totals);
        if totals.energy >= self.rest_energy * (1.0 - ENERGY_ROUNDING) {
            // The energy has not decreased since the last restart: single precision allows no further progress.
            state.switch_to_double();
        }
        if higher {
            assembly.restore()?;
            assembly.evaluate();
            self.evaluation_count += 1;
        } else {
            (self.rest_energy, self.rest_scale) = (totals.energy, totals.energy_scale());
            assembly.set_checkpoint();
        }
        self.report(trace);
        state.rest();
        let sums = state.products(assembly);
        self.cut_step(higher);
        Ok(ControlFlow::Continue(sums))
    }

    /// Whether the energy is above that at the last restart.
    fn is_higher<const D: usize>(&self, assembly: &Assembly<D>, totals: &Totals<D>) -> bool {
        let energy = totals.energy;
        if assembly.has_on_site_forces() {
            // Energies have either sign, so the rounding is relative to the sum of their absolute values.
            energy - self.rest_energy > ENERGY_ROUNDING * (totals.energy_scale() + self.rest_scale)
        } else {
            energy > self.rest_energy * (1.0 + ENERGY_ROUNDING)
        }
    }

    /// Reports the restart.
    fn report(&self, trace: &mut dyn Trace) {
        if trace.is_active() {
            let check = Check {
                step_count: self.step_count,
                energy: self.rest_energy,
                kinetic_energy: 0.0,
                residual: f64::NAN,
                time_step: self.time_step,
                restart: true,
            };
            trace.checked(&check);
        }
    }

    /// Shortens the time step after a restart, and resets the mixing.
    fn cut_step(&mut self, higher: bool) {
        let settings = self.settings;
        let kept = matches!(settings.uphill, Uphill::StepBack(back) if self.step_count < back.start_delay && !higher);
        if !kept {
            self.time_step *= settings.step_cut;
        }
        self.mixing = settings.mixing;
        self.downhill = 0;
    }
}
