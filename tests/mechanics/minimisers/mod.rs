//! Nonlinear conjugate gradients, L-BFGS, FIRE's step back and its steps in single precision: closed forms, the energy on the way, invariances, agreement
//! with the other relaxers, the rounding floor, named ends, and the work of fixed scenes.

mod agreement;
mod closed_forms;
mod descent;
mod outcomes;
mod precision;
mod work;

use jamscope::relax::{
    Fire, ForceLimit, NonlinearConjugateGradients, Precision, QuasiNewton, RelaxerChoice, StepBack, Uphill,
};

fn gradients(limit: ForceLimit) -> RelaxerChoice {
    RelaxerChoice::ConjugateGradients(NonlinearConjugateGradients { limit, ..NonlinearConjugateGradients::default() })
}

fn quasi_newton(limit: ForceLimit) -> RelaxerChoice {
    RelaxerChoice::QuasiNewton(QuasiNewton { limit, ..QuasiNewton::default() })
}

fn step_back(limit: ForceLimit) -> RelaxerChoice {
    RelaxerChoice::Fire(Fire { limit, uphill: Uphill::StepBack(StepBack::default()), ..Fire::default() })
}

fn mixed(limit: ForceLimit) -> RelaxerChoice {
    RelaxerChoice::Fire(Fire { limit, precision: Precision::Mixed, ..Fire::default() })
}

/// The two that go along directions.
fn minimisers(limit: f64) -> [RelaxerChoice; 2] {
    [gradients(ForceLimit::Relative(limit)), quasi_newton(ForceLimit::Relative(limit))]
}

/// All that these tests are about.
fn all(limit: f64) -> [RelaxerChoice; 4] {
    let limit = ForceLimit::Relative(limit);
    [gradients(limit), quasi_newton(limit), step_back(limit), mixed(limit)]
}
