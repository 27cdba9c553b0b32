//! [`MethodSelection`]: the method of the next phase of a motion.
//!
//! ```text
//! method        work per unit of time                        limit
//! implicit      E/h
//! stabilised    s(h)/h                                       h ≤ 2.25/ρ
//! explicit      V/h_x                                        h_x = 0.9 of the stability bound of a Verlet step
//! ```
//!
//! h is the step that the allowed error permits, s(h) the number of stages of a stabilised step, see
//! [`super::rkc::coefficients`]. Work is counted in evaluations of all forces. An implicit step takes the time of E
//! evaluations, a Verlet step that of V. The method with the least work per time is selected. While many disks collide,
//! errors of opening and closing contacts keep h short. Then the stabilised method is cheapest, or the explicit one if
//! oscillations are weakly damped. After a phase of explicit steps an implicit step of 2 E h_x/V is tried. If it fails
//! at once, the next phase is twice as long.

use crate::relax::dynamics::explicit_step::ExplicitStep;
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::relax::dynamics::implicit::rkc::coefficients::Stiffness;

/// E over n^(1/8), for n mobile disks.
const IMPLICIT_COST: f64 = 34.0;

/// V.
const VERLET_COST: f64 = 1.8;

/// Explicit step over its stability bound: about half of the longest stable step, see
/// [`TimeStep`](crate::relax::TimeStep).
pub(crate) const SHARE: f64 = 0.9;

/// The implicit step tried after explicit ones, over the shortest one that is cheaper.
const TRIAL_RATIO: f64 = 2.0;

/// Work of the shortest and of the longest phase of explicit steps over E.
const PHASE_COSTS: (usize, usize) = (2, 64);

/// Fraction of the bound below which explicit steps that violate the energy balance are not shortened further.
const SMALLEST_SHARE: f64 = 1e-3;

/// Growth factor of that fraction after a phase that kept the balance.
const SHARE_GROWTH: f64 = 1.2;

/// Number of implicit steps after which the next explicit phase is short again.
const SETTLED_STEPS: usize = 4;

/// A method of integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Method {
    Implicit,
    Rkc {
        /// Length of the next step \[time\].
        step: f64,
        stage_count: usize,
        stiffness: Stiffness,
    },
    Explicit,
}

/// Selects the cheapest method.
#[derive(Debug)]
pub(crate) struct MethodSelection {
    /// E.
    implicit_cost: f64,
    /// Work of the next phase of explicit steps over E.
    phase_cost: usize,
    /// h_x \[time\]; 0 if explicit steps are not applicable.
    explicit_step: f64,
    /// Length of explicit steps.
    pub(crate) control: ExplicitStep,
    /// Stiffness for stabilised steps, if they are applicable.
    pub(crate) stiffness: Option<Stiffness>,
    /// Implicit steps since the last phase of explicit ones.
    step_count: usize,
}

impl MethodSelection {
    pub(crate) fn new<const D: usize>(motion: &mut ImplicitMotion<D>) -> Self {
        let implicit_cost = IMPLICIT_COST * libm::pow(motion.assembly.mobile_count() as f64, 0.125);
        let explicit_step = if motion.has_masses() { SHARE * motion.stable_step() } else { 0.0 };
        let stiffness = motion.stiffness();
        let mut selection = MethodSelection {
            implicit_cost,
            phase_cost: PHASE_COSTS.0,
            explicit_step: 0.0,
            control: ExplicitStep::new(SHARE),
            stiffness,
            step_count: 0,
        };
        selection.set_explicit_step(explicit_step);
        selection
    }

    pub(crate) fn set_explicit_step(&mut self, time_step: f64) {
        self.explicit_step = if time_step.is_finite() { time_step } else { 0.0 };
    }

    /// To be called after an explicit phase that violated the energy balance. Returns whether a trial of shorter steps
    /// is useful.
    pub(crate) fn shorten(&mut self) -> bool {
        self.control.shorten(0.5);
        self.phase_cost = PHASE_COSTS.0;
        self.control.share() > SMALLEST_SHARE
    }

    /// To be called after an explicit phase that kept the energy balance.
    pub(crate) fn after_balanced_phase(&mut self) {
        self.control.lengthen(SHARE_GROWTH, SHARE);
        self.set_explicit_step(self.control.time_step());
    }

    /// E, rounded down.
    pub(crate) fn implicit_cost(&self) -> usize {
        self.implicit_cost as usize
    }

    /// The method of least work, if the allowed error permits steps of this length \[time\].
    pub(crate) fn method(&self, time_step: f64) -> Method {
        let (mut method, mut rate) = (Method::Implicit, self.implicit_cost / time_step);
        if self.explicit_step > 0.0 && VERLET_COST / self.explicit_step < rate {
            (method, rate) = (Method::Explicit, VERLET_COST / self.explicit_step);
        }
        if let Some(stiffness) = self.stiffness {
            let step = time_step.min(stiffness.longest_step());
            let stage_count = stiffness.stage_count(step);
            if (stage_count as f64) < rate * step {
                method = Method::Rkc { step, stage_count, stiffness };
            }
        }
        method
    }

    /// Whether no stabilised step is longer than this one \[time\].
    pub(crate) fn is_longest(&self, step: f64) -> bool {
        self.stiffness.is_some_and(|stiffness| step >= stiffness.longest_step())
    }

    /// The implicit step to try after a phase of explicit ones \[time\].
    pub(crate) fn trial_step(&self) -> f64 {
        TRIAL_RATIO * self.implicit_cost / VERLET_COST * self.explicit_step
    }

    /// To be called after an implicit step.
    pub(crate) fn after_implicit_step(&mut self) {
        self.step_count += 1;
        if self.step_count >= SETTLED_STEPS {
            self.phase_cost = PHASE_COSTS.0;
        }
    }

    /// Starts an explicit phase. Returns its number of steps.
    pub(crate) fn next_phase(&mut self) -> usize {
        if self.step_count == 0 {
            self.phase_cost = (2 * self.phase_cost).min(PHASE_COSTS.1);
        }
        self.step_count = 0;
        ((self.phase_cost as f64) * self.implicit_cost / VERLET_COST) as usize
    }
}
