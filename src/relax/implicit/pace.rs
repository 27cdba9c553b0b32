//! [`Pace`]: which kind of steps the next stretch of a motion is made of.

use crate::contact::PairLaw;
use crate::contact::damping::DampingLaw;
use crate::relax::implicit::chebyshev::Stiffness;
use crate::relax::implicit::motion::ImplicitMotion;

/// E over n^(1/4).
const WORTH: f64 = 6.7;

/// An explicit step over the bound on a stable one, about half of the longest stable step: see
/// [`TimeStep`](crate::relax::TimeStep).
pub(super) const SHARE: f64 = 0.9;

/// Which kind of steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Implicit,
    /// In this many stages.
    Stabilised(usize),
    Explicit,
}

/// Which kind of steps pays.
#[derive(Debug)]
pub(super) struct Pace {
    /// E.
    pub(super) worth: usize,
    /// h_x \[time\]; 0 where explicit steps are out of the question.
    pub(super) explicit_step: f64,
    pub(super) stiffness: Option<Stiffness>,
}

impl Pace {
    pub(super) fn new<const D: usize, L: PairLaw, C: DampingLaw>(motion: &mut ImplicitMotion<D, L, C>) -> Self {
        let worth = (WORTH * (motion.assembly.mobile_count() as f64).powf(0.25)) as usize;
        let mut pace = Pace { worth, explicit_step: 0.0, stiffness: motion.stiffness() };
        pace.set_explicit_step(if motion.has_masses() { SHARE * motion.stable_step() } else { 0.0 });
        pace
    }

    /// Bounds for the present contacts.
    pub(super) fn look<const D: usize, L: PairLaw, C: DampingLaw>(&mut self, motion: &mut ImplicitMotion<D, L, C>) {
        self.stiffness = motion.stiffness();
    }

    pub(super) fn set_explicit_step(&mut self, time_step: f64) {
        self.explicit_step = if time_step.is_finite() { time_step } else { 0.0 };
    }

    /// The kind that covers time at the least work where errors allow steps of this length \[time\].
    pub(super) fn kind(&self, time_step: f64) -> Kind {
        let mut kind = Kind::Implicit;
        let mut rate = self.worth as f64 / time_step;
        if self.explicit_step > 0.0 && 1.0 / self.explicit_step < rate {
            (kind, rate) = (Kind::Explicit, 1.0 / self.explicit_step);
        }
        if let Some(stiffness) = self.stiffness {
            let step = time_step.min(stiffness.longest_step());
            let stage_count = stiffness.stage_count(step);
            if (stage_count as f64) < rate * step {
                kind = Kind::Stabilised(stage_count);
            }
        }
        kind
    }
}
