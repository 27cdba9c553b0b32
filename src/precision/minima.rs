//! [`Minimum`]: the minima in which runs from one start end. Two of them are references found by different methods.

use serde::Serialize;

use crate::inflation::Grown;
use crate::law::damping::DampingChoice;
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::precision::state::{Errors, Measured, State};
use crate::relax::implicit::Finish;
use crate::relax::{
    Criterion, ForceLimit, GradientFlow, ImplicitDynamics, Outcome, QuasiNewton, RelaxerChoice, Staged, Stop,
};
use crate::scene::Observables;

/// Largest distance between two states of one minimum \[length\]. Different minima are much farther apart; states
/// relaxed to rounding are much closer.
pub const SAME: f64 = 1e-6;

/// Tolerance of the implicit dynamics for the first reference.
const REFERENCE_TOLERANCE: f64 = 1e-3;

/// One minimum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Minimum {
    /// A and B for the references, then letters in the order of discovery.
    pub label: String,
    /// The method that found it.
    pub found_by: String,
    /// Distance from the nearest reference, 0 for a reference \[length\].
    pub distance: f64,
    /// Relative residual \[1\].
    pub residual: f64,
    /// Why its relaxation stopped.
    pub stop: Stop,
    /// Its numbers.
    pub measured: Measured,
}

/// Comparison of the two references.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Disagreement {
    /// Methods of the references, A then B.
    pub methods: [&'static str; 2],
    /// Relative residuals reached \[1\].
    pub residuals: [f64; 2],
    /// Whether they are in the same minimum.
    pub same_minimum: bool,
    /// Errors of B relative to A.
    pub errors: Errors,
}

/// The minima found so far, with the data to recognise a new one.
pub(super) struct Minima<'a, const D: usize> {
    grown: &'a Grown<D>,
    law: &'a dyn PairLaw,
    observables: &'a Observables,
    states: Vec<State<D>>,
    /// In the order of the states.
    pub known: Vec<Minimum>,
    pub disagreement: Disagreement,
    reference_count: usize,
}

impl<'a, const D: usize> Minima<'a, D> {
    /// Computes both references.
    pub fn new(
        grown: &'a Grown<D>,
        law: &'a dyn PairLaw,
        observables: &'a Observables,
        damping: DampingChoice,
        limit: f64,
    ) -> Result<Self, PackingError> {
        let limit = ForceLimit::Relative(limit);
        let staged = RelaxerChoice::Staged(Staged { limit, ..Staged::default() });
        // No disk is pressed: the motion would continue for a long time without a result.
        let (methods, relaxers) = if grown.before.criterion == Criterion::Unjammed {
            let quasi_newton = QuasiNewton { limit, ..QuasiNewton::default() };
            (["L-BFGS", "FIRE, then Newton"], [RelaxerChoice::QuasiNewton(quasi_newton), staged])
        } else {
            let dynamics =
                ImplicitDynamics { limit, damping, tolerance: REFERENCE_TOLERANCE, ..ImplicitDynamics::default() };
            let name = "implicit dynamics at tolerance 10⁻³, finished by Newton";
            ([name, "FIRE, then Newton"], [RelaxerChoice::Implicit(dynamics), staged])
        };
        let relax = |relaxer: &RelaxerChoice| {
            let outcome = grown.relax(grown.packing.clone(), law, relaxer, &mut ())?;
            End::new(outcome, grown, law, observables)
        };
        let (mut first, second) = (relax(&relaxers[0])?, relax(&relaxers[1])?);
        let mut methods = methods;
        if !matches!(first.stop, Stop::Converged(_) | Stop::RoundingFloor) {
            // A reference must be at rest. Steepest descent always comes to rest.
            let flow = GradientFlow { limit, ..GradientFlow::default() };
            first = relax(&RelaxerChoice::GradientFlow(flow))?;
            methods[0] = "gradient flow, finished by Newton (implicit dynamics did not come to rest)";
        }
        let errors = second.state.errors(&first.state);
        let same_minimum = errors.displacement <= SAME;
        let residuals = [first.residual, second.residual];
        let disagreement = Disagreement { methods, residuals, same_minimum, errors };
        let mut minima =
            Minima { grown, law, observables, states: Vec::new(), known: Vec::new(), disagreement, reference_count: 0 };
        let found_by = if same_minimum { "both references" } else { methods[0] };
        minima.add(first, found_by, 0.0);
        if !same_minimum {
            minima.add(second, methods[1], 0.0);
        }
        minima.reference_count = minima.states.len();
        Ok(minima)
    }

