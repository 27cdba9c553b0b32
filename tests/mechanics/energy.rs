//! No relaxation gains energy: damped motions from the blow of an inflation, energies in the costs, and states that no relaxation can
//! lead to.

use jamscope::inflation::{Boundary, Inflation, inflate_with};
use jamscope::io::read_packing;
use jamscope::law::damping::{ConstantDamping, DampingChoice, ViscoelasticDamping};
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::relax::implicit::Finish;
use jamscope::relax::{
    Check, DampedDynamics, Fire, ForceLimit, GradientFlow, ImplicitDynamics, NonlinearConjugateGradients, Outcome,
    QuasiNewton, Relaxer, RelaxerChoice, Staged, Stop, TimeStep,
};

use crate::scenes::laws::hertzian;

const DAMPINGS: [DampingChoice; 2] = [
    DampingChoice::Constant(ConstantDamping { rate: 500.0 }),
    DampingChoice::Viscoelastic(ViscoelasticDamping { rate: 500.0 }),
];

fn energy(packing: &Packing<2>) -> f64 {
    ContactNetwork::new(packing, &hertzian()).expect("no coincidence").energy()
}

/// A circle at rest whose centre has just grown by 0.1: seed 2001 of 5548 disks.
fn blow(name: &str) -> (f64, Packing<2>) {
    let file = format!("{}/fixtures/lammps/viscoelastic_{name}.before.xyz", env!("CARGO_MANIFEST_DIR"));
    let before = read_packing::<2>(file).expect("a fixture");
    let centre =
        (0..before.len()).find(|&disk| before.positions()[disk] == [0.0; 2]).expect("the centre is the origin");
    assert!(before.held()[centre]);
    let at_rest = energy(&before);
    (at_rest, before.with_radius(centre, 0.6).expect("a positive radius"))
}

/// Total energy at every check, and how the relaxation ended.
fn watched(relaxer: &impl Relaxer, start: Packing<2>) -> (Vec<(f64, f64)>, Outcome<Packing<2>>) {
    let mut energies = Vec::new();
    let mut trace = |check: &Check| energies.push((check.energy, check.kinetic_energy));
    let outcome = relaxer.relax(start, &hertzian(), &mut trace).expect("no coincidence");
    (energies, outcome)
}

/// E + K may rise between two checks by 5 % of K, by as much of what damping took, and by 10⁻⁷ of E: the balance that steps keep.
fn never_gains(energies: &[(f64, f64)]) {
    for two in energies.windows(2) {
        let [(before, moving), (after, moved)] = [two[0], two[1]];
        let gain = after + moved - before - moving;
        assert!(gain <= 0.1 * moving.max(moved) + 2e-7 * before.max(after), "{two:?}");
    }
}

/// The blow of an inflation near jamming, until a thousandth of it is left or less: the front has spread through the circle.
fn gains_no_energy(name: &str, damping: DampingChoice) {
    let (at_rest, start) = blow(name);
    let blown = energy(&start);
    assert!(blown > 100.0 * at_rest);
    let dynamics = ImplicitDynamics { damping, step_limit: 60, finish: Finish::Motion, ..ImplicitDynamics::default() };
    let (energies, outcome) = watched(&dynamics, start.clone());
    assert_eq!(outcome.stop, Stop::StepLimit);
    never_gains(&energies);
    let account = outcome.cost.energies.expect("energies of a motion");
    assert!((account.before / blown - 1.0).abs() < 1e-12, "{account:?}");
    // 5 % of what damping took, and 5 % of the kinetic energy, which is less than the blow.
    assert!(account.imbalance <= 0.1 * blown, "{account:?}");
    let sum = account.after + account.damped + account.left;
    assert!((sum - account.before).abs() <= account.imbalance * (1.0 + 1e-9) + 1e-9 * blown, "{account:?}");
    // The blow is spent, and the packing is still there; once its energy rose a thousandfold, or was lost.
    let after = energy(&outcome.state);
    assert!(after > 0.1 * at_rest && after < 0.01 * blown, "{name}: {after}, at rest {at_rest}");
}

#[test]
#[ignore = "half a minute: CI runs it"]
fn the_blow_of_an_inflation_near_jamming_gains_no_energy() {
    gains_no_energy("p005", DAMPINGS[1]);
}

#[test]
#[ignore = "half a minute: the weekly tier runs it"]
fn the_blow_with_constant_damping_gains_no_energy() {
    gains_no_energy("p005", DAMPINGS[0]);
}

