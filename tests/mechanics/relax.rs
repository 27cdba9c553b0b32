//! Relaxers: closed forms, energies on the way, agreement with each other, outcomes, units, and work.

mod descent;
mod outcomes;

use jamscope::forces::Assembly;
use jamscope::law::damping::{ConstantDamping, ContactDamping, DampingChoice};
use jamscope::law::{Hertzian, Hookean, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Mixture, Packing};
use jamscope::preparation::random_points;
use jamscope::relax::{
    Check, Criterion, DampedDynamics, Fire, ForceLimit, Motion, Outcome, Relaxer, Stop, TimeStep, rounding_floor,
};
use jamscope::vector::{Vector, difference, dot, larger, norm, scaled, sum};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::scenes::laws::{hertzian, hookean};

fn points(count: usize, packing_fraction: f64, seed: u64) -> Packing<2> {
    random_points::<2>(count, &Mixture::default(), packing_fraction, seed).expect("a possible packing fraction")
}

fn relax(relaxer: &impl Relaxer, packing: Packing<2>, law: &dyn PairLaw) -> Outcome<Packing<2>> {
    relaxer.relax(packing, law, &mut ()).expect("no coincidence")
}

fn at_rest(outcome: Outcome<Packing<2>>) -> Packing<2> {
    outcome.converged().expect("at rest").into_inner()
}

fn fire(limit: f64) -> Fire {
    Fire { limit: ForceLimit::Relative(limit), ..Fire::default() }
}

fn damped(limit: f64) -> DampedDynamics {
    DampedDynamics { limit: ForceLimit::Relative(limit), ..DampedDynamics::default() }
}

/// A disk between four held ones at the corners of a cross around (3, 7), at rest in the middle.
fn cross(from: Vector<2>) -> Packing<2> {
    let middle = [3.0, 7.0];
    let held = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]].map(|arm| sum(middle, arm));
    let positions = [&[sum(middle, from)][..], &held[..]].concat();
    Packing::new(Domain::Open, positions, vec![0.55, 0.5, 0.5, 0.5, 0.5])
        .and_then(|packing| packing.with_held(vec![false, true, true, true, true]))
        .expect("valid")
}

#[test]
fn a_disk_between_four_held_ones_comes_to_rest_in_their_middle() {
    fn check(law: &dyn PairLaw, relaxer: &impl Relaxer, limit: f64) {
        let packing = at_rest(relax(relaxer, cross([0.02, -0.013]), law));
        let force = law.force(law.coefficient(0.55, 0.5), 0.05);
        // Stiffness of the mobile disk: two contacts along, 2 F', two across, −2 F/r with r = 1.
        let stiffness = 2.0 * (law.stiffness(force, 0.05) - force);
        let (position, rest) = packing.centre(0);
        let off = norm(sum(difference(position, [3.0, 7.0]), rest));
        // Force limit over stiffness; twice, for the change of both on the way to the middle.
        assert!(off <= 2.0 * limit * force / stiffness, "{law:?}: {off:e} from the middle");
    }
    check(&hertzian(), &fire(1e-10), 1e-10);
    check(&hookean(), &fire(1e-10), 1e-10);
    check(&hertzian(), &damped(1e-10), 1e-10);
    check(&hookean(), &damped(1e-10), 1e-10);
}

/// Two Hertzian disks let go: largest deviation of the total energy on their way apart, relative.
fn energy_error(step_count: usize) -> f64 {
    let (first, time) = (0.04, 1.2e-2);
    let packing = Packing::new(Domain::<2>::Open, vec![[0.0, 0.0], [1.2 - first, 0.0]], vec![0.5, 0.7]).expect("valid");
    let damping = ContactDamping::Constant(ConstantDamping { rate: 0.0 });
    let mut motion = Motion::new(&packing, &hertzian(), &damping).expect("two disks apart");
    let start = motion.assembly.evaluate_totals().energy;
    let mut worst = 0.0f64;
    for _ in 0..step_count {
        motion.step(time / step_count as f64).expect("no coincidence");
        let energy = motion.assembly.evaluate_totals().energy + motion.kinetic_energy();
        worst = larger(worst, (energy / start - 1.0).abs());
    }
    let totals = motion.assembly.evaluate_totals();
    assert_eq!(totals.contact_count, 0, "still in contact after {time}");
    // All of the energy is kinetic now, half of it each: v² = u(δ₀).
    let speeds = [norm(motion.velocities[0]), norm(motion.velocities[1])];
    for speed in speeds {
        assert!((speed * speed / start - 1.0).abs() <= worst + 1e-12, "{speeds:?}");
    }
    worst
}