    /// The first reference.
    pub fn first(&self) -> &State<D> {
        &self.states[0]
    }

    /// The minimum of a state: where gradient flow from it ends. A new minimum is added.
    ///
    /// In an unjammed packing no disk has a fixed position: states are compared with the nearest reference.
    pub fn of(&mut self, state: &State<D>, found_by: &str) -> Result<usize, PackingError> {
        let (nearest, distance) = self.nearest(state, self.states.len());
        if distance <= SAME {
            return Ok(nearest);
        }
        if state.is_unjammed() {
            return Ok(self.nearest(state, self.reference_count).0);
        }
        let flow = GradientFlow {
            limit: ForceLimit::Relative(FLOW_LIMIT),
            tolerance: FLOW_TOLERANCE,
            finish: Finish::Newton(FLOW_HAND_OVER),
            ..GradientFlow::default()
        };
        let outcome = self.grown.relax(state.packing.clone(), self.law, &flow, &mut ())?;
        let end = End::new(outcome, self.grown, self.law, self.observables)?;
        let (nearest, distance) = self.nearest(&end.state, self.states.len());
        if distance <= SAME {
            return Ok(nearest);
        }
        let distance = self.nearest(&end.state, self.reference_count).1;
        self.add(end, found_by, distance);
        Ok(self.states.len() - 1)
    }

    /// The errors of a state relative to a minimum.
    pub fn errors(&self, state: &State<D>, minimum: usize) -> Errors {
        state.errors(&self.states[minimum])
    }

    /// The nearest of the first `count` states, and its distance.
    fn nearest(&self, state: &State<D>, count: usize) -> (usize, f64) {
        let distances = self.states[..count].iter().map(|other| state.distance(other)).enumerate();
        distances.min_by(|a, b| a.1.total_cmp(&b.1)).expect("there is at least one reference")
    }

    fn add(&mut self, end: End<D>, found_by: &str, distance: f64) {
        self.known.push(Minimum {
            label: label(self.known.len()),
            found_by: found_by.into(),
            distance,
            residual: end.residual,
            stop: end.stop,
            measured: end.state.measured,
        });
        self.states.push(end.state);
    }
}

/// Force limit of the gradient flow that identifies minima \[1\].
const FLOW_LIMIT: f64 = 1e-12;

/// Its tolerance \[1\]: displacements from a nearly relaxed state are small.
const FLOW_TOLERANCE: f64 = 0.1;

/// Residual at which Newton's method takes over \[1\].
const FLOW_HAND_OVER: f64 = 1e-4;

/// A, B, …, Z, A1, B1, …
fn label(index: usize) -> String {
    let letter = char::from(b'A' + (index % 26) as u8);
    if index < 26 { letter.into() } else { format!("{letter}{}", index / 26) }
}

/// The end of a relaxation.
pub(super) struct End<const D: usize> {
    pub state: State<D>,
    pub stop: Stop,
    pub residual: f64,
}

impl<const D: usize> End<D> {
    pub fn new(
        outcome: Outcome<Packing<D>>,
        grown: &Grown<D>,
        law: &dyn PairLaw,
        observables: &Observables,
    ) -> Result<Self, PackingError> {
        let criterion: Option<Criterion> = match outcome.stop {
            Stop::Converged(criterion) => Some(criterion),
            _ => None,
        };
        let (stop, residual) = (outcome.stop, outcome.residual.relative());
        Ok(End { state: State::new(outcome.state, criterion, grown, law, observables)?, stop, residual })
    }
}
