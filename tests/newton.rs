//! Newton's method and the staged relaxer: closed forms, the energy on the way, invariances, agreement with the other
//! relaxers, the rounding floor, named ends, and the work of fixed scenes.
//!
//! Random cases come from proptest with a fixed seed, so every run sees the same ones; a failure prints its case.

use jamscope::contact::{
    Assembly, ContactNetwork, Hertzian, Hessian, Hookean, Members, OnSite, PairLaw, PowerLaw, Prestress,
};
use jamscope::inflation::Circle;
use jamscope::io::read_packing;
use jamscope::linear::Analysis;
use jamscope::packing::{Domain, Mixture, Packing};
use jamscope::preparation::random_points;
use jamscope::relax::{
    Criterion, DampedDynamics, Fire, ForceLimit, Look, Newton, Outcome, Relaxer, RelaxerChoice, Staged, Stop,
};
use jamscope::scene::Scene;
use jamscope::vector::{Vector, difference, norm, scaled, sum};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn newton(limit: f64) -> Newton {
    Newton { limit: ForceLimit::Relative(limit), ..Newton::default() }
}

fn staged(limit: f64) -> Staged {
    Staged { limit: ForceLimit::Relative(limit), ..Staged::default() }
}

fn fire(limit: f64) -> Fire {
    Fire { limit: ForceLimit::Relative(limit), ..Fire::default() }
}

fn points<const D: usize>(count: usize, packing_fraction: f64, seed: u64) -> Packing<D> {
    random_points::<D>(count, &Mixture::default(), packing_fraction, seed).expect("a possible packing fraction")
}

fn relax<const D: usize, L: PairLaw>(relaxer: &impl Relaxer, packing: Packing<D>, law: &L) -> Outcome<Packing<D>> {
    relaxer.relax(packing, law, &mut ()).expect("no coincidence")
}

fn at_rest<const D: usize>(outcome: Outcome<Packing<D>>) -> Packing<D> {
    let (stop, residual) = (outcome.stop, outcome.residual.relative());
    outcome.converged().unwrap_or_else(|_| panic!("{stop:?} at {residual:e}")).into_inner()
}

