//! LAMMPS data that we write, and read again.

use jamscope::io::{WriteError, read_packing, write_lammps_data};
use jamscope::packing::{Domain, Packing};

use super::{Scratch, fixture};

fn round_trip<const D: usize>(packing: &Packing<D>) -> Packing<D> {
    let scratch = Scratch::new();
    write_lammps_data(scratch.path(), packing).expect("writable packing");
    read_packing(scratch.path()).expect("what was written is read")
}

#[test]
fn stored_packings_come_back_to_the_bit() {
    for name in ["hertz_N1000_p100", "hertz_N1000_phi082", "hooke_N1000_p800", "hertz_N5548_p1"] {
        let packing = read_packing::<2>(fixture("packings").join(format!("{name}.xyz"))).expect("readable");
        let read = round_trip(&packing);
        assert_eq!((read.domain(), read.labels()), (packing.domain(), packing.labels()), "{name}");
        assert_eq!((read.positions(), read.radii()), (packing.positions(), packing.radii()), "{name}");
    }
}

#[test]
fn a_file_of_lammps_written_again_is_the_same_packing() {
    // Corners are not the origin there; their ends are in the file, and what is read is what was written.
    let disks = read_packing::<2>(fixture("formats").join("disks.data")).expect("readable");
    assert_eq!(round_trip(&disks), disks);
    let balls = read_packing::<3>(fixture("formats").join("balls.data")).expect("readable");
    assert_eq!(round_trip(&balls), balls);
}

#[test]
fn labels_that_are_no_ids_are_renumbered_and_types_go_by_radius() {
    let domain = Domain::<2>::cube(9.0);
    let sites = vec![[1.0, 1.0], [3.0, 1.0], [5.0, 1.0]];
    let packing = Packing::new(domain, sites, vec![0.7, 0.5, 0.7]).expect("valid");
    // 0, 1, 2: LAMMPS has no id 0.
    assert_eq!(round_trip(&packing).labels(), [1, 2, 3]);
    let twice = packing.clone().with_labels(vec![4, 4, 5]).expect("a label a disk");
    assert_eq!(round_trip(&twice).labels(), [1, 2, 3]);
    let own = packing.clone().with_labels(vec![9, 4, 5]).expect("a label a disk");
    // Who reads sorts by id.
    assert_eq!((round_trip(&own).labels(), round_trip(&own).radii()), (&[4, 5, 9][..], &[0.5, 0.7, 0.7][..]));
    let scratch = Scratch::new();
    write_lammps_data(scratch.path(), &own).expect("writable packing");
    let text = std::fs::read_to_string(scratch.path()).expect("readable");
    assert!(text.contains("\n2 atom types\n") && text.contains("\n9 2 1.4 ") && text.contains("\n4 1 1.0 "), "{text}");
}

#[test]
fn what_the_format_has_no_place_for_is_refused_and_nothing_is_written() {
    let boxed = Packing::new(Domain::<2>::cube(9.0), vec![[1.0, 1.0]], vec![0.5]).expect("valid");
    let refused = |packing: &Packing<2>, what: &str| {
        let scratch = Scratch::new();
        let error = write_lammps_data(scratch.path(), packing).expect_err("no place for it");
        assert!(matches!(error, WriteError::NoPlaceFor { .. }) && error.to_string().contains(what), "{error}");
        assert!(scratch.names().is_empty());
    };
    refused(&Packing::new(Domain::Open, vec![[1.0, 1.0]], vec![0.5]).expect("valid"), "open plane");
    refused(&boxed.clone().with_held(vec![true]).expect("a flag a disk"), "held disks");
    refused(&boxed.clone().with_sites_here(), "sites");
    refused(&boxed.clone().with_loads(vec![[1.0, 0.0]; boxed.len()]).expect("finite"), "loads");
    refused(&Packing::new(Domain::cube(9.0), vec![[1.0, 1.0]], vec![1e-120]).expect("valid"), "radius");
    let far = Domain::rectangular([1e300, 0.0], [1.0, 1.0]);
    refused(&Packing::new(far, vec![[1e300, 0.0]], vec![0.1]).expect("valid"), "box");
}
