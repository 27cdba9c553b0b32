//! Phases of explicit steps, by velocity Verlet.

use crate::forces::totals::Totals;
use crate::packing::PackingError;
use crate::relax::dynamics::energy_balance::{Energies, EnergyBalance};
use crate::relax::dynamics::explicit_step::ExplicitStep;
use crate::relax::dynamics::implicit::method_selection::MethodSelection;
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::relax::dynamics::verlet::Motion;
use crate::relax::outcome::{Cost, Stop};
use crate::vector::scaled;

/// A trial phase of explicit steps. The original motion is unchanged.
pub(crate) struct ExplicitPhase<const D: usize> {
    motion: Motion<D>,
    totals: Totals<D>,
    time: f64,
    dissipated: f64,
    peak: f64,
}

impl<const D: usize> ExplicitPhase<D> {
    /// Energies at its end.
    pub(crate) fn energies(&self) -> Energies {
        Energies::new(&self.totals, self.motion.kinetic_energy(), self.dissipated).with_peak(self.peak)
    }
}

impl<const D: usize> ImplicitMotion<D> {
    /// Tries this many explicit steps of damped dynamics.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(crate) fn try_explicit_phase(
        &mut self,
        count: usize,
        step: &mut ExplicitStep,
    ) -> Result<ExplicitPhase<D>, PackingError> {
        let mut motion = Motion::moving(self.assembly.clone(), &self.velocities, &self.damping);
        let mut time = self.time;
        for _ in 0..count {
            let time_step = step.next(&mut motion);
            motion.step(time_step)?;
            time += time_step;
        }
        self.work.evaluation_count += count + 1;
        let totals = motion.assembly.evaluate_totals();
        let (dissipated, peak) = (self.dissipated + motion.dissipated, motion.take_peak());
        Ok(ExplicitPhase { totals, time, dissipated, peak, motion })
    }

    /// Continues from the end of a phase. `ahead` is the length of the next step, over which contacts may close
    /// \[time\].
    pub(crate) fn accept_phase(&mut self, phase: ExplicitPhase<D>, ahead: f64) -> Totals<D> {
        let ExplicitPhase { motion, time, dissipated, .. } = phase;
        (self.time, self.dissipated) = (time, dissipated);
        self.velocities.copy_from_slice(&motion.velocities[..self.assembly.mobile_count()]);
        self.assembly = motion.assembly;
        self.taken_back = false;
        for (moved, &velocity) in self.moved.iter_mut().zip(&self.velocities) {
            *moved = scaled(ahead, velocity);
        }
        self.set_damping_coefficients();
        self.evaluate()
    }

    /// The longest stable explicit step, see [`Motion::stable_step`].
    pub(crate) fn stable_step(&mut self) -> f64 {
        self.work.evaluation_count += 1;
        Motion::of(self.assembly.clone(), &self.damping).stable_step()
    }
}

/// Takes the explicit steps selected by [`MethodSelection`]. `time_step` becomes that of the next implicit trial step.
pub(crate) fn explicit_phase<const D: usize>(
    motion: &mut ImplicitMotion<D>,
    selection: &mut MethodSelection,
    time_step: &mut f64,
    (cost, balance): (&mut Cost, &mut EnergyBalance),
) -> Result<Result<Totals<D>, Stop>, PackingError> {
    loop {
        let count = selection.next_phase();
        let mut control = selection.control.clone();
        let phase = motion.try_explicit_phase(count, &mut control)?;
        cost.explicit_count += count;
        if balance.accept(phase.energies()) {
            selection.control = control;
            selection.after_balanced_phase();
            *time_step = selection.trial_step();
            return Ok(Ok(motion.accept_phase(phase, *time_step)));
        }
        cost.rejected_count += 1;
        if !selection.shorten() {
            return Ok(Err(Stop::Unstable));
        }
    }
}
