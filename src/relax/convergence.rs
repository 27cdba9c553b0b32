//! [`Monitor`]: when to stop, by periodic checks of the residual on the backbone and of the rounding floor.

use std::time::Instant;

use crate::forces::assembly::Assembly;
use crate::forces::totals::Totals;
use crate::network::{Links, Peeling};
use crate::packing::Packing;
use crate::relax::energy_account::EnergyAccount;
use crate::relax::force_limit::{ForceLimit, RUNAWAY, UNJAMMED_FORCE};
use crate::relax::outcome::{Cost, Criterion, Outcome, Residual, Stop};
use crate::relax::rounding::{floor_of, mean_force};
use crate::relax::trace::{Check, Trace};
use crate::vector::{Vector, dot, larger, norm};

/// Evaluations between two checks of the residual. A check adds half the cost of an evaluation.
pub const CHECK_INTERVAL: usize = 20;

/// While forces are large, one of this many checks is made.
const FAR_CHECKS: usize = 4;

/// A force is large if it is this many times the limit that the check applies \[1\].
const FAR: f64 = 30.0;

/// Mean contact force below which the residual is unknown \[force\]. Residuals come from squares of net forces. Below
/// this force, the square of the last digit is less than the smallest normal number: √(2⁻¹⁰²²)/2⁻⁵² = 2⁻⁴⁵⁹, or
/// 6.7·10⁻¹³⁹.
const SMALLEST_FORCE: f64 = f64::from_bits((1023 - 511 + 52) << 52);

/// The schedule of relaxers whose steps cost one evaluation.
const FIRE_SCHEDULE: CheckSchedule = CheckSchedule { refresh_every: 10, patience: 150, waits_for_rattlers: false };

/// How often a monitor does its costly work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CheckSchedule {
    /// Checks after which the backbone is recomputed even if nothing suggests convergence.
    pub refresh_every: usize,
    /// Checks without progress near the rounding floor after which the floor counts as reached.
    pub patience: usize,
    /// Whether a converged backbone waits at the floor for rattlers, however long they take.
    pub waits_for_rattlers: bool,
}

/// Relative rise of the elastic energy from start to rest that does not count as a gain. The energies of two states
/// within the same force limit may differ by the square of a residual of 10⁻⁴.
const ENERGY_GAIN: f64 = 1e-8;

/// Monitors one relaxation.
pub struct Monitor {
    limit: ForceLimit,
    schedule: CheckSchedule,
    unjammed_force: f64,
    /// Whether the smallest relevant forces of the law are below [`SMALLEST_FORCE`].
    weak: bool,
    /// Distance from a site that ends the relaxation: [`RUNAWAY`] radii if the law pushes disks away from their sites, the extent
    /// of the packing if disks have loads, otherwise infinite.
    farthest: f64,
    backbone: Vec<bool>,
    links: Links,
    peeling: Peeling,
    /// Buffer for sums over the contacts of each disk.
    row: Vec<f64>,
    check_count: usize,
    best: f64,
    best_check: usize,
    floor: f64,
    needs_anchors: bool,
    last: Residual,
    /// Elastic energies at the first and at the last check, and the scale of the rounding of the first.
    energies: Option<(f64, f64)>,
    first_scale: f64,
}

/// Diagonal of the smallest box around all centres \[length\].
fn extent<const D: usize>(assembly: &Assembly<D>) -> f64 {
    let mut sides = [0.0; D];
    for (axis, side) in sides.iter_mut().enumerate() {
        let places = (0..assembly.len()).map(|disk| assembly.place(disk)[axis]);
        let ends = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
        *side = ends[1] - ends[0];
    }
    norm(sides)
}

impl Monitor {
    /// A monitor with this limit.
    pub fn new<const D: usize>(limit: ForceLimit, assembly: &Assembly<D>) -> Self {
        Monitor::with(limit, FIRE_SCHEDULE, assembly)
    }

