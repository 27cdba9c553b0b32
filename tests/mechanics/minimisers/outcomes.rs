//! The rounding floor, named ends, and the settings in a scene.

use jamscope::law::Hookean;
use jamscope::packing::{Domain, Packing, PackingError};
use jamscope::relax::{
    Criterion, Fire, ForceLimit, NonlinearConjugateGradients, QuasiNewton, RelaxerChoice, StepBack, Stop, Uphill,
};
use jamscope::scene::Scene;

use super::{all, gradients, mixed, quasi_newton, step_back};
use crate::scenes::laws::hertzian;
use crate::scenes::rest::{at_rest, relax};
use crate::scenes::starts::{cross, inflated, points};

/// A limit of zero cannot be met: it ends where rounding is all there is.
#[test]
fn a_limit_of_zero_ends_at_the_rounding_floor() {
    for (name, index) in [("hertz_N1000_p1", 0), ("hertz_N1000_p100", 1), ("hertz_N1000_p800", 2)] {
        for choice in all(0.0) {
            let outcome = relax(&choice, inflated(name, index), &hertzian());
            let (residual, floor) = (outcome.residual.relative(), outcome.rounding_floor);
            println!("{name}, {}: {residual:e}, floor {floor:e}, {:?}", choice.name(), outcome.cost);
            assert_eq!(outcome.stop, Stop::RoundingFloor, "{name}, {}", choice.name());
            // The estimate is that of a single rounding from above; what fluctuates there is within a factor of 16 of it.
            assert!(residual > 0.0 && residual <= 16.0 * floor && floor < 3e-14, "{name}: {residual:e} and {floor:e}");
        }
    }
}

#[test]
fn what_is_not_a_number_never_counts_as_at_rest() {
    for stiffness in [f64::NAN, f64::INFINITY, 1e308] {
        for choice in all(1e-8) {
            let outcome = relax(&choice, points::<2>(100, 0.9, 13), &Hookean { stiffness });
            assert_eq!(outcome.stop, Stop::NonFinite, "{stiffness}, {}", choice.name());
            assert!(outcome.converged().is_err());
        }
    }
    // Radii that are none never get as far.
    let error = Packing::new(Domain::<2>::Open, vec![[0.0; 2]], vec![f64::NAN]).expect_err("no disk");
    assert!(matches!(error, PackingError::RadiusOutOfRange { .. }), "{error}");
}

#[test]
fn loose_packings_and_lone_disks_are_at_rest_without_forces() {
    let lone = Packing::new(Domain::<2>::Open, vec![[1.0, 2.0]], vec![0.5]).expect("valid");
    let two = Packing::new(Domain::<2>::Open, vec![[0.0; 2], [0.9, 0.0]], vec![0.5; 2]).expect("valid");
    let held = two.clone().with_held(vec![true; 2]).expect("valid");
    for choice in all(1e-8) {
        let law = hertzian();
        for packing in [points::<2>(100, 0.7, 10), lone.clone(), two.clone()] {
            let outcome = relax(&choice, packing, &law);
            assert_eq!(outcome.stop, Stop::Converged(Criterion::Unjammed), "{}", choice.name());
        }
        // Nothing can move: at rest as it is.
        let outcome = relax(&choice, held.clone(), &law);
        assert_eq!((outcome.state, outcome.cost.step_count), (held.clone(), 0), "{}", choice.name());
    }
}

