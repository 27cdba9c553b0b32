//! [`Integration`]: a motion from its start to rest, step by step, each as long as its error allows.

use std::time::Instant;

use crate::contact::PairLaw;
use crate::contact::assembly::Assembly;
use crate::contact::damping::DampingLaw;
use crate::contact::totals::Totals;
use crate::packing::{Packing, PackingError};
use crate::relax::implicit::Finish;
use crate::relax::implicit::growth::{LARGEST_GROWTH, SMALLEST_GROWTH, growth};
use crate::relax::implicit::motion::{ImplicitMotion, Inertia, Stepped};
use crate::relax::implicit::pace::{Kind, Pace};
use crate::relax::implicit::restless::Restless;
use crate::relax::implicit::stretch;
use crate::relax::monitor::Monitor;
use crate::relax::newton::{Descent, End, Patience, WATCH};
use crate::relax::{Cost, ForceLimit, Look, NetForce, Outcome, Stop, Trace};
use crate::vector::{Vector, difference, larger, norm};

/// Settings of either.
pub(super) struct Integration {
    pub(super) limit: ForceLimit,
    pub(super) net_force: NetForce,
    pub(super) tolerance: f64,
    pub(super) finish: Finish,
    pub(super) step_limit: usize,
}

/// Ratio after a step whose matrix was not positive definite.
const INDEFINITE_GROWTH: f64 = 0.5;

/// Error allowed off the backbone over that on it. Rattlers fly and hit; where they hit matters little to the backbone, but an
/// error there is an overlap, and so energy.
const OFF_BACKBONE: f64 = 3.0;

/// Overlap over a radius that stands in for the mean one where nothing is pressed \[1\].
const SMALLEST_OVERLAP: f64 = 1e-6;

/// (hγ)² λ, or hγ λ/ζ, of the stiffest contacts beyond which a step grows no more: disks that touch nothing are held by the
/// mass term alone, and the pivots of the matrix must stay well apart from rounding.
const LONGEST_STEP: f64 = 1e12;

/// Factorisations in which Newton must bring the residual down to a tenth.
const PATIENCE: usize = 12;

/// Longest way of a disk in one of Newton's steps over its radius \[1\], as is [`Newton`](super::Newton)'s default.
const LONGEST_NEWTON_STEP: f64 = 0.1;

/// Newton's factorisations at most.
const NEWTON_LIMIT: usize = 100;

impl Integration {
    pub(super) fn relax<const D: usize, L: PairLaw, C: DampingLaw>(
        &self,
        packing: Packing<D>,
        law: &L,
        damping: &C,
        inertia: Inertia,
        trace: &mut impl Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let start = Instant::now();
        let mut motion = ImplicitMotion::new(&packing, law, damping, inertia)?;
        let mut monitor = Monitor::with(self.limit, WATCH, &motion.assembly);
        let mut cost = Cost::default();
        let stop = self.run(&mut motion, &mut monitor, &mut cost, trace)?;
        let assembly = &motion.assembly;
        let net_forces = self.judged(&motion);
        let (residual, rounding_floor) = monitor.finish(assembly, net_forces);
        cost.force_evaluation_count += motion.work.evaluation_count;
        cost.factorisation_count += motion.work.factorisation_count;
        cost.iteration_count += motion.work.iteration_count;
        cost.simulated_time = motion.time;
        cost.rebuild_count = assembly.rebuild_count();
        cost.seconds = start.elapsed().as_secs_f64();
        Ok(Outcome { state: assembly.placed(packing), stop, residual, rounding_floor, cost })
    }

