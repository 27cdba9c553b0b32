//! Random points in a periodic box, quenched to a jammed (or unjammed) packing at a packing fraction or at a pressure.
//!
//! At a packing fraction φ the points are drawn uniformly and relaxed once: this is the protocol of the study. At a
//! pressure, the points are relaxed at an estimated packing fraction. The box is then scaled together with the
//! positions, and relaxed again, until the pressure is met. Close to jamming
//!
//! ```text
//! p^(1/(α−1)) ∝ φ − φ_J
//! ```
//!
//! so the search uses secants in that quantity. If a step ends in an unjammed packing, it is repeated from the last
//! jammed one with half the length. Intermediate states count as at rest at a relative residual of
//! [`INTERMEDIATE_RESIDUAL`]. The state that meets the pressure is then relaxed to the relaxer's own limit. If its
//! pressure leaves the tolerance, the search continues with the full limit for every state.
//!
//! # Source
//! O'Hern, Silbert, Liu, Nagel (2003), Phys. Rev. E 68, 011306 (quench, scaling of the pressure).

mod error;

pub use error::PreparationError;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use crate::law::choice::LawChoice;
use crate::law::pair_law::PairLaw;
use crate::network::ContactNetwork;
use crate::packing::{Domain, Mixture, Packing, ball_volume};
use crate::relax::{Cost, Criterion, Fire, Outcome, Relaxed, Relaxer, Residual, Stop, Trace};
use crate::vector::Vector;

/// What the packing is prepared for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Target {
    /// Packing fraction of the quench \[1\].
    PackingFraction(f64),
    /// Pressure of the packing \[force / length^(D−1)\], met to the relative tolerance of [`Preparation::tolerance`].
    Pressure(f64),
}

/// How to prepare a packing.
#[derive(Debug, Clone, PartialEq)]
pub struct Preparation {
    /// Number of disks.
    pub disk_count: usize,
    /// Their radii.
    pub mixture: Mixture,
    /// Packing fraction or pressure.
    pub target: Target,
    /// Largest relative deviation of the pressure from the target \[1\].
    pub tolerance: f64,
    /// Seed of the random points.
    pub seed: u64,
    /// Side of the box along the first axis over the others \[1\].
    pub side_ratio: f64,
}

impl Default for Preparation {
    /// 1000 disks of the usual mixture at p = 100, seed 1: jammed, below the transition.
    fn default() -> Self {
        let (mixture, target) = (Mixture::default(), Target::Pressure(100.0));
        Preparation { disk_count: 1000, mixture, target, tolerance: 0.01, seed: 1, side_ratio: 1.0 }
    }
}

/// A packing at rest, with its residual and its cost.
#[derive(Debug, Clone)]
pub struct Prepared<const D: usize> {
    /// The packing.
    pub packing: Relaxed<Packing<D>>,
    /// Its pressure \[force / length^(D−1)\].
    pub pressure: f64,
    /// Its packing fraction \[1\].
    pub packing_fraction: f64,
    /// Packing fraction at which the random points were quenched \[1\].
    pub quench_packing_fraction: f64,
    /// Residual of the final relaxation.
    pub residual: Residual,
    /// Rounding floor of the relative residual \[1\].
    pub rounding_floor: f64,
    /// Which limit the final relaxation met.
    pub criterion: Criterion,
    /// Number of relaxations, the quench included.
    pub relaxation_count: usize,
    /// Cost of all relaxations.
    pub cost: Cost,
}

/// Largest number of relaxations in a search for a pressure; secants need 3 to 8.
const RELAXATION_LIMIT: usize = 60;

/// Relative residual at which an intermediate state of the search for a pressure counts as at rest \[1\]; a tenth of
/// the tolerance on the pressure, if that is smaller. Changes which packing is found, not its quality.
pub const INTERMEDIATE_RESIDUAL: f64 = 1e-3;

/// Packing fraction at jamming of random bidisperse packings, the start of a search. Source: O'Hern et al. (2003).
fn jamming_fraction<const D: usize>() -> f64 {
    if D == 2 { 0.842 } else { 0.648 }
}

