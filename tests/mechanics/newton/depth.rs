//! How deep the relaxers get, and with how many factorisations.

use jamscope::law::{PairLaw, PowerLaw};
use jamscope::network::ContactNetwork;
use jamscope::relax::{Criterion, Stop};
use jamscope::vector::{larger, norm};

use super::{fire, newton, staged};
use crate::scenes::laws::{hertzian, hookean};
use crate::scenes::rest::{at_rest, relax};
use crate::scenes::starts::{inflated, points};

/// A limit of zero cannot be met: it ends where rounding is all there is, as deep as FIRE gets.
#[test]
fn a_limit_of_zero_ends_at_the_rounding_floor() {
    for (name, index) in [("hertz_N1000_p1", 0), ("hertz_N1000_p100", 1), ("hertz_N1000_p800", 2)] {
        let law = hertzian();
        let start = at_rest(relax(&staged(1e-10), inflated(name, index), &law));
        let ours = relax(&newton(0.0), start.clone(), &law);
        let theirs = relax(&fire(0.0), start, &law);
        assert_eq!((ours.stop, theirs.stop), (Stop::RoundingFloor, Stop::RoundingFloor), "{name}");
        let (residual, floor) = (ours.residual.relative(), ours.rounding_floor);
        println!("{name}: {residual:e}, floor {floor:e}, FIRE {:e}, {:?}", theirs.residual.relative(), ours.cost);
        // The estimate is that of a single rounding from above; what fluctuates there is within a factor of 16 of it.
        assert!(residual > 0.0 && residual <= 16.0 * floor && floor < 3e-14, "{name}: {residual:e} and {floor:e}");
        assert!(residual <= 4.0 * theirs.residual.relative(), "{name}: {residual:e}, FIRE {:?}", theirs.residual);
    }
}

/// The work of inflated packings after FIRE's stage, and how deep they get.
#[test]
fn inflated_packings_come_to_rest_at_rounding_with_few_factorisations() {
    fn check(law: &dyn PairLaw, name: &str, most: usize) {
        for index in [0, 1, 2] {
            let outcome = relax(&staged(1e-12), inflated(name, index), law);
            let (made, residual) = (outcome.cost.factorisation_count, outcome.residual.relative());
            println!("{name}: {:?}, residual {residual:e}, {:?}", outcome.stop, outcome.cost);
            assert_eq!(outcome.stop, Stop::Converged(Criterion::RelativeForce), "{name}, {index}");
            assert!(made > 0 && made <= most, "{name}, {index}: {made} factorisations");
            // The residual is computed again from the returned packing, which has anchors of its own.
            let network = ContactNetwork::new(&outcome.state, law).expect("no coincidence");
            let (held, backbone) = (outcome.state.held(), &network.backbone);
            let largest = (0..outcome.state.len())
                .filter(|&disk| backbone[disk] && !held[disk])
                .map(|disk| norm(network.forces()[disk]))
                .fold(0.0, larger);
            let anew = largest / network.mean_contact_force();
            assert!(anew <= 1e-12 + 2.0 * outcome.rounding_floor, "{name}, {index}: {anew:e} anew");
        }
    }
    check(&hertzian(), "hertz_N1000_p005", 60);
    check(&hertzian(), "hertz_N1000_p1", 60);
    check(&hertzian(), "hertz_N1000_p10", 60);
    check(&hertzian(), "hertz_N1000_p100", 12);
    check(&hertzian(), "hertz_N1000_p800", 12);
    check(&hertzian(), "hertz_N5548_p100", 12);
    check(&hookean(), "hooke_N1000_p100", 12);
    check(&hookean(), "hooke_N1000_p800", 12);
    check(&hookean(), "hooke_N1000_p5000", 12);
}

#[test]
fn random_points_come_to_rest_at_rounding() {
    fn check<const D: usize>(law: &dyn PairLaw, count: usize, fraction: f64) {
        for seed in [1, 2] {
            let outcome = relax(&staged(1e-12), points::<D>(count, fraction, seed), law);
            println!(
                "{D}, {law:?}, {fraction}: {:?}, {:e}, {:?}",
                outcome.stop,
                outcome.residual.relative(),
                outcome.cost
            );
            assert_eq!(outcome.stop, Stop::Converged(Criterion::RelativeForce), "{D}, {law:?}, {fraction}, {seed}");
            assert!(outcome.cost.factorisation_count > 0);
        }
    }
    check::<2>(&hertzian(), 400, 0.86);
    check::<2>(&hertzian(), 400, 1.0);
    check::<2>(&hookean(), 400, 0.9);
    check::<2>(&PowerLaw { energy_scale: 1e5, exponent: 3.0 }, 400, 0.95);
    check::<3>(&hertzian(), 200, 0.8);
    check::<3>(&hookean(), 200, 0.75);
}
