//! Steps of Newton's method on an assembly: a direction from the shifted Hessian, a point along it that is low enough,
//! and the update of the shift.

use crate::forces::assembly::Assembly;
use crate::forces::totals::Totals;
use crate::packing::PackingError;
use crate::relax::convergence::{CheckSchedule, Monitor};
use crate::relax::minimise::line_search::acceptance;
use crate::relax::minimise::shifted_hessian::{ShiftedHessian, Solved};
use crate::relax::outcome::{Cost, Stop};
use crate::relax::trace::{Check, Trace};
use crate::vector::{Vector, difference, dot, larger, norm, scaled, sum};

/// Share of the predicted fall of the energy that a step must reach; Newton's own step reaches half near a minimum.
/// Energies decide where half of this share is above their rounding.
const SUFFICIENT: f64 = 0.1;

/// Lengths tried along one direction. Each costs an evaluation of the forces, far less than a factorisation.
const TRIAL_LIMIT: usize = 8;

/// Slope over the initial slope below which a point along a direction counts as the lowest \[1\].
const FLATNESS: f64 = 0.3;

/// First shift θ tried if K itself is not positive definite; smaller shifts are set to 0.
const FIRST_SHIFT: f64 = 1e-2;

/// Largest shift tried: s is then the force over 10⁸ times the stiffness that holds the disk.
const LARGEST_SHIFT: f64 = 1e8;

/// Each check is a factorisation, so few of them without progress mean the rounding floor.
pub(crate) const NEWTON_SCHEDULE: CheckSchedule =
    CheckSchedule { refresh_every: 1, patience: 4, waits_for_rattlers: true };

/// How long a descent continues without progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Patience {
    /// Continues to the limit of factorisations.
    Unlimited,
    /// Stops after this many factorisations if the residual has not fallen to a tenth.
    Factorisations(usize),
}

/// How a descent ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// With this reason to stop.
    Stop(Stop),
    /// Without progress for as long as [`Patience`] allows.
    Stalled,
}

/// Newton's method on an assembly.
pub(crate) struct NewtonDescent {
    largest_step: f64,
    direction_limit: usize,
    /// Solutions tried: factorisations, and steps of disks without contacts, which need no matrix.
    direction_count: usize,
    patience: Patience,
    /// θ of the last step.
    shift: f64,
    /// Cost so far.
    pub cost: Cost,
}

/// A point reached along a direction.
struct Reached<const D: usize> {
    totals: Totals<D>,
    /// Fall of the energy over the prediction of the model, where energies can resolve it.
    ratio: f64,
}

impl NewtonDescent {
    pub(crate) fn new(largest_step: f64, direction_limit: usize, patience: Patience) -> Self {
        NewtonDescent { largest_step, direction_limit, direction_count: 0, patience, shift: 0.0, cost: Cost::default() }
    }

    /// Takes steps until the monitor stops it or its patience is exhausted.
    pub(crate) fn run<const D: usize>(
        &mut self,
        assembly: &mut Assembly<D>,
        monitor: &mut Monitor,
        trace: &mut dyn Trace,
    ) -> Result<End, PackingError> {
        let mobile = assembly.mobile_count();
        let mut totals = self.evaluate(assembly);
        let mut shifted = ShiftedHessian::new(assembly);
        let (mut best, mut best_count) = (f64::INFINITY, self.direction_count);
        loop {
            let check = Check {
                step_count: self.cost.step_count,
                energy: totals.energy,
                kinetic_energy: 0.0,
                residual: 0.0,
                time_step: 0.0,
                restart: false,
            };
            if let Some(stop) = monitor.check(assembly, &assembly.forces[..mobile], &totals, check, trace) {
                return Ok(End::Stop(stop));
            }
            let residual = monitor.residual().relative();
            if residual < 0.1 * best {
                (best, best_count) = (residual, self.direction_count);
            }
            if let Patience::Factorisations(patience) = self.patience
                && self.direction_count - best_count >= patience
            {
                return Ok(End::Stalled);
            }
            if monitor.takes_new_anchors() {
                assembly.reanchor()?;
                totals = self.evaluate(assembly);
            }
            shifted.update(assembly, monitor.backbone());
            let mean = monitor.residual().mean_contact_force;
            match self.step(assembly, &mut shifted, (monitor.backbone(), mean), &totals)? {
                Ok(reached) => totals = reached.totals,
                Err(Stop::NoDescent) if monitor.near_the_floor() => return Ok(End::Stop(Stop::RoundingFloor)),
                Err(stop) => return Ok(End::Stop(stop)),
            }
            self.cost.step_count += 1;
        }
    }

