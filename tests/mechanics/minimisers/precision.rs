//! Steps of FIRE in single precision: the state it leaves, and how far it goes.

use jamscope::law::{OnSite, PairLaw};
use jamscope::packing::Packing;
use jamscope::relax::{Criterion, Fire, ForceLimit, Outcome, Precision, Stop};

use crate::scenes::laws::{hertzian, hookean};
use crate::scenes::rest::{apart, at_rest, relax};
use crate::scenes::starts::{inflated, points};

fn fire(precision: Precision, limit: f64) -> Fire {
    Fire { precision, limit: ForceLimit::Relative(limit), ..Fire::default() }
}

/// Wherever it is stopped, the residual is that of the state, in double precision.
#[test]
fn a_relaxation_cut_short_tells_the_residual_where_it_is() {
    let mut before = None;
    for step_limit in [1, 7, 79, 80, 81, 333] {
        let cut = |packing: Packing<2>, step_limit| -> Outcome<Packing<2>> {
            relax(&Fire { step_limit, ..fire(Precision::Mixed, 1e-10) }, packing, &hertzian())
        };
        let outcome = cut(inflated("hertz_N1000_p10", 2), step_limit);
        assert_eq!((outcome.stop, outcome.cost.step_count), (Stop::StepLimit, step_limit));
        assert!(before.as_ref() != Some(&outcome.state), "{step_limit}: the last steps are in the state as well");
        let again = cut(outcome.state.clone(), 0);
        let [one, two] = [&outcome, &again].map(|outcome| outcome.residual.largest_net_force);
        // Sums of the same forces, known to 10⁻¹⁵ of a contact force each, in another order.
        let scale = outcome.residual.mean_contact_force;
        assert!((one - two).abs() <= 1e-12 * scale, "{step_limit}: {one} and {two}, mean force {scale}");
        before = Some(outcome.state);
    }
}

/// Down to 10⁻⁶ nothing but single precision is needed, and no more steps than in double; below, it ends at the same
/// limits.
#[test]
fn as_few_steps_as_in_double_precision() {
    for (limit, name) in [(1e-5, "hertz_N1000_p10"), (1e-12, "hertz_N1000_p10"), (1e-12, "hertz_N1000_p800")] {
        let (mut double, mut mixed) = (0, 0);
        for index in 0..6 {
            let steps = |precision| {
                let outcome = relax(&fire(precision, limit), inflated(name, index), &hertzian());
                assert_eq!(outcome.stop, Stop::Converged(Criterion::RelativeForce), "{precision:?}, {name} {index}");
                outcome.cost.step_count
            };
            double += steps(Precision::Double);
            mixed += steps(Precision::Mixed);
        }
        println!("{name} to {limit:e}: {double} steps in double precision, {mixed} mixed");
        // Ways of their own from the first contact that opens in another step: within a third over six inflations.
        assert!(3 * double.abs_diff(mixed) <= double, "{name} to {limit:e}: {double} and {mixed}");
    }
}

/// From random points as well, loose and dense, and to the same end where only one is near.
#[test]
fn random_points_come_to_rest() {
    fn check(law: &dyn PairLaw) {
        for fraction in [0.5, 0.84, 0.9, 1.3] {
            for seed in 0..4 {
                let outcome = relax(&fire(Precision::Mixed, 1e-12), points::<2>(200, fraction, seed), law);
                assert!(matches!(outcome.stop, Stop::Converged(_)), "{law:?} {fraction} {seed}: {:?}", outcome.stop);
            }
        }
        let near = at_rest(relax(&fire(Precision::Double, 1e-12), inflated("hertz_N1000_p800", 4), law));
        let other = at_rest(relax(&fire(Precision::Mixed, 1e-12), inflated("hertz_N1000_p800", 4), law));
        // As in the comparison with Newton's method.
        assert!(apart(&near, &other, law) <= 1e-9, "{law:?}");
    }
    check(&hertzian());
    check(&hookean());
}

/// Newton's method takes over from steps in single precision and ends where FIRE in double does.
#[test]
#[cfg(feature = "linear")]
fn the_staged_relaxer_makes_them_too() {
    use jamscope::relax::Staged;
    let (law, limit) = (hertzian(), ForceLimit::Relative(1e-12));
    let staged = |precision| Staged { limit, precision, ..Staged::default() };
    let outcome = relax(&staged(Precision::Mixed), inflated("hertz_N1000_p800", 4), &law);
    assert_eq!(outcome.stop, Stop::Converged(Criterion::RelativeForce));
    let double = relax(&staged(Precision::Double), inflated("hertz_N1000_p800", 4), &law);
    let cost = |outcome: &Outcome<Packing<2>>| (outcome.cost.step_count, outcome.cost.factorisation_count);
    println!("mixed {:?}, double {:?}", cost(&outcome), cost(&double));
    assert!(outcome.cost.factorisation_count <= double.cost.factorisation_count + 2);
    assert!(apart(&at_rest(double), &at_rest(outcome), &law) <= 1e-9);
}

/// Sites are for double precision alone: the same bits.
#[test]
fn disks_with_sites_are_left_in_double_precision() {
    let law = OnSite { law: hertzian(), coupling: -0.5 };
    let [one, two] = [Precision::Double, Precision::Mixed]
        .map(|precision| relax(&fire(precision, 1e-8), inflated("hertz_N1000_p100", 3), &law));
    assert_eq!((one.state, one.cost.step_count), (two.state, two.cost.step_count));
}