#[test]
fn hertzian_disks_keep_their_energy_without_damping_to_second_order() {
    let errors = [energy_error(64), energy_error(128), energy_error(256), energy_error(512)];
    // Velocity Verlet: error c h² while F' is smooth; where the contact opens F' has a square root, which adds h^2.5 and
    // more: at h ω = 0.1 and less the order is off by less than 0.1.
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.1, "order {order}, errors {errors:?}");
    }
}

#[test]
fn energies_at_the_restarts_of_fire_never_increase() {
    for (seed, law) in [(1, Hertzian { stiffness: 2e5 }), (2, Hertzian { stiffness: 1.0 })] {
        let packing = points(200, 0.9, seed);
        let mut checks: Vec<Check> = Vec::new();
        let start = ContactNetwork::new(&packing, &law).expect("no coincidence").energy();
        let outcome =
            fire(1e-8).relax(packing, &law, &mut |check: &Check| checks.push(*check)).expect("no coincidence");
        let packing = at_rest(outcome);
        let end = ContactNetwork::new(&packing, &law).expect("no coincidence").energy();
        let restarts: Vec<f64> = checks.iter().filter(|check| check.restart).map(|check| check.energy).collect();
        assert!(restarts.len() > 3, "{} restarts", restarts.len());
        // Rounding of a sum over contacts, as the relaxer claims.
        let rounding = 1.0 + 1e-13;
        assert!(restarts[0] <= start * rounding, "first restart {} above the start {start}", restarts[0]);
        assert!(restarts.is_sorted_by(|&before, &after| after <= before * rounding), "{restarts:?}");
        assert!(end <= restarts[restarts.len() - 1] * rounding, "end {end}");
    }
}

/// With the first step beyond stability FIRE climbs at once; it must come back, shorten the step and end below the start.
#[test]
fn fire_comes_back_from_a_time_step_far_too_long() {
    let packing = at_rest(relax(&fire(1e-4), points(100, 0.9, 3), &hertzian()));
    let law = hertzian();
    let start = ContactNetwork::new(&packing, &law).expect("no coincidence").energy();
    let settings = Fire { time_step_fraction: 40.0, step_limit: 400, ..fire(1e-10) };
    let mut restarts = Vec::new();
    let mut trace = |check: &Check| {
        if check.restart {
            restarts.push(check.energy)
        }
    };
    let outcome = settings.relax(packing, &law, &mut trace).expect("no coincidence");
    println!("start {start}, restarts {restarts:?}, {:?}", outcome.stop);
    assert!(restarts.len() > 2);
    assert!(restarts.iter().all(|&energy| energy <= start * (1.0 + 1e-13)), "start {start}, restarts {restarts:?}");
}

/// The total energy at every look of a slightly overdamped step can rise by the integrator's error only.
///
/// Velocity Verlet follows H + h² (v·K·v/12 − F²/24) to higher order, so H itself is off by at most h² λ/6 of the energy
/// above the minimum at either end, h² λ/3 together, and damping only takes. At a share s of the stable step
/// h² λ_K / 2 ≤ 2 s², so the rise is below (4/3) s² (E − E_min).
#[test]
fn damped_dynamics_only_loses_energy() {
    let share = 0.1;
    for (seed, law) in [(1, hertzian()), (2, hertzian())] {
        let packing = points(100, 0.95, seed);
        let settings = DampedDynamics {
            damping: DampingChoice::Constant(ConstantDamping { rate: 50.0 }),
            time_step: TimeStep::OfStability(share),
            ..damped(1e-6)
        };
        let mut totals: Vec<f64> = Vec::new();
        let mut trace = |check: &Check| totals.push(check.energy + check.kinetic_energy);
        let outcome = settings.relax(packing, &law, &mut trace).expect("no coincidence");
        assert!(matches!(outcome.stop, Stop::Converged(_)), "{:?}", outcome.stop);
        assert!(totals.len() > 100, "{} checks", totals.len());
        let least = totals.iter().copied().fold(f64::INFINITY, f64::min);
        for pair in totals.windows(2) {
            let allowed = 4.0 / 3.0 * share * share * (pair[0] - least) + 1e-13 * pair[0];
            assert!(pair[1] - pair[0] <= allowed, "{} rises to {}", pair[0], pair[1]);
        }
        assert!(totals[totals.len() - 1] < totals[0]);
    }
}

