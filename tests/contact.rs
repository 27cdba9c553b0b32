//! Contacts: the neighbour list and the hot loop against their slow twins, forces against energies, invariances,
//! rounding, and what is refused.
//!
//! Random cases come from proptest with a fixed seed, so every run sees the same ones; a failure prints its case.

#[path = "twins/all_pairs.rs"]
mod all_pairs;
#[path = "twins/naive_backbone.rs"]
mod naive_backbone;
#[path = "scenes/random_disks.rs"]
mod random_disks;

use std::collections::BTreeSet;
use std::f64::consts::SQRT_2;

use all_pairs::{mechanics, pairs_within};
use jamscope::contact::assembly::SKIN;
use jamscope::contact::forces::Totals;
use jamscope::contact::network::backbone;
use jamscope::contact::{Assembly, ContactNetwork, Hertzian, Hookean, PairLaw, PowerLaw};
use jamscope::packing::{Domain, Packing, PackingError};
use jamscope::vector::{Vector, difference, norm, sum};
use naive_backbone::contacts_within;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use random_disks::{disks, on_grid, periodic};

/// Unit roundoff, twice.
const EPSILON: f64 = f64::EPSILON;

fn cases(count: u32) -> ProptestConfig {
    ProptestConfig {
        cases: count,
        rng_seed: RngSeed::Fixed(20),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Boxes from the smallest allowed (one to three cells a side) to elongated ones, and the open plane (`None`).
fn domains<const D: usize>() -> impl Strategy<Value = Domain<D>> {
    let side = prop_oneof![Just(1.0), 1.0..1.6f64, 1.0..6.0f64];
    prop_oneof![
        4 => proptest::array::uniform::<_, D>(side).prop_map(|sides| periodic(sides.map(on_grid))),
        1 => Just(Domain::Open),
    ]
}

/// Forces of the hot loop in the caller's order, from buffers full of NaN.
fn evaluated<const D: usize, L: PairLaw>(assembly: &mut Assembly<D, L>) -> (Vec<Vector<D>>, Totals<D>) {
    assembly.forces.fill([f64::NAN; D]);
    let totals = assembly.evaluate_totals();
    let with_totals = assembly.forces.clone();
    assembly.forces.fill([f64::NAN; D]);
    assembly.evaluate();
    assert_eq!(assembly.forces, with_totals, "the loop with totals gives other forces than the one without");
    let mut forces = vec![[f64::NAN; D]; assembly.len()];
    for (&disk, &force) in assembly.order().iter().zip(&with_totals) {
        forces[disk as usize] = force;
    }
    (forces, totals)
}

fn forces_of<const D: usize, L: PairLaw>(packing: &Packing<D>, law: L) -> (Vec<Vector<D>>, Totals<D>) {
    evaluated(&mut Assembly::new(packing, law).expect("no coincidence"))
}

/// How far forces and totals may be off when every separation is known to `blur` only, pair by pair: the force by
/// F(δ + blur) − F(δ) and by the turn of its direction, F blur / r; and by 16 roundings of itself.
struct Allowed {
    forces: Vec<f64>,
    energy: f64,
    virial: f64,
    force_sum: f64,
}

fn allowed<const D: usize, L: PairLaw>(packing: &Packing<D>, law: &L, blur: f64) -> Allowed {
    let pairs = pairs_within(packing, blur);
    let mut allowed = Allowed { forces: vec![0.0; packing.len()], energy: 0.0, virial: 0.0, force_sum: 0.0 };
    // A sum over all contacts rounds once a contact.
    let sum_rounding = (16 + pairs.len()) as f64 * EPSILON;
    for pair in &pairs {
        let coefficient = law.coefficient(packing.radii()[pair.first], packing.radii()[pair.second]);
        let overlap = pair.overlap.max(0.0);
        let (force, most) = (law.force(coefficient, overlap), law.force(coefficient, overlap + blur));
        let off = (most - force) + most * (blur / pair.distance + 16.0 * EPSILON);
        // A disk has at most all pairs; its sum rounds once each.
        allowed.forces[pair.first] += off + sum_rounding * most;
        allowed.forces[pair.second] += off + sum_rounding * most;
        allowed.energy += most * blur + sum_rounding * most * (overlap + blur);
        allowed.virial += off * pair.distance + most * blur + sum_rounding * most * pair.distance;
        allowed.force_sum += off + sum_rounding * most;
    }
    allowed
}

/// Rounding of plain coordinate differences: a few roundings of the largest coordinate and the largest box.
fn blur<const D: usize>(packing: &Packing<D>) -> f64 {
    let largest = packing.positions().iter().flatten().fold(1.0f64, |most, value| most.max(value.abs()));
    let side = packing.domain().lengths().map_or(0.0, |lengths| lengths.iter().copied().fold(0.0, f64::max));
    8.0 * EPSILON * (largest + 3.0 * side)
}

fn assert_agree<const D: usize>(
    what: &str,
    ours: (&[Vector<D>], &Totals<D>),
    theirs: (&[Vector<D>], f64, &[[f64; D]; D], f64),
    allowed: &Allowed,
) {
    for (disk, (&a, &b)) in ours.0.iter().zip(theirs.0).enumerate() {
        let off = norm(difference(a, b));
        assert!(off <= allowed.forces[disk], "{what}: force on {disk} is {a:?}, not {b:?}");
    }
    let totals = ours.1;
    assert!((totals.energy - theirs.1).abs() <= allowed.energy, "{what}: energy {} and {}", totals.energy, theirs.1);
    for a in 0..D {
        for b in 0..D {
            let off = (totals.virial[a][b] - theirs.2[a][b]).abs();
            assert!(off <= allowed.virial, "{what}: virial {a}{b} {:?} and {:?}", totals.virial, theirs.2);
        }
    }
    assert!((totals.force_sum - theirs.3).abs() <= allowed.force_sum, "{what}: {} and {}", totals.force_sum, theirs.3);
}

/// The list has every pair in reach, once, along the right image, and nothing beyond the skin.
fn assert_list_is_complete<const D: usize, L: PairLaw>(assembly: &Assembly<D, L>, packing: &Packing<D>, fresh: bool) {
    let smallest = packing.radii().iter().copied().fold(f64::INFINITY, f64::min);
    let pairs = assembly.pairs();
    let order = assembly.order();
    let blur = blur(packing);
    let listed: BTreeSet<(usize, usize)> = (0..pairs.len())
        .map(|pair| {
            let (i, j) = (pairs.first[pair] as usize, pairs.second[pair] as usize);
            assert!(i < j && i < assembly.mobile_count(), "pair {i} {j} is held–held or in the wrong order");
            let (a, b) = (order[i] as usize, order[j] as usize);
            if fresh {
                let reach = packing.radii()[a] + packing.radii()[b] + SKIN * smallest;
                assert!(pairs.distance[pair] < reach + blur, "pair {a} {b} is beyond the skin");
            }
            (a.min(b), a.max(b))
        })
        .collect();
    assert_eq!(listed.len(), pairs.len(), "a pair is listed twice");
    for pair in pairs_within(packing, -blur) {
        assert!(listed.contains(&(pair.first, pair.second)), "{} and {} touch, unlisted", pair.first, pair.second);
    }
}

fn check_against_all_pairs<const D: usize, L: PairLaw>(law: L, seed: u64, count: usize, domain: Domain<D>) {
    let packing = disks(seed, count, domain, 0.2);
    let mut assembly = Assembly::new(&packing, law).expect("no coincidence");
    let mut generator = Pcg64::seed_from_u64(seed ^ 1);
    // First as listed, then in flight, each disk on its own straight way for up to half the skin a round: between two
    // rounds the list stays or is made anew, and at the end disks have come together from well beyond the skin.
    let mobile = assembly.mobile_count();
    let mut away = |_| std::array::from_fn(|_| 0.15 * SKIN * (2.0 * generator.random::<f64>() - 1.0));
    let flight: Vec<Vector<D>> = (0..mobile).map(&mut away).collect();
    let longest = flight.iter().map(|&step| norm(step)).fold(0.0, f64::max);
    for round in 0..8 {
        if round > 0 {
            for (u, &step) in assembly.displacements[..mobile].iter_mut().zip(&flight) {
                *u = sum(*u, step);
            }
            assembly.keep_listed(longest).expect("no coincidence");
        }
        let placed = assembly.placed(packing.clone());
        assert_list_is_complete(&assembly, &placed, round == 0);
        let (forces, totals) = evaluated(&mut assembly);
        let twin = mechanics(&placed, &law);
        let allowed = allowed(&placed, &law, blur(&placed));
        let theirs = (&twin.forces[..], twin.energy, &twin.virial, twin.force_sum);
        assert_agree("hot loop and twin", (&forces, &totals), theirs, &allowed);
        let near = pairs_within(&placed, blur(&placed)).len() - pairs_within(&placed, -blur(&placed)).len();
        assert!(totals.contact_count.abs_diff(twin.contact_count) <= near, "contacts");
    }
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn list_and_hot_loop_are_those_of_all_pairs_in_the_plane(
        seed: u64, count in 1usize..60, domain in domains::<2>(), exponent in 2.0..4.0f64,
    ) {
        check_against_all_pairs(Hertzian::default(), seed, count, domain);
        check_against_all_pairs(Hookean::default(), seed, count, domain);
        check_against_all_pairs(PowerLaw { energy_scale: 1.0, exponent }, seed, count, domain);
    }

    #[test]
    fn contacts_of_the_network_are_those_of_all_pairs(seed: u64, count in 1usize..60, domain in domains::<2>()) {
        let packing = disks(seed, count, domain, 0.2);
        let network = ContactNetwork::new(&packing, &Hertzian::default()).expect("no coincidence");
        let ours: Vec<(usize, usize)> =
            network.contacts.iter().map(|contact| (contact.first as usize, contact.second as usize)).collect();
        let sure = pairs_within(&packing, -blur(&packing));
        let possible = pairs_within(&packing, blur(&packing));
        prop_assert!(ours.is_sorted());
        let ours: BTreeSet<_> = ours.into_iter().collect();
        prop_assert_eq!(ours.len(), network.contacts.len());
        prop_assert!(sure.iter().all(|pair| ours.contains(&(pair.first, pair.second))));
        let possible_set: BTreeSet<_> = possible.iter().map(|pair| (pair.first, pair.second)).collect();
        prop_assert!(ours.is_subset(&possible_set));
        for contact in &network.contacts {
            let pair = possible.iter().find(|pair| (pair.first, pair.second) == (contact.first as usize, contact.second as usize));
            let pair = pair.expect("found above");
            prop_assert!(norm(difference(contact.separation, pair.separation)) <= blur(&packing));
            prop_assert!((contact.overlap - pair.overlap).abs() <= blur(&packing));
        }
    }
}

proptest! {
    // Three-dimensional images are many (7³ a pair): fewer cases.
    #![proptest_config(cases(32))]

    #[test]
    fn list_and_hot_loop_are_those_of_all_pairs_in_space(seed: u64, count in 1usize..40, domain in domains::<3>()) {
        check_against_all_pairs(Hertzian::default(), seed, count, domain);
    }
}

/// Bound on the error of a central difference over ±s of u(|r + s e|), e a unit vector.
///
/// Away from contact, s²/6 times the third derivative, |u'''| + 3|u''|/r + 3|u'|/r², taken at the ends of the interval.
/// Within s of contact u'' = F' is only Hölder continuous (for α < 3; it jumps for α = 2): F differs from its tangent by
/// at most its growth over the interval.
fn difference_error<L: PairLaw>(law: &L, coefficient: f64, overlap: f64, distance: f64, s: f64) -> f64 {
    if overlap < -s {
        return 0.0;
    }
    let alpha = law.exponent();
    let ends = [overlap - s, overlap + s].map(|overlap| overlap.max(0.0));
    let force = law.force(coefficient, ends[1]);
    let stiffness = law.stiffness(force, ends[1]);
    let near = distance - s;
    let geometry = s * s / 6.0 * (3.0 * stiffness / near + 3.0 * force / (near * near));
    if overlap > 2.0 * s {
        let third = |overlap: f64| (alpha - 2.0) * law.stiffness(law.force(coefficient, overlap), overlap) / overlap;
        geometry + s * s / 6.0 * third(ends[0]).max(third(ends[1]))
    } else {
        geometry + law.force(coefficient, overlap.max(0.0) + s) - law.force(coefficient, 0.0)
    }
}

/// What a central difference of the energy may be off by: truncation of each pair; over h, the rounding of the energy and
/// that of the separations, `blur`.
fn slope_error<const D: usize, L: PairLaw>(
    packing: &Packing<D>,
    law: &L,
    h: f64,
    blur: f64,
    speed: impl Fn(&all_pairs::Pair<D>) -> f64,
) -> f64 {
    let pairs = pairs_within(packing, 0.1);
    let mut error = 0.0;
    let mut energy = 0.0;
    for pair in &pairs {
        let coefficient = law.coefficient(packing.radii()[pair.first], packing.radii()[pair.second]);
        let speed = speed(pair);
        error += speed * difference_error(law, coefficient, pair.overlap, pair.distance, h * speed);
        let overlap = pair.overlap.max(0.0) + h * speed;
        let force = law.force(coefficient, overlap);
        energy += law.energy(force, overlap);
        error += force * blur / h;
    }
    error + (pairs.len() + 16) as f64 * EPSILON * energy / h
}

/// Step of the differences: rounding ε/h and truncation h^1.5 to h² are both near 1e-9 of what is differentiated.
const STEP: f64 = 1.0 / 65536.0;

fn check_gradient<const D: usize, L: PairLaw>(law: L, seed: u64, count: usize, domain: Domain<D>) {
    let packing = disks(seed, count, domain, 0.2);
    let mut assembly = Assembly::new(&packing, law).expect("no coincidence");
    assembly.evaluate();
    let forces = assembly.forces.clone();
    for index in 0..assembly.mobile_count() {
        let disk = assembly.order()[index] as usize;
        let touches = |pair: &all_pairs::Pair<D>| if pair.first == disk || pair.second == disk { 1.0 } else { 0.0 };
        let allowed = slope_error(&packing, &law, STEP, 4.0 * EPSILON, touches);
        for d in 0..D {
            let mut energy_at = |h: f64| {
                let before = assembly.displacements[index];
                assembly.displacements[index][d] += h;
                let energy = assembly.evaluate_totals().energy;
                assembly.displacements[index] = before;
                energy
            };
            let slope = (energy_at(STEP) - energy_at(-STEP)) / (2.0 * STEP);
            let off = (forces[index][d] + slope).abs();
            assert!(
                off <= allowed,
                "{law:?}, disk {disk}, axis {d}: force {} and slope {slope}, {off:e} > {allowed:e}",
                forces[index][d]
            );
        }
    }
}

/// Stretching the box along one axis with the positions: dE/dε = −(virial along that axis), radii kept.
fn check_virial<const D: usize, L: PairLaw>(law: L, seed: u64, count: usize, sides: Vector<D>) {
    let packing = disks(seed, count, periodic(sides), 0.0);
    let (_, totals) = forces_of(&packing, law);
    for axis in 0..D {
        let stretched = |h: f64| {
            let Domain::Periodic { mut corner, mut lengths } = *packing.domain() else { panic!("made periodic") };
            corner[axis] *= 1.0 + h;
            lengths[axis] *= 1.0 + h;
            let mut positions = packing.positions().to_vec();
            positions.iter_mut().for_each(|position| position[axis] *= 1.0 + h);
            let packing = Packing::new(Domain::Periodic { corner, lengths }, positions, packing.radii().to_vec());
            forces_of(&packing.expect("valid"), law).1.energy
        };
        let slope = (stretched(STEP) - stretched(-STEP)) / (2.0 * STEP);
        let off = (slope + totals.virial[axis][axis]).abs();
        // The stretched coordinates are rounded anew.
        let allowed = slope_error(&packing, &law, STEP, blur(&packing), |pair| pair.separation[axis].abs());
        assert!(
            off <= allowed,
            "{law:?}, axis {axis}: virial {} and slope {slope}, {off:e} > {allowed:e}",
            totals.virial[axis][axis]
        );
    }
    let volume = packing.domain().volume().expect("periodic");
    let network = ContactNetwork::new(&packing, &law).expect("no coincidence");
    let expected = totals.virial_trace() / (D as f64 * volume);
    // Two sums of the same positive terms.
    assert!((network.pressure(volume) - expected).abs() <= (16 + network.contacts.len()) as f64 * EPSILON * expected);
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn force_is_minus_the_energy_gradient(seed: u64, exponent in 2.0..4.0f64, flat in domains::<2>(), deep in domains::<3>()) {
        check_gradient(Hertzian { stiffness: 1.0 }, seed, 24, flat);
        check_gradient(Hookean { stiffness: 1.0 }, seed, 24, flat);
        check_gradient(PowerLaw { energy_scale: 1.0, exponent }, seed, 24, flat);
        check_gradient(Hertzian { stiffness: 1.0 }, seed, 24, deep);
        check_gradient(Hookean { stiffness: 1.0 }, seed, 24, deep);
        check_gradient(PowerLaw { energy_scale: 1.0, exponent }, seed, 24, deep);
    }

    #[test]
    fn virial_is_minus_the_energy_change_when_the_box_is_stretched(seed: u64, exponent in 2.0..4.0f64, x in 1.1..3.0f64, y in 1.1..3.0f64, z in 1.1..2.0f64) {
        let (flat, deep) = ([x, y].map(on_grid), [x, y, z].map(on_grid));
        check_virial(Hertzian { stiffness: 1.0 }, seed, 24, flat);
        check_virial(Hookean { stiffness: 1.0 }, seed, 24, flat);
        check_virial(PowerLaw { energy_scale: 1.0, exponent }, seed, 24, flat);
        check_virial(Hertzian { stiffness: 1.0 }, seed, 24, deep);
    }

    #[test]
    fn forces_of_a_packing_without_held_disks_add_up_to_nothing(seed: u64, count in 2usize..80, domain in domains::<2>()) {
        let packing = disks(seed, count, domain, 0.0);
        let (forces, totals) = forces_of(&packing, Hertzian::default());
        let net = forces.iter().fold([0.0; 2], |total, &force| sum(total, force));
        // Each contact adds and takes the same number, exactly; what remains is the rounding of the sums: at most one
        // rounding of a partial sum below ΣF for every contact and disk.
        let roundings = (2 * totals.contact_count + count) as f64;
        prop_assert!(norm(net) <= roundings * EPSILON * totals.force_sum, "{net:?}, ΣF {}", totals.force_sum);
    }

    #[test]
    fn two_disks_push_each_other_with_opposite_forces_to_the_last_bit(x in 0.01..0.7f64, y in 0.01..0.7f64, z in 0.01..0.7f64) {
        let packing = Packing::new(Domain::<3>::cube(8.0), vec![[7.9, 0.1, 4.0], [(7.9 + x) % 8.0, 0.1 + y, 4.0 + z]], vec![0.7, 0.8]);
        let (forces, totals) = forces_of(&packing.expect("valid"), Hertzian::default());
        prop_assert_eq!(totals.contact_count, 1);
        prop_assert_eq!(forces[0], forces[1].map(|component| -component));
        // Along the line of centres, pushing apart.
        prop_assert!(forces[1][0] > 0.0 && forces[1][1] > 0.0 && forces[1][2] > 0.0);
    }
}

/// Every disk moved by `shift`, box kept.
fn translated<const D: usize>(packing: &Packing<D>, shift: Vector<D>) -> Packing<D> {
    let positions = packing.positions().iter().map(|&position| sum(position, shift)).collect();
    Packing::new(*packing.domain(), positions, packing.radii().to_vec())
        .and_then(|moved| moved.with_held(packing.held().to_vec()))
        .expect("valid")
}

fn check_same<const D: usize, L: PairLaw>(
    what: &str,
    law: L,
    first: &Packing<D>,
    second: &Packing<D>,
    image: impl Fn(usize, Vector<D>) -> (usize, Vector<D>),
    blur: f64,
) {
    let (forces, totals) = forces_of(first, law);
    let (others, other_totals) = forces_of(second, law);
    let allowed = allowed(first, &law, blur);
    for (disk, &force) in forces.iter().enumerate() {
        let (index, expected) = image(disk, force);
        let off = norm(difference(others[index], expected));
        assert!(off <= allowed.forces[disk], "{what}: force on {disk} is {:?}, not {expected:?}", others[index]);
    }
    assert!((totals.energy - other_totals.energy).abs() <= allowed.energy, "{what}: energy");
    assert!((totals.virial_trace() - other_totals.virial_trace()).abs() <= D as f64 * allowed.virial, "{what}: virial");
    if blur == 0.0 {
        assert_eq!(totals.contact_count, other_totals.contact_count, "{what}: contacts");
    }
}

proptest! {
    #![proptest_config(cases(64))]

    /// Coordinates are multiples of 2⁻²⁰, so that a shift by one below 2³² rounds nothing, and the separations are the
    /// same to the last bit: only the order of the sums may change.
    #[test]
    fn moving_all_disks_changes_nothing_but_the_order_of_sums(
        seed: u64, domain in domains::<2>(), near in proptest::array::uniform2(-20.0..20.0f64), far in proptest::array::uniform2(-4e9..4e9f64),
    ) {
        let packing = disks(seed, 40, domain, 0.2);
        for shift in [near, far] {
            let moved = translated(&packing, shift.map(on_grid));
            check_same("moved", Hertzian::default(), &packing, &moved, |disk, force| (disk, force), 0.0);
        }
    }

    #[test]
    fn taking_disks_across_the_sides_of_the_box_changes_nothing(seed: u64, sides in proptest::array::uniform2(1.0..5.0f64)) {
        let packing = disks(seed, 40, periodic(sides.map(on_grid)), 0.2);
        let lengths = packing.domain().lengths().expect("periodic");
        let mut generator = Pcg64::seed_from_u64(seed);
        let moved = |position: &Vector<2>| std::array::from_fn(|d| position[d] + lengths[d] * generator.random_range(-9..9) as f64);
        let positions = packing.positions().iter().map(moved).collect();
        let other = Packing::new(*packing.domain(), positions, packing.radii().to_vec()).and_then(|p| p.with_held(packing.held().to_vec()));
        check_same("taken across", Hertzian::default(), &packing, &other.expect("valid"), |disk, force| (disk, force), 0.0);
    }

    #[test]
    fn forces_turn_with_a_square_box_by_a_quarter(seed: u64, side in 1.0..5.0f64) {
        let packing = disks(seed, 40, periodic([on_grid(side); 2]), 0.2);
        let Domain::Periodic { corner: [x, y], lengths } = *packing.domain() else { panic!("made periodic") };
        let domain = Domain::Periodic { corner: [-y - lengths[1], x], lengths };
        let positions = packing.positions().iter().map(|&[x, y]| [-y, x]).collect();
        let turned = Packing::new(domain, positions, packing.radii().to_vec()).and_then(|p| p.with_held(packing.held().to_vec()));
        check_same("turned", Hertzian::default(), &packing, &turned.expect("valid"), |disk, [x, y]| (disk, [-y, x]), 0.0);
    }

    #[test]
    fn forces_turn_with_the_packing_in_the_open_plane(seed: u64, angle in 0.0..6.28f64) {
        let packing = disks(seed, 40, Domain::Open, 0.2);
        let (sine, cosine) = angle.sin_cos();
        let turn = |[x, y]: Vector<2>| [cosine * x - sine * y, sine * x + cosine * y];
        let positions = packing.positions().iter().map(|&position| turn(position)).collect();
        let turned = Packing::new(Domain::Open, positions, packing.radii().to_vec()).and_then(|p| p.with_held(packing.held().to_vec()));
        check_same("turned", Hertzian::default(), &packing, &turned.expect("valid"), |disk, force| (disk, turn(force)), blur(&packing));
    }

    #[test]
    fn relabelling_disks_relabels_forces_contacts_and_backbone(seed: u64, domain in domains::<2>()) {
        let packing = disks(seed, 40, domain, 0.2);
        let place = shuffled(seed, packing.len());
        let other = relabelled(&packing, &place);
        check_same("relabelled", Hertzian::default(), &packing, &other, |disk, force| (place[disk], force), 0.0);
        let networks = [&packing, &other].map(|packing| ContactNetwork::new(packing, &Hertzian::default()).expect("no coincidence"));
        for disk in 0..packing.len() {
            prop_assert_eq!(networks[0].backbone[disk], networks[1].backbone[place[disk]]);
        }
        let pair = |a: usize, b: usize| (a.min(b), a.max(b));
        let moved: BTreeSet<_> = networks[0].contacts.iter().map(|c| pair(place[c.first as usize], place[c.second as usize])).collect();
        let theirs: BTreeSet<_> = networks[1].contacts.iter().map(|c| (c.first as usize, c.second as usize)).collect();
        prop_assert_eq!(moved, theirs);
    }

    /// Lengths by 4^a and stiffnesses by 2^b: √(δ R_ij) scales by 4^a exactly, so F by 2^b 4^(2a) (Hertzian) or 2^b 4^a
    /// (Hookean) and every bit of the mantissa stays.
    #[test]
    fn other_units_give_the_same_bits(seed: u64, domain in domains::<2>(), a in -6i32..6, b in -9i32..9) {
        let packing = disks(seed, 40, domain, 0.2);
        let (length, stiffness) = (4f64.powi(a), 2f64.powi(b));
        let other = in_units(&packing, length);
        let check = |ours: (Vec<Vector<2>>, Totals<2>), theirs: (Vec<Vector<2>>, Totals<2>), force: f64| {
            let scaled: Vec<Vector<2>> = ours.0.iter().map(|f| f.map(|component| component * force)).collect();
            assert_eq!(scaled, theirs.0);
            assert_eq!(ours.1.energy * force * length, theirs.1.energy);
            assert_eq!(ours.1.virial.map(|row| row.map(|value| value * force * length)), theirs.1.virial);
            assert_eq!(ours.1.contact_count, theirs.1.contact_count);
        };
        let (one, two) = (Hertzian { stiffness: 3.0 }, Hertzian { stiffness: 3.0 * stiffness });
        check(forces_of(&packing, one), forces_of(&other, two), stiffness * length * length);
        let (one, two) = (Hookean { stiffness: 3.0 }, Hookean { stiffness: 3.0 * stiffness });
        check(forces_of(&packing, one), forces_of(&other, two), stiffness * length);
    }
}

/// A random permutation: where each disk goes.
fn shuffled(seed: u64, count: usize) -> Vec<usize> {
    let mut generator = Pcg64::seed_from_u64(seed);
    let mut place: Vec<usize> = (0..count).collect();
    for last in (1..count).rev() {
        place.swap(last, generator.random_range(0..=last));
    }
    place
}

fn relabelled<const D: usize>(packing: &Packing<D>, place: &[usize]) -> Packing<D> {
    let mut order = vec![0; place.len()];
    for (disk, &index) in place.iter().enumerate() {
        order[index] = disk;
    }
    let positions = order.iter().map(|&disk| packing.positions()[disk]).collect();
    let radii = order.iter().map(|&disk| packing.radii()[disk]).collect();
    let held = order.iter().map(|&disk| packing.held()[disk]).collect();
    Packing::new(*packing.domain(), positions, radii).and_then(|other| other.with_held(held)).expect("valid")
}

fn in_units<const D: usize>(packing: &Packing<D>, length: f64) -> Packing<D> {
    let domain = match *packing.domain() {
        Domain::Periodic { corner, lengths } => {
            Domain::Periodic { corner: corner.map(|x| x * length), lengths: lengths.map(|x| x * length) }
        }
        Domain::Open => Domain::Open,
    };
    let positions = packing.positions().iter().map(|position| position.map(|x| x * length)).collect();
    let radii = packing.radii().iter().map(|radius| radius * length).collect();
    Packing::new(domain, positions, radii).and_then(|other| other.with_held(packing.held().to_vec())).expect("valid")
}

proptest! {
    #![proptest_config(cases(128))]

    #[test]
    fn the_backbone_is_the_largest_set_with_three_contacts_each(
        seed: u64, count in 1usize..60, side in 1.5..3.5f64, held_share in 0.0..0.3f64,
    ) {
        let packing = disks(seed, count, periodic([on_grid(side); 2]), held_share);
        let network = ContactNetwork::new(&packing, &Hertzian::default()).expect("no coincidence");
        let links: Vec<(u32, u32)> = network.contacts.iter().map(|contact| (contact.first, contact.second)).collect();
        // Maximal: the naive removal, which takes out only what no such set can contain, leaves the same disks.
        prop_assert_eq!(&network.backbone, &naive_backbone::backbone(packing.held(), &links, 3));
        let mut ends = 0;
        for disk in 0..packing.len() {
            let contacts = contacts_within(disk, &network.backbone, &links);
            prop_assert!(packing.held()[disk] || !network.backbone[disk] || contacts >= 3);
            prop_assert!(!packing.held()[disk] || network.backbone[disk]);
            if network.backbone[disk] && !packing.held()[disk] {
                ends += contacts;
            }
        }
        // Z: mean number of contacts of the mobile disks of the backbone.
        let mobile = network.backbone_count();
        prop_assert_eq!(network.coordination(), if mobile == 0 { 0.0 } else { ends as f64 / mobile as f64 });
        prop_assert_eq!(mobile + network.rattlers().count() + packing.held().iter().filter(|&&held| held).count(), count);
        // Once more, within the backbone, takes nothing out.
        let kept: Vec<usize> = (0..packing.len()).filter(|&disk| network.backbone[disk]).collect();
        let index = |disk: u32| kept.iter().position(|&other| other == disk as usize).expect("on the backbone") as u32;
        let inner: Vec<(u32, u32)> = network.backbone_contacts().map(|c| (index(c.first), index(c.second))).collect();
        let held: Vec<bool> = kept.iter().map(|&disk| packing.held()[disk]).collect();
        prop_assert!(backbone::<2>(&held, &inner).iter().all(|&member| member));
    }
}

/// A triangular lattice of disks a apart, in a periodic box: Z = 6, and per disk 3 contacts, so with a cell of √3 a²/2
///
/// ```text
/// E = 3 N u(δ)      p = 3 N F a / (2 V) = √3 F / a
/// ```
#[test]
fn a_triangular_lattice_has_six_contacts_and_its_pressure_and_energy_in_closed_form() {
    fn check<L: PairLaw>(law: L) {
        let (columns, rows, radius, apart) = (12usize, 14usize, 0.5, 0.97);
        let height = 3f64.sqrt() / 2.0 * apart;
        let positions: Vec<Vector<2>> = (0..rows * columns)
            .map(|disk| (disk / columns, disk % columns))
            .map(|(row, column)| [(column as f64 + 0.5 * (row % 2) as f64) * apart, row as f64 * height])
            .collect();
        let lengths = [columns as f64 * apart, rows as f64 * height];
        let count = positions.len();
        let domain = Domain::Periodic { corner: [0.0; 2], lengths };
        let packing = Packing::new(domain, positions, vec![radius; count]).expect("valid");
        let network = ContactNetwork::new(&packing, &law).expect("no coincidence");
        let overlap = 2.0 * radius - apart;
        let force = law.force(law.coefficient(radius, radius), overlap);
        assert_eq!(network.contacts.len(), 3 * count);
        assert_eq!(network.coordination(), 6.0);
        assert_eq!(network.rattlers().count(), 0);
        // Coordinates up to 14 carry 2e-15, an overlap of 0.03 twice that: 1.3e-13 of it, α times that in the energy.
        let tolerance = 1e-12;
        let energy = 3.0 * count as f64 * law.energy(force, overlap);
        assert!((network.energy() / energy - 1.0).abs() < tolerance, "{law:?}: energy");
        let pressure = 3f64.sqrt() * force / apart;
        let volume = lengths[0] * lengths[1];
        assert!((network.pressure(volume) / pressure - 1.0).abs() < tolerance, "{law:?}: pressure");
        // Isotropic, and no net force: six equal forces cancel to their rounding.
        let stress = network.stress(volume);
        assert!((stress[0][0] / stress[1][1] - 1.0).abs() < tolerance && stress[0][1].abs() < tolerance * pressure);
        assert!(network.largest_net_force() < 6.0 * tolerance * force, "{law:?}: net force");
        assert!((network.mean_contact_force() / force - 1.0).abs() < tolerance);
    }
    check(Hertzian::default());
    check(Hookean::default());
    check(PowerLaw { energy_scale: 2.0, exponent: 3.3 });
}

/// A face-centred cubic crystal of balls a apart: Z = 12, 6 contacts a ball in a cell of a³/√2, so p = 2√2 F/a².
#[test]
fn a_cubic_crystal_has_twelve_contacts_and_its_pressure_in_closed_form() {
    let (cells, radius, apart) = (3usize, 0.5, 0.98);
    let edge = SQRT_2 * apart;
    let corners = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
    let positions: Vec<Vector<3>> = (0..4 * cells.pow(3))
        .map(|ball| {
            let cell = [ball / 4 % cells, ball / 4 / cells % cells, ball / 4 / cells / cells];
            std::array::from_fn(|d| (cell[d] as f64 + corners[ball % 4][d]) * edge)
        })
        .collect();
    let count = positions.len();
    let side = cells as f64 * edge;
    let packing = Packing::new(Domain::<3>::cube(side), positions, vec![radius; count]).expect("valid");
    let law = Hertzian::default();
    let network = ContactNetwork::new(&packing, &law).expect("no coincidence");
    let force = law.force(law.coefficient(radius, radius), 2.0 * radius - apart);
    assert_eq!(network.contacts.len(), 6 * count);
    assert_eq!(network.coordination(), 12.0);
    // Coordinates up to 4 carry 4e-16 each, overlaps of 0.02: 4e-14, times 3/2.
    let pressure = 2.0 * SQRT_2 * force / (apart * apart);
    assert!((network.pressure(side.powi(3)) / pressure - 1.0).abs() < 1e-12);
}

/// The plain positions of these two disks touch exactly; the correction alone presses them together.
#[test]
fn an_overlap_far_below_the_rounding_of_positions_has_its_force() {
    let overlap = 1e-22;
    let law = Hookean { stiffness: 2e5 };
    for start in [0.0, 1024.0, 1e9] {
        let packing = Packing::new(Domain::<2>::Open, vec![[start, 0.0], [start + 1.25, 0.0]], vec![0.5, 0.75])
            .and_then(|packing| packing.with_corrections(vec![[overlap, 0.0], [0.0; 2]]))
            .expect("valid");
        let (forces, totals) = forces_of(&packing, law);
        assert_eq!(totals.contact_count, 1);
        // The product k δ rounds, and so do its division by and multiplication with the distance.
        assert!((forces[1][0] / (law.stiffness * overlap) - 1.0).abs() < 4.0 * EPSILON, "{:?} at {start}", forces[1]);
    }
}

#[test]
fn coincident_centres_are_named() {
    let positions = vec![[1.0, 1.0], [5.0, 5.0], [3.0, 3.0], [13.0, -7.0]];
    let packing = Packing::new(Domain::<2>::cube(10.0), positions, vec![0.5; 4]).expect("valid");
    // The fourth is an image of the third.
    let error = Assembly::new(&packing, Hertzian::default()).expect_err("coincident");
    assert_eq!(error, PackingError::CoincidentCentres { first: 2, second: 3 });
    assert_eq!(
        error.to_string(),
        "disks 2 and 3 have the same centre: the direction of their contact force is undefined"
    );
    // Held ones do not push each other.
    let held = packing.with_held(vec![false, false, true, true]).expect("four flags");
    assert!(Assembly::new(&held, Hertzian::default()).is_ok());
}

#[test]
fn a_box_in_which_a_pair_could_touch_twice_is_refused() {
    let packing = |side: f64| {
        let domain = Domain::Periodic { corner: [0.0; 2], lengths: [20.0, side] };
        Packing::new(domain, vec![[1.0, 1.0], [3.0, 1.0]], vec![0.5, 0.7]).expect("valid")
    };
    let error = Assembly::new(&packing(2.75), Hertzian::default()).expect_err("too small");
    assert_eq!(error, PackingError::BoxTooSmall { axis: 1, length: 2.75, range: 1.4 });
    for number in ["axis 1", "2.75", "1.4"] {
        assert!(error.to_string().contains(number), "{error} does not say {number}");
    }
    // Two contact ranges are enough.
    assert!(Assembly::new(&packing(2.8), Hertzian::default()).is_ok());
}

#[test]
fn held_disks_push_mobile_ones_but_not_each_other() {
    let positions = vec![[0.0, 0.0], [0.9, 0.0], [0.45, 0.8]];
    let packing = Packing::new(Domain::<2>::Open, positions, vec![0.5; 3])
        .and_then(|packing| packing.with_held(vec![true, true, false]))
        .expect("valid");
    let network = ContactNetwork::new(&packing, &Hookean::default()).expect("no coincidence");
    let pairs: Vec<(u32, u32)> = network.contacts.iter().map(|contact| (contact.first, contact.second)).collect();
    assert_eq!(pairs, [(0, 2), (1, 2)]);
    // Pushed up by both, by symmetry: 2 k δ cos with cos = 0.8 / r.
    let distance = 0.45f64.hypot(0.8);
    let expected = 2.0 * 2e5 * (1.0 - distance) * 0.8 / distance;
    let [x, y] = network.forces()[2];
    // An overlap of 0.08 from a distance of order 1, rounded to 1e-16: 1e-15, and a few products.
    assert!((y / expected - 1.0).abs() < 1e-14 && x.abs() < 1e-14 * expected, "{x} {y} {expected}");
}

#[test]
fn a_force_that_is_not_a_number_shows_in_energy_and_forces() {
    let packing = disks::<2>(3, 30, periodic([2.0; 2]), 0.0);
    let mut assembly = Assembly::new(&packing, Hertzian::default()).expect("no coincidence");
    let touching = assembly.pairs().first[0] as usize;
    assembly.displacements[touching][0] = f64::NAN;
    // keep_listed leaves such a state to the relaxer.
    assert_eq!(assembly.keep_listed(f64::NAN), Ok(false));
    let totals = assembly.evaluate_totals();
    assert!(totals.energy.is_nan() && assembly.forces[touching][0].is_nan());
}
