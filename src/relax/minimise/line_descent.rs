//! Going downhill along one direction after another: what nonlinear conjugate gradients and L-BFGS have in common.

use std::time::Instant;

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::column_operations::dot_product;
use crate::relax::convergence::{Monitor, Watch};
use crate::relax::force_limit::ForceLimit;
use crate::relax::minimise::line_search::{Line, search};
use crate::relax::outcome::{Cost, Outcome, Stop};
use crate::relax::trace::{Look, Trace};

/// Steps between two looks at the residual, of one or two evaluations each.
const LOOK_EVERY: usize = 10;

/// As patient as FIRE, whose looks are 20 evaluations apart.
const WATCH: Watch = Watch { refresh_every: 10, patience: 150, waits_for_rattlers: false };

/// A step made: `u ← u + length · direction`.
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

/// A rule that turns forces into directions.
pub trait Directions {
    /// Learns from a step.
    fn learn(&mut self, step: &Step<'_>);

    /// The direction to go in next, written over the last one; the length to try first along it. None: nothing is known but the
    /// forces, or the direction would not lead down.
    fn turn(&mut self, forces: &[f64], direction: &mut [f64]) -> Option<Turn>;

    /// Forgets all steps.
    fn forget(&mut self);
}

/// A direction of descent.
#[derive(Debug, Clone, Copy)]
pub struct Turn {
    /// F·s > 0.
    pub slope: f64,
    /// Length to try first.
    pub first: f64,
}

/// The settings both have.
#[derive(Debug, Clone, Copy)]
pub struct Descent {
    /// When the packing counts as at rest.
    pub limit: ForceLimit,
    /// Steps allowed.
    pub step_limit: usize,
    /// Longest way of a disk in one step over its radius \[1\].
    pub largest_step: f64,
    /// Slope over that at the start below which a point along a direction counts as the lowest \[1\].
    pub flat: f64,
}

impl Descent {
    /// Brings a packing to rest along these directions.
    ///
    /// # Errors
    /// Only what makes forces undefined.
    pub fn relax<const D: usize, L: PairLaw>(
        &self,
        mut directions: impl Directions,
        packing: Packing<D>,
        law: &L,
        trace: &mut impl Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let start = Instant::now();
        let mut assembly = Assembly::new(&packing, *law)?;
        let mut monitor = Monitor::with(self.limit, WATCH, &assembly);
        let ended = self.run(&mut directions, &mut assembly, &mut monitor, trace)?;
        Ok(monitor.outcome(assembly, packing, ended, start))
    }

    /// Steps until the monitor stops it or the steps are used up.
    fn run<const D: usize, L: PairLaw>(
        &self,
        directions: &mut impl Directions,
        assembly: &mut Assembly<D, L>,
        monitor: &mut Monitor,
        trace: &mut impl Trace,
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
            // A step may end at the minimum to rounding, as in a system of few disks; no need to wait for the next look then.
            let enough = self.limit_of(monitor.residual().mean_contact_force);
            let due = cost.step_count.is_multiple_of(LOOK_EVERY) || lost;
            if due || force_squared.is_nan() || force_squared <= enough * enough {
                let look = Look {
                    step_count: cost.step_count,
                    energy: totals.energy,
                    kinetic_energy: 0.0,
                    residual: 0.0,
                    time_step: 0.0,
                    restart: false,
                };
                if let Some(stop) = monitor.check(assembly, &assembly.forces[..mobile], &totals, look, trace) {
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
            let turned = directions.turn(forces, &mut direction);
            let turn = turned.unwrap_or_else(|| {
                directions.forget();
                direction.copy_from_slice(forces);
                Turn { slope: dot_product(forces, forces), first: 1.0 / assembly.stiffness_bound(&mut row) }
            });
            before.copy_from_slice(forces);
            let line = Line {
                direction: &direction,
                slope: turn.slope,
                first: turn.first,
                flat: self.flat,
                largest_step: self.largest_step,
            };
            let evaluation_count = &mut cost.force_evaluation_count;
            // Written so that NaN leads nowhere.
            let found = if turn.slope > 0.0 && turn.first > 0.0 {
                search(assembly, &line, &totals, evaluation_count)?
            } else {
                assembly.set_checkpoint();
                None
            };
            if let Some(reached) = found {
                totals = reached.totals;
                let slopes = [turn.slope, reached.slope];
                let forces = [&before[..], assembly.forces[..mobile].as_flattened()];
                directions.learn(&Step { direction: &direction, length: reached.length, slopes, forces });
                cost.step_count += 1;
                if assembly.law().has_sites() && monitor.ran_away(assembly) {
                    return Ok((Stop::NoMinimum, cost));
                }
            } else {
                assembly.restore()?;
                totals = assembly.evaluate_totals();
                cost.force_evaluation_count += 1;
                directions.forget();
                // The forces themselves lead nowhere either.
                lost = turned.is_none();
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