/// x^(1/D), the same on every system (the power function of the standard library depends on the system).
fn root_of_dimension<const D: usize>(x: f64) -> f64 {
    if D == 2 { x.sqrt() } else { libm::cbrt(x) }
}

/// Uniformly random points in a periodic cube at a packing fraction, with radii of a mixture.
///
/// # Errors
/// An invalid mixture or packing fraction.
pub fn random_points<const D: usize>(
    disk_count: usize,
    mixture: &Mixture,
    packing_fraction: f64,
    seed: u64,
) -> Result<Packing<D>, PreparationError> {
    random_points_in(1.0, disk_count, mixture, packing_fraction, seed)
}

/// Uniformly random points in a periodic box whose first side is `side_ratio` times the others.
///
/// # Errors
/// As [`random_points`]; a ratio of sides that is not positive.
pub fn random_points_in<const D: usize>(
    side_ratio: f64,
    disk_count: usize,
    mixture: &Mixture,
    packing_fraction: f64,
    seed: u64,
) -> Result<Packing<D>, PreparationError> {
    check_fraction(packing_fraction)?;
    if !(side_ratio > 0.0 && side_ratio.is_finite()) {
        return Err(PreparationError::SideRatioNotPositive { side_ratio });
    }
    let radii = mixture.radii(disk_count)?;
    let solid: f64 = radii.iter().map(|&radius| ball_volume::<D>(radius)).sum();
    let side = root_of_dimension::<D>(solid / packing_fraction / side_ratio);
    let lengths: Vector<D> = std::array::from_fn(|d| if d == 0 { side_ratio * side } else { side });
    let mut generator = Pcg64::seed_from_u64(seed);
    let positions = radii.iter().map(|_| lengths.map(|length| length * generator.random::<f64>())).collect();
    Ok(Packing::new(Domain::rectangular([0.0; D], lengths), positions, radii)?)
}

/// Prepares a packing of Hertzian disks by FIRE.
///
/// [`prepare_with`] takes any law, relaxer and observer, in two dimensions or three.
///
/// # Errors
/// [`PreparationError`] says what is not possible, with numbers.
///
/// # Example
/// ```
/// use jamscope::{Preparation, prepare};
/// let prepared = prepare(&Preparation { disk_count: 100, ..Preparation::default() })?;
/// assert!((prepared.pressure / 100.0 - 1.0).abs() <= 0.01);
/// # Ok::<(), jamscope::preparation::PreparationError>(())
/// ```
pub fn prepare(preparation: &Preparation) -> Result<Prepared<2>, PreparationError> {
    prepare_with(preparation, &LawChoice::default(), &Fire::default(), &mut ())
}

/// Prepares a packing with this law and relaxer; `trace` observes the relaxations.
///
/// # Errors
/// [`PreparationError`] says what is not possible, with numbers.
pub fn prepare_with<const D: usize>(
    preparation: &Preparation,
    law: &dyn PairLaw,
    relaxer: &impl Relaxer,
    trace: &mut dyn Trace,
) -> Result<Prepared<D>, PreparationError> {
    let Preparation { disk_count, mixture, target, tolerance, seed, side_ratio } = preparation;
    match *target {
        Target::PackingFraction(packing_fraction) => {
            let points = random_points_in::<D>(*side_ratio, *disk_count, mixture, packing_fraction, *seed)?;
            Ok(Search { law, cost: Cost::default(), count: 0, quench: packing_fraction }
                .rest(points, relaxer, trace)?
                .0)
        }
        Target::Pressure(pressure) => {
            check_pressure(pressure, *tolerance)?;
            let quench = quench_fraction::<D>(law, mixture, pressure)?;
            let points = random_points_in::<D>(*side_ratio, *disk_count, mixture, quench, *seed)?;
            Search { law, cost: Cost::default(), count: 0, quench }.meet(points, (pressure, *tolerance), relaxer, trace)
        }
    }
}

