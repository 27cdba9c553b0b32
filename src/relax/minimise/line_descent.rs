//! Descent along one direction after another, by line searches: the common part of nonlinear conjugate gradients and
//! L-BFGS.

use std::time::Instant;

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::convergence::{CheckSchedule, Monitor};
use crate::relax::force_limit::ForceLimit;
use crate::relax::minimise::line_search::{Line, search};
use crate::relax::outcome::{Cost, Outcome, Stop};
use crate::relax::trace::{Check, Trace};
use crate::simd::lanes::dot_product;

/// Steps between two checks of the residual. A step has one or two evaluations.
const CHECK_INTERVAL: usize = 10;

/// The same patience as for FIRE, whose checks are 20 evaluations apart.
const SCHEDULE: CheckSchedule = CheckSchedule { refresh_every: 10, patience: 150, waits_for_rattlers: false };

/// A completed step: `u ← u + length · direction`.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    /// s.
    pub direction: &'a [f64],
    /// a.
    pub length: f64,
    /// F·s before and after.
    pub slopes: [f64; 2],
    /// Forces before and after.
    pub forces: [&'a [f64]; 2],
}

/// A rule that computes directions from forces.
pub trait DirectionRule {
    /// Learns from a step.
    fn learn(&mut self, step: &Step<'_>);

    /// Writes the next direction over the last one. None if there are no stored steps or the direction would not lead
    /// down.
    fn next(&mut self, forces: &[f64], direction: &mut [f64]) -> Option<Direction>;

    /// Discards all steps.
    fn forget(&mut self);
}

/// A direction of descent.
#[derive(Debug, Clone, Copy)]
pub struct Direction {
    /// F·s > 0.
    pub slope: f64,
    /// Length to try first.
    pub first: f64,
}

/// The common settings.
#[derive(Debug, Clone, Copy)]
pub struct Descent {
    /// When the packing counts as at rest.
    pub limit: ForceLimit,
    /// Steps allowed.
    pub step_limit: usize,
    /// Longest displacement of a disk in one step over its radius \[1\].
    pub largest_step: f64,
    /// Slope over the initial slope below which a point along a direction counts as the lowest \[1\].
    pub flatness: f64,
}

impl Descent {
    /// Brings a packing to rest along directions of this rule.
    ///
    /// # Errors
    /// Only conditions that make forces undefined.
    pub fn relax<const D: usize>(
        &self,
        mut rule: impl DirectionRule,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let start = Instant::now();
        let mut assembly = Assembly::new(&packing, law)?;
        let mut monitor = Monitor::with(self.limit, SCHEDULE, &assembly);
        let ended = self.run(&mut rule, &mut assembly, &mut monitor, trace)?;
        Ok(monitor.outcome(assembly, packing, ended, start))
    }

    /// Takes steps until the monitor stops it or the steps are used up.
    fn run<const D: usize>(
        &self,
        rule: &mut impl DirectionRule,
        assembly: &mut Assembly<D>,
        monitor: &mut Monitor,
        trace: &mut dyn Trace,
    ) -> Result<(Stop, Cost), PackingError> {
        let mobile = assembly.mobile_count();
        let mut direction = vec![0.0; mobile * D];
        let mut before = vec![0.0; mobile * D];
        let mut row = Vec::new();
        let mut cost = Cost { force_evaluation_count: 1, ..Cost::default() };
        let mut totals = assembly.evaluate_totals();
        let mut lost = false;
        loop {
            let forces = assembly.forces[..mobile].as_flattened();
            let force_squared = dot_product(forces, forces);
            // In a system of few disks a step may end at the minimum to rounding: check at once.
            let enough = self.limit_of(monitor.residual().mean_contact_force);
            let due = cost.step_count.is_multiple_of(CHECK_INTERVAL) || lost;
            if due || force_squared.is_nan() || force_squared <= enough * enough {
                let check = Check {
                    step_count: cost.step_count,
                    energy: totals.energy,
                    kinetic_energy: 0.0,
                    residual: 0.0,
                    time_step: 0.0,
                    restart: false,
                };
                if let Some(stop) = monitor.check(assembly, &assembly.forces[..mobile], &totals, check, trace) {
                    return Ok((stop, cost));
                }
                if lost {
                    let floor = monitor.near_the_floor();
                    return Ok((if floor { Stop::RoundingFloor } else { Stop::NoDescent }, cost));
                }
                if monitor.takes_new_anchors() {
                    assembly.reanchor()?;
                    totals = assembly.evaluate_totals();
                    cost.force_evaluation_count += 1;
                }
            }
            if cost.step_count >= self.step_limit {
                return Ok((Stop::StepLimit, cost));
            }
            let forces = assembly.forces[..mobile].as_flattened();
            let found = rule.next(forces, &mut direction);
            let next = found.unwrap_or_else(|| {
                rule.forget();
                direction.copy_from_slice(forces);
                Direction { slope: dot_product(forces, forces), first: 1.0 / assembly.stiffness_bound(&mut row) }
            });
            before.copy_from_slice(forces);
            let line = Line {
                direction: &direction,
                slope: next.slope,
                first: next.first,
                flatness: self.flatness,
                largest_step: self.largest_step,
            };
            let evaluation_count = &mut cost.force_evaluation_count;
            // The comparisons fail for NaN, and no step is taken.
            let reached = if next.slope > 0.0 && next.first > 0.0 {
                search(assembly, &line, &totals, evaluation_count)?
            } else {
                assembly.set_checkpoint();
                None
            };
            if let Some(reached) = reached {
                totals = reached.totals;
                let slopes = [next.slope, reached.slope];
                let forces = [&before[..], assembly.forces[..mobile].as_flattened()];
                rule.learn(&Step { direction: &direction, length: reached.length, slopes, forces });
                cost.step_count += 1;
                if assembly.has_on_site_forces() && monitor.ran_away(assembly) {
                    return Ok((Stop::NoMinimum, cost));
                }
            } else {
                assembly.restore()?;
                totals = assembly.evaluate_totals();
                cost.force_evaluation_count += 1;
                rule.forget();
                // The forces themselves do not lead down either.
                lost = found.is_none();
            }
        }
    }

    /// The largest net force allowed.
    fn limit_of(&self, mean_contact_force: f64) -> f64 {
        match self.limit {
            ForceLimit::Relative(limit) => limit * mean_contact_force,
            ForceLimit::Absolute(limit) => limit,
        }
    }
}
