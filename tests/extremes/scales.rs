//! Stiffness constants over forty decades, lengths over a hundred and more.

use jamscope::law::damping::{ConstantDamping, DampingChoice};
use jamscope::law::{Hertzian, Hookean, PairLaw, PowerLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Packing, PackingError};
use jamscope::relax::{Criterion, DampedDynamics, ForceLimit, Relaxer, RelaxerChoice, Stop};

use crate::{all_finite, points, relax, relaxers};

#[test]
fn stiffness_constants_over_forty_decades_give_one_packing() {
    // Only the unit of time changes; 10^±20 is no power of four, so the last bits differ, and the minimum is one.
    let start = points(64, 0.95, 5);
    for relaxer in relaxers(1e-10) {
        let energy = |stiffness: f64| {
            let law = Hertzian { stiffness };
            let outcome = relax(start.clone(), &law, &relaxer);
            assert!(matches!(outcome.stop, Stop::Converged(_)), "{stiffness:e}: {:?}", outcome.stop);
            ContactNetwork::new(&outcome.state, &law).expect("no coincidence").energy() / stiffness
        };
        let reference = energy(2e5);
        for stiffness in [1e-20, 1e-10, 1.0, 1e10, 1e20] {
            let found = energy(stiffness);
            // The energy is flat at the minimum: the square of the limit, and the rounding of 10² terms.
            let off = (found / reference - 1.0).abs();
            assert!(off < 1e-13, "{}, {stiffness:e}: {found}, not {reference}", relaxer.name());
        }
    }
}

/// γ²/k' keeps its value: the same motion in another unit of time, and the same packing.
fn one_packing_with_its_rate_in_the_same_unit<R: Relaxer>(relaxer: impl Fn(DampingChoice) -> R) {
    let start = points(64, 1.0, 5);
    let energy = |stiffness: f64| {
        let law = Hookean { stiffness };
        let rate = 500.0 * (stiffness / 2e5).sqrt();
        let relaxer = relaxer(DampingChoice::Constant(ConstantDamping { rate }));
        let outcome = relaxer.relax(start.clone(), &law, &mut ()).expect("no coincidence");
        assert!(matches!(outcome.stop, Stop::Converged(_)), "{stiffness:e}: {:?}", outcome.stop);
        ContactNetwork::new(&outcome.state, &law).expect("no coincidence").energy() / stiffness
    };
    let reference = energy(2e5);
    for stiffness in [1e-20, 1e20] {
        // Powers of ten are not powers of two: the way differs in its rounding, and ends in the minimum to the limit asked,
        // 10⁻⁹ of a force, whose square is the energy's.
        let found = energy(stiffness);
        assert!((found / reference - 1.0).abs() < 1e-12, "{stiffness:e}: {found}, not {reference}");
    }
}

#[cfg(feature = "linear")]
#[test]
fn implicit_dynamics_does_too_with_its_rate_in_the_same_unit() {
    let limit = ForceLimit::Relative(1e-9);
    one_packing_with_its_rate_in_the_same_unit(|damping| jamscope::relax::ImplicitDynamics {
        damping,
        limit,
        ..Default::default()
    });
}

#[test]
fn damped_dynamics_does_too_with_its_rate_in_the_same_unit() {
    let (limit, step_limit) = (ForceLimit::Relative(1e-9), 2_000_000);
    one_packing_with_its_rate_in_the_same_unit(|damping| DampedDynamics {
        damping,
        limit,
        step_limit,
        ..DampedDynamics::default()
    });
}

/// The points of a packing with all lengths times `unit`.
fn in_unit(packing: &Packing<2>, unit: f64) -> Packing<2> {
    let side = packing.domain().lengths().expect("periodic")[0] * unit;
    let positions = packing.positions().iter().map(|position| position.map(|x| x * unit)).collect();
    Packing::new(Domain::cube(side), positions, packing.radii().iter().map(|r| r * unit).collect()).expect("valid")
}

