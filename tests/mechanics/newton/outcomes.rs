//! Named ends other than rest at the limit asked for, and the settings in a scene.

use jamscope::law::Hookean;
use jamscope::relax::{Criterion, ForceLimit, Newton, RelaxerChoice, Staged, Stop};
use jamscope::scene::Scene;

use super::{fire, newton, staged};
use crate::scenes::laws::{hertzian, hookean};
use crate::scenes::rest::relax;
use crate::scenes::starts::{cross, inflated, points};

#[test]
fn too_few_factorisations_are_an_outcome_and_the_staged_relaxer_goes_on_without() {
    let (law, start) = (hertzian(), inflated("hertz_N1000_p100", 0));
    let outcome = relax(&Newton { step_limit: 2, ..newton(1e-12) }, start.clone(), &law);
    assert_eq!((outcome.stop, outcome.cost.factorisation_count), (Stop::StepLimit, 2));
    assert!(outcome.converged().is_err());
    let outcome = relax(&Staged { factorisation_limit: 1, ..staged(1e-12) }, start.clone(), &law);
    assert_eq!((outcome.stop, outcome.cost.factorisation_count), (Stop::Converged(Criterion::RelativeForce), 1));
    let outcome = relax(&Staged { step_limit: 7, ..staged(1e-12) }, start, &law);
    assert_eq!((outcome.stop, outcome.cost.step_count), (Stop::StepLimit, 7));
}

#[test]
fn what_is_not_a_number_never_counts_as_at_rest() {
    for stiffness in [f64::NAN, f64::INFINITY, 1e308] {
        for choice in [RelaxerChoice::Newton(newton(1e-8)), RelaxerChoice::Staged(staged(1e-8))] {
            let outcome = relax(&choice, points::<2>(100, 0.9, 13), &Hookean { stiffness });
            assert_eq!(outcome.stop, Stop::NonFinite, "{stiffness}, {}", choice.name());
            assert!(outcome.converged().is_err());
        }
    }
}

#[test]
fn a_loose_packing_is_at_rest_without_forces() {
    for choice in [RelaxerChoice::Newton(newton(1e-8)), RelaxerChoice::Staged(staged(1e-8))] {
        let outcome = relax(&choice, points::<2>(100, 0.7, 10), &hertzian());
        assert_eq!(outcome.stop, Stop::Converged(Criterion::Unjammed), "{}", choice.name());
    }
}

#[test]
fn an_absolute_limit_is_met_in_force() {
    for choice in [
        RelaxerChoice::Newton(Newton { limit: ForceLimit::Absolute(1e-9), ..Newton::default() }),
        RelaxerChoice::Staged(Staged { limit: ForceLimit::Absolute(1e-9), ..Staged::default() }),
    ] {
        let outcome = relax(&choice, inflated("hertz_N1000_p100", 0), &hertzian());
        assert_eq!(outcome.stop, Stop::Converged(Criterion::AbsoluteForce), "{}", choice.name());
        assert!(outcome.residual.largest_net_force <= 1e-9 && outcome.residual.mean_contact_force > 1.0);
    }
}

#[test]
fn a_scene_names_the_relaxers_and_refuses_what_makes_no_sense() {
    let text = r#"{"staged": {"hand_over": 1e-5, "limit": {"relative": 1e-12}}}"#;
    let choice: RelaxerChoice = serde_json::from_str(text).expect("a relaxer");
    assert_eq!(choice, RelaxerChoice::Staged(Staged { hand_over: 1e-5, ..staged(1e-12) }));
    assert!(serde_json::from_str::<RelaxerChoice>(r#"{"newton": {"hand_over": 1e-5}}"#).is_err());
    let mut scene = Scene::default();
    scene.sample[0].relaxer = RelaxerChoice::Newton(Newton { largest_step: -1.0, ..Newton::default() });
    let message = scene.check().expect_err("a negative step").to_string();
    assert_eq!(message, "sample \"unjammed\": relaxer.newton.largest_step = -1: must be a positive number");
    scene.sample[0].relaxer = RelaxerChoice::Staged(Staged { hand_over: f64::NAN, ..Staged::default() });
    assert!(scene.check().expect_err("no number").to_string().contains("relaxer.staged.hand_over = NaN"));
    // Reports of relaxers that factorise nothing have no such number.
    let cost = relax(&fire(1e-8), cross([0.01, 0.0]), &hookean()).cost;
    assert!(!serde_json::to_string(&cost).expect("plain data").contains("factorisation"));
    let cost = relax(&newton(1e-8), cross([0.01, 0.0]), &hookean()).cost;
    assert!(serde_json::to_string(&cost).expect("plain data").contains("\"factorisation_count\":"));
}
