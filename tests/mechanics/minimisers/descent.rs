//! The way down: the energy only falls, no step is too long.

use jamscope::law::PairLaw;
use jamscope::packing::{Domain, Packing};
use jamscope::relax::{
    Check, Fire, ForceLimit, NonlinearConjugateGradients, QuasiNewton, Relaxer, RelaxerChoice, Stop,
};
use jamscope::vector::norm;

use super::{minimisers, mixed, step_back};
use crate::claims::only_falls::only_falls;
use crate::scenes::laws::{hertzian, hookean};
use crate::scenes::rest::relax;
use crate::scenes::starts::{inflated, points};

#[test]
fn the_energy_never_increases() {
    fn check<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw) {
        for choice in minimisers(1e-10) {
            let mut checks = Vec::new();
            let trace = &mut |check: &Check| checks.push(*check);
            let outcome = choice.relax(packing.clone(), law, trace).expect("no coincidence");
            assert!(matches!(outcome.stop, Stop::Converged(_)), "{law:?}, {}: {:?}", choice.name(), outcome.stop);
            only_falls(&checks, 10.0, &format!("{law:?}, {}", choice.name()));
        }
    }
    for seed in [1, 2, 3] {
        for fraction in [0.86, 0.95, 1.2] {
            check(&points::<2>(100, fraction, seed), &hertzian());
            check(&points::<2>(100, fraction, seed), &hookean());
        }
        check(&points::<3>(60, 0.9, seed), &hertzian());
        check(&inflated("hertz_N1000_p1", seed as usize), &hertzian());
    }
}

/// With half steps back, and in single precision, FIRE still starts again only where it is not higher than before.
#[test]
fn energies_at_the_restarts_of_fire_never_increase_either_way() {
    let limit = ForceLimit::Relative(1e-8);
    for (time_step_fraction, choice) in
        [(1.0, step_back(limit)), (1.9, step_back(limit)), (1.0, mixed(limit)), (1.9, mixed(limit))]
    {
        let RelaxerChoice::Fire(fire) = choice else { unreachable!("it is FIRE") };
        let fire = Fire { time_step_fraction, step_limit: 20_000, ..fire };
        let mut checks: Vec<Check> = Vec::new();
        let trace = &mut |check: &Check| checks.push(*check);
        let _ = fire.relax(points::<2>(200, 0.9, 1), &hertzian(), trace).expect("no coincidence");
        let restarts: Vec<f64> = checks.iter().filter(|check| check.restart).map(|check| check.energy).collect();
        assert!(restarts.len() > 3, "{} restarts", restarts.len());
        assert!(restarts.is_sorted_by(|&before, &after| after <= before * (1.0 + 1e-13)), "{restarts:?}");
    }
}

/// No disk moves farther in a step than it may: not even out of a heap of disks at nearly one point.
#[test]
fn no_step_is_longer_than_a_share_of_a_radius() {
    let packing = Packing::new(Domain::<2>::Open, vec![[0.0; 2], [1e-9, 0.0]], vec![0.5, 0.7]).expect("valid");
    for choice in minimisers(1e-8) {
        for step_limit in [1, 2] {
            let limited = match choice {
                RelaxerChoice::ConjugateGradients(it) => {
                    RelaxerChoice::ConjugateGradients(NonlinearConjugateGradients { step_limit, ..it })
                }
                RelaxerChoice::QuasiNewton(it) => RelaxerChoice::QuasiNewton(QuasiNewton { step_limit, ..it }),
                other => other,
            };
            let outcome = relax(&limited, packing.clone(), &hertzian());
            let way = norm(outcome.state.separation(0, 1));
            // Both move alike, the smaller one by a tenth of 1/2 at most.
            assert!(way <= 0.1 * step_limit as f64 * (1.0 + 1e-12) + 1e-9, "{}: {way}", choice.name());
        }
    }
}