#[test]
#[ignore = "half a minute: the weekly tier runs it"]
fn the_blow_at_a_higher_pressure_gains_no_energy() {
    gains_no_energy("p1", DAMPINGS[1]);
}

#[test]
fn default_explicit_steps_foresee_that_contacts_stiffen() {
    for damping in DAMPINGS {
        let (_, start) = blow("p005");
        let dynamics = DampedDynamics { damping, step_limit: 2000, ..DampedDynamics::default() };
        let (energies, outcome) = watched(&dynamics, start);
        assert_eq!(outcome.stop, Stop::StepLimit);
        never_gains(&energies);
        // Not by steps tried again and again.
        assert!(outcome.cost.rejected_count <= 100, "{:?}", outcome.cost);
    }
}

#[test]
fn an_explicit_step_that_is_always_too_long_is_unstable() {
    let (_, start) = blow("p1");
    let dynamics =
        DampedDynamics { damping: DAMPINGS[1], time_step: TimeStep::Fixed(0.02), ..DampedDynamics::default() };
    let (_, outcome) = watched(&dynamics, start);
    assert!(matches!(outcome.stop, Stop::Unstable | Stop::NonFinite), "{:?}", outcome.stop);
}

fn small_start(name: &str) -> Packing<2> {
    read_packing::<2>(format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR"))).expect("a fixture")
}

#[test]
fn every_relaxer_ends_lower_than_it_began_and_inside_the_rim() {
    let limit = ForceLimit::Relative(1e-8);
    let mut relaxers = vec![
        RelaxerChoice::Fire(Fire { limit, ..Fire::default() }),
        RelaxerChoice::ConjugateGradients(NonlinearConjugateGradients {
            limit,
            ..NonlinearConjugateGradients::default()
        }),
        RelaxerChoice::QuasiNewton(QuasiNewton { limit, ..QuasiNewton::default() }),
        RelaxerChoice::Staged(Staged { limit, ..Staged::default() }),
        RelaxerChoice::GradientFlow(GradientFlow { limit, ..GradientFlow::default() }),
    ];
    relaxers
        .extend(DAMPINGS.map(|damping| {
            RelaxerChoice::Implicit(ImplicitDynamics { damping, limit, ..ImplicitDynamics::default() })
        }));
    let boundary = Boundary::HeldRim { outer_radius_over_side: 0.45 };
    for name in ["hertz_N1000_p005", "hertz_N1000_p1", "hertz_N1000_p100"] {
        for relaxer in relaxers.iter() {
            let inflation = Inflation { boundary, ..Inflation::default() };
            let inflated = inflate_with(&inflation, &small_start(name), &hertzian(), relaxer, 3, &mut ());
            let inflated = inflated.unwrap_or_else(|error| panic!("{name}, {}: {error}", relaxer.name()));
            let account = inflated.after.cost.energies.expect("energies");
            assert!(account.after <= account.before, "{name}, {}: {account:?}", relaxer.name());
            // Summed by blocks, and by contacts.
            assert!((inflated.after.energy - account.after).abs() <= 1e-9 * account.before, "{name}: {account:?}");
            let largest = 0.7;
            for (place, &held) in
                inflated.after.packing.get().positions().iter().zip(inflated.after.packing.get().held())
            {
                assert!(held || place[0].hypot(place[1]) < inflated.outer_radius + 2.0 * largest);
            }
        }
    }
}

#[test]
fn newton_finishes_where_the_motion_leads() {
    // From one trajectory: Newton's method, tried early, and the motion followed until it is a hundredth of a hundredth as fast.
    for (name, damping) in
        [("hertz_N1000_p1", DAMPINGS[1]), ("hertz_N1000_p100", DAMPINGS[1]), ("hertz_N1000_p10", DAMPINGS[0])]
    {
        let end = |finish: Finish| {
            let relaxer = ImplicitDynamics { damping, finish, ..ImplicitDynamics::default() };
            let boundary = Boundary::HeldRim { outer_radius_over_side: 0.45 };
            let inflation = Inflation { boundary, ..Inflation::default() };
            let inflated = inflate_with(&inflation, &small_start(name), &hertzian(), &relaxer, 5, &mut ());
            inflated.unwrap_or_else(|error| panic!("{name}: {error}")).after.energy
        };
        let (early, late) = (end(Finish::default()), end(Finish::Newton(1e-4)));
        // One minimum: energies at rest differ by the square of a residual of 10⁻⁸.
        assert!((early - late).abs() < 1e-10 * late, "{name}: {early} and {late}");
    }
}
