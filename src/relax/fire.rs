//! FIRE: a ball rolling downhill that is stopped whenever it climbs.
//!
//! ```text
//! P = F·v > 0:  after a delay  dt ← min(1.1 dt, dt_max), α ← 0.99 α        otherwise  v ← 0, dt ← dt/2, α ← 0.1
//! v ← v + dt F,   v ← (1 − α) v + α |v| F/|F|,   u ← u + dt v              (masses 1)
//! ```
//!
//! The largest time step follows the contacts: `dt_max = c · 2/√λ` with λ Gershgorin's bound on the largest eigenvalue of
//! the present stiffness matrix, taken anew every few steps, so no step has to be chosen for a pressure.
//!
//! [`Uphill::StepBack`] are the corrections of FIRE 2.0: where a step climbed, the disks go half of it back before they rest,
//! `u ← u − (dt/2) v`, and the first steps may climb without a shorter time step. Forces are taken anew where the disks then
//! are, in place of the evaluation that a restart has anyway.
//!
//! What is guaranteed about the energy: FIRE lets it rise within a run, but every restart (v ← 0) happens at an energy
//! not above that of the restart before, to rounding (10⁻¹³ of it; of contacts and sites added up where disks have sites). Where a restart would be higher, the disks go back
//! to the last one and the time step is halved. The final energy is therefore never above the first.
//!
//! # Source
//! Bitzek, Koskinen, Gähler, Moseler, Gumbsch (2006), Phys. Rev. Lett. 97, 170201; order of kick, mixing and drift
//! (semi-implicit Euler): Guénolé et al. (2020), Comput. Mater. Sci. 175, 109584.

mod motion;

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::forces::advance::Advanced;
use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::fire::motion::{Motion, Step};
use crate::relax::flat::Products;
use crate::relax::monitor::Monitor;
use crate::relax::{Cost, ForceLimit, Look, Outcome, Relaxer, Stop, Trace};

/// FIRE. Defaults: Bitzek et al. (2006), Phys. Rev. Lett. 97, 170201, where no other origin is given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Fire {
    /// When the packing counts as at rest. Changes results.
    pub limit: ForceLimit,
    /// Steps allowed.
    pub step_limit: usize,
    /// Largest time step over the stability limit 2/√λ of Gershgorin's bound \[1\]. Changes speed only: the bound lies
    /// above the largest eigenvalue, 0.9 to 1.2 converge with the fewest steps and 1.3 no longer does near jamming.
    pub time_step_fraction: f64,
    /// Steps downhill before the time step grows.
    pub delay: usize,
    /// Factor on the time step after a step downhill \[1\].
    pub step_growth: f64,
    /// Factor on the time step at a restart \[1\].
    pub step_cut: f64,
    /// Mixing of velocity and force at a restart \[1\].
    pub mixing: f64,
    /// Factor on the mixing after a step downhill \[1\].
    pub mixing_decay: f64,
    /// What happens where a step climbed.
    #[serde(skip_serializing_if = "Uphill::is_restart")]
    pub uphill: Uphill,
    /// Precision of the steps. Changes results where minima lie close together.
    #[serde(skip_serializing_if = "Precision::is_double")]
    pub precision: Precision,
}

/// In what precision FIRE makes its steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    /// Double throughout.
    #[default]
    Double,
    /// Single while the residual is above 10⁻⁶, then double. Energies, residuals and bounds on the time step are taken in double
    /// throughout, and so are the forces at rest.
    Mixed,
}

impl Precision {
    /// Whether it is the one that needs no mention.
    pub(super) fn is_double(&self) -> bool {
        *self == Precision::Double
    }
}

/// What FIRE does where a step climbed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Uphill {
    /// It rests where it is.
    #[default]
    Restart,
    /// It goes half a step back and rests there.
    StepBack(StepBack),
}

impl Uphill {
    /// Whether it is the one that needs no mention.
    fn is_restart(&self) -> bool {
        *self == Uphill::Restart
    }
}

/// The corrections of FIRE 2.0. Defaults: Guénolé et al. (2020), Comput. Mater. Sci. 175, 109584, table 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StepBack {
    /// Steps from the start in which a step that climbs leaves the time step as it is.
    pub start_delay: usize,
    /// Steps that may climb one after the other; one more ends the relaxation.
    pub uphill_limit: usize,
}

impl Default for StepBack {
    fn default() -> Self {
        StepBack { start_delay: 20, uphill_limit: 2000 }
    }
}

impl Default for Fire {
    fn default() -> Self {
        Fire {
            limit: ForceLimit::default(),
            // Random points of 88776 disks close to jamming need about 10⁵ (design §7).
            step_limit: 2_000_000,
            time_step_fraction: 1.0,
            delay: 5,
            step_growth: 1.1,
            step_cut: 0.5,
            mixing: 0.1,
            mixing_decay: 0.99,
            uphill: Uphill::default(),
            precision: Precision::default(),
        }
    }
}

