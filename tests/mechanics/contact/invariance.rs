//! Translation, rotation, relabelling, change of units.

use super::*;

/// Every disk moved by `shift`, box kept.
fn translated<const D: usize>(packing: &Packing<D>, shift: Vector<D>) -> Packing<D> {
    let positions = packing.positions().iter().map(|&position| sum(position, shift)).collect();
    Packing::new(*packing.domain(), positions, packing.radii().to_vec())
        .and_then(|moved| moved.with_held(packing.held().to_vec()))
        .expect("valid")
}

fn check_same<const D: usize>(
    what: &str,
    law: &dyn PairLaw,
    first: &Packing<D>,
    second: &Packing<D>,
    image: impl Fn(usize, Vector<D>) -> (usize, Vector<D>),
    blur: f64,
) {
    let (forces, totals) = forces_of(first, law);
    let (others, other_totals) = forces_of(second, law);
    let allowed = allowed(first, law, blur);
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
            check_same("moved", &Hertzian::default(), &packing, &moved, |disk, force| (disk, force), 0.0);
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
        check_same("taken across", &Hertzian::default(), &packing, &other.expect("valid"), |disk, force| (disk, force), 0.0);
    }

    #[test]
    fn forces_turn_with_a_square_box_by_a_quarter(seed: u64, side in 1.0..5.0f64) {
        let packing = disks(seed, 40, periodic([on_grid(side); 2]), 0.2);
        let Domain::Periodic { corner: [x, y], edges: [[_, _], [_, height]] } = *packing.domain() else { panic!("made periodic") };
        let domain = Domain::rectangular([-y - height, x], [height; 2]);
        let positions = packing.positions().iter().map(|&[x, y]| [-y, x]).collect();
        let turned = Packing::new(domain, positions, packing.radii().to_vec()).and_then(|p| p.with_held(packing.held().to_vec()));
        check_same("turned", &Hertzian::default(), &packing, &turned.expect("valid"), |disk, [x, y]| (disk, [-y, x]), 0.0);
    }

    #[test]
    fn forces_turn_with_the_packing_in_the_open_plane(seed: u64, angle in 0.0..std::f64::consts::TAU) {
        let packing = disks(seed, 40, Domain::Open, 0.2);
        let (sine, cosine) = angle.sin_cos();
        let turn = |[x, y]: Vector<2>| [cosine * x - sine * y, sine * x + cosine * y];
        let positions = packing.positions().iter().map(|&position| turn(position)).collect();
        let turned = Packing::new(Domain::Open, positions, packing.radii().to_vec()).and_then(|p| p.with_held(packing.held().to_vec()));
        check_same("turned", &Hertzian::default(), &packing, &turned.expect("valid"), |disk, force| (disk, turn(force)), blur(&packing));
    }

    #[test]
    fn relabelling_disks_relabels_forces_contacts_and_backbone(seed: u64, domain in domains::<2>()) {
        let packing = disks(seed, 40, domain, 0.2);
        let place = shuffled(seed, packing.len());
        let other = relabelled(&packing, &place);
        check_same("relabelled", &Hertzian::default(), &packing, &other, |disk, force| (place[disk], force), 0.0);
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
        check(forces_of(&packing, &one), forces_of(&other, &two), stiffness * length * length);
        let (one, two) = (Hookean { stiffness: 3.0 }, Hookean { stiffness: 3.0 * stiffness });
        check(forces_of(&packing, &one), forces_of(&other, &two), stiffness * length);
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
        Domain::Periodic { corner, edges } => {
            Domain::Periodic { corner: corner.map(|x| x * length), edges: edges.map(|edge| edge.map(|x| x * length)) }
        }
        Domain::Open => Domain::Open,
    };
    let positions = packing.positions().iter().map(|position| position.map(|x| x * length)).collect();
    let radii = packing.radii().iter().map(|radius| radius * length).collect();
    Packing::new(domain, positions, radii).and_then(|other| other.with_held(packing.held().to_vec())).expect("valid")
}
