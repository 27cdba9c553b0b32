//! Where disks stand: at one point, at the end of the numbers, in the smallest box, an ulp or a subnormal overlap apart.

use jamscope::forces::Assembly;
use jamscope::law::{Hertzian, Hookean, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Packing, PackingError};
use jamscope::relax::{Criterion, Fire, Relaxer, Stop};
use jamscope::vector::two_sum;

use crate::{all_finite, fire, open, points, relax, relaxers};

#[test]
fn a_hundred_disks_at_one_point_are_refused_by_number() {
    let packing = open(&[([3.0, 7.0], 0.5); 100], &[false; 100]);
    let error = Fire::default().relax(packing, &Hertzian::default(), &mut ()).expect_err("no direction");
    assert_eq!(error, PackingError::CoincidentCentres { first: 0, second: 1 });
}

#[test]
fn a_hundred_disks_next_to_one_point_fly_apart() {
    // From 10⁻³ down to where squares of distances are subnormal: directions are defined as long as the centres differ.
    for apart in [1e-3, 1e-9, 1e-100, 1e-150] {
        let spiral = |disk: usize| {
            let (angle, radius) = (2.4 * disk as f64, apart * (1.0 + disk as f64).sqrt());
            ([radius * angle.cos(), radius * angle.sin()], 0.5)
        };
        let packing = open(&(0..100).map(spiral).collect::<Vec<_>>(), &[false; 100]);
        for relaxer in relaxers(1e-8) {
            for outcome in [
                relax(packing.clone(), &Hertzian::default(), &relaxer),
                relax(packing.clone(), &Hookean::default(), &relaxer),
            ] {
                assert_eq!(outcome.stop, Stop::Converged(Criterion::Unjammed), "{apart:e}, {}", relaxer.name());
                assert!(all_finite(&outcome.state));
            }
        }
    }
}

#[test]
fn centres_nearer_than_squares_of_numbers_reach_are_refused_or_pushed_never_nan() {
    // (10⁻²⁰⁰)² is 0: the distance is 0 to the arithmetic, and the pair is named.
    let packing = open(&[([0.0; 2], 0.5), ([1e-200, 0.0], 0.5)], &[false; 2]);
    let error = Fire::default().relax(packing, &Hertzian::default(), &mut ()).expect_err("no direction");
    assert_eq!(error, PackingError::CoincidentCentres { first: 0, second: 1 });
}

/// The triangular lattice of unit disks with 8 × 8 disks whose spacing is 2⁻⁵³ below 1, as near to contact as numbers go.
fn lattice_an_ulp_above_contact() -> Packing<2> {
    let ulp = f64::EPSILON / 2.0;
    let height = (1.0 - ulp) * 0.75f64.sqrt();
    // Columns at whole and half numbers, less their share of the ulp in the correction: exact.
    let column = |index: usize| (index % 8) as f64 + 0.5 * (index / 8 % 2) as f64;
    let positions = (0..64).map(|index| [column(index), height * (index / 8) as f64]).collect();
    let corrections = (0..64).map(|index| [-ulp * column(index), 0.0]).collect();
    let domain = Domain::rectangular([0.0; 2], [8.0 * (1.0 - ulp), 8.0 * height]);
    Packing::new(domain, positions, vec![0.5; 64])
        .and_then(|packing| packing.with_corrections(corrections))
        .expect("valid")
}

#[test]
fn a_packing_fraction_an_ulp_above_contact_has_overlaps_of_an_ulp_and_counts_as_unjammed() {
    let packing = lattice_an_ulp_above_contact();
    // φ_J of the lattice, π/(2√3), and its share (1 − ulp)⁻², to the rounding of the sum over 64 disks.
    let fraction = packing.packing_fraction().expect("periodic");
    let contact = std::f64::consts::PI / (2.0 * 3.0f64.sqrt());
    assert!((fraction / contact - 1.0).abs() < 70.0 * f64::EPSILON, "{fraction}");
    let network = ContactNetwork::new(&packing, &Hookean::default()).expect("no coincidence");
    // Rows are exact: every overlap along them is that ulp, to the 2⁻¹⁰⁰ of a length to which distances are known. Between rows sites are rounded to 2⁻⁵⁰ (heights up to 7).
    for contact in &network.contacts {
        assert!(contact.overlap > 0.0 && contact.overlap < 16.0 * f64::EPSILON, "{contact:?}");
        let row = contact.first / 8 == contact.second / 8;
        assert!(!row || (contact.overlap - f64::EPSILON / 2.0).abs() <= f64::exp2(-100.0), "{contact:?}");
    }
    assert!(network.contacts.len() >= 64);
    // Forces of 10⁻¹¹ where one radius gives 10⁵: as good as none.
    for relaxer in relaxers(1e-8) {
        let outcome = relax(packing.clone(), &Hookean::default(), &relaxer);
        assert_eq!((outcome.stop, outcome.cost.step_count), (Stop::Converged(Criterion::Unjammed), 0));
    }
}