#[test]
fn limits_are_outcomes() {
    for choice in [
        RelaxerChoice::ConjugateGradients(NonlinearConjugateGradients { step_limit: 7, ..Default::default() }),
        RelaxerChoice::QuasiNewton(QuasiNewton { step_limit: 7, ..QuasiNewton::default() }),
    ] {
        let outcome = relax(&choice, points::<2>(100, 0.9, 8), &hertzian());
        assert_eq!((outcome.stop, outcome.cost.step_count), (Stop::StepLimit, 7), "{}", choice.name());
    }
    for choice in [gradients(ForceLimit::Absolute(1e-9)), quasi_newton(ForceLimit::Absolute(1e-9))] {
        let outcome = relax(&choice, inflated("hertz_N1000_p100", 0), &hertzian());
        assert_eq!(outcome.stop, Stop::Converged(Criterion::AbsoluteForce), "{}", choice.name());
        assert!(outcome.residual.largest_net_force <= 1e-9 && outcome.residual.mean_contact_force > 1.0);
    }
    // FIRE 2.0 gives up after so many steps uphill; none is soon too few.
    let uphill = Uphill::StepBack(StepBack { uphill_limit: 0, ..StepBack::default() });
    let outcome = relax(&Fire { uphill, ..Fire::default() }, inflated("hertz_N1000_p100", 0), &hertzian());
    assert_eq!(outcome.stop, Stop::NoDescent);
    // A memory for all steps there may ever be is as large as the steps there are.
    let endless = QuasiNewton { memory: usize::MAX, ..QuasiNewton::default() };
    let _ = at_rest(relax(&endless, points::<2>(100, 0.95, 8), &hertzian()));
    // Without memory L-BFGS is steepest descent, which is slow but not lost.
    let choice = RelaxerChoice::QuasiNewton(QuasiNewton { memory: 0, ..QuasiNewton::default() });
    let _ = at_rest(relax(&choice, cross([0.02, -0.013]), &hertzian()));
}

#[test]
fn a_scene_names_them_and_refuses_what_makes_no_sense() {
    let read = |text: &str| serde_json::from_str::<RelaxerChoice>(text);
    let choice = read(r#"{"quasi_newton": {"memory": 30, "limit": {"relative": 1e-12}}}"#).expect("a relaxer");
    let limit = ForceLimit::Relative(1e-12);
    assert_eq!(choice, RelaxerChoice::QuasiNewton(QuasiNewton { limit, memory: 30, ..QuasiNewton::default() }));
    assert_eq!((choice.name(), choice.limit()), ("L-BFGS", limit));
    let choice = read(r#"{"conjugate_gradients": {}}"#).expect("a relaxer");
    assert_eq!(choice, RelaxerChoice::ConjugateGradients(NonlinearConjugateGradients::default()));
    assert_eq!(choice.name(), "conjugate gradients");
    assert!(read(r#"{"conjugate_gradients": {"memory": 3}}"#).is_err());
    // FIRE as it was is written as it was; the step back is written and read.
    let text = serde_json::to_string(&RelaxerChoice::default()).expect("plain data");
    assert!(!text.contains("uphill"), "{text}");
    assert_eq!(read(&text).expect("a relaxer"), RelaxerChoice::default());
    assert_eq!(read(r#"{"fire": {"uphill": "restart"}}"#).expect("a relaxer"), RelaxerChoice::default());
    let back = step_back(ForceLimit::default());
    assert_eq!(read(&serde_json::to_string(&back).expect("plain data")).expect("a relaxer"), back);
    assert_eq!(read(r#"{"fire": {"uphill": {"step_back": {}}}}"#).expect("a relaxer"), back);

    // So is the precision.
    assert!(!text.contains("precision"), "{text}");
    let choice = mixed(ForceLimit::default());
    assert_eq!(read(&serde_json::to_string(&choice).expect("plain data")).expect("a relaxer"), choice);
    assert_eq!(read(r#"{"fire": {"precision": "mixed"}}"#).expect("a relaxer"), choice);
    assert_eq!(choice.name(), "FIRE, mixed");
    let error = read(r#"{"fire": {"precision": "single"}}"#).expect_err("there is none").to_string();
    assert!(error.contains("`single`") && error.contains("`mixed`"), "{error}");

    let refused = |relaxer: RelaxerChoice| {
        let mut scene = Scene::default();
        scene.sample[0].relaxer = relaxer;
        scene.check().expect_err("nonsense").to_string()
    };
    let message = refused(RelaxerChoice::QuasiNewton(QuasiNewton { largest_step: f64::NAN, ..QuasiNewton::default() }));
    assert!(message.contains("relaxer.quasi_newton.largest_step = NaN"), "{message}");
    let message = refused(RelaxerChoice::QuasiNewton(QuasiNewton { memory: usize::MAX, ..QuasiNewton::default() }));
    assert!(message.contains("relaxer.quasi_newton.memory"), "{message}");
    let message = refused(RelaxerChoice::ConjugateGradients(NonlinearConjugateGradients {
        flatness: 1.0,
        ..NonlinearConjugateGradients::default()
    }));
    assert!(message.contains("relaxer.conjugate_gradients.flatness = 1"), "{message}");
}
