//! Damped dynamics and gradient flow by long implicit steps.
//!
//! ```text
//! damped dynamics   v̇ = F(u) − Σ c_ij (n·v_ij) n,  u̇ = v        gradient flow   ζ u̇ = F(u)
//! ```
//!
//! The equations are stiff: contacts relax in 10⁻³ of the time the softest modes take, and an explicit step follows the
//! contacts. Here a step follows what still moves. Its length is set by the estimated error, the largest one over the
//! backbone in units of the mean overlap; where a contact opens or closes within a step, the force or the damping kinks or
//! jumps, the stages disagree, and the step is repeated with a shorter one. Near the minimum the steps grow without bound
//! and become Newton's. See [`ImplicitMotion`] for the step, [`tableau`] for the method.

mod motion;
pub mod tableau;

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::contact::PairLaw;
use crate::contact::damping::{ConstantDamping, DampingChoice, DampingLaw};
use crate::contact::forces::Totals;
use crate::packing::{Packing, PackingError};
use crate::relax::monitor::Monitor;
use crate::relax::newton::{Descent, End, Patience, WATCH};
use crate::relax::{Cost, ForceLimit, Look, NetForce, Outcome, Relaxer, Stop, Trace};
use crate::vector::larger;

pub use motion::{ImplicitMotion, Inertia, Stepped, Work};

/// Damped dynamics by implicit steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ImplicitDynamics {
    /// How contacts dissipate. Changes results.
    pub damping: DampingChoice,
    /// When the packing counts as at rest. Changes results.
    pub limit: ForceLimit,
    /// Which net force the limit is on. Changes results.
    pub net_force: NetForce,
    /// Error allowed in one step, over the mean overlap \[1\]. Changes results where minima lie close together.
    pub tolerance: f64,
    /// What the last part of the way is left to.
    pub finish: Finish,
    /// Steps allowed, rejected ones included.
    pub step_limit: usize,
}

/// Gradient flow, the path of steepest descent, by implicit steps: it ends in the minimum to whose basin the start belongs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GradientFlow {
    /// When the packing counts as at rest. Changes results.
    pub limit: ForceLimit,
    /// Error allowed in one step, over the mean overlap \[1\]. Changes results where minima lie close together.
    pub tolerance: f64,
    /// What the last part of the way is left to.
    pub finish: Finish,
    /// Steps allowed, rejected ones included.
    pub step_limit: usize,
}

/// How a motion ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finish {
    /// By its own steps.
    Motion,
    /// By [`Newton`](super::Newton), from this relative residual on, if the stiffness matrix is definite there and what
    /// is left of the motion is too slow to leave the minimum; \[1\].
    Newton(f64),
}

impl Default for Finish {
    fn default() -> Self {
        Finish::Newton(1e-4)
    }
}

/// Default of the tolerance.
const TOLERANCE: f64 = 0.03;

/// Steps allowed by default.
const STEP_LIMIT: usize = 100_000;

impl Default for ImplicitDynamics {
    fn default() -> Self {
        ImplicitDynamics {
            damping: DampingChoice::default(),
            limit: ForceLimit::default(),
            net_force: NetForce::default(),
            tolerance: TOLERANCE,
            finish: Finish::default(),
            step_limit: STEP_LIMIT,
        }
    }
}

impl Default for GradientFlow {
    fn default() -> Self {
        GradientFlow {
            limit: ForceLimit::default(),
            tolerance: TOLERANCE,
            finish: Finish::default(),
            step_limit: STEP_LIMIT,
        }
    }
}

impl Relaxer for ImplicitDynamics {
    fn relax<const D: usize, L: PairLaw>(
        &self,
        packing: Packing<D>,
        law: &L,
        trace: &mut impl Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let run = Integration {
            limit: self.limit,
            net_force: self.net_force,
            tolerance: self.tolerance,
            finish: self.finish,
            step_limit: self.step_limit,
        };
        match self.damping {
            DampingChoice::Constant(damping) => run.relax(packing, law, &damping, Inertia::Massive, trace),
            DampingChoice::Viscoelastic(damping) => {
                run.relax(packing, law, &law.viscoelastic(damping.rate), Inertia::Massive, trace)
            }
        }
    }
}