#[test]
fn damped_motion_keeps_the_momentum() {
    let packing = points(100, 0.95, 4);
    let mut motion =
        Motion::new(&packing, &hertzian(), &ContactDamping::Constant(ConstantDamping { rate: 500.0 })).expect("apart");
    let mut generator = Pcg64::seed_from_u64(5);
    for velocity in &mut motion.velocities {
        *velocity = std::array::from_fn(|_| generator.random::<f64>());
    }
    let momentum = |velocities: &[Vector<2>]| velocities.iter().fold([0.0; 2], |total, &v| sum(total, v));
    let start = momentum(&motion.velocities);
    let (step_count, time_step) = (400, 1e-4);
    let mut kicked = 0.0;
    for _ in 0..step_count {
        motion.step(time_step).expect("no coincidence");
        let net: f64 = motion.total_forces().iter().map(|&force| norm(force)).sum();
        let speeds: f64 = motion.velocities.iter().map(|&velocity| norm(velocity)).sum();
        // Each step rounds velocities, and forces with up to 10 contacts a disk of up to 10 times the net force.
        kicked += speeds + 100.0 * time_step * net;
    }
    let off = norm(difference(momentum(&motion.velocities), start));
    assert!(off <= f64::EPSILON * kicked, "{off:e} of {start:?}, rounding {:e}", f64::EPSILON * kicked);
}

/// Softest stiffness of a packing: Rayleigh quotient after power iteration on (bound − K), translations left out.
/// The quotient is an upper bound that falls towards the softest eigenvalue; K is applied by differences of forces.
fn softest_stiffness(packing: &Packing<2>, law: &dyn PairLaw) -> f64 {
    let mut assembly = Assembly::new(packing, law).expect("no coincidence");
    let backbone = ContactNetwork::new(packing, law).expect("no coincidence").backbone;
    let member: Vec<bool> = assembly.order().iter().map(|&disk| backbone[disk as usize]).collect();
    let bound = assembly.stiffness_bound(&mut Vec::new());
    let mut generator = Pcg64::seed_from_u64(1);
    let mut mode: Vec<Vector<2>> =
        member.iter().map(|_| std::array::from_fn(|_| generator.random::<f64>() - 0.5)).collect();
    let (mut quotient, length) = (f64::INFINITY, 1e-6);
    for _ in 0..20_000 {
        let count = member.iter().filter(|&&member| member).count() as f64;
        let mean =
            mode.iter().zip(&member).filter(|&(_, &member)| member).fold([0.0; 2], |total, (&m, _)| sum(total, m));
        for (m, &member) in mode.iter_mut().zip(&member) {
            *m = if member { difference(*m, scaled(1.0 / count, mean)) } else { [0.0; 2] };
        }
        let size = mode.iter().map(|&m| dot(m, m)).sum::<f64>().sqrt();
        mode.iter_mut().for_each(|m| *m = scaled(1.0 / size, *m));
        let mut forces_at = |side: f64| {
            assembly.displacements.copy_from_slice(&mode.iter().map(|&m| scaled(side * length, m)).collect::<Vec<_>>());
            assembly.evaluate();
            assembly.forces.clone()
        };
        let (ahead, behind) = (forces_at(1.0), forces_at(-1.0));
        let stiff: Vec<Vector<2>> =
            ahead.iter().zip(&behind).map(|(&a, &b)| scaled(-0.5 / length, difference(a, b))).collect();
        quotient = mode.iter().zip(&stiff).map(|(&m, &s)| dot(m, s)).sum();
        mode = mode.iter().zip(&stiff).map(|(&m, &s)| difference(scaled(bound, m), s)).collect();
    }
    quotient
}

