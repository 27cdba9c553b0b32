//! Stretches of explicit steps, by velocity Verlet.

use crate::forces::totals::Totals;
use crate::law::damping::DampingLaw;
use crate::law::pair_law::PairLaw;
use crate::packing::PackingError;
use crate::relax::dynamics::energy_balance::Energies;
use crate::relax::dynamics::energy_balance::EnergyBalance;
use crate::relax::dynamics::explicit_step::ExplicitStep;
use crate::relax::dynamics::implicit::method_selection::Pace;
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::relax::dynamics::verlet::Motion;
use crate::relax::outcome::{Cost, Stop};
use crate::vector::scaled;

/// A stretch of explicit steps that has been tried: nothing of the motion it began from has changed.
pub(crate) struct Stretch<const D: usize, L, C> {
    motion: Motion<D, L, C>,
    totals: Totals<D>,
    time: f64,
    dissipated: f64,
    peak: f64,
}

impl<const D: usize, L: PairLaw, C: DampingLaw> Stretch<D, L, C> {
    /// Energies at its end.
    pub(crate) fn energies(&self) -> Energies {
        Energies::new(&self.totals, self.motion.kinetic_energy(), self.dissipated).with_peak(self.peak)
    }
}

impl<const D: usize, L: PairLaw, C: DampingLaw> ImplicitMotion<D, L, C> {
    /// So many explicit steps of damped dynamics from here.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(crate) fn try_explicitly(
        &mut self,
        count: usize,
        step: &mut ExplicitStep,
    ) -> Result<Stretch<D, L, C>, PackingError> {
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
        Ok(Stretch { totals, time, dissipated, peak, motion })
    }

    /// The motion goes on from the end of a stretch. `ahead` is the length of the step that is to follow, which looks out for contacts
    /// that far \[time\].
    pub(crate) fn accept(&mut self, stretch: Stretch<D, L, C>, ahead: f64) -> Totals<D> {
        let Stretch { motion, time, dissipated, .. } = stretch;
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

    /// The longest stable explicit step, as [`Motion::stable_step`].
    pub(crate) fn stable_step(&mut self) -> f64 {
        self.work.evaluation_count += 1;
        Motion::of(self.assembly.clone(), &self.damping).stable_step()
    }
}

/// Verlet's steps, as many as [`Pace`] says; `time_step` is that of the implicit one to try after it.
pub(crate) fn explicit<const D: usize, L: PairLaw, C: DampingLaw>(
    motion: &mut ImplicitMotion<D, L, C>,
    pace: &mut Pace,
    time_step: &mut f64,
    (cost, balance): (&mut Cost, &mut EnergyBalance),
) -> Result<Result<Totals<D>, Stop>, PackingError> {
    loop {
        let count = pace.next_stretch();
        let mut control = pace.control.clone();
        let stretch = motion.try_explicitly(count, &mut control)?;
        cost.explicit_count += count;
        if balance.accept(stretch.energies()) {
            pace.control = control;
            pace.kept();
            *time_step = pace.tried();
            return Ok(Ok(motion.accept(stretch, *time_step)));
        }
        cost.rejected_count += 1;
        if !pace.shorten() {
            return Ok(Err(Stop::Unstable));
        }
    }
}