    /// A monitor with this limit and this schedule.
    pub fn with<const D: usize>(limit: ForceLimit, schedule: CheckSchedule, assembly: &Assembly<D>) -> Self {
        let radius = assembly.radii().iter().copied().fold(f64::INFINITY, f64::min);
        let unjammed_force = UNJAMMED_FORCE * assembly.law().force_scale(radius);
        let farthest = if assembly.law().on_site_coupling() > 0.0 {
            RUNAWAY * assembly.radii().iter().copied().fold(0.0, f64::max)
        } else if assembly.law().on_site_coupling() == 0.0 && assembly.has_on_site_forces() {
            extent(assembly)
        } else {
            f64::INFINITY
        };
        Monitor {
            limit,
            schedule,
            // An absolute limit below the unjammed threshold replaces the threshold.
            unjammed_force: match limit {
                ForceLimit::Absolute(limit) => unjammed_force.min(limit),
                ForceLimit::Relative(_) => unjammed_force,
            },
            weak: unjammed_force < SMALLEST_FORCE,
            farthest,
            backbone: vec![true; assembly.len()],
            links: Links::default(),
            peeling: Peeling::default(),
            row: Vec::new(),
            check_count: 0,
            best: f64::INFINITY,
            best_check: 0,
            floor: 0.0,
            needs_anchors: false,
            last: Residual { largest_net_force: f64::INFINITY, mean_contact_force: 1.0 },
            energies: None,
            first_scale: 0.0,
        }
    }

    /// Checks the net forces just evaluated, one per mobile disk. Returns why to stop, if so.
    pub fn check<const D: usize>(
        &mut self,
        assembly: &Assembly<D>,
        net_forces: &[Vector<D>],
        totals: &Totals<D>,
        report: Check,
        trace: &mut dyn Trace,
    ) -> Option<Stop> {
        self.check_count += 1;
        let first = self.energies.map_or(totals.energy, |(first, _)| first);
        if self.energies.is_none() {
            self.first_scale = totals.energy_scale();
        }
        self.energies = Some((first, totals.energy));
        let (on_backbone, off_backbone) = self.largest(net_forces);
        let mean = totals.mean_contact_force();
        self.last = Residual { largest_net_force: on_backbone, mean_contact_force: mean };
        trace.checked(&Check { residual: self.last.relative(), ..report });
        if trace.interrupted() {
            return Some(Stop::Interrupted);
        }
        if self.ran_away(assembly) {
            return Some(Stop::NoMinimum);
        }
        if !(on_backbone + off_backbone + totals.energy).is_finite() {
            return Some(Stop::NonFinite);
        }
        if self.weak && totals.contact_count > 0 && mean < SMALLEST_FORCE {
            return Some(Stop::Underflow);
        }
        if larger(on_backbone, off_backbone) <= self.unjammed_force && mean <= self.unjammed_force {
            return Some(Stop::Converged(Criterion::Unjammed));
        }
        let meets_limit = self.within(on_backbone, mean);
        let due = meets_limit || self.check_count.is_multiple_of(self.schedule.refresh_every) || self.check_count == 1;
        let converged = if due { self.refresh(assembly, net_forces) } else { None };
        if converged.is_some() {
            let gained = totals.energy - first > ENERGY_GAIN * (self.first_scale + totals.energy_scale());
            return if gained { Some(Stop::EnergyGained) } else { converged };
        }
        self.at_the_floor().then_some(Stop::RoundingFloor)
    }

    /// Whether a check is due after this step. `largest_force` is the largest component of a net force. A check comes
    /// every [`CHECK_INTERVAL`] steps. While a force is large, only one in [`FAR_CHECKS`] of these checks is made. A
    /// disk off the backbone may have a large force for a long time.
    pub fn is_due(&self, step: usize, largest_force: f64) -> bool {
        let Residual { mean_contact_force: mean, .. } = self.last;
        let limit_force = match self.limit {
            ForceLimit::Relative(limit) => limit * mean,
            ForceLimit::Absolute(limit) => limit,
        };
        let far = largest_force > FAR * larger(limit_force, self.floor * mean);
        step.is_multiple_of(if far { FAR_CHECKS * CHECK_INTERVAL } else { CHECK_INTERVAL })
    }

    /// Whether a disk pushed from its site is too far from it. Callers also call this after every rebuild of the list,
    /// since a disk may move far between two checks.
    pub fn ran_away<const D: usize>(&self, assembly: &Assembly<D>) -> bool {
        assembly.has_on_site_forces() && assembly.longest_displacement_from_site() >= self.farthest
    }