impl Relaxer for GradientFlow {
    fn relax<const D: usize, L: PairLaw>(
        &self,
        packing: Packing<D>,
        law: &L,
        trace: &mut impl Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let run = Integration {
            limit: self.limit,
            net_force: NetForce::Elastic,
            tolerance: self.tolerance,
            finish: self.finish,
            step_limit: self.step_limit,
        };
        // The unit of time is that of the friction: 1 is as good as any.
        run.relax(packing, law, &ConstantDamping { rate: 0.0 }, Inertia::Friction(1.0), trace)
    }
}

/// Settings of either.
struct Integration {
    limit: ForceLimit,
    net_force: NetForce,
    tolerance: f64,
    finish: Finish,
    step_limit: usize,
}

/// Largest ratio of a step to the one before.
const LARGEST_GROWTH: f64 = 5.0;

/// Smallest one.
const SMALLEST_GROWTH: f64 = 0.1;

/// Aim of the next step's error over what is allowed.
const SAFETY: f64 = 0.8;

/// Error allowed off the backbone over that on it: rattlers and what is not yet held by its neighbours.
thread_local!{static OFF: f64 = std::env::var("OFF").map_or(3.0, |s| s.parse().unwrap());}

/// Overlap over a radius that stands in for the mean one where nothing is pressed \[1\].
const SMALLEST_OVERLAP: f64 = 1e-6;

/// Step over that of the motion at whose start it would be too short to change any position: nothing is gained any more.
thread_local!{static MARGIN: f64 = std::env::var("MARGIN").map_or(1.0, |s| s.parse().unwrap());}
thread_local!{static WAY: f64 = std::env::var("WAY").map_or(10.0, |s| s.parse().unwrap());}
thread_local!{static SF: f64 = std::env::var("SF").map_or(0.5, |s| s.parse().unwrap());static GG: f64 = std::env::var("GG").map_or(5.0, |s| s.parse().unwrap());static RG: f64 = std::env::var("RG").map_or(5.0, |s| s.parse().unwrap());}
const SHORTEST_STEP: f64 = 1e-12;

