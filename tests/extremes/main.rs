//! The stress suite: numbers far beyond what packings are made of. Each case says what is expected of it, a value with a
//! bound or a named outcome. Nothing hangs, overflows unseen, or comes back as NaN.
//!
//! `.ci/run` runs it twice, with the tests' profile and optimised as a release with overflow checks on.

mod command;
#[cfg(feature = "fit")]
mod fits;
mod geometry;
mod inflations;
mod preparations;
mod scales;
#[cfg(feature = "fit")]
#[path = "../scenes/seeds.rs"]
mod seeds;
mod small_systems;
#[path = "../scenes/square_lattice.rs"]
mod square_lattice;

use jamscope::law::PairLaw;
use jamscope::packing::{Domain, Mixture, Packing};
use jamscope::preparation::random_points;
use jamscope::relax::{
    Fire, ForceLimit, NonlinearConjugateGradients, Outcome, Precision, QuasiNewton, Relaxer, RelaxerChoice, StepBack,
    Uphill,
};

/// FIRE with this relative limit and no more than 200 000 steps: a hang would show as the step limit.
fn fire(limit: f64) -> Fire {
    Fire { limit: ForceLimit::Relative(limit), step_limit: 200_000, ..Fire::default() }
}

/// Every relaxer that goes by forces alone and knows no time.
fn relaxers(limit: f64) -> Vec<RelaxerChoice> {
    let (fire, limit) = (fire(limit), ForceLimit::Relative(limit));
    let gradients =
        NonlinearConjugateGradients { limit, step_limit: 200_000, ..NonlinearConjugateGradients::default() };
    let quasi_newton = QuasiNewton { limit, step_limit: 200_000, ..QuasiNewton::default() };
    vec![
        RelaxerChoice::Fire(fire),
        RelaxerChoice::Fire(Fire { uphill: Uphill::StepBack(StepBack::default()), ..fire }),
        RelaxerChoice::Fire(Fire { precision: Precision::Mixed, ..fire }),
        RelaxerChoice::ConjugateGradients(gradients),
        RelaxerChoice::QuasiNewton(quasi_newton),
        #[cfg(feature = "linear")]
        RelaxerChoice::GradientFlow(jamscope::relax::GradientFlow { limit, ..Default::default() }),
    ]
}

fn relax<const D: usize>(packing: Packing<D>, law: &dyn PairLaw, relaxer: &impl Relaxer) -> Outcome<Packing<D>> {
    relaxer.relax(packing, law, &mut ()).expect("no coincidence")
}

fn points(count: usize, packing_fraction: f64, seed: u64) -> Packing<2> {
    random_points::<2>(count, &Mixture::default(), packing_fraction, seed).expect("a possible packing fraction")
}

/// Disks in the open plane, the flagged ones held.
fn open(disks: &[([f64; 2], f64)], held: &[bool]) -> Packing<2> {
    let (positions, radii) = disks.iter().copied().unzip();
    Packing::new(Domain::Open, positions, radii).and_then(|packing| packing.with_held(held.to_vec())).expect("valid")
}

/// Whether every number of a packing is finite.
fn all_finite<const D: usize>(packing: &Packing<D>) -> bool {
    let numbers = packing.positions().iter().chain(packing.corrections()).flatten();
    numbers.copied().all(f64::is_finite)
}