fn stored(name: &str) -> Packing<2> {
    read_packing::<2>(format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR"))).expect("a fixture")
}

/// A stored packing cut to a circle with a held rim around its `index`-th small disk, grown by 0.1.
fn inflated(name: &str, index: usize) -> Packing<2> {
    let packing = stored(name);
    let side = packing.domain().lengths().expect("periodic")[0];
    let backbone = ContactNetwork::new(&packing, &Hertzian::default()).expect("no coincidence").backbone;
    let small: Vec<usize> = (0..packing.len()).filter(|&disk| packing.radii()[disk] == 0.5 && backbone[disk]).collect();
    let circle = Circle::cut(&packing, small[(37 * index) % small.len()], 0.48 * side).expect("a circle in its box");
    circle.packing.with_radius(circle.centre, 0.6).expect("a positive radius")
}

/// Every disk that is not held moved by up to `length` along each axis.
fn shaken<const D: usize>(packing: &Packing<D>, length: f64, seed: u64) -> Packing<D> {
    let mut generator = Pcg64::seed_from_u64(seed);
    let corrections = (0..packing.len())
        .map(|disk| {
            let moved: Vector<D> = std::array::from_fn(|_| length * (2.0 * generator.random::<f64>() - 1.0));
            if packing.held()[disk] { packing.corrections()[disk] } else { sum(packing.corrections()[disk], moved) }
        })
        .collect();
    packing.clone().with_corrections(corrections).expect("finite")
}

/// How far a disk is from where it is in another packing.
fn moved<const D: usize>(one: &Packing<D>, two: &Packing<D>, disk: usize) -> Vector<D> {
    let ((a, a_low), (b, b_low)) = (one.centre(disk), two.centre(disk));
    one.domain().separation((a, a_low), (b, b_low))
}

/// Softest stiffness of the backbone of a packing with held disks, by inverse iteration: an upper bound that falls to it.
fn softest<const D: usize, L: PairLaw>(packing: &Packing<D>, law: &L) -> f64 {
    let hessian = Hessian::new(packing, law, Members::Backbone, Prestress::Included).expect("no coincidence");
    let matrix = hessian.matrix();
    let mut analysis = Analysis::of(&hessian).expect("small");
    let mut factorisation = analysis.cholesky(matrix).expect("a minimum");
    let mut generator = Pcg64::seed_from_u64(1);
    let mut mode: Vec<f64> = (0..matrix.dimension()).map(|_| generator.random::<f64>() - 0.5).collect();
    let mut next = vec![f64::NAN; mode.len()];
    let mut quotient = f64::INFINITY;
    for _ in 0..200 {
        let length = mode.iter().map(|x| x * x).sum::<f64>().sqrt();
        mode.iter_mut().for_each(|x| *x /= length);
        let _ = factorisation.solve(&mode, &mut next).expect("well conditioned enough");
        quotient = 1.0 / mode.iter().zip(&next).map(|(x, y)| x * y).sum::<f64>();
        std::mem::swap(&mut mode, &mut next);
    }
    quotient
}

/// Largest distance of a backbone disk between two states.
fn apart<const D: usize, L: PairLaw>(one: &Packing<D>, two: &Packing<D>, law: &L) -> f64 {
    let backbone = ContactNetwork::new(one, law).expect("no coincidence").backbone;
    (0..one.len()).filter(|&disk| backbone[disk]).map(|disk| norm(moved(one, two, disk))).fold(0.0, f64::max)
}

/// How far two states at rest to this relative limit may be apart: |u| ≤ |F|/λ_min each, |F| ≤ √N times the largest.
fn allowed<const D: usize, L: PairLaw>(packing: &Packing<D>, law: &L, limit: f64) -> f64 {
    let mean = ContactNetwork::new(packing, law).expect("no coincidence").mean_contact_force();
    2.0 * limit * mean * (packing.len() as f64).sqrt() / softest(packing, law)
}

/// A disk between four held ones at the corners of a cross, at rest in the middle.
fn cross(from: Vector<2>) -> Packing<2> {
    let positions = vec![from, [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    Packing::new(Domain::Open, positions, vec![0.55, 0.5, 0.5, 0.5, 0.5])
        .and_then(|packing| packing.with_held(vec![false, true, true, true, true]))
        .expect("valid")
}

#[test]
fn a_disk_between_four_held_ones_comes_to_rest_in_their_middle() {
    fn check<L: PairLaw>(law: L) {
        let limit = 1e-12;
        let outcome = relax(&newton(limit), cross([0.02, -0.013]), &law);
        assert!(outcome.cost.factorisation_count <= 8, "{law:?}: {:?}", outcome.cost);
        let force = law.force(law.coefficient(0.55, 0.5), 0.05);
        // Stiffness of the mobile disk: two contacts along, 2 F', two across, −2 F/r with r = 1.
        let stiffness = 2.0 * (law.stiffness(force, 0.05) - force);
        let (position, rest) = at_rest(outcome).centre(0);
        let off = norm(sum(position, rest));
        // Force limit over stiffness; twice, for the change of both on the way to the middle.
        assert!(off <= 2.0 * limit * force / stiffness, "{law:?}: {off:e} from the middle");
    }
    check(Hertzian::default());
    check(Hookean::default());
    check(PowerLaw { energy_scale: 3.0, exponent: 3.5 });
}

/// Next to a minimum at which no contact is about to open, r_{k+1} ≤ C r_k²: from 10⁻⁶ of a length two steps are enough.
#[test]
fn the_residual_is_squared_at_each_step_near_a_minimum() {
    let law = Hertzian::default();
    let minimum = at_rest(relax(&staged(1e-13), inflated("hertz_N1000_p800", 1), &law));
    let network = ContactNetwork::new(&minimum, &law).expect("no coincidence");
    let least = network.backbone_contacts().map(|contact| contact.overlap).fold(f64::INFINITY, f64::min);
    // Moved by far less than the smallest overlap, so no contact of the backbone opens; F' then changes by 1/(2δ) of
    // itself per length, and errors u become (F''/F') u² times what the softest mode makes of a force.
    let start = shaken(&minimum, 1e-3 * least, 2);
    let mut residuals = Vec::new();
    let mut trace = |look: &Look| residuals.push(look.residual);
    let outcome = newton(1e-13).relax(start, &law, &mut trace).expect("no coincidence");
    assert!(matches!(outcome.stop, Stop::Converged(_)), "{residuals:?}");
    // Each residual at most the square of the one before over that of the start times ten, down to the floor.
    for pair in residuals.windows(2) {
        assert!(pair[1] <= (10.0 * pair[0] / residuals[0] * pair[0]).max(1e-13), "{residuals:?}");
    }
    assert!(residuals.len() <= 5, "{residuals:?}");
}

/// The claim of the module: the energy does not rise beyond the rounding of sums over contacts, 10⁻¹³ of what is summed up.
fn only_falls(looks: &[Look]) {
    assert!(looks.len() > 2, "{} looks", looks.len());
    for pair in looks.windows(2) {
        let (before, after) = (pair[0].energy, pair[1].energy);
        assert!(after <= before + 2e-13 * before.abs(), "{before} rises to {after}");
    }
    assert!(looks[looks.len() - 1].energy < looks[0].energy);
}

/// Near jamming contacts close on the way of a whole step and make it climb (the energy would rise by 30 times what the forces
/// promise of a fall): not a look may show that.
#[test]
fn the_energy_falls_where_contacts_that_close_make_the_whole_step_climb() {
    fn check<L: PairLaw>(law: L, name: &str) {
        let near = at_rest(relax(&fire(1e-4), inflated(name, 0), &law));
        let mut looks = Vec::new();
        let settings = Newton { step_limit: 40, ..newton(1e-12) };
        let _ = settings.relax(near, &law, &mut |look: &Look| looks.push(*look)).expect("no coincidence");
        only_falls(&looks);
    }
    check(Hookean::default(), "hooke_N1000_p100");
    check(Hookean::default(), "hooke_N1000_p10");
    check(Hertzian::default(), "hertz_N1000_p1");
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 12, rng_seed: RngSeed::Fixed(20), failure_persistence: None, ..ProptestConfig::default()
    })]

    #[test]
    fn the_energy_of_newton_never_increases(seed in 0..1000u64, fraction in 0.8..1.3f64, law in 0..3usize) {
        fn check<const D: usize, L: PairLaw>(packing: Packing<D>, law: &L) {
            let settings = Newton { step_limit: 60, ..newton(1e-10) };
            let mut looks = Vec::new();
            let _ = settings.relax(packing, law, &mut |look: &Look| looks.push(*look)).expect("no coincidence");
            only_falls(&looks);
        }
        match law {
            0 => check(points::<2>(100, fraction, seed), &Hertzian::default()),
            1 => check(points::<2>(100, fraction, seed), &Hookean::default()),
            _ => check(points::<3>(60, fraction, seed), &Hertzian::default()),
        }
    }

    #[test]
    fn a_shaken_minimum_is_found_again_wherever_it_lies_and_whatever_its_disks_are_called(
        seed in 0..1000u64,
        shift in -8..8i32,
        turned in any::<bool>(),
    ) {
        let (law, limit) = (Hertzian::default(), 1e-12);
        let minimum = at_rest(relax(&staged(1e-13), inflated("hertz_N1000_p800", 3), &law));
        let start = shaken(&minimum, 1e-5, seed);
        // By a quarter turn, which rounds nothing, a multiple of 2¹⁰, and in reverse order.
        let place = |position: Vector<2>| if turned { [-position[1], position[0]] } else { position };
        let offset = f64::from(shift) * 1024.0;
        let count = start.len();
        let reverse = |disk: usize| count - 1 - disk;
        // Centres are unevaluated sums: what the shift rounds off goes into the corrections.
        let exact: Vec<Vector<2>> = (0..count).map(|disk| place(start.centre(reverse(disk)).0)).collect();
        let rests: Vec<Vector<2>> = (0..count).map(|disk| place(start.centre(reverse(disk)).1)).collect();
        let split = |x: f64| { let high = x + offset; (high, x - (high - offset)) };
        let positions: Vec<Vector<2>> = exact.iter().map(|x| [split(x[0]).0, split(x[1]).0]).collect();
        let corrections: Vec<Vector<2>> =
            exact.iter().zip(&rests).map(|(x, rest)| [split(x[0]).1 + rest[0], split(x[1]).1 + rest[1]]).collect();
        let radii = (0..count).map(|disk| start.radii()[reverse(disk)]).collect();
        let held = (0..count).map(|disk| start.held()[reverse(disk)]).collect();
        let other = Packing::new(*start.domain(), positions, radii)
            .and_then(|packing| packing.with_corrections(corrections))
            .and_then(|packing| packing.with_held(held))
            .expect("valid");
        let (one, two) = (at_rest(relax(&newton(limit), start, &law)), at_rest(relax(&newton(limit), other, &law)));
        let backbone = ContactNetwork::new(&one, &law).expect("no coincidence").backbone;
        let mut worst = 0.0f64;
        for disk in (0..count).filter(|&disk| backbone[disk]) {
            let (a, a_rest) = (place(one.centre(disk).0), place(one.centre(disk).1));
            let (b, b_rest) = two.centre(reverse(disk));
            let b = b.map(|x| x - offset);
            worst = worst.max(norm(sum(difference(a, b), difference(a_rest, b_rest))));
        }
        // Beside the forces left: centres of the second were made with one rounding of a correction, 2⁻⁵³ of 2⁻⁴⁰.
        let tolerance = allowed(&minimum, &law, limit) + 1e-15;
        prop_assert!(worst <= tolerance, "{worst:e} apart, {tolerance:e} allowed");
        prop_assert!(tolerance < 1e-8, "the tolerance {tolerance:e} says nothing");
    }
}

