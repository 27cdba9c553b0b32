//! Certificates against published packings, stored counts, and states whose numbers are known in closed form.

use std::path::Path;

use crate::scenes::laws::{hertzian, hookean};
use crate::scenes::published::{BALLS, DISKS, HARMONIC, published};
#[cfg(feature = "linear")]
use crate::scenes::random_disks;
#[cfg(feature = "linear")]
use jamscope::certificate::Stability;
use jamscope::certificate::{Certificate, Support};
use jamscope::inflation::{Circle, choose_centre};
use jamscope::io::read_packing;
use jamscope::law::{Hookean, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Packing};
use jamscope::relax::Criterion;

fn certificate<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw) -> Certificate {
    Certificate::of(packing, law, None).expect("apart")
}

fn fixture(name: &str) -> Packing<2> {
    read_packing(format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR"))).expect("a fixture")
}

/// How far apart the two virials may be.
///
/// At a step of η = 2⁻¹⁷ mean overlaps: rounding of energies 1e-16/η = 1.5e-11, a few times; truncation η² = 6e-11. A contact
/// with a force linear in its overlap that opens or closes on the way has ½ k (η δ)² of energy wrong where all together have
/// 2 η N_c ⟨F⟩ δ: η/(4 N_c) each; ten are allowed for (pairs that just touch are frequent in a jammed packing).
fn tolerance(linear: bool, contact_count: usize) -> f64 {
    2e-10 + if linear { 10.0 * 2e-6 / contact_count as f64 } else { 0.0 }
}

#[test]
fn published_packings_are_minima_with_no_fewer_contacts_than_they_need() {
    fn check<const D: usize>(file: &str, isostatic: usize) {
        let mut exactly = 0;
        for record in published::<D>(file) {
            let found = certificate(&record.packing, &HARMONIC);
            let contacts = found.contacts.expect("jammed");
            assert_eq!(contacts.support, Support::BoxUnderPressure);
            assert_eq!(contacts.isostatic_count, D * (contacts.disk_count - 1) + 1);
            assert_eq!(contacts.disk_count + found.rattler_count, record.packing.len());
            assert!(contacts.excess >= 0, "{}: {contacts:?}", record.name);
            exactly += usize::from(contacts.excess == 0);
            #[cfg(feature = "linear")]
            assert_eq!(found.stability.negative_eigenvalue_count(), Some(0), "{}: {:?}", record.name, found.stability);
            // D V p of the published stress: 1e-14 absolute there, pressures of 1e-4 and more.
            let volume = record.packing.domain().volume().expect("a box");
            let trace: f64 = (0..D).map(|axis| record.stress[axis][axis]).sum();
            let virial = found.virial.expect("contacts");
            assert!((virial.from_forces / (trace * volume) - 1.0).abs() < 1e-10, "{}", record.name);
            let off = virial.relative_difference.abs();
            assert!(off < tolerance(true, contacts.contact_count), "{}: {virial:?}", record.name);
            // What the publisher left: net forces up to 3e-13 in every file, 1e-9 of a mean force of 1e-4.
            assert!(found.largest_net_force < 1e-12, "{}: {:e}", record.name, found.largest_net_force);
            assert!(found.rounding_floor > 0.0 && found.rounding_floor < 1e-13);
        }
        assert_eq!(exactly, isostatic, "{file}: packings with exactly the isostatic number");
    }
    check::<2>(DISKS[0], 0);
    check::<2>(DISKS[1], 7);
    check::<3>(BALLS[0], 0);
    check::<3>(BALLS[1], 0);
}

#[test]
fn counts_are_those_stored_with_the_packings_and_energies_tell_the_same_virial_as_forces() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/packings/expected.json");
    let expected: serde_json::Value = serde_json::from_slice(&std::fs::read(path).expect("a fixture")).expect("JSON");
    for (name, stored) in expected.as_object().expect("a table by name") {
        let (packing, is_hookean) = (fixture(name), name.starts_with("hooke"));
        let found = if is_hookean { certificate(&packing, &hookean()) } else { certificate(&packing, &hertzian()) };
        assert_eq!(Some(found.rattler_count as u64), stored["rattlers"].as_u64(), "{name}");
        let count = found.contacts.map_or(0, |contacts| contacts.contact_count);
        assert_eq!(Some(count as u64), stored["contacts_backbone"].as_u64(), "{name}");
        if name.ends_with("phi082") {
            // Overlaps of 1e-12 at most: no side has digits for their change.
            assert!(found.contacts.is_none() && found.virial.is_none(), "{name}: {found:?}");
            #[cfg(feature = "linear")]
            assert_eq!(found.stability, Stability::NoBackbone);
            continue;
        }
        let virial = found.virial.expect("contacts");
        let off = virial.relative_difference.abs();
        assert!(off < tolerance(is_hookean, count), "{name}: {virial:?}");
        assert!(found.contacts.expect("jammed").excess > 0, "{name}");
        #[cfg(feature = "linear")]
        assert_eq!(found.stability.negative_eigenvalue_count(), Some(0), "{name}");
    }
}

