//! Places of a list without a pair, and disks with one centre.

use jamscope::forces::Assembly;
use jamscope::forces::elastic::geometry;
use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::neighbours::block::BLOCK;
use jamscope::packing::{Mixture, Packing, PackingError};
use jamscope::preparation::random_points;

#[test]
fn places_without_a_pair_are_gaps_that_nothing_closes() {
    check_vacant_places(&read_packing::<2>("fixtures/packings/hertz_N5548_p100.xyz").expect("a stored packing"));
    check_vacant_places(&random_points::<2>(20_000, &Mixture::default(), 0.9, 3).expect("possible"));
}

fn check_vacant_places(packing: &Packing<2>) {
    let mut assembly = Assembly::new(packing, &Hertzian::default()).expect("no coincidence");
    assembly.displacements[0] = [1e6; 2];
    let pairs = assembly.pairs();
    let mut has_pair = vec![false; pairs.place_count()];
    pairs.numbers().for_each(|pair| has_pair[pair] = true);
    assert_eq!(has_pair.iter().filter(|&&has| has).count(), pairs.len());
    // Its blocks are not all full, and it has places for pairs to come.
    assert!(pairs.len() + 6 * BLOCK < pairs.place_count());
    for place in (0..has_pair.len()).filter(|&place| !has_pair[place]) {
        let (_, distance, overlap) = geometry(pairs, place, &assembly.displacements);
        assert!(distance > 1e99 && overlap < -1e99, "place {place}: {distance} {overlap}");
    }
}

#[test]
fn disks_with_one_centre_are_found_and_others_are_not() {
    let packing = random_points::<2>(20_000, &Mixture::default(), 0.9, 3).expect("possible");
    let with = |places: [[f64; 2]; 2]| {
        let mut positions = packing.positions().to_vec();
        [positions[77], positions[19_000]] = places;
        Packing::new(*packing.domain(), positions, packing.radii().to_vec()).expect("as before")
    };
    let found = Assembly::new(&with([[1.0, 2.0]; 2]), &Hertzian::default()).err();
    assert_eq!(found, Some(PackingError::CoincidentCentres { first: 77, second: 19_000 }));
    // Far nearer than the rounding of the sum of their radii, but apart.
    let mut assembly = Assembly::new(&with([[1e-20, 0.0], [0.0; 2]]), &Hertzian::default()).expect("apart");
    assembly.evaluate();
    assert!(assembly.forces.as_flattened().iter().all(|force| force.is_finite()));
}