    fn run<const D: usize, L: PairLaw, C: DampingLaw>(
        &self,
        motion: &mut ImplicitMotion<D, L, C>,
        monitor: &mut Monitor,
        cost: &mut Cost,
        trace: &mut impl Trace,
    ) -> Result<Stop, PackingError> {
        let mut totals = motion.evaluate();
        let mut hand_over = match self.finish {
            Finish::Motion => 0.0,
            Finish::Newton(residual) => residual,
        };
        let mut time_step = 0.0;
        let mut restless = Restless::default();
        let mut pace = Pace::new(motion);
        loop {
            let kinetic_energy = motion.kinetic_energy();
            let look = Look {
                step_count: cost.step_count,
                energy: totals.energy,
                kinetic_energy,
                residual: 0.0,
                time_step,
                restart: false,
            };
            if let Some(stop) = monitor.look(&motion.assembly, self.judged(motion), &totals, look, trace) {
                return Ok(stop);
            }
            let residual = monitor.residual().relative();
            if restless.after(cost.step_count, (kinetic_energy, motion.dissipated), residual) {
                return Ok(Stop::Restless);
            }
            if monitor.takes_new_anchors() {
                motion.reanchor()?;
            }
            let overlap = mean_overlap(&motion.assembly, &totals);
            let slow = kinetic_energy <= hand_over * hand_over * totals.energy_scale();
            if residual <= hand_over && slow {
                if let Some(stop) = finish(motion, monitor, cost, overlap, trace)? {
                    return Ok(stop);
                }
                hand_over *= 0.1;
            }
            if time_step == 0.0 {
                time_step = first_step(motion, self.tolerance * overlap);
            }
            // Explicit steps follow contacts that come and go; where there is no backbone, nothing bounds them.
            let pressed = monitor.backbone()[..motion.assembly.mobile_count()].iter().any(|&member| member);
            let kind = if pressed { pace.kind(time_step) } else { Kind::Implicit };
            if kind != Kind::Implicit {
                if cost.step_count >= self.step_limit {
                    return Ok(Stop::StepLimit);
                }
                cost.step_count += 1;
            }
            let allowed = Allowed { overlap, tolerance: self.tolerance, backbone: monitor.backbone() };
            match kind {
                Kind::Explicit => totals = stretch::explicit(motion, &mut pace, &mut time_step, cost)?,
                Kind::Stabilised { .. } => {
                    totals = stretch::stabilised(motion, &mut pace, &mut time_step, cost, &allowed)?;
                }
                Kind::Implicit => {
                    match self.advance(motion, cost, &mut time_step, (&allowed, pressed.then_some(&pace)))? {
                        Ok(Some(reached)) => {
                            totals = reached;
                            pace.stepped();
                        }
                        // Back at the start of the step.
                        Ok(None) => {}
                        Err(stop) => return Ok(stop),
                    }
                }
            }
        }
    }

    /// One implicit step, repeated with shorter ones until its error is small enough; `time_step` is that of the next
    /// afterwards. None if it would have to be so short that other steps pay.
    fn advance<const D: usize, L: PairLaw, C: DampingLaw>(
        &self,
        motion: &mut ImplicitMotion<D, L, C>,
        cost: &mut Cost,
        time_step: &mut f64,
        (allowed, pace): (&Allowed<'_>, Option<&Pace>),
    ) -> Result<Result<Option<Totals<D>>, Stop>, PackingError> {
        motion.prestressed.copy_from_slice(allowed.backbone);
        motion.margin = allowed.overlap;
        *time_step = time_step.min(motion.longest_step(LONGEST_STEP));
        let mut rejected = false;
        loop {
            if cost.step_count >= self.step_limit {
                return Ok(Err(Stop::StepLimit));
            }
            cost.step_count += 1;
            let growth = match motion.step(*time_step)? {
                Stepped::OutOfMemory => return Ok(Err(Stop::OutOfMemory)),
                Stepped::Indefinite => INDEFINITE_GROWTH,
                Stepped::TooFar => SMALLEST_GROWTH,
                Stepped::Moved(reached) => {
                    let error = allowed.share(motion, |motion, disk| motion.error(*time_step, disk));
                    let growth = growth(error, LARGEST_GROWTH);
                    if error <= 1.0 {
                        *time_step *= if rejected { growth.min(1.0) } else { growth };
                        return Ok(Ok(Some(reached)));
                    }
                    growth
                }
            };
            cost.rejected_count += 1;
            rejected = true;
            motion.take_back()?;
            *time_step *= growth;
            if pace.is_some_and(|pace| pace.kind(*time_step) != Kind::Implicit) {
                return Ok(Ok(None));
            }
        }
    }

    /// The net forces the limit is on.
    fn judged<'a, const D: usize, L: PairLaw, C: DampingLaw>(
        &self,
        motion: &'a ImplicitMotion<D, L, C>,
    ) -> &'a [Vector<D>] {
        match self.net_force {
            NetForce::Elastic => &motion.assembly.forces[..motion.assembly.mobile_count()],
            NetForce::Total => motion.net_forces(),
        }
    }
}