/// Lengths by 4^a, stiffness by 2^b with b even: every entry of the matrix is a power of four of the one before, so not even
/// the roots of Cholesky round otherwise.
#[test]
fn a_relaxation_in_other_units_takes_the_same_steps_to_the_same_bits() {
    fn check<L: PairLaw>(laws: [L; 2], length: f64) {
        let scale = |column: &[Vector<2>]| -> Vec<Vector<2>> { column.iter().map(|x| scaled(length, *x)).collect() };
        let packing = points::<2>(100, 0.9, 15);
        let side = packing.domain().lengths().expect("periodic")[0];
        let radii = packing.radii().iter().map(|radius| radius * length).collect();
        let other = Packing::new(Domain::cube(side * length), scale(packing.positions()), radii).expect("valid");
        for choice in [RelaxerChoice::Newton(newton(1e-12)), RelaxerChoice::Staged(staged(1e-12))] {
            let (one, two) = (relax(&choice, packing.clone(), &laws[0]), relax(&choice, other.clone(), &laws[1]));
            assert_eq!(one.stop, Stop::Converged(Criterion::RelativeForce), "{}", choice.name());
            assert!(one.cost.factorisation_count > 1);
            assert_eq!(
                (one.stop, one.cost.step_count, one.cost.factorisation_count),
                (two.stop, two.cost.step_count, two.cost.factorisation_count)
            );
            assert_eq!(scale(one.state.positions()), two.state.positions());
            assert_eq!(scale(one.state.corrections()), two.state.corrections());
        }
    }
    // F' grows with k' √(length²) = k' length.
    check([Hertzian { stiffness: 2e5 }, Hertzian { stiffness: 2e5 * 64.0 }], 16.0);
    check([Hertzian { stiffness: 2e5 }, Hertzian { stiffness: 2e5 / 256.0 }], 0.25);
    check([Hookean { stiffness: 2e5 }, Hookean { stiffness: 2e5 / 256.0 }], 4.0);
}

