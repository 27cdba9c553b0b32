//! The advance of FIRE by one step.

use crate::forces::advance::Advanced;
use crate::forces::assembly::Assembly;
use crate::packing::PackingError;
use crate::relax::column_operations::Products;
use crate::relax::convergence::Monitor;
use crate::relax::fire::run::Run;
use crate::relax::fire::state::State;
use crate::relax::fire::step::Step;

impl Run<'_> {
    /// Lengthens the time step and lowers the mixing after a step downhill.
    pub(super) fn grow_step(&mut self) {
        self.downhill += 1;
        self.uphill = 0;
        if self.downhill > self.settings.delay {
            self.time_step = (self.time_step * self.settings.step_growth).min(self.largest_step);
            self.mixing *= self.settings.mixing_decay;
        }
    }

    /// Takes one step. Returns whether the neighbour list has been rebuilt.
    pub(super) fn advance<const D: usize>(
        &mut self,
        assembly: &mut Assembly<D>,
        state: &mut State<D>,
        monitor: &Monitor,
        sums: &Products,
    ) -> Result<bool, PackingError> {
        let step = self.next_step(sums);
        // A displacement is at most √D times its largest component.
        let reach = self.time_step * (D as f64).sqrt();
        self.step_count += 1;
        self.due = monitor.is_due(self.step_count, sums.largest_force);
        // A check needs totals, which are evaluated separately.
        let advanced = if self.due { Advanced::Not } else { state.advance(assembly, step, reach) };
        let rebuilt = if advanced == Advanced::Not {
            let fastest = state.kick(assembly, step);
            assembly.update_list(reach * fastest)?
        } else {
            assembly.update_list_after_advance()?
        };
        if let Advanced::Evaluated(parts) = advanced {
            self.present_products = Some(state.sum(&parts));
        }
        Ok(rebuilt)
    }

    /// The next step: the kick, and the mixing of velocity and force.
    fn next_step(&self, sums: &Products) -> Step {
        let (time_step, mixing) = (self.time_step, self.mixing);
        let kicked = sums.speed_squared + time_step * (2.0 * sums.power + time_step * sums.force_squared);
        let mixed = if sums.force_squared > 0.0 { mixing * (kicked / sums.force_squared).sqrt() } else { 0.0 };
        let keep = 1.0 - mixing;
        let push = keep * time_step + mixed;
        Step { keep, push, time_step }
    }
}