/// Compresses or decompresses a packing in its periodic box to a packing fraction or a pressure, with this law and
/// relaxer; `trace` observes the relaxations.
///
/// Box and positions are scaled together, and the packing is relaxed. To a packing fraction this is done once. To a
/// pressure it is done until the pressure is met to the relative `tolerance`, as in [`prepare_with`].
///
/// # Errors
/// [`PreparationError`] says what is not possible, with numbers.
pub fn compress<const D: usize>(
    packing: Packing<D>,
    (target, tolerance): (Target, f64),
    law: &dyn PairLaw,
    relaxer: &impl Relaxer,
    trace: &mut dyn Trace,
) -> Result<Prepared<D>, PreparationError> {
    let fraction = packing.packing_fraction().ok_or(PreparationError::NotPeriodic)?;
    let mut search = Search { law, cost: Cost::default(), count: 0, quench: fraction };
    match target {
        Target::PackingFraction(packing_fraction) => {
            check_fraction(packing_fraction)?;
            let scaled = packing.rescaled(root_of_dimension::<D>(fraction / packing_fraction));
            Ok(search.rest(scaled, relaxer, trace)?.0)
        }
        Target::Pressure(pressure) => {
            check_pressure(pressure, tolerance)?;
            search.meet(packing, (pressure, tolerance), relaxer, trace)
        }
    }
}

fn check_fraction(packing_fraction: f64) -> Result<(), PreparationError> {
    if packing_fraction > 0.0 && packing_fraction < 4.0 {
        return Ok(());
    }
    Err(PreparationError::PackingFractionOutOfRange { packing_fraction })
}

fn check_pressure(pressure: f64, tolerance: f64) -> Result<(), PreparationError> {
    if !(pressure.is_finite() && pressure > 0.0) {
        return Err(PreparationError::PressureNotPositive { pressure });
    }
    if !(tolerance > 0.0 && tolerance < 1.0) {
        return Err(PreparationError::ToleranceOutOfRange { tolerance });
    }
    Ok(())
}

/// Pressure after affine compression from jamming. Packings have about 0.7 of it; it only starts the search.
fn affine_pressure<const D: usize>(law: &dyn PairLaw, mixture: &Mixture, packing_fraction: f64) -> f64 {
    let total: f64 = mixture.components.iter().map(|kind| kind.share).sum();
    let mean =
        |f: &dyn Fn(f64) -> f64| mixture.components.iter().map(|kind| kind.share * f(kind.radius)).sum::<f64>() / total;
    let radius = mean(&|r| r);
    let density = packing_fraction / mean(&|r| ball_volume::<D>(r));
    let reach = 2.0 * radius;
    let overlap = reach * (root_of_dimension::<D>(packing_fraction / jamming_fraction::<D>()) - 1.0).max(0.0);
    // Z / (2 D) contacts per disk and dimension, Z slightly above isostatic.
    1.15 * density * reach * law.force(law.coefficient(radius, radius), overlap)
}

/// Packing fraction at which random points are quenched to reach a pressure.
fn quench_fraction<const D: usize>(
    law: &dyn PairLaw,
    mixture: &Mixture,
    pressure: f64,
) -> Result<f64, PreparationError> {
    // A quench closer to jamming is slow and often ends unjammed. The search decompresses from here.
    let lowest = jamming_fraction::<D>() + 0.004;
    let (mut low, mut high) = (lowest, 4.0);
    let largest = 0.7 * affine_pressure::<D>(law, mixture, high);
    if largest < pressure {
        return Err(PreparationError::PressureOutOfReach { pressure, largest });
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if 0.7 * affine_pressure::<D>(law, mixture, middle) < pressure { low = middle } else { high = middle }
    }
    Ok(low)
}

/// One jammed state of the search.
struct State<const D: usize> {
    prepared: Prepared<D>,
    /// p^(1/(α−1)), linear in φ near jamming.
    root: f64,
}

struct Search<'a> {
    law: &'a dyn PairLaw,
    cost: Cost,
    count: usize,
    quench: f64,
}