#[test]
fn newton_and_fire_meet_in_a_minimum_near_by() {
    fn check<L: PairLaw>(law: L, name: &str) {
        let limit = 1e-11;
        let minimum = at_rest(relax(&fire(1e-12), inflated(name, 5), &law));
        let start = shaken(&minimum, 1e-4, 7);
        let tolerance = allowed(&minimum, &law, limit);
        for choice in [
            RelaxerChoice::Newton(newton(limit)),
            RelaxerChoice::Staged(staged(limit)),
            RelaxerChoice::Fire(fire(limit)),
        ] {
            let off = apart(&minimum, &at_rest(relax(&choice, start.clone(), &law)), &law);
            println!("{name}, {}: {off:e} from the minimum, {tolerance:e} allowed", choice.name());
            assert!(off <= tolerance, "{name}, {}: {off:e}, {tolerance:e} allowed", choice.name());
        }
        assert!(tolerance < 1e-7, "the tolerance {tolerance:e} says nothing");
    }
    check(Hertzian::default(), "hertz_N1000_p800");
    check(Hertzian::default(), "hertz_N1000_p100");
    check(Hookean::default(), "hooke_N1000_p5000");
}

/// n × n disks of radius 1/2 on a square lattice of spacing `1 − overlap`, columns moved along y by ± `height`.
fn square_lattice(count: usize, overlap: f64, height: f64) -> Packing<2> {
    let spacing = 1.0 - overlap;
    let sites = (0..count * count).map(|site| (site / count, site % count));
    let positions = sites.clone().map(|(x, y)| [x as f64 * spacing, y as f64 * spacing]).collect();
    let corrections = sites.map(|(x, _)| [0.0, if x % 2 == 0 { height } else { -height }]).collect();
    Packing::new(Domain::cube(count as f64 * spacing), positions, vec![0.5; count * count])
        .and_then(|packing| packing.with_corrections(corrections))
        .expect("valid")
}

