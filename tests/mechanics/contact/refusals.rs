//! The edges: overlaps below the rounding of positions, coincident centres, boxes too small, held pairs, NaN.

use super::*;

/// The plain positions of these two disks touch exactly; the correction alone presses them together.
#[test]
fn an_overlap_far_below_the_rounding_of_positions_has_its_force() {
    let overlap = 1e-22;
    let law = Hookean { stiffness: 2e5 };
    for start in [0.0, 1024.0, 1e9] {
        let packing = Packing::new(Domain::<2>::Open, vec![[start, 0.0], [start + 1.25, 0.0]], vec![0.5, 0.75])
            .and_then(|packing| packing.with_corrections(vec![[overlap, 0.0], [0.0; 2]]))
            .expect("valid");
        let (forces, totals) = forces_of(&packing, &law);
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
    let error = Assembly::new(&packing, &Hertzian::default()).expect_err("coincident");
    assert_eq!(error, PackingError::CoincidentCentres { first: 2, second: 3 });
    assert_eq!(
        error.to_string(),
        "disks 2 and 3 have the same centre: the direction of their contact force is undefined"
    );
    // Held ones do not push each other.
    let held = packing.with_held(vec![false, false, true, true]).expect("four flags");
    assert!(Assembly::new(&held, &Hertzian::default()).is_ok());
}

#[test]
fn a_box_in_which_a_pair_could_touch_twice_is_refused() {
    let packing = |side: f64| {
        let domain = Domain::rectangular([0.0; 2], [20.0, side]);
        Packing::new(domain, vec![[1.0, 1.0], [3.0, 1.0]], vec![0.5, 0.7]).expect("valid")
    };
    let error = Assembly::new(&packing(2.75), &Hertzian::default()).expect_err("too small");
    assert_eq!(error, PackingError::BoxTooSmall { axis: 1, length: 2.75, range: 1.4 });
    for number in ["axis 1", "2.75", "1.4"] {
        assert!(error.to_string().contains(number), "{error} does not say {number}");
    }
    // Two contact ranges are enough.
    assert!(Assembly::new(&packing(2.8), &Hertzian::default()).is_ok());
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
    let mut assembly = Assembly::new(&packing, &Hertzian::default()).expect("no coincidence");
    let touching = assembly.pairs().first[0] as usize;
    assembly.displacements[touching][0] = f64::NAN;
    // update_list leaves such a state to the relaxer.
    assert_eq!(assembly.update_list(f64::NAN), Ok(false));
    let totals = assembly.evaluate_totals();
    assert!(totals.energy.is_nan() && assembly.forces[touching][0].is_nan());
}