#[test]
fn the_residual_is_that_of_the_backbone_beside_its_floor() {
    let (packing, law) = (fixture("hertz_N1000_p10"), hertzian());
    let network = ContactNetwork::new(&packing, &law).expect("apart");
    let found = certificate(&packing, &law);
    // LAMMPS left 1e-10 of a force of 11.
    assert!(found.relative_residual < 1e-10 && found.relative_residual > found.rounding_floor);
    assert_eq!(found.mean_contact_force, network.mean_contact_force());
    // A disk of the backbone that is moved counts.
    let moved = |disk: usize| {
        let mut positions = packing.positions().to_vec();
        positions[disk][0] += 1e-6;
        certificate(&Packing::new(*packing.domain(), positions, packing.radii().to_vec()).expect("a packing"), &law)
    };
    let member = network.backbone.iter().position(|&member| member).expect("jammed");
    // A contact's stiffness is at least some 1e3 here, so 1e-6 makes 1e-3 of force over 11.
    assert!(moved(member).relative_residual > 1e-5);
    // Two loose disks that press each other elsewhere do not, neither by their net force nor by that of their contact.
    let one = between_three(1.0);
    let positions = [one.positions(), &[[10.0, 0.0], [10.1, 0.0]]].concat();
    let with_two = Packing::new(Domain::Open, positions, vec![0.6; 6])
        .and_then(|packing| packing.with_held(vec![false, true, true, true, false, false]))
        .expect("a packing");
    let (alone, with_two) = (certificate(&one, &law), certificate(&with_two, &law));
    assert_eq!(with_two.rattler_count, 2);
    assert_eq!(
        (with_two.largest_net_force, with_two.mean_contact_force),
        (alone.largest_net_force, alone.mean_contact_force)
    );
}

#[test]
fn bucklers_are_disks_of_the_backbone_with_three_contacts_on_it() {
    let law = hertzian();
    for name in ["hertz_N1000_p005", "hertz_N1000_p100"] {
        let packing = fixture(name);
        let network = ContactNetwork::new(&packing, &law).expect("apart");
        let touches = |disk: usize| {
            let ends =
                |contact: &&jamscope::network::Contact<2>| [contact.first, contact.second].contains(&(disk as u32));
            network.backbone_contacts().filter(ends).count()
        };
        let members = (0..packing.len()).filter(|&disk| network.backbone[disk]);
        let counted = members.filter(|&disk| touches(disk) == 3).count();
        assert!(counted > 0);
        assert_eq!(certificate(&packing, &law).buckler_count, counted, "{name}");
    }
}

/// A disk between three held ones at this distance, all of radius 0.6.
fn between_three(distance: f64) -> Packing<2> {
    let around = (0..3).map(|k| {
        let angle = std::f64::consts::TAU * f64::from(k) / 3.0;
        [distance * angle.cos(), distance * angle.sin()]
    });
    Packing::new(Domain::Open, std::iter::once([0.0; 2]).chain(around).collect(), vec![0.6; 4])
        .and_then(|packing| packing.with_held(vec![false, true, true, true]))
        .expect("a packing")
}

