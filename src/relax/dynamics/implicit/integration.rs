//! [`Integration`]: integrates a motion from its start to rest, in steps as long as the allowed error permits.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::forces::assembly::Assembly;
use crate::forces::totals::Totals;
use crate::law::damping::ContactDamping;
use crate::law::pair_law::PairLaw;
use crate::neighbours::for_each_pair::for_each_pair;
use crate::packing::{Packing, PackingError};
use crate::relax::convergence::Monitor;
use crate::relax::dynamics::damped::NetForce;
use crate::relax::dynamics::energy_balance::{Energies, EnergyBalance};
use crate::relax::dynamics::implicit::allowed_error::AllowedError;
use crate::relax::dynamics::implicit::explicit_phase::explicit_phase;
use crate::relax::dynamics::implicit::inertia::{Inertia, Stepped};
use crate::relax::dynamics::implicit::method_selection::{Method, MethodSelection};
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::relax::dynamics::implicit::newton_finish::{Finish, FinishState, NewtonFinish};
use crate::relax::dynamics::implicit::rkc::stabilised_phase::rkc_phase;
use crate::relax::dynamics::implicit::stagnation::Stagnation;
use crate::relax::dynamics::implicit::step_control::{LARGEST_RATIO, SMALLEST_RATIO, step_ratio};
use crate::relax::force_limit::ForceLimit;
use crate::relax::minimise::newton_descent::NEWTON_SCHEDULE;
use crate::relax::outcome::{Cost, Outcome, Stop};
use crate::relax::trace::{Check, Trace};
use crate::vector::{Vector, larger, norm};

/// Settings of damped dynamics or of gradient flow.
pub(crate) struct Integration {
    pub(crate) limit: ForceLimit,
    pub(crate) net_force: NetForce,
    pub(crate) tolerance: f64,
    pub(crate) finish: Finish,
    pub(crate) step_limit: usize,
}

/// Ratio of step lengths after a step whose matrix was not positive definite.
const INDEFINITE_RATIO: f64 = 0.5;

/// Ratio of step lengths after a step that violated the energy balance.
const UNBALANCED_RATIO: f64 = 0.5;

/// Floor of the median overlap over the smallest radius, for every packing \[1\]; its value in a packing without
/// contacts.
const SMALLEST_OVERLAP: f64 = 1e-6;

/// Largest (hg)² λ, or hg λ/ζ, of the stiffest contacts; a step does not grow beyond it. Disks without contacts have
/// only the mass term, and the pivots of the matrix must stay well above rounding.
const LARGEST_SCALED_STIFFNESS: f64 = 1e12;