    /// One step: directions with ever larger shifts, until one leads down.
    fn step<const D: usize>(
        &mut self,
        assembly: &mut Assembly<D>,
        shifted: &mut ShiftedHessian<D>,
        (backbone, mean): (&[bool], f64),
        totals: &Totals<D>,
    ) -> Result<Result<Reached<D>, Stop>, PackingError> {
        assembly.set_checkpoint();
        let mut raised = false;
        loop {
            if self.direction_count >= self.direction_limit {
                return Ok(Err(Stop::StepLimit));
            }
            let solved = shifted.solve(assembly, backbone, mean, self.shift);
            self.direction_count += 1;
            self.cost.factorisation_count = shifted.factorisation_count;
            match solved {
                Solved::OutOfMemory => return Ok(Err(Stop::OutOfMemory)),
                Solved::Indefinite => {}
                Solved::Step => {
                    let longest = self.bound(assembly, &mut shifted.step, backbone);
                    if let Some(reached) = self.search(assembly, &shifted.step, longest, totals)? {
                        if reached.ratio < 0.25 {
                            self.shift = (4.0 * self.shift).max(FIRST_SHIFT);
                        } else if reached.ratio > 0.75 && !raised {
                            self.shift = if self.shift <= FIRST_SHIFT { 0.0 } else { 0.25 * self.shift };
                        }
                        return Ok(Ok(reached));
                    }
                    assembly.restore()?;
                    self.evaluate(assembly);
                }
            }
            self.shift = (4.0 * self.shift).max(FIRST_SHIFT);
            raised = true;
            if self.shift > LARGEST_SHIFT {
                self.shift = 0.0;
                return Ok(Err(Stop::NoDescent));
            }
        }
    }

    /// Clips the steps of disks off the backbone. Returns the share of the step that the other disks may take.
    fn bound<const D: usize>(&self, assembly: &Assembly<D>, step: &mut [Vector<D>], backbone: &[bool]) -> f64 {
        let mut share = 1.0f64;
        for (disk, step) in step.iter_mut().enumerate() {
            let (distance, longest) = (norm(*step), self.largest_step * assembly.radii()[disk]);
            if distance > longest {
                if backbone[disk] {
                    share = share.min(longest / distance);
                } else {
                    *step = scaled(longest / distance, *step);
                }
            }
        }
        if assembly.law().on_site_coupling() == 0.0 && assembly.mobile_count() == assembly.len() {
            // Nothing holds the packing as a whole: its centre of mass must not move.
            let total = step.iter().fold([0.0; D], |total, &s| sum(total, s));
            let mean = scaled(1.0 / step.len() as f64, total);
            step.iter_mut().for_each(|s| *s = difference(*s, mean));
        }
        share
    }

    /// Searches for the lowest point along a direction from the checkpoint, to within `FLATNESS`. None if no point
    /// leads down.
    ///
    /// Its acceptance test is that of [`search`](crate::relax::minimise::line_search::search), but its lengths differ.
    /// The model gives the length, so no length above 1 is tried. The next point lies between a tenth and half of the
    /// bracket.
    fn search<const D: usize>(
        &mut self,
        assembly: &mut Assembly<D>,
        step: &[Vector<D>],
        longest: f64,
        totals: &Totals<D>,
    ) -> Result<Option<Reached<D>>, PackingError> {
        let slope = along(&assembly.forces, step);
        if slope.is_nan() || slope <= 0.0 {
            return Ok(None);
        }
        // Length and slope of the farthest accepted point before the lowest one, and of the nearest one beyond.
        let (mut low, mut high) = ((0.0, slope), (f64::INFINITY, f64::NAN));
        let mut length = longest;
        for trial in 1..=TRIAL_LIMIT {
            let (reached, end_slope) = self.go(assembly, step, length)?;
            let ratio = acceptance([totals, &reached], length * slope, [slope, end_slope], SUFFICIENT);
            if let Some(ratio) = ratio {
                // Model: the slope falls linearly, to zero at length 1.
                let found = Reached { totals: reached, ratio: ratio / (1.0 - 0.5 * length) };
                let is_flat = end_slope.abs() <= FLATNESS * slope;
                if is_flat || length >= longest || trial == TRIAL_LIMIT {
                    return Ok(Some(found));
                }
            }
            if ratio.is_some() && end_slope > 0.0 {
                low = (length, end_slope);
            } else {
                high = (length, end_slope);
            }
            let secant = low.0 + (high.0 - low.0) * low.1 / (low.1 - high.1);
            let (near, far) = (low.0 + 0.1 * (high.0 - low.0), high.0 - 0.5 * (high.0 - low.0));
            length = if secant.is_finite() { secant.clamp(near, far) } else { near };
        }
        if low.0 == 0.0 {
            return Ok(None);
        }
        let (reached, end_slope) = self.go(assembly, step, low.0)?;
        let ratio = acceptance([totals, &reached], low.0 * slope, [slope, end_slope], SUFFICIENT);
        Ok(ratio.map(|ratio| Reached { totals: reached, ratio: ratio / (1.0 - 0.5 * low.0) }))
    }

    /// The point at a length along a direction from the checkpoint, and F·s there.
    fn go<const D: usize>(
        &mut self,
        assembly: &mut Assembly<D>,
        step: &[Vector<D>],
        length: f64,
    ) -> Result<(Totals<D>, f64), PackingError> {
        assembly.restore()?;
        let mut distance = 0.0;
        for (u, &s) in assembly.displacements.iter_mut().zip(step) {
            *u = sum(*u, scaled(length, s));
            distance = larger(dot(s, s), distance);
        }
        assembly.update_list(length * distance.sqrt())?;
        let reached = self.evaluate(assembly);
        Ok((reached, along(&assembly.forces, step)))
    }

    fn evaluate<const D: usize>(&mut self, assembly: &mut Assembly<D>) -> Totals<D> {
        self.cost.force_evaluation_count += 1;
        assembly.evaluate_totals()
    }
}

/// F·s.
fn along<const D: usize>(forces: &[Vector<D>], step: &[Vector<D>]) -> f64 {
    forces.iter().zip(step).map(|(&force, &s)| dot(force, s)).sum()
}