#[test]
fn subnormal_overlaps_have_forces_that_are_tiny_and_never_nan() {
    fn check(law: &dyn PairLaw, overlap: f64) {
        // Centres 0 and 1 with a correction: an overlap of any size.
        let packing = Packing::new(Domain::<2>::Open, vec![[0.0; 2], [1.0, 0.0]], vec![0.5; 2])
            .and_then(|packing| packing.with_corrections(vec![[0.0; 2], [-overlap, 0.0]]))
            .expect("valid");
        let mut assembly = Assembly::new(&packing, law).expect("no coincidence");
        let totals = assembly.evaluate_totals();
        assert_eq!(totals.contact_count, 1, "{law:?} at {overlap:e}");
        let expected = law.force(law.coefficient(0.5, 0.5), overlap);
        for force in &assembly.forces {
            // One part in 2⁵⁰, or the spacing of subnormal numbers.
            assert!(
                (force[0].abs() - expected).abs() <= 1e-15 * expected + 1e-323,
                "{law:?} at {overlap:e}: {force:?}"
            );
        }
        assert!(totals.energy >= 0.0 && totals.energy <= expected * overlap);
        for relaxer in relaxers(1e-8) {
            let outcome = relax(packing.clone(), law, &relaxer);
            assert_eq!(outcome.stop, Stop::Converged(Criterion::Unjammed), "{}", relaxer.name());
        }
    }
    for overlap in [f64::from_bits(1), 1e-310, 1e-300, 1e-200, 1e-100] {
        check(&Hookean::default(), overlap);
        check(&Hertzian::default(), overlap);
    }
}

#[test]
fn a_box_of_exactly_two_contact_ranges_is_the_smallest() {
    // Four disks of radius 1/2 on a square of side 2: each touches both neighbours on both sides.
    let sites = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let boxed =
        |side: f64, radius: f64| Packing::new(Domain::cube(side), sites.clone(), vec![radius; 4]).expect("valid");
    let network = ContactNetwork::new(&boxed(2.0, 0.5), &Hookean::default()).expect("large enough");
    assert_eq!(network.contacts.len(), 0);
    let error = ContactNetwork::new(&boxed(2.0, 0.5 + f64::EPSILON), &Hookean::default()).expect_err("too small");
    assert!(matches!(error, PackingError::BoxTooSmall { axis: 0, .. }), "{error}");
    // A little larger: neighbours in the box overlap, their images do not, and the disks space out evenly to rest.
    for relaxer in relaxers(1e-10) {
        let outcome = relax(boxed(2.125, 0.53125), &Hookean::default(), &relaxer);
        assert!(matches!(outcome.stop, Stop::Converged(_)), "{}: {:?}", relaxer.name(), outcome.stop);
        let network = ContactNetwork::new(&outcome.state, &Hookean::default()).expect("large enough");
        // Spacing 1.0625 = two radii: nothing is left of the overlaps, or next to nothing where the path ends early.
        assert!(network.contacts.iter().all(|contact| contact.overlap < 1e-6), "{:?}", network.contacts);
    }
}

#[test]
fn a_packing_at_the_end_of_the_digits_comes_to_rest_as_the_one_at_the_origin() {
    // 10⁸ and 10¹⁵ away a position is known to 10⁻⁸ and to 1/8 only; centres are unevaluated sums, so nothing is lost.
    let near = points(64, 0.95, 5);
    let side = near.domain().lengths().expect("periodic")[0];
    let law = Hertzian::default();
    let reference = relax(near.clone(), &law, &fire(1e-10));
    let energy = ContactNetwork::new(&reference.state, &law).expect("no coincidence").energy();
    for far in [f64::exp2(27.0), f64::exp2(50.0)] {
        let domain = Domain::rectangular([far, -far], [side; 2]);
        let shifted = near.positions().iter().map(|position| {
            let corner = [far, -far];
            let sums: [(f64, f64); 2] = std::array::from_fn(|d| two_sum(corner[d], position[d]));
            (sums.map(|sum| sum.0), sums.map(|sum| sum.1))
        });
        let (positions, corrections): (Vec<_>, Vec<_>) = shifted.unzip();
        let packing = Packing::new(domain, positions, near.radii().to_vec())
            .and_then(|packing| packing.with_corrections(corrections))
            .expect("valid");
        let outcome = relax(packing, &law, &fire(1e-10));
        assert!(matches!(outcome.stop, Stop::Converged(_)), "{far:e}: {:?}", outcome.stop);
        // The same minimum: energies agree to the square of the limit, and to the rounding of a sum of 10² terms.
        let found = ContactNetwork::new(&outcome.state, &law).expect("no coincidence").energy();
        assert!((found / energy - 1.0).abs() < 1e-13, "{far:e}: {found}, not {energy}");
    }
}

#[test]
fn one_contact_short_of_rigid_is_unjammed_and_with_it_at_rest() {
    // A disk pressed by three held ones around it is held in the plane; by two of them it is pushed out.
    let around = |count: usize| {
        let mut disks = vec![([0.0; 2], 0.5)];
        for arm in 0..3 {
            let angle = 2.0 * std::f64::consts::FRAC_PI_3 * arm as f64;
            // The third one stands back instead of touching.
            let distance = if arm < count { 0.95 } else { 50.0 };
            disks.push(([distance * angle.cos(), distance * angle.sin()], 0.5));
        }
        open(&disks, &[false, true, true, true])
    };
    for relaxer in relaxers(1e-10) {
        let rigid = relax(around(3), &Hertzian::default(), &relaxer);
        assert_eq!(rigid.stop, Stop::Converged(Criterion::RelativeForce), "{}", relaxer.name());
        let short = relax(around(2), &Hertzian::default(), &relaxer);
        assert_eq!(short.stop, Stop::Converged(Criterion::Unjammed), "{}", relaxer.name());
    }
}

#[test]
fn a_far_away_disk_costs_no_memory_and_moves_nothing() {
    let mut disks: Vec<_> = (0..10).map(|disk| ([0.9 * f64::from(disk), 0.0], 0.5)).collect();
    disks.push(([1e300, -1e300], 0.5));
    let packing = open(&disks, &[false; 11]);
    for relaxer in relaxers(1e-8) {
        let outcome = relax(packing.clone(), &Hookean::default(), &relaxer);
        assert_eq!(outcome.stop, Stop::Converged(Criterion::Unjammed), "{}", relaxer.name());
        assert_eq!(outcome.state.positions()[10], [1e300, -1e300]);
    }
}