#[test]
fn a_saddle_is_left_downhill() {
    fn check<L: PairLaw>(law: L) {
        let energy = |packing: &Packing<2>| ContactNetwork::new(packing, &law).expect("no coincidence").energy();
        let lattice_energy = energy(&square_lattice(6, f64::exp2(-6.0), 0.0));
        // The columns move out until the rows no longer touch: the half of the energy that the rows had is gone at least.
        for height in [1e-3, 1e-6] {
            for choice in [RelaxerChoice::Newton(newton(1e-10)), RelaxerChoice::Staged(staged(1e-10))] {
                let outcome = relax(&choice, square_lattice(6, f64::exp2(-6.0), height), &law);
                let share = energy(&outcome.state) / lattice_energy;
                println!("{law:?} {height:e} {}: {:?}, {:?}, {share}", choice.name(), outcome.stop, outcome.cost);
                assert!(matches!(outcome.stop, Stop::Converged(_)), "{}: {:?}", choice.name(), outcome.stop);
                assert!(share < 0.5 * (1.0 + 1e-8), "{}: {share}", choice.name());
            }
        }
    }
    check(Hookean::default());
    check(Hertzian::default());
}

/// A limit of zero cannot be met: it ends where rounding is all there is, as deep as FIRE gets.
#[test]
fn a_limit_of_zero_ends_at_the_rounding_floor() {
    for (name, index) in [("hertz_N1000_p1", 0), ("hertz_N1000_p100", 1), ("hertz_N1000_p800", 2)] {
        let law = Hertzian::default();
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
    fn check<L: PairLaw>(law: L, name: &str, most: usize) {
        for index in [0, 1, 2] {
            let outcome = relax(&staged(1e-12), inflated(name, index), &law);
            let (made, residual) = (outcome.cost.factorisation_count, outcome.residual.relative());
            println!("{name}: {:?}, residual {residual:e}, {:?}", outcome.stop, outcome.cost);
            assert_eq!(outcome.stop, Stop::Converged(Criterion::RelativeForce), "{name}, {index}");
            assert!(made > 0 && made <= most, "{name}, {index}: {made} factorisations");
            // Measured anew from the packing handed out, whose anchors are its own.
            let network = ContactNetwork::new(&outcome.state, &law).expect("no coincidence");
            let (held, backbone) = (outcome.state.held(), &network.backbone);
            let largest = (0..outcome.state.len())
                .filter(|&disk| backbone[disk] && !held[disk])
                .map(|disk| norm(network.forces()[disk]))
                .fold(0.0, f64::max);
            let anew = largest / network.mean_contact_force();
            assert!(anew <= 1e-12 + 2.0 * outcome.rounding_floor, "{name}, {index}: {anew:e} anew");
        }
    }
    check(Hertzian::default(), "hertz_N1000_p005", 60);
    check(Hertzian::default(), "hertz_N1000_p1", 60);
    check(Hertzian::default(), "hertz_N1000_p10", 60);
    check(Hertzian::default(), "hertz_N1000_p100", 12);
    check(Hertzian::default(), "hertz_N1000_p800", 12);
    check(Hertzian::default(), "hertz_N5548_p100", 12);
    check(Hookean::default(), "hooke_N1000_p100", 12);
    check(Hookean::default(), "hooke_N1000_p800", 12);
    check(Hookean::default(), "hooke_N1000_p5000", 12);
}

/// Far above jamming the three relaxers end in one minimum. Damped dynamics is held to no limit but the distance asked for:
/// its rattlers creep out of their contacts for more than 10⁵ steps, without touching the backbone.
#[test]
fn fire_damped_dynamics_and_staged_end_in_one_minimum_at_high_pressure() {
    let (law, limit) = (Hertzian::default(), 1e-12);
    let damped = DampedDynamics { limit: ForceLimit::Relative(1e-10), step_limit: 80_000, ..DampedDynamics::default() };
    let mut together = 0;
    for index in 0..10 {
        let start = || inflated("hertz_N1000_p800", index);
        let ends = [
            at_rest(relax(&staged(limit), start(), &law)),
            at_rest(relax(&fire(limit), start(), &law)),
            relax(&damped, start(), &law).state,
        ];
        let far = [apart(&ends[0], &ends[1], &law), apart(&ends[0], &ends[2], &law)];
        println!("sample {index}: FIRE {:e}, damped dynamics {:e} from staged", far[0], far[1]);
        together += usize::from(far.iter().all(|&far| far <= 1e-9));
    }
    assert!(together >= 9, "{together} of 10 end together");
}

#[test]
fn random_points_come_to_rest_at_rounding() {
    fn check<const D: usize, L: PairLaw>(law: L, count: usize, fraction: f64) {
        for seed in [1, 2] {
            let outcome = relax(&staged(1e-12), points::<D>(count, fraction, seed), &law);
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
    check::<2, _>(Hertzian::default(), 400, 0.86);
    check::<2, _>(Hertzian::default(), 400, 1.0);
    check::<2, _>(Hookean::default(), 400, 0.9);
    check::<2, _>(PowerLaw { energy_scale: 1e5, exponent: 3.0 }, 400, 0.95);
    check::<3, _>(Hertzian::default(), 200, 0.8);
    check::<3, _>(Hookean::default(), 200, 0.75);
}

/// Nothing holds a periodic packing: forces add up to nothing, and so must steps.
#[test]
fn the_centre_of_mass_of_a_periodic_packing_stays() {
    let (law, start) = (Hertzian::default(), points::<2>(200, 0.95, 4));
    let near = at_rest(relax(&fire(1e-3), start, &law));
    let end = at_rest(relax(&newton(1e-12), near.clone(), &law));
    let (mut mean, mut way) = ([0.0; 2], 0.0);
    for disk in 0..near.len() {
        let moved = moved(&end, &near, disk);
        mean = sum(mean, scaled(1.0 / near.len() as f64, moved));
        way += norm(moved) / near.len() as f64;
    }
    // Each step rounds each displacement once; fewer than 100 steps.
    assert!(way > 1e-6 && norm(mean) <= 100.0 * f64::EPSILON * way.max(1e-3), "{mean:?} of {way:e}");
}

#[test]
fn too_few_factorisations_are_an_outcome_and_the_staged_relaxer_goes_on_without() {
    let (law, start) = (Hertzian::default(), inflated("hertz_N1000_p100", 0));
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
        let outcome = relax(&choice, points::<2>(100, 0.7, 10), &Hertzian::default());
        assert_eq!(outcome.stop, Stop::Converged(Criterion::Unjammed), "{}", choice.name());
    }
}

#[test]
fn an_absolute_limit_is_met_in_force() {
    for choice in [
        RelaxerChoice::Newton(Newton { limit: ForceLimit::Absolute(1e-9), ..Newton::default() }),
        RelaxerChoice::Staged(Staged { limit: ForceLimit::Absolute(1e-9), ..Staged::default() }),
    ] {
        let outcome = relax(&choice, inflated("hertz_N1000_p100", 0), &Hertzian::default());
        assert_eq!(outcome.stop, Stop::Converged(Criterion::AbsoluteForce), "{}", choice.name());
        assert!(outcome.residual.largest_net_force <= 1e-9 && outcome.residual.mean_contact_force > 1.0);
    }
}

/// Three disks in a row between two held ones have no backbone, and nothing holds them across the row: they rest under
/// one force F = c_j δ_j^(α−1), the overlaps adding up to what the last disk was pushed in.
#[test]
fn a_chain_without_a_backbone_comes_to_rest_under_one_force() {
    let (law, total, limit) = (Hertzian::default(), 0.125, 1e-12);
    let radii = [0.5, 0.75, 0.5, 0.625, 1.0];
    let mut positions = vec![[0.0, 0.0]];
    for pair in radii.windows(2) {
        positions.push([positions[positions.len() - 1][0] + pair[0] + pair[1], 0.0]);
    }
    positions[4][0] -= total;
    let packing = Packing::new(Domain::Open, positions, radii.to_vec())
        .and_then(|packing| packing.with_held(vec![true, false, false, false, true]))
        .expect("valid");
    let shares: Vec<f64> = radii.windows(2).map(|pair| law.coefficient(pair[0], pair[1]).powf(-2.0 / 3.0)).collect();
    for choice in [RelaxerChoice::Newton(newton(limit)), RelaxerChoice::Staged(staged(limit))] {
        let end = at_rest(relax(&choice, packing.clone(), &law));
        let network = ContactNetwork::new(&end, &law).expect("no coincidence");
        assert_eq!(network.contacts.len(), 4);
        for contact in &network.contacts {
            let expected = total * shares[contact.first as usize] / shares.iter().sum::<f64>();
            // Forces differ by the limit a disk, overlaps by two thirds of that; rounding of positions up to 5 over 0.03.
            let error = (contact.overlap / expected - 1.0).abs();
            assert!(error <= 5.0 * limit + 5.0 * 8.0 * f64::EPSILON / 0.03, "{}: {error:e}", choice.name());
        }
    }
}

/// A Hookean disk between four held ones, one of them grown, with a site: force along x at (x, 0), by hand.
fn push(x: f64, growth: f64, coupling: f64) -> f64 {
    let force = |overlap: f64| 2e5 * overlap.max(0.0);
    let above = (1.0 + x * x).sqrt();
    force(0.05 + growth - x) - force(0.05 + x) + 2.0 * force(1.05 - above) * x / above + coupling * x
}

fn grown_cross(growth: f64) -> Packing<2> {
    cross([0.0; 2]).with_radius(2, 0.5 + growth).expect("positive")
}

#[test]
fn a_disk_pushed_from_its_site_rests_where_contacts_hold_it_and_else_there_is_no_minimum() {
    let (growth, limit) = (0.01, 1e-12);
    // Two contacts along, two across.
    let stiffness = 2.0 * 2e5 - 2.0 * 2e5 * 0.05;
    for share in [-1.0, 0.5, 0.7] {
        let law = OnSite { law: Hookean { stiffness: 2e5 }, coupling: share * stiffness };
        let (mut low, mut high) = (0.0, 0.04);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if push(middle, growth, law.coupling) > 0.0 { low = middle } else { high = middle }
        }
        for choice in [RelaxerChoice::Newton(newton(limit)), RelaxerChoice::Staged(staged(limit))] {
            let outcome = relax(&choice, grown_cross(growth), &law);
            let mean = outcome.residual.mean_contact_force;
            let (position, rest) = at_rest(outcome).centre(0);
            let off = norm([position[0] + rest[0] - low, position[1] + rest[1]]);
            // Limit over what is left of the stiffness (its change along the way: a tenth), twice; and 4 ulp of the root.
            let allowed = 2.0 * limit * mean / ((1.0 - share) * 0.9 * stiffness) + 4.0 * f64::EPSILON * low;
            assert!(off <= allowed, "Γ = {share} K, {}: {off:e}, {allowed:e} allowed", choice.name());
        }
    }
    for share in [1.5, 10.0, 1e6] {
        let law = OnSite { law: Hookean { stiffness: 2e5 }, coupling: share * stiffness };
        for choice in [RelaxerChoice::Newton(newton(limit)), RelaxerChoice::Staged(staged(limit))] {
            let outcome = relax(&choice, grown_cross(1e-3), &law);
            assert_eq!(outcome.stop, Stop::NoMinimum, "Γ = {share} K, {}: {:?}", choice.name(), outcome.cost);
        }
    }
}

/// Disks tied to their sites, rattlers without any contact among them: Newton and FIRE meet.
#[test]
fn tied_disks_end_where_fire_brings_them() {
    let law = OnSite { law: Hertzian::default(), coupling: -1e3 };
    let start = inflated("hertz_N1000_p100", 4);
    let limit = 1e-12;
    let [one, two] = [at_rest(relax(&newton(limit), start.clone(), &law)), at_rest(relax(&fire(limit), start, &law))];
    // Every mode has a stiffness of −Γ = 1000 at least, less the prestress; forces left are at most √N limit each.
    let mean = ContactNetwork::new(&one, &law).expect("no coincidence").mean_contact_force();
    let allowed = 4.0 * limit * mean * (one.len() as f64).sqrt() / 1e3 + 1e-15;
    let off = apart(&one, &two, &law);
    assert!(off <= allowed, "{off:e}, {allowed:e} allowed");
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
    let cost = relax(&fire(1e-8), cross([0.01, 0.0]), &Hookean::default()).cost;
    assert!(!serde_json::to_string(&cost).expect("plain data").contains("factorisation"));
    let cost = relax(&newton(1e-8), cross([0.01, 0.0]), &Hookean::default()).cost;
    assert!(serde_json::to_string(&cost).expect("plain data").contains("\"factorisation_count\":"));
}

#[test]
fn the_same_input_gives_the_same_bits() {
    let outcomes = || {
        let (packing, law) = (points::<2>(100, 0.9, 14), Hertzian::default());
        [relax(&newton(1e-10), packing.clone(), &law), relax(&staged(1e-10), packing, &law)]
    };
    for (one, two) in outcomes().into_iter().zip(outcomes()) {
        assert_eq!(one.state, two.state);
        assert_eq!((one.stop, one.residual, one.cost.step_count), (two.stop, two.residual, two.cost.step_count));
    }
}

/// The stiffness of a rattler's contacts is the one that opens them in one step; Newton's own would leave a third of each
/// overlap, a residual of a fifth a step.
#[test]
fn a_rattler_is_pushed_off_in_a_step() {
    let law = Hertzian::default();
    let mut packing = cross([0.0; 2]);
    // A fifth disk leans on the mobile one and on nothing else.
    let positions = [packing.positions(), &[[0.55f64, 0.55].map(|x| x * 0.99)]].concat();
    let radii = [packing.radii(), &[0.22786]].concat();
    let held = [packing.held(), &[false]].concat();
    packing = Packing::new(Domain::Open, positions, radii).and_then(|packing| packing.with_held(held)).expect("valid");
    let network = ContactNetwork::new(&packing, &law).expect("no coincidence");
    assert!(network.contacts.iter().any(|contact| contact.second == 5), "the disk leans on nothing");
    let outcome = relax(&newton(1e-12), packing, &law);
    println!("{:?}", outcome.cost);
    assert!(matches!(outcome.stop, Stop::Converged(_)), "{:?}", outcome.stop);
    assert!(outcome.cost.factorisation_count <= 8, "{:?}", outcome.cost);
}

#[test]
fn assemblies_are_left_where_they_were_found_when_nothing_is_to_do() {
    let packing = cross([0.0; 2]);
    let mut assembly = Assembly::new(&packing, Hookean::default()).expect("no coincidence");
    assert_eq!(assembly.evaluate_totals().contact_count, 4);
    let outcome = relax(&newton(1e-8), packing.clone(), &Hookean::default());
    assert_eq!((outcome.state, outcome.cost.factorisation_count, outcome.cost.step_count), (packing, 0, 0));
}
