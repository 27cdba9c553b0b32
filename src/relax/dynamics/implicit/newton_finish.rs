//! [`NewtonFinish`]: decides when Newton's method finishes a motion.
//!
//! Newton's method finds a minimum from almost any state, but perhaps not the one to which the motion leads. It is
//! tried once the residual and the kinetic energy of the backbone are small. Its minimum is accepted at once if every
//! backbone disk is within a tenth of an overlap of it. Otherwise the motion continues until its kinetic energy has
//! fallen to a quarter. The minimum is accepted if Newton's method finds it again. Rattlers may move for ever; their
//! energy does not count.

use serde::{Deserialize, Serialize};

use crate::packing::PackingError;
use crate::relax::convergence::Monitor;
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::relax::minimise::newton_descent::{End, NewtonDescent, Patience};
use crate::relax::outcome::{Cost, Stop};
use crate::relax::trace::{Check, Trace};
use crate::vector::{Vector, difference, larger, norm};

/// How a motion ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finish {
    /// By its own steps.
    Motion,
    /// By [`Newton`](crate::relax::Newton) below this relative residual r \[1\], once the kinetic energy of the
    /// backbone is below r² times the elastic energy. The minimum is accepted if it is within a tenth of an overlap. It
    /// is also accepted if it is found again after the kinetic energy has fallen to a quarter. Until then the motion
    /// continues.
    Newton(f64),
}

impl Default for Finish {
    /// Below 10⁻². A limit of 10⁻³ leads to the same minima with more evaluations, see the book.
    fn default() -> Self {
        Finish::Newton(1e-2)
    }
}

/// Largest distance of a backbone disk from the minimum, over an overlap, at which the minimum is certain \[1\].
const NEAR: f64 = 0.1;

/// Largest distance, over an overlap, of two minima that count as the same \[1\]. Newton's method leaves an error of
/// 10⁻⁸ of an overlap in a stiff direction; the softest directions are about 10⁴ times softer.
const SAME: f64 = 1e-3;

/// Ratio to the kinetic energy of the last trial at which the next trial is made; for gradient flow, to the residual.
const NEXT_KINETIC: f64 = 0.25;
const NEXT_RESIDUAL: f64 = 0.1;

/// Number of factorisations within which Newton's method must reduce the residual to a tenth.
const PATIENCE: usize = 12;

/// Largest displacement of a disk in a Newton step over its radius \[1\]. It is the default of
/// [`Newton`](crate::relax::Newton), but at most an overlap.
const LONGEST_STEP: f64 = 0.1;

/// Largest number of Newton's factorisations.
const FACTORISATION_LIMIT: usize = 100;

/// A trace that hides a trial, because the trial may be rejected, and keeps its last check.
struct HiddenTrace<'a> {
    trace: &'a mut dyn Trace,
    last: Option<Check>,
}

impl Trace for HiddenTrace<'_> {
    fn is_active(&self) -> bool {
        self.trace.is_active()
    }

    fn checked(&mut self, check: &Check) {
        self.last = Some(*check);
    }

    fn interrupted(&mut self) -> bool {
        self.trace.interrupted()
    }
}

/// The present state of a motion.
pub(crate) struct FinishState {
    /// Relative residual \[1\].
    pub(crate) residual: f64,
    /// Kinetic energy of the backbone \[energy\].
    pub(crate) kinetic: f64,
    /// The scale of energies \[energy\].
    pub(crate) scale: f64,
    /// A typical overlap \[length\].
    pub(crate) overlap: f64,
}

/// Decides when Newton's method can finish.
pub(crate) struct NewtonFinish<const D: usize> {
    /// Residual and kinetic energy below which Newton's method is tried; the latter is infinite before the first trial.
    residual: f64,
    kinetic: f64,
    /// (K/E)^(1/2) below which Newton's method is tried.
    hand_over: f64,
    /// The minimum of the last trial: the positions of the disks.
    minimum: Option<Vec<Vector<D>>>,
}

impl<const D: usize> NewtonFinish<D> {
    /// Tries Newton's method below this relative residual and K ≤ `hand_over`² E; never if `hand_over` is 0.
    pub(crate) fn from(hand_over: f64) -> Self {
        NewtonFinish { residual: hand_over, kinetic: f64::INFINITY, hand_over, minimum: None }
    }

    /// Whether Newton's method is to be tried here.
    pub(crate) fn is_due(&self, at: &FinishState) -> bool {
        let slow = self.hand_over * self.hand_over * at.scale;
        at.residual <= self.residual && at.kinetic <= slow.min(self.kinetic)
    }

    /// Tries Newton's method. Returns None and changes nothing if the minimum of the motion is not certain yet.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(crate) fn attempt(
        &mut self,
        motion: &mut ImplicitMotion<D>,
        monitor: &mut Monitor,
        cost: &mut Cost,
        at: &FinishState,
        trace: &mut dyn Trace,
    ) -> Result<Option<Stop>, PackingError> {
        let before = motion.assembly.clone();
        let smallest = before.radii().iter().copied().fold(f64::INFINITY, f64::min);
        let longest = LONGEST_STEP.min(at.overlap / smallest);
        let mut descent = NewtonDescent::new(longest, FACTORISATION_LIMIT, Patience::Factorisations(PATIENCE));
        let mut hidden = HiddenTrace { trace, last: None };
        let end = descent.run(&mut motion.assembly, monitor, &mut hidden)?;
        let last = hidden.last;
        *cost = cost.plus(descent.cost);
        if let End::Stop(stop @ (Stop::Converged(_) | Stop::RoundingFloor)) = end {
            let places: Vec<_> = (0..before.mobile_count()).map(|disk| motion.assembly.place(disk)).collect();
            let farthest = |from: &dyn Fn(usize) -> Vector<D>| {
                let distances = places.iter().enumerate().filter(|&(disk, _)| monitor.backbone()[disk]);
                distances.map(|(disk, &place)| norm(difference(place, from(disk)))).fold(0.0, larger) / at.overlap
            };
            let near = farthest(&|disk| before.place(disk)) <= NEAR;
            let again = self.minimum.as_ref().is_some_and(|minimum| farthest(&|disk| minimum[disk]) <= SAME);
            if near || again {
                if let Some(check) = last {
                    trace.checked(&check);
                }
                return Ok(Some(stop));
            }
            self.minimum = Some(places);
        } else {
            self.minimum = None;
        }
        if motion.has_masses() {
            self.kinetic = NEXT_KINETIC * at.kinetic;
        } else {
            self.residual = NEXT_RESIDUAL * at.residual;
        }
        motion.assembly = before;
        motion.put_back()?;
        Ok(None)
    }
}