impl Search<'_> {
    /// Relaxes a packing and computes its pressure.
    fn rest<const D: usize>(
        &mut self,
        packing: Packing<D>,
        relaxer: &impl Relaxer,
        trace: &mut dyn Trace,
    ) -> Result<(Prepared<D>, f64), PreparationError> {
        let packing_fraction = packing.packing_fraction().unwrap_or(0.0);
        let outcome = relaxer.relax(packing, self.law, trace)?;
        self.cost = self.cost.plus(outcome.cost);
        self.count += 1;
        let Outcome { stop, residual, rounding_floor, cost: Cost { step_count, .. }, .. } = outcome;
        let (Stop::Converged(criterion), Ok(packing)) = (stop, outcome.converged()) else {
            let residual = residual.relative();
            return Err(PreparationError::NotAtRest { packing_fraction, stop, step_count, residual });
        };
        let pressure = match criterion {
            Criterion::Unjammed => 0.0,
            _ => {
                let volume = packing.get().domain().volume().unwrap_or(f64::INFINITY);
                ContactNetwork::new(packing.get(), self.law)?.pressure(volume)
            }
        };
        let prepared = Prepared {
            packing,
            pressure,
            packing_fraction,
            quench_packing_fraction: self.quench,
            residual,
            rounding_floor,
            criterion,
            relaxation_count: self.count,
            cost: self.cost,
        };
        let root = libm::pow(pressure, 1.0 / (self.law.exponent() - 1.0));
        Ok((prepared, root))
    }

    fn meet<const D: usize>(
        &mut self,
        points: Packing<D>,
        (target, tolerance): (f64, f64),
        relaxer: &impl Relaxer,
        trace: &mut dyn Trace,
    ) -> Result<Prepared<D>, PreparationError> {
        let wanted = libm::pow(target, 1.0 / (self.law.exponent() - 1.0));
        let mut intermediate = relaxer.for_intermediate_states(INTERMEDIATE_RESIDUAL.min(0.1 * tolerance));
        let (prepared, root) = self.rest(points, intermediate.as_ref().unwrap_or(relaxer), trace)?;
        let mut state = State { prepared, root };
        // Slope of the root against φ: if unknown, that of a straight line from jamming.
        let mut slope = wanted.max(state.root) / (state.prepared.packing_fraction - jamming_fraction::<D>()).max(0.004);
        let mut nearest = (state.prepared.pressure, state.prepared.packing_fraction);
        let mut step_share = 1.0;
        let mut unjammed_above: f64 = 0.0;
        while self.count < RELAXATION_LIMIT {
            let (pressure, fraction) = (state.prepared.pressure, state.prepared.packing_fraction);
            if (pressure - target).abs() < (nearest.0 - target).abs() {
                nearest = (pressure, fraction);
            }
            if (pressure / target - 1.0).abs() <= tolerance {
                if intermediate.take().is_some() {
                    let (prepared, root) = self.rest(state.prepared.packing.into_inner(), relaxer, trace)?;
                    state = State { prepared, root };
                    continue;
                }
                state.prepared.relaxation_count = self.count;
                state.prepared.cost = self.cost;
                return Ok(state.prepared);
            }
            let mut step = step_share * (wanted - state.root) / slope;
            // One step changes φ by a tenth at most, and never reaches a φ known to be unjammed.
            step = step.clamp(-0.1 * fraction, 0.1 * fraction);
            if fraction + step <= unjammed_above {
                step = 0.5 * (unjammed_above - fraction);
            }
            let next = fraction + step;
            let packing = state.prepared.packing.get().clone().rescaled(root_of_dimension::<D>(fraction / next));
            let (prepared, root) = self.rest(packing, intermediate.as_ref().unwrap_or(relaxer), trace)?;
            if root == 0.0 {
                if state.root == 0.0 {
                    // Still unjammed while compressing: continue from here with longer steps.
                    step_share *= 2.0;
                    state = State { prepared, root };
                } else {
                    unjammed_above = unjammed_above.max(next);
                    step_share *= 0.5;
                }
                continue;
            }
            step_share = 1.0;
            let measured = (root - state.root) / (prepared.packing_fraction - fraction);
            if measured.is_finite() && measured > 0.0 {
                slope = measured.clamp(0.2 * slope, 5.0 * slope);
            }
            state = State { prepared, root };
            if unjammed_above >= state.prepared.packing_fraction {
                unjammed_above = 0.0;
            }
        }
        Err(PreparationError::PressureNotReached {
            target,
            tolerance,
            relaxation_count: self.count,
            nearest: nearest.0,
            packing_fraction: nearest.1,
        })
    }
}