#[test]
fn a_disk_between_three_held_ones_is_a_buckler_and_snaps_through_where_it_is_pressed_too_hard() {
    let law = Hookean { stiffness: 2.0 };
    // K = (3/2)(F' − F/r) times one: F' = 2, F = 2 (1.2 − r). Above r = 0.6 a minimum, below a maximum.
    for (distance, negative) in [(1.0, 0), (0.65, 0), (0.55, 2)] {
        let found = certificate(&between_three(distance), &law);
        let contacts = found.contacts.expect("a backbone of one");
        assert_eq!((contacts.support, contacts.disk_count, contacts.contact_count), (Support::HeldDisks, 1, 3));
        assert_eq!((contacts.isostatic_count, contacts.excess), (2, 1));
        assert_eq!((found.buckler_count, found.rattler_count), (1, 0));
        #[cfg(feature = "linear")]
        assert_eq!(found.stability.negative_eigenvalue_count(), Some(negative), "{distance}: {:?}", found.stability);
        let _ = negative;
        // Σ F r over three contacts, to a few roundings; energies are parabolas.
        let virial = found.virial.expect("contacts");
        assert!((virial.from_forces / (3.0 * 2.0 * (1.2 - distance) * distance) - 1.0).abs() < 1e-14);
        assert!(virial.relative_difference.abs() < 2e-10, "{virial:?}");
    }
    // Without its third neighbour it is a rattler, and there is nothing to certify.
    let two = between_three(1.0).with_radius(3, 0.3).expect("a radius");
    let found = certificate(&two, &law);
    assert_eq!((found.contacts, found.buckler_count, found.rattler_count), (None, 0, 1));
    assert_eq!(found.relative_residual, found.largest_net_force / found.mean_contact_force);
    assert!(found.relative_residual > 0.9, "two forces at 120 degrees add up to one: {}", found.relative_residual);
}

#[test]
fn what_holds_the_packing_decides_how_many_contacts_it_needs() {
    let (packing, law) = (fixture("hertz_N1000_p100"), hertzian());
    let count = |packing: &Packing<2>, criterion| {
        Certificate::of(packing, &law, criterion).expect("apart").contacts.expect("a backbone")
    };
    let (pressed, not) = (count(&packing, None), count(&packing, Some(Criterion::Unjammed)));
    assert_eq!((pressed.support, not.support), (Support::BoxUnderPressure, Support::Box));
    assert_eq!(not.isostatic_count + 1, pressed.isostatic_count);
    let centre = choose_centre(&packing, &law, Default::default(), 1).expect("a disk");
    let circle = Circle::cut(&packing, centre, 15.0).expect("a circle").packing;
    let held = count(&circle, None);
    assert_eq!((held.support, held.isostatic_count), (Support::HeldDisks, 2 * held.disk_count));
    let open = Packing::new(Domain::Open, packing.positions().to_vec(), packing.radii().to_vec()).expect("a packing");
    let open = count(&open, None);
    assert_eq!((open.support, open.isostatic_count), (Support::Nothing, 2 * open.disk_count - 3));
    let virial = certificate(&circle, &law).virial.expect("contacts");
    // As in a box; held disks are scaled with the others.
    assert!(virial.relative_difference.abs() < 2e-10, "{virial:?}");
}

#[cfg(feature = "linear")]
#[test]
fn negative_eigenvalues_are_those_of_dense_algebra() {
    use faer::{Mat, Side};
    use jamscope::linear::{Hessian, Members, Prestress};
    fn check<const D: usize>(packing: &Packing<D>, law: Hookean) -> usize {
        let hessian = Hessian::new(packing, &law, Members::Backbone, Prestress::Included).expect("apart");
        let (dimension, norm) = (hessian.matrix().dimension(), hessian.matrix().norm());
        let mut matrix = Mat::zeros(dimension, dimension);
        for (row, column, value) in hessian.matrix().entries() {
            matrix[(row, column)] = value;
            matrix[(column, row)] = value;
        }
        let values = matrix.self_adjoint_eigenvalues(Side::Lower).expect("finite");
        // Translations are 0 to the rounding of dense algebra, 400 · 1e-16.
        let negative = values.iter().filter(|&&value| value < -1e-13 * norm).count();
        let free = values.iter().filter(|value| value.abs() <= 1e-13 * norm).count();
        let found = certificate(packing, &law).stability;
        // A part of the backbone that floats alone may go where it likes, beside the translations of the whole.
        if free > if packing.held().contains(&true) { 0 } else { D } {
            assert!(matches!(found, Stability::Singular { .. }), "{found:?}");
            return 0;
        }
        assert_eq!(found.negative_eigenvalue_count(), Some(negative), "{found:?}");
        negative
    }
    let (law, mut seen) = (Hookean { stiffness: 1.0 }, 0);
    for seed in 1..6 {
        seen += check(&random_disks::disks(seed, 80, random_disks::periodic([2.0, 3.0]), 0.0), law);
        seen += check(&random_disks::disks(seed, 80, random_disks::periodic([2.0, 3.0]), 0.2), law);
        seen += check(&random_disks::disks(seed, 120, random_disks::periodic([1.2, 1.2, 1.2]), 0.0), law);
    }
    assert!(seen > 20, "random disks are at saddles");
}
