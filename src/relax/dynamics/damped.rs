//! Explicit damped dynamics: Newton's equations with contact damping, until mechanical equilibrium.
//!
//! The disks move by velocity Verlet, see [`Motion`]. The step is a fraction of the stability bound. A motion that
//! gains energy, for example with a fixed step that is too long, ends as [`Stop::Unstable`].

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::law::damping::{ContactDamping, DampingChoice};
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::convergence::{CHECK_INTERVAL, Monitor};
use crate::relax::dynamics::energy_balance::{Energies, EnergyBalance};
use crate::relax::dynamics::explicit_step::ExplicitStep;
use crate::relax::dynamics::verlet::Motion;
use crate::relax::force_limit::ForceLimit;
use crate::relax::outcome::{Cost, Outcome, Stop};
use crate::relax::relaxer::Relaxer;
use crate::relax::trace::{Check, Trace};

/// Settings of explicit damped dynamics.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DampedDynamics {
    /// Damping law of contacts. Changes results.
    pub damping: DampingChoice,
    /// Criterion of mechanical equilibrium. Changes results.
    pub limit: ForceLimit,
    /// Net force to which the limit applies. Changes results.
    pub net_force: NetForce,
    /// The time step.
    pub time_step: TimeStep,
    /// Largest number of steps.
    pub step_limit: usize,
}

impl Default for DampedDynamics {
    fn default() -> Self {
        DampedDynamics {
            damping: DampingChoice::default(),
            limit: ForceLimit::default(),
            net_force: NetForce::default(),
            time_step: TimeStep::default(),
            // About 10⁴ steps are needed at p > 500, 10⁶ near jamming.
            step_limit: 20_000_000,
        }
    }
}

/// The net force of damped dynamics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NetForce {
    /// Elastic forces only: mechanical equilibrium of the elastic energy.
    #[default]
    Elastic,
    /// Elastic and damping forces. A slow creep in which both cancel also meets the limit.
    Total,
}

/// The time step of damped dynamics.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeStep {
    /// A constant step \[time\].
    Fixed(f64),
    /// This fraction of the stability bound, updated as contacts change \[1\].
    OfStability(f64),
}

impl Default for TimeStep {
    /// 0.9 of the bound. At the bound itself, a mode whose Gershgorin row is exact would oscillate for ever.
    /// Gershgorin's rows are about twice the largest eigenvalue of the damping matrix of a packing, so this is about
    /// half of the longest stable step.
    fn default() -> Self {
        TimeStep::OfStability(0.9)
    }
}

/// Fraction of the bound below which steps that gain energy are not shortened further.
const SMALLEST_SHARE: f64 = 1e-3;

/// Ratio of a step to the one before, which gained energy.
const SHORTER: f64 = 0.5;

/// Growth factor of the fraction after steps without a gain.
const SHARE_GROWTH: f64 = 1.2;

impl Relaxer for DampedDynamics {
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        self.relax_with(packing, law, &law.contact_damping(&self.damping), trace)
    }

    fn for_intermediate_states(&self, limit: f64) -> Option<Self> {
        self.limit.loosened(limit).map(|limit| DampedDynamics { limit, ..*self })
    }
}

impl DampedDynamics {
    fn relax_with<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        damping: &ContactDamping,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let start = Instant::now();
        let mut motion = Motion::new(&packing, law, damping)?;
        let mut monitor = Monitor::new(self.limit, &motion.assembly);
        let (mut time_step, mut step_count) = (0.0, 0);
        let (fixed, mut control) = match self.time_step {
            TimeStep::Fixed(step) => (step, None),
            TimeStep::OfStability(share) => (0.0, Some(ExplicitStep::new(share))),
        };
        // The evaluation at the start of the motion.
        let mut evaluation_count = 1;
        let mut balance: Option<EnergyBalance> = None;
        let mut rejected_count = 0;
        let mobile = motion.assembly.mobile_count();
        let stop = loop {
            if step_count % CHECK_INTERVAL == 0 {
                let totals = motion.assembly.evaluate_totals();
                evaluation_count += 1;
                let kinetic_energy = motion.kinetic_energy();
                let check = Check {
                    step_count,
                    energy: totals.energy,
                    kinetic_energy,
                    residual: 0.0,
                    time_step,
                    restart: false,
                };
                let energies = Energies::new(&totals, kinetic_energy, motion.dissipated).with_peak(motion.take_peak());
                let balance = balance.get_or_insert(EnergyBalance::new(energies));
                if balance.accept(energies) {
                    motion.remember();
                    if let (Some(control), TimeStep::OfStability(share)) = (&mut control, self.time_step) {
                        control.lengthen(SHARE_GROWTH, share);
                    }
                } else if let Some(control) = control.as_mut().filter(|control| control.share() > SMALLEST_SHARE)
                    && step_count < self.step_limit
                {
                    control.shorten(SHORTER);
                    motion.take_back()?;
                    rejected_count += CHECK_INTERVAL;
                    continue;
                } else {
                    break if totals.energy.is_finite() { Stop::Unstable } else { Stop::NonFinite };
                }
                let net_forces = match self.net_force {
                    NetForce::Elastic => &motion.assembly.forces[..mobile],
                    NetForce::Total => &motion.accelerations[..mobile],
                };
                if let Some(stop) = monitor.check(&motion.assembly, net_forces, &totals, check, trace) {
                    break stop;
                }
                if monitor.takes_new_anchors() {
                    motion.assembly.reanchor()?;
                    motion.set_damping_coefficients();
                }
            }
            if step_count >= self.step_limit {
                break Stop::StepLimit;
            }
            time_step = match &mut control {
                None => fixed,
                Some(control) => control.next(&mut motion),
            };
            let list_count = motion.assembly.build_count();
            motion.step(time_step)?;
            step_count += 1;
            evaluation_count += 1;
            if motion.assembly.build_count() > list_count && monitor.ran_away(&motion.assembly) {
                break Stop::NoMinimum;
            }
        };
        if matches!(stop, Stop::StepLimit | Stop::NoMinimum) {
            // Without a preceding check the elastic forces belong to an earlier step.
            motion.assembly.evaluate();
            evaluation_count += 1;
        }
        let net_forces = match self.net_force {
            NetForce::Elastic => &motion.assembly.forces[..mobile],
            NetForce::Total => &motion.accelerations[..mobile],
        };
        let monitor_energies = monitor.energies();
        let (residual, rounding_floor) = monitor.finish(&motion.assembly, net_forces);
        let cost = Cost {
            step_count,
            rejected_count,
            energies: monitor_energies.zip(balance).map(|(energies, balance)| balance.account(energies.after)),
            force_evaluation_count: evaluation_count,
            build_count: motion.assembly.build_count(),
            seconds: start.elapsed().as_secs_f64(),
            ..Cost::default()
        };
        Ok(Outcome { state: motion.assembly.placed(packing), stop, residual, rounding_floor, cost })
    }
}