/// What error a step may have.
pub(super) struct Allowed<'a> {
    /// Mean overlap \[length\].
    pub(super) overlap: f64,
    /// Error allowed over that.
    pub(super) tolerance: f64,
    /// See [`Monitor::backbone`].
    pub(super) backbone: &'a [bool],
}

impl Allowed<'_> {
    /// Largest error of a disk in the last step over what is allowed \[1\]; NaN if one is.
    pub(super) fn share<const D: usize, L: PairLaw, C: DampingLaw>(
        &self,
        motion: &ImplicitMotion<D, L, C>,
        error: impl Fn(&ImplicitMotion<D, L, C>, usize) -> f64,
    ) -> f64 {
        let of_disk = |disk: usize| error(motion, disk) * self.weight(disk);
        (0..motion.assembly.mobile_count()).map(of_disk).fold(0.0, |most, error| larger(error, most))
    }

    /// What an error of a disk \[length\] is over the one allowed is this times it.
    pub(super) fn weight(&self, disk: usize) -> f64 {
        (if self.backbone[disk] { 1.0 } else { 1.0 / OFF_BACKBONE }) / (self.tolerance * self.overlap)
    }
}

/// Leaves the last part of the way to Newton. None if that is not where the motion leads: everything is as before then.
fn finish<const D: usize, L: PairLaw, C: DampingLaw>(
    motion: &mut ImplicitMotion<D, L, C>,
    monitor: &mut Monitor,
    cost: &mut Cost,
    overlap: f64,
    trace: &mut impl Trace,
) -> Result<Option<Stop>, PackingError> {
    let before = motion.assembly.clone();
    let mut descent = Descent::new(LONGEST_NEWTON_STEP, NEWTON_LIMIT, Patience::Factorisations(PATIENCE));
    let end = descent.run(&mut motion.assembly, monitor, trace)?;
    *cost = cost.plus(descent.cost);
    let far = |disk: usize| {
        let way = difference(motion.assembly.place(disk), before.place(disk));
        monitor.backbone()[disk] && norm(way) > overlap
    };
    let here = !(0..before.mobile_count()).any(far);
    match end {
        End::Stop(stop @ (Stop::Converged(_) | Stop::RoundingFloor)) if here => Ok(Some(stop)),
        _ => {
            motion.assembly = before;
            motion.put_back()?;
            Ok(None)
        }
    }
}

/// The overlap of a contact, in the mean over contacts by their force: α Σu / ΣF.
fn mean_overlap<const D: usize, L: PairLaw>(assembly: &Assembly<D, L>, totals: &Totals<D>) -> f64 {
    let radius = assembly.radii().iter().copied().fold(f64::INFINITY, f64::min);
    let contacts = totals.energy - totals.on_site_energy;
    let overlap = if totals.force_sum > 0.0 { assembly.law().exponent() * contacts / totals.force_sum } else { 0.0 };
    larger(overlap, SMALLEST_OVERLAP * radius)
}

/// The step in which the largest force moves a disk by as much as an error may be.
fn first_step<const D: usize, L: PairLaw, C: DampingLaw>(motion: &ImplicitMotion<D, L, C>, allowed: f64) -> f64 {
    let largest = motion.net_forces().iter().fold(0.0, |most, &force| larger(norm(force), most));
    let step = motion.time_of_way(allowed, largest);
    // Nothing pushes: any step is as good, and the look that follows finds it at rest.
    if step.is_finite() && step > 0.0 { step } else { 1.0 }
}