#[test]
fn fire_and_damped_dynamics_meet_in_a_minimum_near_by() {
    fn check(law: &dyn PairLaw) {
        let limit = 1e-9;
        let minimum = at_rest(relax(&fire(1e-12), points(64, 1.0, 6), law));
        let network = ContactNetwork::new(&minimum, law).expect("no coincidence");
        let mut generator = Pcg64::seed_from_u64(7);
        let mut shaken = minimum.positions().to_vec();
        for position in &mut shaken {
            *position = std::array::from_fn(|d| position[d] + 1e-3 * (generator.random::<f64>() - 0.5));
        }
        let start = || Packing::new(*minimum.domain(), shaken.clone(), minimum.radii().to_vec()).expect("valid");
        let ends = [at_rest(relax(&fire(limit), start(), law)), at_rest(relax(&damped(limit), start(), law))];
        // Nothing holds the packing as a whole, and both keep its centre of mass: distances from the mean of the backbone.
        let from_mean = |packing: &Packing<2>| -> Vec<Vector<2>> {
            let members: Vec<usize> = (0..packing.len()).filter(|&disk| network.backbone[disk]).collect();
            let moved = |disk: usize| packing.domain().separation(packing.centre(disk), minimum.centre(disk));
            let mean = members.iter().fold([0.0; 2], |total, &disk| sum(total, moved(disk)));
            members.iter().map(|&disk| difference(moved(disk), scaled(1.0 / members.len() as f64, mean))).collect()
        };
        let softest = softest_stiffness(&minimum, law);
        // |u| ≤ |F| / λ_min, |F| ≤ √N times the largest force on a disk.
        let allowed = limit * network.mean_contact_force() * (minimum.len() as f64).sqrt() / softest;
        for end in &ends {
            let worst = from_mean(end).into_iter().map(norm).fold(0.0, larger);
            println!("{law:?}: softest {softest}, {worst:e} from the minimum, allowed {allowed:e}");
            assert!(worst <= allowed, "{worst:e} from the minimum, allowed {allowed:e}");
        }
        assert!(allowed < 1e-6, "the tolerance {allowed:e} says nothing");
    }
    check(&hertzian());
    check(&hookean());
}

/// One disk between two held ones has one mode, for which Gershgorin's rows are the eigenvalues: λ_K = 2k, λ_Γ = 2γ. The
/// default step must be stable there too; a fixed one three times as long is not, and must not end as a packing.
#[test]
fn the_default_step_is_stable_where_its_bound_is_tight_and_a_longer_one_is_found_out() {
    let line = || {
        Packing::new(Domain::Open, vec![[1e-3, 0.0], [-0.9, 0.0], [0.9, 0.0]], vec![0.5; 3])
            .and_then(|packing| packing.with_held(vec![false, true, true]))
            .expect("valid")
    };
    for rate in [100.0, 500.0, 5000.0] {
        let law = hookean();
        let damping = DampingChoice::Constant(ConstantDamping { rate });
        let settings = DampedDynamics { damping, limit: ForceLimit::Absolute(1e-6), ..DampedDynamics::default() };
        let outcome = relax(&settings, line(), &law);
        assert_eq!(outcome.stop, Stop::Converged(Criterion::AbsoluteForce), "rate {rate}");
        let (by_stiffness, by_damping): (f64, f64) = (2.0 * Hookean::default().stiffness, 2.0 * rate);
        let limit = 2.0 * ((by_damping.powi(2) + by_stiffness).sqrt() - by_damping) / by_stiffness;
        let outcome = relax(&DampedDynamics { time_step: TimeStep::Fixed(3.0 * limit), ..settings }, line(), &law);
        assert_eq!(outcome.stop, Stop::Unstable, "rate {rate}");
    }
}

#[test]
fn the_same_input_gives_the_same_bits() {
    let outcomes = || {
        let (packing, law) = (points(100, 0.9, 14), hertzian());
        [relax(&fire(1e-8), packing.clone(), &law), relax(&damped(1e-6), packing, &law)]
    };
    for (one, two) in outcomes().into_iter().zip(outcomes()) {
        assert_eq!(one.state, two.state);
        assert_eq!((one.stop, one.residual, one.cost.step_count), (two.stop, two.residual, two.cost.step_count));
        assert!(matches!(one.stop, Stop::Converged(_)));
    }
}

/// Lengths by 4^a, stiffness by 2^b with b even: forces by powers of two, times by √(1/F') = 2^(−b/2 − a) (Hertzian,
/// masses 1) or 2^(−b/2) (Hookean). No rounding changes, so every step is the same.
#[test]
fn a_relaxation_in_other_units_takes_the_same_steps_to_the_same_bits() {
    fn check(laws: [&dyn PairLaw; 2], length: f64, time: f64) {
        let packing = points(100, 0.9, 15);
        let scale = |column: &[Vector<2>]| -> Vec<Vector<2>> { column.iter().map(|x| x.map(|x| x * length)).collect() };
        let side = packing.domain().lengths().expect("periodic")[0];
        let radii = packing.radii().iter().map(|radius| radius * length).collect();
        let other = Packing::new(Domain::cube(side * length), scale(packing.positions()), radii).expect("valid");
        let same = |one: Outcome<Packing<2>>, two: Outcome<Packing<2>>| {
            assert!(matches!(one.stop, Stop::Converged(_)), "{:?}", one.stop);
            assert_eq!(
                (one.stop, one.cost.step_count, one.cost.build_count),
                (two.stop, two.cost.step_count, two.cost.build_count)
            );
            assert_eq!(scale(one.state.positions()), two.state.positions());
            assert_eq!(scale(one.state.corrections()), two.state.corrections());
            assert_eq!(one.residual.relative(), two.residual.relative());
        };
        same(relax(&fire(1e-8), packing.clone(), laws[0]), relax(&fire(1e-8), other.clone(), laws[1]));
        let with_rate =
            |rate: f64| DampedDynamics { damping: DampingChoice::Constant(ConstantDamping { rate }), ..damped(1e-5) };
        same(relax(&with_rate(500.0), packing, laws[0]), relax(&with_rate(500.0 / time), other, laws[1]));
    }
    check([&Hertzian { stiffness: 2e5 }, &Hertzian { stiffness: 2e5 * 64.0 }], 16.0, 1.0 / 8.0 / 4.0);
    check([&Hertzian { stiffness: 2e5 }, &Hertzian { stiffness: 2e5 / 256.0 }], 0.25, 16.0 * 2.0);
    check([&Hookean { stiffness: 2e5 }, &Hookean { stiffness: 2e5 / 256.0 }], 4.0, 16.0);
}

