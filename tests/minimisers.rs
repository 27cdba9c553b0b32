//! Nonlinear conjugate gradients, L-BFGS and FIRE's step back: closed forms, the energy on the way, invariances, agreement
//! with the other relaxers, the rounding floor, named ends, and the work of fixed scenes.

use jamscope::contact::{Assembly, ContactNetwork, Hertzian, Hookean, OnSite, PairLaw, PowerLaw};
use jamscope::inflation::Circle;
use jamscope::io::read_packing;
use jamscope::packing::{Domain, Mixture, Packing, PackingError};
use jamscope::preparation::random_points;
use jamscope::relax::{
    Criterion, Fire, ForceLimit, Look, NonlinearConjugateGradients, Outcome, QuasiNewton, Relaxer, RelaxerChoice,
    StepBack, Stop, Uphill,
};
use jamscope::scene::Scene;
use jamscope::vector::{Vector, difference, larger, norm, scaled, sum};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn gradients(limit: ForceLimit) -> RelaxerChoice {
    RelaxerChoice::ConjugateGradients(NonlinearConjugateGradients { limit, ..NonlinearConjugateGradients::default() })
}

fn quasi_newton(limit: ForceLimit) -> RelaxerChoice {
    RelaxerChoice::QuasiNewton(QuasiNewton { limit, ..QuasiNewton::default() })
}

fn step_back(limit: ForceLimit) -> RelaxerChoice {
    RelaxerChoice::Fire(Fire { limit, uphill: Uphill::StepBack(StepBack::default()), ..Fire::default() })
}

/// The two that go along directions.
fn minimisers(limit: f64) -> [RelaxerChoice; 2] {
    [gradients(ForceLimit::Relative(limit)), quasi_newton(ForceLimit::Relative(limit))]
}