impl Integration {
    pub(crate) fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        damping: &ContactDamping,
        inertia: Inertia,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let start = Instant::now();
        let mut motion = ImplicitMotion::new(&packing, law, damping, inertia)?;
        let mut monitor = Monitor::with(self.limit, NEWTON_SCHEDULE, &motion.assembly);
        let mut cost = Cost::default();
        let totals = motion.evaluate();
        let mut balance = EnergyBalance::new(Energies::new(&totals, 0.0, 0.0));
        let stop = self.run(totals, &mut motion, &mut monitor, (&mut cost, &mut balance), trace)?;
        let assembly = &motion.assembly;
        let net_forces = self.net_forces(&motion);
        cost.energies = monitor.energies().map(|energies| balance.account(energies.after));
        let (residual, rounding_floor) = monitor.finish(assembly, net_forces);
        cost.force_evaluation_count += motion.work.evaluation_count;
        cost.factorisation_count += motion.work.factorisation_count;
        cost.iteration_count += motion.work.iteration_count;
        cost.simulated_time = motion.time;
        cost.build_count = assembly.build_count();
        cost.seconds = start.elapsed().as_secs_f64();
        Ok(Outcome { state: assembly.placed(packing), stop, residual, rounding_floor, cost })
    }

    fn run<const D: usize>(
        &self,
        mut totals: Totals<D>,
        motion: &mut ImplicitMotion<D>,
        monitor: &mut Monitor,
        (cost, balance): (&mut Cost, &mut EnergyBalance),
        trace: &mut dyn Trace,
    ) -> Result<Stop, PackingError> {
        let mut newton_finish = match self.finish {
            Finish::Motion => None,
            Finish::Newton(residual) => Some(NewtonFinish::from(residual)),
        };
        let mut time_step = 0.0;
        let mut overlaps = Vec::new();
        let mut stagnation = Stagnation::default();
        let mut selection = MethodSelection::new(motion);
        loop {
            let kinetic_energy = motion.kinetic_energy();
            let check = Check {
                step_count: cost.step_count,
                energy: totals.energy,
                kinetic_energy,
                residual: 0.0,
                time_step,
                restart: false,
            };
            if let Some(stop) = monitor.check(&motion.assembly, self.net_forces(motion), &totals, check, trace) {
                return Ok(stop);
            }
            let residual = monitor.residual().relative();
            if stagnation.is_reached(cost.step_count, (kinetic_energy, motion.dissipated), residual) {
                return Ok(Stop::Stagnation);
            }
            if monitor.takes_new_anchors() {
                motion.reanchor()?;
            }
            let overlap = typical_overlap(&motion.assembly, &mut overlaps);
            if let Some(newton_finish) = &mut newton_finish {
                let kinetic = motion.kinetic_energy_of(monitor.backbone());
                let state = FinishState { residual, kinetic, scale: totals.energy_scale(), overlap };
                if newton_finish.is_due(&state)
                    && let Some(stop) = newton_finish.attempt(motion, monitor, cost, &state, trace)?
                {
                    return Ok(stop);
                }
            }
            if time_step == 0.0 {
                time_step = first_step(motion, self.tolerance * overlap);
            }
            // Explicit steps resolve opening and closing contacts. Without a backbone disks may fly freely for an
            // unlimited number of explicit steps, so all steps are implicit.
            let has_backbone = monitor.backbone()[..motion.assembly.mobile_count()].iter().any(|&member| member);
            let method = if has_backbone { selection.method(time_step) } else { Method::Implicit };
            if method != Method::Implicit {
                if cost.step_count >= self.step_limit {
                    return Ok(Stop::StepLimit);
                }
                cost.step_count += 1;
            }
            let allowed = AllowedError { overlap, tolerance: self.tolerance, backbone: monitor.backbone() };
            match method {
                Method::Explicit => {
                    match explicit_phase(motion, &mut selection, &mut time_step, (cost, &mut *balance))? {
                        Ok(reached) => totals = reached,
                        Err(stop) => return Ok(stop),
                    }
                }
                Method::Rkc { .. } => {
                    let account = (&mut *cost, &mut *balance);
                    if let Some(reached) = rkc_phase(motion, &mut selection, &mut time_step, account, &allowed)? {
                        totals = reached;
                    }
                }
                Method::Implicit => {
                    let account = (&mut *cost, &mut *balance);
                    match self.advance(
                        motion,
                        account,
                        &mut time_step,
                        (&allowed, has_backbone.then_some(&selection)),
                    )? {
                        ControlFlow::Continue(Some(reached)) => {
                            totals = reached;
                            selection.after_implicit_step();
                        }
                        // The motion is at the start of the step again.
                        ControlFlow::Continue(None) => {}
                        ControlFlow::Break(stop) => return Ok(stop),
                    }
                }
            }
        }
    }

    /// One implicit step, repeated with shorter lengths until its error is small enough. `time_step` becomes that of
    /// the next step. Returns None if another method is cheaper than such a short step.
    fn advance<const D: usize>(
        &self,
        motion: &mut ImplicitMotion<D>,
        (cost, balance): (&mut Cost, &mut EnergyBalance),
        time_step: &mut f64,
        (allowed, selection): (&AllowedError<'_>, Option<&MethodSelection>),
    ) -> Result<ControlFlow<Stop, Option<Totals<D>>>, PackingError> {
        motion.prestressed.copy_from_slice(allowed.backbone);
        motion.margin = allowed.overlap;
        *time_step = time_step.min(motion.longest_step(LARGEST_SCALED_STIFFNESS));
        let mut rejected = false;
        loop {
            if cost.step_count >= self.step_limit {
                return Ok(ControlFlow::Break(Stop::StepLimit));
            }
            cost.step_count += 1;
            let ratio = match motion.step(*time_step)? {
                Stepped::OutOfMemory => return Ok(ControlFlow::Break(Stop::OutOfMemory)),
                Stepped::Indefinite => INDEFINITE_RATIO,
                Stepped::TooFar => SMALLEST_RATIO,
                Stepped::Moved(reached) => {
                    let error = allowed.largest_ratio(motion, |motion, disk| motion.error(*time_step, disk));
                    let ratio = step_ratio(error, LARGEST_RATIO);
                    let energies = || Energies::new(&reached, motion.kinetic_energy(), motion.dissipated);
                    let balanced = |balance: &mut EnergyBalance| match motion.has_masses() {
                        true => balance.accept(energies()),
                        false => balance.accept_descent(energies()),
                    };
                    if error <= 1.0 && balanced(balance) {
                        *time_step *= if rejected { ratio.min(1.0) } else { ratio };
                        return Ok(ControlFlow::Continue(Some(reached)));
                    }
                    if error <= 1.0 { UNBALANCED_RATIO } else { ratio }
                }
            };
            cost.rejected_count += 1;
            rejected = true;
            motion.take_back()?;
            *time_step *= ratio;
            if selection.is_some_and(|selection| selection.method(*time_step) != Method::Implicit) {
                return Ok(ControlFlow::Continue(None));
            }
        }
    }

    /// The net forces to which the limit applies.
    fn net_forces<'a, const D: usize>(&self, motion: &'a ImplicitMotion<D>) -> &'a [Vector<D>] {
        match self.net_force {
            NetForce::Elastic => &motion.assembly.forces[..motion.assembly.mobile_count()],
            NetForce::Total => motion.net_forces(),
        }
    }
}

/// The median overlap of all contacts \[length\]. It does not depend on the few overlaps that an inflation makes a
/// thousand times larger.
fn typical_overlap<const D: usize>(assembly: &Assembly<D>, overlaps: &mut Vec<f64>) -> f64 {
    let radius = assembly.radii().iter().copied().fold(f64::INFINITY, f64::min);
    overlaps.clear();
    for_each_pair(assembly.pairs(), &assembly.displacements, &mut |pair| {
        if pair.overlap > 0.0 {
            overlaps.push(pair.overlap);
        }
    });
    let middle = overlaps.len() / 2;
    let median = if overlaps.is_empty() { 0.0 } else { *overlaps.select_nth_unstable_by(middle, f64::total_cmp).1 };
    larger(median, SMALLEST_OVERLAP * radius)
}

/// The step in which the largest force moves a disk by the allowed error.
fn first_step<const D: usize>(motion: &ImplicitMotion<D>, allowed: f64) -> f64 {
    let largest = motion.net_forces().iter().fold(0.0, |most, &force| larger(norm(force), most));
    let step = motion.time_to_move(allowed, largest);
    // Without forces any length serves, because the next check finds mechanical equilibrium.
    if step.is_finite() && step > 0.0 { step } else { 1.0 }
}