    /// Determines the backbone and its residual. Without a backbone, all disks count if there are forces. Returns the
    /// criterion met.
    fn refresh<const D: usize>(&mut self, assembly: &Assembly<D>, net_forces: &[Vector<D>]) -> Option<Stop> {
        let mobile = assembly.mobile_count();
        self.links.take(assembly);
        self.peeling.peel::<D>(|disk| disk >= mobile, &self.links.ends, &mut self.backbone);
        let rigid = self.backbone[..mobile].iter().any(|&member| member);
        if !rigid && self.links.forces.iter().any(|&force| force > self.unjammed_force) {
            // A chain between walls has no backbone but may be at rest under forces: every disk counts.
            self.backbone.fill(true);
        }
        let members = &self.backbone;
        let mean = mean_force(&self.links, members);
        let (on_backbone, off_backbone) = self.largest(net_forces);
        let row = &mut self.row;
        self.floor = floor_of(assembly, members, mean, assembly.longest_displacement(), row);
        self.last = Residual { largest_net_force: on_backbone, mean_contact_force: mean };
        // Rounding counts if it is within a factor 20 of the residual and new anchors would lower it by more than a
        // factor 4.
        self.needs_anchors =
            self.floor > 0.05 * self.last.relative() && self.floor > 4.0 * floor_of(assembly, members, mean, 0.0, row);
        let stop = match self.limit {
            ForceLimit::Relative(limit) => {
                (mean > 0.0 && on_backbone <= limit * mean && off_backbone <= limit.sqrt() * mean)
                    .then_some(Criterion::RelativeForce)
            }
            ForceLimit::Absolute(limit) if rigid => (on_backbone <= limit
                && off_backbone <= limit.sqrt() * mean.max(limit))
            .then_some(Criterion::AbsoluteForce),
            ForceLimit::Absolute(limit) => {
                (larger(on_backbone, off_backbone) <= limit).then_some(Criterion::AbsoluteForce)
            }
        };
        stop.map(Stop::Converged)
    }

    /// Largest net forces on and off the backbone.
    fn largest<const D: usize>(&self, net_forces: &[Vector<D>]) -> (f64, f64) {
        let mut largest = [0.0; 2];
        for (force, &member) in net_forces.iter().zip(&self.backbone) {
            let slot = usize::from(!member);
            largest[slot] = larger(dot(*force, *force), largest[slot]);
        }
        (largest[0].sqrt(), largest[1].sqrt())
    }

    fn within(&self, largest: f64, mean: f64) -> bool {
        match self.limit {
            ForceLimit::Relative(limit) => largest <= limit * mean,
            ForceLimit::Absolute(limit) => largest <= limit,
        }
    }

    fn at_the_floor(&mut self) -> bool {
        let residual = self.last.relative();
        // A fall by 10 % counts as progress. Fluctuations at the floor are larger, so the best value is kept.
        if residual < 0.9 * self.best {
            self.best = residual;
            self.best_check = self.check_count;
        }
        // Without a backbone the residual is 0 and contains no information.
        let known = self.last.largest_net_force > 0.0;
        known && self.near_the_floor() && self.check_count - self.best_check >= self.schedule.patience
    }

    /// Whether rounding may explain the last residual, and the backbone does not merely wait for rattlers.
    pub fn near_the_floor(&self) -> bool {
        let waits =
            self.schedule.waits_for_rattlers && self.within(self.last.largest_net_force, self.last.mean_contact_force);
        self.last.relative() <= 16.0 * self.floor && !waits
    }

    /// Whether each disk, in working order, counted for the last residual.
    #[cfg(feature = "linear")]
    pub fn backbone(&self) -> &[bool] {
        &self.backbone
    }

    /// The residual of the last check.
    pub fn residual(&self) -> Residual {
        self.last
    }

    /// Whether the caller should re-anchor, because the rounding of displacements is relevant. Asked once per check.
    pub fn takes_new_anchors(&mut self) -> bool {
        std::mem::take(&mut self.needs_anchors)
    }

    /// Elastic energies at the first and at the last check.
    pub fn energies(&self) -> Option<EnergyAccount> {
        self.energies.map(|(before, after)| EnergyAccount { before, after, ..EnergyAccount::default() })
    }

    /// The outcome of a relaxer that began at `start`, with the net forces of the assembly.
    pub fn outcome<const D: usize>(
        self,
        assembly: Assembly<D>,
        packing: Packing<D>,
        (stop, cost): (Stop, Cost),
        start: Instant,
    ) -> Outcome<Packing<D>> {
        let energies = cost.energies.or(self.energies());
        let (residual, rounding_floor) = self.finish(&assembly, &assembly.forces[..assembly.mobile_count()]);
        let (build_count, seconds) = (assembly.build_count(), start.elapsed().as_secs_f64());
        let cost = Cost { build_count, seconds, energies, ..cost };
        Outcome { state: assembly.placed(packing), stop, residual, rounding_floor, cost }
    }

    /// The residual and the floor for the outcome, with the backbone recomputed.
    pub fn finish<const D: usize>(mut self, assembly: &Assembly<D>, net_forces: &[Vector<D>]) -> (Residual, f64) {
        let _ = self.refresh(assembly, net_forces);
        (self.last, self.floor)
    }
}
