//! [`Pace`]: whether the next stretch of a motion is for one implicit step or for many explicit ones.
//!
//! ```text
//! explicit while h < E h_x        E = 6.7 n^(1/4)        h_x = 0.9 of the bound on a stable explicit step
//! ```
//!
//! E is the number of explicit steps that take the time of one implicit step, of n mobile disks: 36 of 750, 54 of 4 124, 109 of
//! 66 000 in two dimensions (constant damping, p = 10). While disks collide everywhere, the errors of contacts that open and
//! close keep implicit steps short, and explicit ones are cheaper. After a stretch of them an implicit step of 2 E h_x is
//! tried; where it fails at once, the next stretch is twice as long.

use crate::contact::PairLaw;
use crate::contact::damping::DampingLaw;
use crate::contact::forces::Totals;
use crate::packing::PackingError;
use crate::relax::Cost;
use crate::relax::implicit::motion::ImplicitMotion;

/// E over n^(1/4).
const WORTH: f64 = 6.7;

/// An explicit step over the bound on a stable one, about half of the longest stable step: see
/// [`TimeStep`](crate::relax::TimeStep).
const SHARE: f64 = 0.9;

/// Implicit step that is tried, over the shortest one that pays.
const TRIED: f64 = 2.0;

/// Shortest stretch of explicit steps over E, and the longest.
const STRETCHES: (usize, usize) = (2, 8);

/// Implicit steps after which the next stretch is a short one again.
const SETTLED: usize = 4;

/// Which kind of steps pays.
#[derive(Debug)]
pub(super) struct Pace {
    /// E; 0 where there is nothing to choose.
    worth: usize,
    /// Length of the next stretch over E.
    length: usize,
    /// h_x \[time\].
    explicit_step: f64,
    /// Implicit steps since the last stretch.
    step_count: usize,
}

impl Pace {
    pub(super) fn new<const D: usize, L: PairLaw, C: DampingLaw>(motion: &mut ImplicitMotion<D, L, C>) -> Self {
        let worth = (WORTH * (motion.assembly.mobile_count() as f64).powf(0.25)) as usize;
        let explicit_step = if motion.has_masses() { SHARE * motion.stable_step() } else { 0.0 };
        let explicit_step = if explicit_step.is_finite() { explicit_step } else { 0.0 };
        Pace { worth, length: STRETCHES.0, explicit_step, step_count: 0 }
    }

    /// The shortest implicit step that pays \[time\].
    pub(super) fn shortest(&self) -> f64 {
        self.worth as f64 * self.explicit_step
    }

    /// Whether an implicit step of this length \[time\] does not pay.
    pub(super) fn is_explicit(&self, time_step: f64) -> bool {
        time_step < self.shortest()
    }

    /// An implicit step was made.
    pub(super) fn stepped(&mut self) {
        self.step_count += 1;
        if self.step_count >= SETTLED {
            self.length = STRETCHES.0;
        }
    }

    /// A stretch of explicit steps; `time_step` is that of the implicit one to try after it.
    pub(super) fn stretch<const D: usize, L: PairLaw, C: DampingLaw>(
        &mut self,
        motion: &mut ImplicitMotion<D, L, C>,
        time_step: &mut f64,
        cost: &mut Cost,
    ) -> Result<Totals<D>, PackingError> {
        if self.step_count == 0 {
            self.length = (2 * self.length).min(STRETCHES.1);
        }
        self.step_count = 0;
        let count = self.length * self.worth;
        let (totals, explicit_step) = motion.go_explicitly(count, SHARE, TRIED * self.shortest())?;
        cost.explicit_count += count;
        self.explicit_step = if explicit_step.is_finite() { explicit_step } else { 0.0 };
        *time_step = TRIED * self.shortest();
        Ok(totals)
    }
}