/// Steps after which the bound on the time step is taken anew (design §7: 10 to 50 is enough).
const BOUND_EVERY: usize = 40;

/// Relative residual down to which steps may be made in single precision \[1\]: some ten times what its rounding makes of it.
const SINGLE_LIMIT: f64 = 1e-6;

/// Relative residual below which every look begins with a new base: what the ways from it change an overlap by is rounded \[1\].
const BASE_FELT: f64 = 1e-3;

/// First time step over the largest one \[1\].
const FIRST_STEP: f64 = 0.1;

/// Rounding of an energy summed over blocks, relative \[1\].
pub(super) const ENERGY_ROUNDING: f64 = 1e-13;

impl Relaxer for Fire {
    fn relax<const D: usize, L: PairLaw>(
        &self,
        packing: Packing<D>,
        law: &L,
        trace: &mut impl Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let start = Instant::now();
        let mut assembly = Assembly::with_amended_lists(&packing, *law)?;
        let mut monitor = Monitor::new(self.limit, &assembly);
        let (stop, cost) = self.run(&mut assembly, &mut monitor, trace)?;
        Ok(monitor.outcome(assembly, packing, (stop, cost), start))
    }

    fn passing(&self, limit: f64) -> Option<Self> {
        self.limit.loosened(limit).map(|limit| Fire { limit, ..*self })
    }
}

impl Fire {
    /// Moves an assembly until the monitor stops it or the steps are used up.
    pub(super) fn run<const D: usize, L: PairLaw>(
        &self,
        assembly: &mut Assembly<D, L>,
        monitor: &mut Monitor,
        trace: &mut impl Trace,
    ) -> Result<(Stop, Cost), PackingError> {
        assembly.prune_lists(true);
        let ended = Run { settings: self, evaluation_count: 0, step_count: 0 }.run(assembly, monitor, trace);
        assembly.prune_lists(false);
        ended
    }
}

struct Run<'a> {
    settings: &'a Fire,
    evaluation_count: usize,
    step_count: usize,
}