#[test]
fn checks_are_rare_until_forces_are_small() {
    let limit = 1e-8;
    let mut checks: Vec<Check> = Vec::new();
    let mut trace = |check: &Check| checks.push(*check);
    let packing = points(256, 0.95, 16);
    let outcome = fire(limit).relax(packing, &hertzian(), &mut trace).expect("no coincidence");
    assert!(matches!(outcome.stop, Stop::Converged(_)));
    checks.retain(|check| !check.restart);
    // "Small" is 30 times the limit, by the largest component of any disk a step before.
    let far = checks.iter().filter(|check| check.residual > 100.0 * limit);
    assert!(far.clone().count() > 3);
    assert!(far.clone().all(|check| check.step_count % 80 == 0), "{:?}", far.collect::<Vec<_>>());
    let near: Vec<usize> =
        checks.iter().skip_while(|check| check.residual > 10.0 * limit).map(|check| check.step_count).collect();
    assert!(near.len() > 1 && near.windows(2).all(|pair| pair[1] == pair[0] + 20), "{near:?}");
}

#[test]
fn a_damped_motion_cut_short_tells_the_residual_where_it_is() {
    // Between two checks, of which the last was 17 steps before.
    let cut = DampedDynamics { step_limit: 37, ..damped(1e-12) };
    let law = hertzian();
    let outcome = relax(&cut, points(64, 0.95, 16), &law);
    assert_eq!(outcome.stop, Stop::StepLimit);
    let told = outcome.residual.relative();
    let there = relax(&DampedDynamics { step_limit: 0, ..cut }, outcome.state, &law).residual.relative();
    // Sums of a few contact forces, each to 10⁻¹⁵ of itself.
    assert!((told - there).abs() < 1e-12 * there, "{told} told, {there} there");
}

/// Steps, evaluations and lists of fixed scenes. They may change with the method, not by accident: within a quarter of what
/// was counted when this was written.
#[test]
fn the_work_of_fixed_scenes_stays_what_it_was() {
    let counted = |what: &str, outcome: Outcome<Packing<2>>, steps: usize, evaluations: usize, lists: usize| {
        let cost = outcome.cost;
        println!("{what}: {cost:?} {:?}", outcome.stop);
        assert!(matches!(outcome.stop, Stop::Converged(_)), "{what}: {:?}", outcome.stop);
        let near = |ours: usize, then: usize| 4 * ours.abs_diff(then) <= then.max(4);
        assert!(near(cost.step_count, steps), "{what}: {} steps, {steps} then", cost.step_count);
        let counts = (cost.force_evaluation_count, evaluations);
        assert!(
            near(counts.0, counts.1) && counts.0 > cost.step_count,
            "{what}: {} evaluations, {} then",
            counts.0,
            counts.1
        );
        assert!(near(cost.build_count, lists), "{what}: {} lists, {lists} then", cost.build_count);
    };
    let law = hertzian();
    counted("FIRE, random points at 0.9", relax(&fire(1e-8), points(256, 0.9, 16), &law), 940, 962, 54);
    counted("FIRE, random points at 1.0", relax(&fire(1e-8), points(256, 1.0, 16), &law), 880, 902, 62);
    counted("FIRE, Hookean, 0.9", relax(&fire(1e-8), points(256, 0.9, 16), &hookean()), 1100, 1122, 60);
    counted("damped, 0.95", relax(&damped(1e-5), points(256, 0.95, 16), &law), 22720, 23858, 56);
}
