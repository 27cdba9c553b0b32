//! Files made by LAMMPS itself (`fixtures/formats`): every format gives one packing.

use jamscope::io::{Frame, read_frame, read_packing};
use jamscope::packing::{Domain, Packing};

use super::fixture;

fn read<const D: usize>(name: &str) -> Packing<D> {
    read_packing(fixture("formats").join(name)).expect("a file of LAMMPS is read")
}

/// The same disks up to images and `tolerance` in the coordinates.
fn assert_same_disks<const D: usize>(found: &Packing<D>, expected: &Packing<D>, tolerance: f64) {
    assert_eq!((found.labels(), found.radii()), (expected.labels(), expected.radii()));
    assert_eq!(found.domain(), expected.domain());
    for disk in 0..expected.len() {
        let apart = found.domain().separation(found.centre(disk), expected.centre(disk));
        assert!(apart.iter().all(|difference| difference.abs() <= tolerance), "disk {disk}: {apart:?}");
    }
}

#[test]
fn a_dump_is_read_as_it_stands_and_sorted_by_id() {
    let packing = read::<2>("disks_wrapped.dump");
    assert_eq!(packing.labels(), [1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(packing.radii(), [0.5, 0.7, 0.5, 0.7, 0.5, 0.7, 0.5]);
    assert_eq!(packing.positions()[3], [1.231967807073031, 0.6062626602305565]);
    // Sides are differences of the ends in the file: 4.8 − (−1.5) and 5.35 − 0.25.
    let domain = Domain::rectangular([-1.5, 0.25], [4.8 + 1.5, 5.35 - 0.25]);
    assert_eq!(packing.domain(), &domain);
}

#[test]
fn a_data_file_and_a_dump_of_one_system_agree_to_the_bit() {
    assert_eq!(read::<2>("disks.data"), read::<2>("disks_wrapped.dump"));
    assert_eq!(read::<3>("balls.data"), read::<3>("balls_wrapped.dump"));
}

#[test]
fn scaled_and_unwrapped_coordinates_give_the_same_packing() {
    let disks = read::<2>("disks_wrapped.dump");
    // 17 digits of a fraction of the box, times its side of 6.3: one rounding of each and one of the sum, below 4 ulp(8).
    let rounding = 4.0 * 8.0 * f64::EPSILON;
    assert_same_disks(&read("disks_scaled.dump"), &disks, rounding);
    assert_same_disks(&read::<3>("balls_scaled.dump"), &read("balls_wrapped.dump"), rounding);
    let unwrapped = read::<2>("disks_unwrapped.dump");
    assert_same_disks(&unwrapped, &disks, rounding);
    // Disk 2 has image flags 1 and −2: it is read where it stands.
    assert!((unwrapped.positions()[1][1] + 7.217).abs() < 1e-3);
    // LAMMPS itself multiplies by inverse sides here and is off by 2.7e-13 in these files.
    assert_same_disks(&read("disks_scaled_unwrapped.dump"), &disks, 1e-12);
}

#[test]
fn unscaled_columns_go_before_scaled_ones() {
    assert_eq!(read::<2>("disks_both.dump"), read::<2>("disks_wrapped.dump"));
}

#[test]
fn the_last_frame_is_taken_unless_another_is_asked_for() {
    let path = fixture("formats/disks_two_frames.dump");
    assert_eq!(read_frame::<2>(&path, Frame::Index(0)).expect("first"), read("disks_wrapped.dump"));
    let last = read_packing::<2>(&path).expect("last");
    assert_eq!(last.positions()[0], [0.5401464079704972, 1.019330793868422]);
    assert_eq!(read_frame::<2>(&path, Frame::Index(1)).expect("second"), last);
    let message = read_frame::<2>(&path, Frame::Index(2)).expect_err("no third frame").to_string();
    assert!(message.contains("disks_two_frames.dump: no frame 2 (counted from 0); the file has 2 frames"), "{message}");
}

#[test]
fn balls_are_not_read_as_disks() {
    for name in ["balls.data", "balls_wrapped.dump", "balls_scaled.dump"] {
        let message = read_packing::<2>(fixture("formats").join(name)).expect_err("balls").to_string();
        assert!(message.contains(name) && message.contains("not a packing in 2 dimensions"), "{message}");
    }
}