/// All that this file is about.
fn all(limit: f64) -> [RelaxerChoice; 3] {
    let limit = ForceLimit::Relative(limit);
    [gradients(limit), quasi_newton(limit), step_back(limit)]
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

/// A stored packing cut to a circle with a held rim around its `index`-th small disk, grown by 0.1.
fn inflated(name: &str, index: usize) -> Packing<2> {
    let packing = read_packing::<2>(format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR")));
    let packing = packing.expect("a fixture");
    let side = packing.domain().lengths().expect("periodic")[0];
    let backbone = ContactNetwork::new(&packing, &Hertzian::default()).expect("no coincidence").backbone;
    let small: Vec<usize> = (0..packing.len()).filter(|&disk| packing.radii()[disk] == 0.5 && backbone[disk]).collect();
    let circle = Circle::cut(&packing, small[(37 * index) % small.len()], 0.48 * side).expect("a circle in its box");
    circle.packing.with_radius(circle.centre, 0.6).expect("a positive radius")
}

/// Every disk that is not held moved by up to `length` along each axis.
fn shaken(packing: &Packing<2>, length: f64, seed: u64) -> Packing<2> {
    let mut generator = Pcg64::seed_from_u64(seed);
    let corrections = (0..packing.len())
        .map(|disk| {
            let moved: Vector<2> = std::array::from_fn(|_| length * (2.0 * generator.random::<f64>() - 1.0));
            if packing.held()[disk] { packing.corrections()[disk] } else { sum(packing.corrections()[disk], moved) }
        })
        .collect();
    packing.clone().with_corrections(corrections).expect("finite")
}

/// Largest distance of a backbone disk between two states.
fn apart<L: PairLaw>(one: &Packing<2>, two: &Packing<2>, law: &L) -> f64 {
    let backbone = ContactNetwork::new(one, law).expect("no coincidence").backbone;
    let way = |disk: usize| norm(one.domain().separation(one.centre(disk), two.centre(disk)));
    (0..one.len()).filter(|&disk| backbone[disk]).map(way).fold(0.0, larger)
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
        for choice in all(limit) {
            let outcome = relax(&choice, cross([0.02, -0.013]), &law);
            let force = law.force(law.coefficient(0.55, 0.5), 0.05);
            // Stiffness of the mobile disk: two contacts along, 2 F', two across, −2 F/r with r = 1.
            let stiffness = 2.0 * (law.stiffness(force, 0.05) - force);
            let (position, rest) = at_rest(outcome).centre(0);
            let off = norm(sum(position, rest));
            // Force limit over stiffness; twice, for the change of both on the way to the middle.
            assert!(off <= 2.0 * limit * force / stiffness, "{law:?}, {}: {off:e} from the middle", choice.name());
        }
    }
    check(Hertzian::default());
    check(Hookean::default());
    check(PowerLaw { energy_scale: 3.0, exponent: 3.5 });
}

/// A row of Hookean disks of radius 1/2 on a line between two held ones, every one of them in contact whatever happens: springs,
/// E = (k/2) Σ (δ₀ + u_j − u_(j+1))². At rest disk j stands at j (1 − δ₀), wherever it began.
fn springs(count: usize, seed: u64) -> Packing<2> {
    let (overlap, last) = (0.125, count + 1);
    let mut generator = Pcg64::seed_from_u64(seed);
    let positions = (0..=last).map(|disk| [disk as f64 * (1.0 - overlap), 0.0]).collect();
    let off =
        |disk: usize| if disk == 0 || disk == last { 0.0 } else { 0.05 * (2.0 * generator.random::<f64>() - 1.0) };
    let corrections = (0..=last).map(off).map(|x| [x, 0.0]).collect();
    Packing::new(Domain::Open, positions, vec![0.5; count + 2])
        .and_then(|packing| packing.with_corrections(corrections))
        .and_then(|packing| packing.with_held((0..=last).map(|disk| disk == 0 || disk == last).collect()))
        .expect("valid")
}

/// On a quadratic energy and with exact searches conjugate gradients end after as many steps as there are coordinates, and so do
/// quasi-Newton methods (Nocedal, Wright (2006), theorems 5.3 and 6.4). A memory that forgets, and searches as loose as those
/// of the defaults, take more, to the same place.
#[test]
fn both_end_in_a_row_of_springs_after_as_many_steps_as_it_has_disks() {
    let (law, flatness) = (Hookean::default(), 1e-12);
    let limit = ForceLimit::Relative(1e-10);
    for count in [1, 2, 5, 10, 20, 40] {
        let exact = NonlinearConjugateGradients { limit, flatness, ..NonlinearConjugateGradients::default() };
        let remembers_all = QuasiNewton { limit, flatness, memory: count, ..QuasiNewton::default() };
        for (choice, most) in [
            (RelaxerChoice::ConjugateGradients(exact), count + 1),
            (RelaxerChoice::QuasiNewton(remembers_all), count + 1),
            (gradients(limit), 10 * count),
            (quasi_newton(limit), 10 * count),
        ] {
            let outcome = relax(&choice, springs(count, 3), &law);
            let cost = outcome.cost;
            println!("{count} springs, {}: {} steps, at most {most}", choice.name(), cost.step_count);
            assert!(cost.step_count <= most, "{count}, {}: {cost:?}", choice.name());
            let end = at_rest(outcome);
            // |u| ≤ |F|/λ_min with λ_min = 2k (1 − cos(π/(n + 1))), |F| ≤ √n of the limit on a disk, which is of k δ₀.
            let softest = 2.0 * law.stiffness * (1.0 - (std::f64::consts::PI / (count as f64 + 1.0)).cos());
            let allowed = 1e-10 * law.stiffness * 0.125 * (count as f64).sqrt() / softest;
            for disk in 1..=count {
                let off = end.positions()[disk][0] + end.corrections()[disk][0] - 0.875 * disk as f64;
                // And an ulp of the position.
                let allowed = allowed + f64::EPSILON * disk as f64;
                assert!(off.abs() <= allowed, "{count}, {}: disk {disk} is off by {off:e}", choice.name());
                assert_eq!(end.centre(disk).0[1] + end.centre(disk).1[1], 0.0);
            }
        }
    }
}

/// One Hookean disk pressed between two held ones of other radii: F = k δ is shared half and half, in one step.
#[test]
fn one_disk_between_two_walls_rests_where_both_press_alike() {
    let law = Hookean::default();
    let packing = Packing::new(Domain::<2>::Open, vec![[-1.2, 0.0], [0.0, 0.0], [1.0, 0.0]], vec![0.75, 0.5, 0.75])
        .and_then(|packing| packing.with_held(vec![true, false, true]))
        .expect("valid");
    for choice in minimisers(1e-12) {
        let outcome = relax(&choice, packing.clone(), &law);
        assert!(outcome.cost.step_count <= 3, "{}: {:?}", choice.name(), outcome.cost);
        let (position, rest) = at_rest(outcome).centre(1);
        // Overlaps 0.05 − x... each 0.15: the middle between the walls, to the limit and an ulp.
        assert!((position[0] + rest[0] + 0.1).abs() <= 0.15e-12 + f64::EPSILON, "{}", choice.name());
    }
}

/// The energy does not rise beyond the rounding of sums over contacts, 10⁻¹³ of what is summed up, a step: ten a look.
fn only_falls(looks: &[Look], what: &str) {
    assert!(looks.len() > 2, "{what}: {} looks", looks.len());
    for pair in looks.windows(2) {
        let (before, after) = (pair[0].energy, pair[1].energy);
        assert!(after <= before + 2e-12 * before.abs(), "{what}: {before} rises to {after}");
    }
    assert!(looks[looks.len() - 1].energy < looks[0].energy);
}

#[test]
fn the_energy_never_increases() {
    fn check<const D: usize, L: PairLaw>(packing: &Packing<D>, law: &L) {
        for choice in minimisers(1e-10) {
            let mut looks = Vec::new();
            let trace = &mut |look: &Look| looks.push(*look);
            let outcome = choice.relax(packing.clone(), law, trace).expect("no coincidence");
            assert!(matches!(outcome.stop, Stop::Converged(_)), "{law:?}, {}: {:?}", choice.name(), outcome.stop);
            only_falls(&looks, &format!("{law:?}, {}", choice.name()));
        }
    }
    for seed in [1, 2, 3] {
        for fraction in [0.86, 0.95, 1.2] {
            check(&points::<2>(100, fraction, seed), &Hertzian::default());
            check(&points::<2>(100, fraction, seed), &Hookean::default());
        }
        check(&points::<3>(60, 0.9, seed), &Hertzian::default());
        check(&inflated("hertz_N1000_p1", seed as usize), &Hertzian::default());
    }
}

/// With half steps back FIRE still starts again only where it is not higher than before.
#[test]
fn energies_at_the_restarts_of_fire_with_steps_back_never_increase() {
    for time_step_fraction in [1.0, 1.9] {
        let RelaxerChoice::Fire(fire) = step_back(ForceLimit::Relative(1e-8)) else { unreachable!("it is FIRE") };
        let fire = Fire { time_step_fraction, step_limit: 20_000, ..fire };
        let mut looks: Vec<Look> = Vec::new();
        let trace = &mut |look: &Look| looks.push(*look);
        let _ = fire.relax(points::<2>(200, 0.9, 1), &Hertzian::default(), trace).expect("no coincidence");
        let restarts: Vec<f64> = looks.iter().filter(|look| look.restart).map(|look| look.energy).collect();
        assert!(restarts.len() > 3, "{} restarts", restarts.len());
        assert!(restarts.is_sorted_by(|&before, &after| after <= before * (1.0 + 1e-13)), "{restarts:?}");
    }
}

/// Far above jamming all end in one minimum.
#[test]
#[cfg(feature = "linear")]
fn all_end_in_the_minimum_of_newton_at_high_pressure() {
    use jamscope::relax::Staged;
    let (law, limit) = (Hertzian::default(), 1e-12);
    let mut together = 0;
    for index in 0..10 {
        let start = || inflated("hertz_N1000_p800", index);
        let staged = Staged { limit: ForceLimit::Relative(limit), ..Staged::default() };
        let reference = at_rest(relax(&staged, start(), &law));
        let far = all(limit).map(|choice| apart(&reference, &at_rest(relax(&choice, start(), &law)), &law));
        println!("sample {index}: {far:?} from staged");
        together += usize::from(far.iter().all(|&far| far <= 1e-9));
    }
    assert!(together >= 9, "{together} of 10 end together");
}

/// From next to a minimum every relaxer goes back to it.
#[test]
fn all_meet_in_a_minimum_near_by() {
    fn check<L: PairLaw>(law: L, name: &str) {
        let fire = |limit| Fire { limit: ForceLimit::Relative(limit), ..Fire::default() };
        let minimum = at_rest(relax(&fire(1e-12), inflated(name, 5), &law));
        let start = shaken(&minimum, 1e-4, 7);
        for choice in all(1e-11) {
            let off = apart(&minimum, &at_rest(relax(&choice, start.clone(), &law)), &law);
            // 10⁻¹¹ of the mean force over the softest stiffness: Newton's tests derive 10⁻⁹ to 10⁻⁷ for these packings.
            assert!(off <= 1e-8, "{name}, {}: {off:e}", choice.name());
        }
    }
    check(Hertzian::default(), "hertz_N1000_p800");
    check(Hertzian::default(), "hertz_N1000_p100");
    check(Hookean::default(), "hooke_N1000_p5000");
}

/// Turned by a quarter, moved by a multiple of 2¹⁰ and relabelled in reverse, a shaken minimum is found at the same place.
#[test]
fn a_minimum_is_found_wherever_it_lies_and_whatever_its_disks_are_called() {
    let (law, limit) = (Hertzian::default(), 1e-12);
    let minimum = at_rest(relax(&all(1e-12)[1], inflated("hertz_N1000_p800", 3), &law));
    let start = shaken(&minimum, 1e-5, 11);
    let (count, offset) = (start.len(), 3072.0);
    let reverse = |disk: usize| count - 1 - disk;
    let turned = |x: Vector<2>| [-x[1], x[0]];
    // Centres are unevaluated sums: what the shift rounds off goes into the corrections.
    let split = |x: f64| (x + offset, x - ((x + offset) - offset));
    let places: Vec<(Vector<2>, Vector<2>)> =
        (0..count).map(|disk| start.centre(reverse(disk))).map(|(x, rest)| (turned(x), turned(rest))).collect();
    let positions = places.iter().map(|(x, _)| x.map(|x| split(x).0)).collect();
    let corrections = places.iter().map(|(x, rest)| sum(x.map(|x| split(x).1), *rest)).collect();
    let other = Packing::new(*start.domain(), positions, (0..count).map(|disk| start.radii()[reverse(disk)]).collect())
        .and_then(|packing| packing.with_corrections(corrections))
        .and_then(|packing| packing.with_held((0..count).map(|disk| start.held()[reverse(disk)]).collect()))
        .expect("valid");
    let backbone = ContactNetwork::new(&minimum, &law).expect("no coincidence").backbone;
    for choice in all(limit) {
        let [one, two] = [start.clone(), other.clone()].map(|start| at_rest(relax(&choice, start, &law)));
        let way = |disk: usize| {
            let ((a, a_rest), (b, b_rest)) = (one.centre(disk), two.centre(reverse(disk)));
            norm(sum(difference(turned(a), b.map(|x| x - offset)), difference(turned(a_rest), b_rest)))
        };
        let worst = (0..count).filter(|&disk| backbone[disk]).map(way).fold(0.0, larger);
        // Both are at rest to 10⁻¹² of the mean force, which at this pressure the softest mode makes 10⁻¹⁰ of a length at most
        // (p of 800 over a stiffness of 10² for the softest mode of 700 disks, √N for the norm).
        assert!(worst <= 1e-10, "{}: {worst:e} apart", choice.name());
    }
}

/// Lengths by 4^a, stiffness by a power of four: every number is a power of two of the one before.
#[test]
fn a_relaxation_in_other_units_takes_the_same_steps_to_the_same_bits() {
    fn check<L: PairLaw>(laws: [L; 2], length: f64) {
        let scale = |column: &[Vector<2>]| -> Vec<Vector<2>> { column.iter().map(|x| scaled(length, *x)).collect() };
        let packing = points::<2>(100, 0.9, 15);
        let side = packing.domain().lengths().expect("periodic")[0];
        let radii = packing.radii().iter().map(|radius| radius * length).collect();
        let other = Packing::new(Domain::cube(side * length), scale(packing.positions()), radii).expect("valid");
        for choice in all(1e-10) {
            let (one, two) = (relax(&choice, packing.clone(), &laws[0]), relax(&choice, other.clone(), &laws[1]));
            assert_eq!(one.stop, Stop::Converged(Criterion::RelativeForce), "{}", choice.name());
            let counts = |outcome: &Outcome<Packing<2>>| (outcome.cost.step_count, outcome.cost.force_evaluation_count);
            assert_eq!(counts(&one), counts(&two), "{}", choice.name());
            assert_eq!(scale(one.state.positions()), two.state.positions());
            assert_eq!(scale(one.state.corrections()), two.state.corrections());
        }
    }
    check([Hertzian { stiffness: 2e5 }, Hertzian { stiffness: 2e5 * 64.0 }], 16.0);
    check([Hertzian { stiffness: 2e5 }, Hertzian { stiffness: 2e5 / 256.0 }], 0.25);
    check([Hookean { stiffness: 2e5 }, Hookean { stiffness: 2e5 / 256.0 }], 4.0);
}

#[test]
fn the_same_input_gives_the_same_bits() {
    for choice in all(1e-8) {
        let [one, two] = [(); 2].map(|()| relax(&choice, points::<2>(100, 0.9, 14), &Hertzian::default()));
        assert_eq!(one.state, two.state);
        assert_eq!((one.stop, one.residual, one.cost.step_count), (two.stop, two.residual, two.cost.step_count));
    }
}

/// A limit of zero cannot be met: it ends where rounding is all there is.
#[test]
fn a_limit_of_zero_ends_at_the_rounding_floor() {
    for (name, index) in [("hertz_N1000_p1", 0), ("hertz_N1000_p100", 1), ("hertz_N1000_p800", 2)] {
        for choice in all(0.0) {
            let outcome = relax(&choice, inflated(name, index), &Hertzian::default());
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
        let law = Hertzian::default();
        for packing in [points::<2>(100, 0.7, 10), lone.clone(), two.clone()] {
            let outcome = relax(&choice, packing, &law);
            assert_eq!(outcome.stop, Stop::Converged(Criterion::Unjammed), "{}", choice.name());
        }
        // Nothing can move: at rest as it is.
        let outcome = relax(&choice, held.clone(), &law);
        assert_eq!((outcome.state, outcome.cost.step_count), (held.clone(), 0), "{}", choice.name());
    }
}

/// Three disks in a row between two held ones have no backbone and rest under one force F = c_j δ_j^(α−1).
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
    for choice in all(limit) {
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

#[test]
fn disks_that_nothing_holds_run_away_from_their_sites_and_end_without_a_minimum() {
    let stiffness = 2.0 * 2e5;
    for share in [1.5, 10.0, 1e6] {
        let law = OnSite { law: Hookean { stiffness: 2e5 }, coupling: share * stiffness };
        let grown = cross([0.0; 2]).with_radius(2, 0.501).expect("positive");
        for choice in all(1e-12) {
            let outcome = relax(&choice, grown.clone(), &law);
            assert_eq!(outcome.stop, Stop::NoMinimum, "Γ = {share} K, {}: {:?}", choice.name(), outcome.cost);
        }
    }
}

#[test]
fn limits_are_outcomes() {
    for choice in [
        RelaxerChoice::ConjugateGradients(NonlinearConjugateGradients { step_limit: 7, ..Default::default() }),
        RelaxerChoice::QuasiNewton(QuasiNewton { step_limit: 7, ..QuasiNewton::default() }),
    ] {
        let outcome = relax(&choice, points::<2>(100, 0.9, 8), &Hertzian::default());
        assert_eq!((outcome.stop, outcome.cost.step_count), (Stop::StepLimit, 7), "{}", choice.name());
    }
    for choice in [gradients(ForceLimit::Absolute(1e-9)), quasi_newton(ForceLimit::Absolute(1e-9))] {
        let outcome = relax(&choice, inflated("hertz_N1000_p100", 0), &Hertzian::default());
        assert_eq!(outcome.stop, Stop::Converged(Criterion::AbsoluteForce), "{}", choice.name());
        assert!(outcome.residual.largest_net_force <= 1e-9 && outcome.residual.mean_contact_force > 1.0);
    }
    // FIRE 2.0 gives up after so many steps uphill; none is soon too few.
    let uphill = Uphill::StepBack(StepBack { uphill_limit: 0, ..StepBack::default() });
    let outcome = relax(&Fire { uphill, ..Fire::default() }, inflated("hertz_N1000_p100", 0), &Hertzian::default());
    assert_eq!(outcome.stop, Stop::NoDescent);
    // A memory for all steps there may ever be is as large as the steps there are.
    let endless = QuasiNewton { memory: usize::MAX, ..QuasiNewton::default() };
    let _ = at_rest(relax(&endless, points::<2>(100, 0.95, 8), &Hertzian::default()));
    // Without memory L-BFGS is steepest descent, which is slow but not lost.
    let choice = RelaxerChoice::QuasiNewton(QuasiNewton { memory: 0, ..QuasiNewton::default() });
    let _ = at_rest(relax(&choice, cross([0.02, -0.013]), &Hertzian::default()));
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
            let outcome = relax(&limited, packing.clone(), &Hertzian::default());
            let way = norm(outcome.state.separation(0, 1));
            // Both move alike, the smaller one by a tenth of 1/2 at most.
            assert!(way <= 0.1 * step_limit as f64 * (1.0 + 1e-12) + 1e-9, "{}: {way}", choice.name());
        }
    }
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

/// Steps and evaluations of fixed scenes. They may move with the method, not by accident: within a quarter of what was counted
/// when this was written.
#[test]
fn the_work_of_fixed_scenes_stays_what_it_was() {
    let counted = |name: &str, choice: RelaxerChoice, steps: usize, evaluations: usize| {
        let outcome = relax(&choice, inflated(name, 0), &Hertzian::default());
        println!("{name}, {}: {:?}, {:?}", choice.name(), outcome.stop, outcome.cost);
        assert_eq!(outcome.stop, Stop::Converged(Criterion::RelativeForce));
        let near = |ours: usize, then: usize| 4 * ours.abs_diff(then) <= then;
        let (ours, then) = (outcome.cost, (steps, evaluations));
        assert!(near(ours.step_count, then.0), "{name}, {}: {} steps, {} then", choice.name(), ours.step_count, then.0);
        let made = ours.force_evaluation_count;
        assert!(near(made, then.1), "{name}, {}: {made} evaluations, {} then", choice.name(), then.1);
    };
    for (name, work) in [
        ("hertz_N1000_p10", [(1850, 3198), (1890, 1954), (2780, 2798)]),
        ("hertz_N1000_p800", [(440, 770), (470, 492), (640, 652)]),
    ] {
        for (choice, (steps, evaluations)) in all(1e-8).into_iter().zip(work) {
            counted(name, choice, steps, evaluations);
        }
    }
}

#[test]
fn a_state_at_rest_is_left_as_it_was_found() {
    let packing = cross([0.0; 2]);
    let mut assembly = Assembly::new(&packing, Hookean::default()).expect("no coincidence");
    assert_eq!(assembly.evaluate_totals().contact_count, 4);
    for choice in all(1e-8) {
        let outcome = relax(&choice, packing.clone(), &Hookean::default());
        assert_eq!((outcome.state, outcome.cost.step_count), (packing.clone(), 0), "{}", choice.name());
    }
}