impl Run<'_> {
    fn run<const D: usize, L: PairLaw>(
        mut self,
        assembly: &mut Assembly<D, L>,
        monitor: &mut Monitor,
        trace: &mut impl Trace,
    ) -> Result<(Stop, Cost), PackingError> {
        let mut motion = Motion::new(assembly, self.settings.precision == Precision::Mixed);
        let stop = self.descend(assembly, &mut motion, monitor, trace)?;
        if motion.is_single() {
            // Who looks at the assembly finds the disks where they are, and their forces in double precision.
            motion.settle(assembly);
            assembly.evaluate();
            self.evaluation_count += 1;
        }
        Ok((stop, self.cost()))
    }

    fn descend<const D: usize, L: PairLaw>(
        &mut self,
        assembly: &mut Assembly<D, L>,
        motion: &mut Motion<D>,
        monitor: &mut Monitor,
        trace: &mut impl Trace,
    ) -> Result<Stop, PackingError> {
        let settings = self.settings;
        let mobile = assembly.mobile_count();
        // The products where the disks are, if the step to there has taken them.
        let mut taken: Option<Products> = None;
        let mut row = Vec::new();
        let mut largest_step = self.largest_step(assembly, &mut row);
        let mut time_step = FIRST_STEP * largest_step;
        let mut mixing = settings.mixing;
        let (mut downhill, mut uphill) = (0, 0);
        let mut rest_energy = f64::INFINITY;
        let mut rest_scale = f64::INFINITY;
        let mut due = true;
        loop {
            let totals = if due { Some(assembly.evaluate_totals()) } else { None };
            self.evaluation_count += 1;
            let mut sums = match taken.take() {
                Some(sums) => sums,
                None if due => motion.products(assembly),
                None => motion.evaluate(assembly),
            };
            if motion.is_single() && !sums.is_finite() {
                // Out of the range of single precision, as disks are whose centres nearly coincide.
                motion.settle(assembly);
                motion.refine();
                sums = motion.evaluate(assembly);
            }
            let restart = sums.power <= 0.0 && self.step_count > 0;
            if let Some(totals) = &totals {
                let look = Look {
                    step_count: self.step_count,
                    energy: totals.energy,
                    kinetic_energy: 0.5 * sums.speed_squared,
                    residual: 0.0,
                    time_step,
                    restart: false,
                };
                if let Some(stop) = monitor.look(assembly, &assembly.forces[..mobile], totals, look, trace) {
                    return Ok(stop);
                }
                if self.step_count == 0 {
                    (rest_energy, rest_scale) = (totals.energy, totals.energy_scale());
                    assembly.set_checkpoint();
                }
                if monitor.takes_new_anchors() {
                    assembly.reanchor()?;
                    motion.forget();
                }
                let residual = monitor.residual().relative();
                if residual <= BASE_FELT {
                    motion.forget();
                }
                if residual <= SINGLE_LIMIT {
                    motion.refine();
                }
            }
            if self.step_count >= settings.step_limit {
                return Ok(Stop::StepLimit);
            }
            if self.step_count.is_multiple_of(BOUND_EVERY) && self.step_count > 0 {
                motion.settle(assembly);
                largest_step = self.largest_step(assembly, &mut row);
                time_step = time_step.min(largest_step);
            }
            if restart {
                motion.settle(assembly);
                motion.forget();
                uphill += 1;
                if let Uphill::StepBack(back) = settings.uphill {
                    if uphill > back.uphill_limit {
                        let floor = monitor.near_the_floor();
                        return Ok(if floor { Stop::RoundingFloor } else { Stop::NoDescent });
                    }
                    motion.step_back(assembly, time_step);
                    assembly.keep_listed(0.5 * time_step * sums.speed_squared.sqrt())?;
                }
                let totals = match totals {
                    Some(totals) if settings.uphill == Uphill::Restart => totals,
                    _ => {
                        self.evaluation_count += 1;
                        assembly.evaluate_totals()
                    }
                };
                let energy = totals.energy;
                let higher = if assembly.law().has_sites() {
                    // Energies of either sign: rounding is relative to what was added up.
                    energy - rest_energy > ENERGY_ROUNDING * (totals.energy_scale() + rest_scale)
                } else {
                    energy > rest_energy * (1.0 + ENERGY_ROUNDING)
                };
                if energy >= rest_energy * (1.0 - ENERGY_ROUNDING) {
                    // No lower than at the restart before: single precision leads no further.
                    motion.refine();
                }
                if higher {
                    assembly.restore()?;
                    assembly.evaluate();
                    self.evaluation_count += 1;
                } else {
                    (rest_energy, rest_scale) = (energy, totals.energy_scale());
                    assembly.set_checkpoint();
                }
                if trace_is_active(trace) {
                    let look = Look {
                        step_count: self.step_count,
                        energy: rest_energy,
                        kinetic_energy: 0.0,
                        residual: f64::NAN,
                        time_step,
                        restart: true,
                    };
                    trace.look(&look);
                }
                motion.rest();
                sums = motion.products(assembly);
                let kept =
                    matches!(settings.uphill, Uphill::StepBack(back) if self.step_count < back.start_delay && !higher);
                if !kept {
                    time_step *= settings.step_cut;
                }
                mixing = settings.mixing;
                downhill = 0;
            } else {
                downhill += 1;
                uphill = 0;
                if downhill > settings.delay {
                    time_step = (time_step * settings.step_growth).min(largest_step);
                    mixing *= settings.mixing_decay;
                }
            }
            let kicked = sums.speed_squared + time_step * (2.0 * sums.power + time_step * sums.force_squared);
            let turn = if sums.force_squared > 0.0 { mixing * (kicked / sums.force_squared).sqrt() } else { 0.0 };
            let keep = 1.0 - mixing;
            let push = keep * time_step + turn;
            let step = Step { keep, push, time_step };
            // No disk goes farther than √D times the longest way along an axis.
            let reach = time_step * (D as f64).sqrt();
            self.step_count += 1;
            due = monitor.is_due(self.step_count, sums.largest_force);
            // A look takes totals, which take a pass of their own.
            let advanced = if due { Advanced::Not } else { motion.advance(assembly, step, reach) };
            let listed_anew = if advanced == Advanced::Not {
                let fastest = motion.kick(assembly, step);
                assembly.keep_listed(reach * fastest)?
            } else {
                assembly.keep()?
            };
            if let Advanced::Evaluated(parts) = advanced {
                taken = Some(motion.sum(&parts));
            }
            if listed_anew && monitor.ran_away(assembly) {
                return Ok(Stop::NoMinimum);
            }
        }
    }

    fn largest_step<const D: usize, L: PairLaw>(&self, assembly: &Assembly<D, L>, row: &mut Vec<f64>) -> f64 {
        let mut bound = assembly.stiffness_bound(row);
        if bound == 0.0 {
            // No contact yet: as if one were pressed by a thousandth of a radius.
            let (law, radius) = (assembly.law(), assembly.radii()[0]);
            let overlap = 1e-3 * radius;
            bound = 2.0 * law.stiffness(law.force(law.coefficient(radius, radius), overlap), overlap);
        }
        self.settings.time_step_fraction * 2.0 / bound.sqrt()
    }

    fn cost(&self) -> Cost {
        Cost { step_count: self.step_count, force_evaluation_count: self.evaluation_count, ..Cost::default() }
    }
}

fn trace_is_active<T: Trace>(_trace: &T) -> bool {
    T::ACTIVE
}