#[test]
fn lengths_over_two_hundred_decades_give_one_packing() {
    // Squares of lengths and forces k' δ stay within the numbers up to 10^±100.
    let start = points(64, 0.95, 5);
    for relaxer in relaxers(1e-10) {
        let energy = |unit: f64| {
            let law = Hookean { stiffness: 1.0 };
            let outcome = relax(in_unit(&start, unit), &law, &relaxer);
            assert!(matches!(outcome.stop, Stop::Converged(_)), "{}, {unit:e}: {:?}", relaxer.name(), outcome.stop);
            ContactNetwork::new(&outcome.state, &law).expect("no coincidence").energy() / unit / unit
        };
        let reference = energy(1.0);
        for unit in [1e-100, 1e-30, 1e30, 1e100] {
            let found = energy(unit);
            let off = (found / reference - 1.0).abs();
            assert!(off < 1e-13, "{}, {unit:e}: {found}, not {reference}", relaxer.name());
        }
    }
}

#[test]
fn lengths_whose_squares_are_no_numbers_are_refused() {
    for radius in [1e-131, 1e-300, f64::from_bits(1), 1.1e150, 1e300, f64::MAX] {
        let error = Packing::new(Domain::<2>::Open, vec![[0.0; 2]], vec![radius]).expect_err("no such disk");
        assert_eq!(error, PackingError::RadiusOutOfRange { disk: 0, radius });
        assert!(error.to_string().contains(&format!("{radius:e}")), "{error}");
    }
}

#[test]
fn forces_that_overflow_are_said_to() {
    fn check(law: &dyn PairLaw, unit: f64) {
        for relaxer in relaxers(1e-10) {
            let outcome = relax(in_unit(&points(16, 0.95, 5), unit), law, &relaxer);
            assert_eq!(outcome.stop, Stop::NonFinite, "{law:?} in {unit:e}, {}", relaxer.name());
        }
    }
    check(&Hookean { stiffness: 1e308 }, 1e10);
    check(&Hertzian { stiffness: 1e300 }, 1e20);
    check(&PowerLaw { energy_scale: 1e308, exponent: 2.5 }, 1e-20);
    check(&Hookean { stiffness: 1e200 }, 1e100);
}

#[test]
fn forces_too_small_for_their_squares_are_said_to_be() {
    fn check(law: &dyn PairLaw, unit: f64) {
        let mut all = relaxers(1e-10);
        all.push(RelaxerChoice::Damped(DampedDynamics { step_limit: 1000, ..DampedDynamics::default() }));
        #[cfg(feature = "linear")]
        all.extend([
            RelaxerChoice::Newton(jamscope::relax::Newton::default()),
            RelaxerChoice::Staged(jamscope::relax::Staged::default()),
            RelaxerChoice::Implicit(jamscope::relax::ImplicitDynamics::default()),
        ]);
        for relaxer in all {
            let outcome = relax(in_unit(&points(16, 0.95, 5), unit), law, &relaxer);
            let found = (outcome.stop, outcome.cost.step_count);
            assert_eq!(found, (Stop::Underflow, 0), "{law:?} in {unit:e}, {}", relaxer.name());
            // Disks that do not touch are at rest, whatever the law.
            let apart = Packing::new(Domain::cube(4.0 * unit), vec![[unit; 2], [3.0 * unit; 2]], vec![0.5 * unit; 2]);
            let outcome = relax(apart.expect("valid"), law, &relaxer);
            assert_eq!(outcome.stop, Stop::Converged(Criterion::Unjammed), "{law:?} in {unit:e}, {}", relaxer.name());
        }
    }
    check(&Hookean { stiffness: 1e-200 }, 1.0);
    check(&Hookean { stiffness: 1e-320 }, 1.0);
    check(&Hertzian { stiffness: f64::from_bits(1) }, 1.0);
    check(&Hertzian::default(), 1e-120);
    check(&PowerLaw { energy_scale: 1e-160, exponent: 2.5 }, 1.0);
}

#[test]
fn a_very_steep_power_law_still_has_its_minimum() {
    // α = 20: forces over dozens of decades in one packing.
    let law = PowerLaw { energy_scale: 1.0, exponent: 20.0 };
    for relaxer in relaxers(1e-6) {
        let outcome = relax(points(32, 1.2, 5), &law, &relaxer);
        let (stop, residual) = (outcome.stop, outcome.residual);
        assert!(matches!(stop, Stop::Converged(_)), "{}: {stop:?} {residual:?}", relaxer.name());
        assert!(all_finite(&outcome.state));
    }
}
