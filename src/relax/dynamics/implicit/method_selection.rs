//! [`Pace`]: which kind of steps the next stretch of a motion is made of.
//!
//! ```text
//! kind          work of a unit of time                       limit
//! implicit      E/h
//! stabilised    s(h)/h                                       h ≤ 2.25/ρ
//! explicit      V/h_x                                        h_x = 0.9 of the bound on a stable Verlet step
//! ```
//!
//! h is the step that errors allow, s(h) the number of stages of a stabilised step, see [`super::chebyshev`]. Work is counted in
//! stages, evaluations of all forces: an implicit step of n mobile disks takes the time of E of them, a Verlet step that of V. The
//! kind with the least work is taken. While disks collide everywhere, the errors of contacts that open and close keep h short, and
//! that is the stabilised one, or the explicit one where oscillations are hardly damped. After a stretch of explicit steps an
//! implicit one of 2 E h_x/V is tried; where it fails at once, the next stretch is twice as long.

use crate::law::damping::DampingLaw;
use crate::law::pair_law::PairLaw;
use crate::relax::dynamics::explicit_step::ExplicitStep;
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::relax::dynamics::implicit::rkc::coefficients::Stiffness;

/// E over n^(1/8).
const WORTH: f64 = 34.0;

/// V.
const VERLET: f64 = 1.8;

/// An explicit step over the bound on a stable one, about half of the longest stable step: see
/// [`TimeStep`](crate::relax::TimeStep).
pub(crate) const SHARE: f64 = 0.9;

/// Implicit step that is tried after explicit ones, over the shortest one that pays.
const TRIED: f64 = 2.0;

/// Work of the shortest stretch of explicit steps over E, and of the longest.
const STRETCHES: (usize, usize) = (2, 64);

/// Share of the bound below which explicit steps that break the balance of energies are not shortened any more.
const SMALLEST_SHARE: f64 = 1e-3;

/// Growth of that share after a stretch that kept the balance.
const SHARE_GROWTH: f64 = 1.2;

/// Implicit steps after which the next stretch of explicit ones is a short one again.
const SETTLED: usize = 4;

/// A kind of steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    Implicit,
    Stabilised {
        /// Length of the next one \[time\].
        step: f64,
        stage_count: usize,
        stiffness: Stiffness,
    },
    Explicit,
}

/// Which kind of steps pays.
#[derive(Debug)]
pub(crate) struct Pace {
    /// E.
    worth: f64,
    /// Work of the next stretch of explicit steps over E.
    length: usize,
    /// h_x \[time\]; 0 where no explicit step is of use.
    explicit_step: f64,
    /// Length of explicit steps.
    pub(crate) control: ExplicitStep,
    /// For stabilised steps, where they are of use.
    pub(crate) stiffness: Option<Stiffness>,
    /// Implicit steps since the last stretch of explicit ones.
    step_count: usize,
}

impl Pace {
    pub(crate) fn new<const D: usize, L: PairLaw, C: DampingLaw>(motion: &mut ImplicitMotion<D, L, C>) -> Self {
        let worth = WORTH * libm::pow(motion.assembly.mobile_count() as f64, 0.125);
        let explicit_step = if motion.has_masses() { SHARE * motion.stable_step() } else { 0.0 };
        let stiffness = motion.stiffness();
        let mut pace = Pace {
            worth,
            length: STRETCHES.0,
            explicit_step: 0.0,
            control: ExplicitStep::new(SHARE),
            stiffness,
            step_count: 0,
        };
        pace.set_explicit_step(explicit_step);
        pace
    }

    pub(crate) fn set_explicit_step(&mut self, time_step: f64) {
        self.explicit_step = if time_step.is_finite() { time_step } else { 0.0 };
    }

    /// A stretch of explicit steps broke the balance of energies. Whether shorter ones are worth a trial.
    pub(crate) fn shorten(&mut self) -> bool {
        self.control.shorten(0.5);
        self.length = STRETCHES.0;
        self.control.share() > SMALLEST_SHARE
    }

    /// A stretch of explicit steps kept the balance.
    pub(crate) fn kept(&mut self) {
        self.control.lengthen(SHARE_GROWTH, SHARE);
        self.set_explicit_step(self.control.time_step());
    }

    /// E, rounded down.
    pub(crate) fn worth(&self) -> usize {
        self.worth as usize
    }

    /// The kind of least work where errors allow steps of this length \[time\].
    pub(crate) fn kind(&self, time_step: f64) -> Kind {
        let (mut kind, mut rate) = (Kind::Implicit, self.worth / time_step);
        if self.explicit_step > 0.0 && VERLET / self.explicit_step < rate {
            (kind, rate) = (Kind::Explicit, VERLET / self.explicit_step);
        }
        if let Some(stiffness) = self.stiffness {
            let step = time_step.min(stiffness.longest_step());
            let stage_count = stiffness.stage_count(step);
            if (stage_count as f64) < rate * step {
                kind = Kind::Stabilised { step, stage_count, stiffness };
            }
        }
        kind
    }

    /// Whether no stabilised step is longer than this one \[time\].
    pub(crate) fn is_longest(&self, step: f64) -> bool {
        self.stiffness.is_some_and(|stiffness| step >= stiffness.longest_step())
    }

    /// The implicit step to try after a stretch of explicit ones \[time\].
    pub(crate) fn tried(&self) -> f64 {
        TRIED * self.worth / VERLET * self.explicit_step
    }

    /// An implicit step was made.
    pub(crate) fn stepped(&mut self) {
        self.step_count += 1;
        if self.step_count >= SETTLED {
            self.length = STRETCHES.0;
        }
    }

    /// How many explicit steps the next stretch of them has; it begins now.
    pub(crate) fn next_stretch(&mut self) -> usize {
        if self.step_count == 0 {
            self.length = (2 * self.length).min(STRETCHES.1);
        }
        self.step_count = 0;
        ((self.length as f64) * self.worth / VERLET) as usize
    }
}
