//! How relaxations end: at rest by each criterion, or with a name for why not.

use super::*;

#[test]
fn too_few_steps_are_an_outcome() {
    let packing = points(100, 0.9, 8);
    let outcome = relax(&Fire { step_limit: 7, ..Fire::default() }, packing.clone(), &hertzian());
    assert_eq!((outcome.stop, outcome.cost.step_count), (Stop::StepLimit, 7));
    let outcome = outcome.converged().expect_err("not at rest");
    assert!(outcome.residual.relative() > 1e-8);
    let outcome = relax(&DampedDynamics { step_limit: 7, ..DampedDynamics::default() }, packing, &hertzian());
    assert_eq!((outcome.stop, outcome.cost.step_count), (Stop::StepLimit, 7));
    assert!(outcome.converged().is_err());
}

#[test]
fn a_limit_of_zero_ends_at_the_rounding_floor() {
    for seed in [1, 2] {
        let outcome = relax(&fire(0.0), points(100, 0.95, seed), &hertzian());
        assert_eq!(outcome.stop, Stop::RoundingFloor);
        let (residual, floor) = (outcome.residual.relative(), outcome.rounding_floor);
        println!("residual {residual:e}, floor {floor:e}");
        // The floor is an estimate from above of a single rounding; what fluctuates there is within a factor of 16 of it.
        assert!(residual > 0.0 && residual <= 16.0 * floor, "{residual:e} and {floor:e}");
        // One number a coordinate would leave about 5 F' ulp(L)/⟨F⟩ ≥ 5 (3/2)/δ·1.8e-15 with δ < 0.1: 1e-13.
        assert!(floor < 3e-14, "floor {floor:e}");
        let network = ContactNetwork::new(&outcome.state, &hertzian()).expect("no coincidence");
        assert!(network.coordination() >= 3.0);
        let again = rounding_floor(&Assembly::new(&outcome.state, &hertzian()).expect("no coincidence"));
        assert!(again <= floor, "new anchors raise the floor: {again:e} from {floor:e}");
    }
}

/// At 10⁶ from the origin a coordinate is rounded to 10⁻¹⁰: forces to 10⁻⁹ of the mean at best, with one number each.
#[test]
fn a_packing_far_from_the_origin_comes_to_rest_all_the_same() {
    let near = points(64, 0.9, 9);
    let far = near.positions().iter().map(|position| position.map(|x| x + 1e6)).collect();
    let packing = Packing::new(*near.domain(), far, near.radii().to_vec()).expect("valid");
    let outcome = relax(&fire(1e-13), packing, &hertzian());
    assert_eq!(outcome.stop, Stop::Converged(Criterion::RelativeForce));
    let network = ContactNetwork::new(&outcome.state, &hertzian()).expect("no coincidence");
    // The residual is computed again from the returned packing, with the rounding errors of its positions.
    let residual = (0..network.backbone.len())
        .filter(|&disk| network.backbone[disk])
        .map(|disk| norm(network.forces()[disk]))
        .fold(0.0, larger);
    assert!(residual <= 2e-13 * network.mean_contact_force(), "{:e}", residual / network.mean_contact_force());
}

#[test]
fn a_loose_packing_is_at_rest_without_forces() {
    for relaxed in [
        relax(&Fire::default(), points(100, 0.7, 10), &hertzian()),
        relax(&Fire::default(), points(100, 0.7, 11), &hertzian()),
    ] {
        assert_eq!(relaxed.stop, Stop::Converged(Criterion::Unjammed));
        let network = ContactNetwork::new(&relaxed.state, &hertzian()).expect("no coincidence");
        // 10⁻¹² of the force at an overlap of one radius, k' √(R/2) R^(3/2) = k' R²/√2.
        assert!(network.largest_net_force() <= 1e-12 * 2e5 * 0.25 / 2f64.sqrt() * (1.0 + 1e-12));
    }
}

#[test]
fn an_absolute_limit_is_met_in_force() {
    let settings = Fire { limit: ForceLimit::Absolute(1e-6), ..Fire::default() };
    let outcome = relax(&settings, points(100, 0.9, 12), &hertzian());
    assert_eq!(outcome.stop, Stop::Converged(Criterion::AbsoluteForce));
    assert!(outcome.residual.largest_net_force <= 1e-6 && outcome.residual.mean_contact_force > 1.0);
}

#[test]
fn what_is_not_a_number_never_counts_as_at_rest() {
    for stiffness in [f64::NAN, f64::INFINITY, 1e308] {
        let law = Hookean { stiffness };
        let outcomes = [
            relax(&Fire { step_limit: 1000, ..Fire::default() }, points(100, 0.9, 13), &law),
            relax(&DampedDynamics { step_limit: 1000, ..DampedDynamics::default() }, points(100, 0.9, 13), &law),
        ];
        for outcome in outcomes {
            assert_eq!(outcome.stop, Stop::NonFinite, "stiffness {stiffness}");
            assert!(outcome.converged().is_err());
        }
    }
}