impl Integration {
    fn relax<const D: usize, L: PairLaw, C: DampingLaw>(
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
        let mobile = assembly.mobile_count();
        let net_forces = match self.net_force {
            NetForce::Elastic => &assembly.forces[..mobile],
            NetForce::Total => motion.net_forces(),
        };
        let (residual, rounding_floor) = monitor.finish(assembly, net_forces);
        cost.force_evaluation_count += motion.work.evaluation_count;
        cost.factorisation_count += motion.work.factorisation_count;
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
        let mobile = motion.assembly.mobile_count();
        let mut totals = motion.evaluate();
        let mut hand_over = match self.finish {
            Finish::Motion => 0.0,
            Finish::Newton(residual) => residual,
        };
        let mut time_step = 0.0;
        let mut rejected = false;
        loop {
            let look = Look {
                step_count: cost.step_count,
                energy: totals.energy,
                kinetic_energy: motion.kinetic_energy(),
                residual: 0.0,
                time_step,
                restart: false,
            };
            let net_forces = match self.net_force {
                NetForce::Elastic => &motion.assembly.forces[..mobile],
                NetForce::Total => motion.net_forces(),
            };
            if let Some(stop) = monitor.look(&motion.assembly, net_forces, &totals, look, trace) {
                return Ok(stop);
            }
            if monitor.takes_new_anchors() {
                motion.reanchor()?;
            }
            if monitor.residual().relative() <= hand_over {
                // TODO kinetic
                let mut descent = Descent::new(0.1, 50, Patience::Factorisations(12));
                motion.assembly.set_checkpoint();
                let end = descent.run(&mut motion.assembly, monitor, trace)?;
                *cost = cost.plus(descent.cost);
                match end {
                    End::Stop(Stop::Converged(criterion)) => return Ok(Stop::Converged(criterion)),
                    End::Stop(Stop::RoundingFloor) => return Ok(Stop::RoundingFloor),
                    _ => {}
                }
                hand_over *= 0.1;
                motion.velocities.fill([0.0; D]);
                totals = motion.evaluate();
                continue;
            }
            let scale = self.length(&motion.assembly, &totals);
            if time_step == 0.0 {
                time_step = first_step(motion, self.tolerance * scale);
            }
            loop {
                if cost.step_count >= self.step_limit {
                    return Ok(Stop::StepLimit);
                }
                cost.step_count += 1;
                motion.prestressed.copy_from_slice(monitor.backbone());
                motion.margin = MARGIN.with(|m| *m) * scale;motion.factor=WAY.with(|m| *m);
                let error = match motion.step(time_step)? {
                    Stepped::Moved(reached) => {
                        totals = reached;
                        let mut error = 0.0;
                        for disk in 0..mobile {
                            let share = if monitor.backbone()[disk] { 1.0 } else { 1.0 / OFF.with(|m| *m) };
                            error = larger(share * motion.error(time_step, disk), error);
                        }
                        error / (self.tolerance * scale)
                    }
                    Stepped::OutOfMemory => return Ok(Stop::OutOfMemory),
                    Stepped::Indefinite => f64::INFINITY,
                };
                if std::env::var("DBG").is_ok() {
                    let (mut e, mut w) = (0.0, 0); let (mut f, mut wf) = (0.0, 0);
                    for disk in 0..mobile { let x = motion.error(time_step, disk); if x > e { e = x; w = disk; } let g = crate::vector::norm(motion.assembly.forces[disk]); if g > f { f = g; wf = disk; } }
                    println!("      h {time_step:.2e} err {error:.2e} worst {w} bb {} force worst {wf} bb {} {f:.2e} mean {:.2e} scale {scale:.2e} ndisk {mobile} v {:?}", monitor.backbone()[w], monitor.backbone()[wf], monitor.residual().mean_contact_force, motion.velocities[w]);
                }
                // The embedded solution is of second order: the error of a step grows as its third power. NaN rejects.
                let growth = if error.is_finite() { (SF.with(|m| *m) / error).cbrt() } else if error.is_nan() { SMALLEST_GROWTH } else { 0.5 };
                let growth = growth.clamp(SMALLEST_GROWTH, LARGEST_GROWTH);
                if error <= 1.0 {
                    time_step *= if rejected { growth.min(RG.with(|m| *m)) } else { growth.min(GG.with(|m| *m)) };
                    rejected = false;
                    break;
                }
                cost.rejected_count += 1;
                rejected = true;
                motion.take_back()?;
                time_step *= growth.min(0.9);
            }
        }
    }

    /// The overlap of a contact, in the mean over contacts by their force: α Σu / ΣF.
    fn length<const D: usize, L: PairLaw>(
        &self,
        assembly: &crate::contact::assembly::Assembly<D, L>,
        totals: &Totals<D>,
    ) -> f64 {
        let radius = assembly.radii().iter().copied().fold(f64::INFINITY, f64::min);
        let contacts = totals.energy - totals.on_site_energy;
        let overlap =
            if totals.force_sum > 0.0 { assembly.law().exponent() * contacts / totals.force_sum } else { 0.0 };
        larger(overlap, SMALLEST_OVERLAP * radius)
    }
}

/// The step in which the largest force moves a disk by an allowed error.
fn first_step<const D: usize, L: PairLaw, C: DampingLaw>(motion: &ImplicitMotion<D, L, C>, allowed: f64) -> f64 {
    let forces = motion.net_forces().iter();
    let largest = forces.fold(0.0, |most, &force| larger(crate::vector::norm(force), most));
    let row = motion.assembly.stiffness_bound(&mut Vec::new());
    if largest > 0.0 { (2.0 * allowed / largest).sqrt() } else { 1.0 / row.sqrt() }
}
