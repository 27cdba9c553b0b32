//! Files as other programs write them: what is read, with which warning, and what is refused.

use std::io::Write;

use jamscope::io::{Contents, Frame, ReadWarning, frame_count, read_contents};
use jamscope::packing::{Domain, Packing};

use super::refusals::{DATA, DUMP, XYZ, assert_change_refused, assert_refused};
use super::{Scratch, fixture};

fn packing() -> Packing<2> {
    Scratch::new().read(XYZ).expect("valid example")
}

fn contents(text: impl AsRef<[u8]>) -> Contents<2> {
    let scratch = Scratch::new();
    std::fs::write(scratch.path(), text).expect("writable folder");
    read_contents(scratch.path(), Frame::Last).expect("a packing")
}

/// The example with its first `from` made `to` is the same packing, without a warning.
fn assert_same(text: &str, from: &str, to: &str) {
    assert!(text.contains(from), "`{from}` stands in the valid file");
    let contents = contents(text.replacen(from, to, 1));
    assert_eq!((contents.packing, contents.warnings), (packing(), Vec::new()), "`{from}` as `{to}`");
}

#[test]
fn columns_under_the_names_of_other_programs() {
    for name in ["Radius", "radii", "RADIUS"] {
        assert_same(XYZ, "radius:R:1", &format!("{name}:R:1"));
    }
    for name in ["Position", "positions", "coordinates"] {
        assert_same(XYZ, "pos:R:3", &format!("{name}:R:3"));
    }
    for name in ["ID", "Identifier", "particle_identifier", "Particle-ID", "label", "atom_id"] {
        assert_same(XYZ, "id:I:1", &format!("{name}:I:1"));
    }
    assert_same(XYZ, "pos:R:3", "x:R:1:Y:R:1:z:R:1");
    assert_same(DUMP, "ATOMS id x y z radius", "ATOMS ID X Y Z Radius");
    let diameters = XYZ.replace("radius", "Diameter").replace("0 0.5", "0 1.0").replace("0 0.7", "0 1.4");
    assert_eq!(contents(diameters).packing, packing());
    // If both are there, the radius counts.
    let both = XYZ.replace("radius:R:1", "diameter:R:1:radius:R:1").replace(" 0.5", " 9 0.5").replace(" 0.7", " 9 0.7");
    assert_eq!(contents(both).packing, packing());
}

#[test]
fn what_ase_holds_is_held() {
    let mask = XYZ.replace("id:I:1", "id:I:1:move_mask:L:1").replace("0.5 1", "0.5 1 T").replace("0.7 2", "0.7 2 F");
    assert_eq!(contents(mask).packing.held(), [false, true]);
}

#[test]
fn two_columns_of_one_meaning_are_refused() {
    let two = XYZ.replace("radius:R:1", "radius:R:1:Radii:R:1").replace(" 0.5", " 0.5 9").replace(" 0.7", " 0.7 9");
    assert_refused::<2>(two, &["line 2", "columns is `radius and Radii`"]);
    assert_change_refused::<2>(DUMP, "z radius", "X radius", &["line 9", "column `X`"]);
}

#[test]
fn a_label_is_neither_guessed_nor_dropped() {
    let two = XYZ.replace("id:I:1", "id:I:1:Identifier:I:1").replace("0.5 1", "0.5 1 7").replace("0.7 2", "0.7 2 8");
    assert_refused::<2>(two, &["line 2", "columns id and Identifier could both be the label"]);
    assert_change_refused::<2>(XYZ, "id:I:1", "Identifier:S:1", &["line 2", "column Identifier is `Identifier:S:1`"]);
    // The held images of a rim repeat labels, whatever their name. Two mobile disks have no common id.
    for name in ["id", "label", "Identifier"] {
        if name != "label" {
            let same = XYZ.replace("id:I:1", &format!("{name}:I:1")).replace("0.7 2", "0.7 1");
            assert_refused::<2>(same, &["line 4", "id `1` is already in line 3"]);
        }
        let rim = XYZ.replace("id:I:1", &format!("{name}:I:1:held:I:1"));
        let rim = rim.replace("0.5 1", "0.5 1 0").replace("0.7 2", "0.7 1 1");
        assert_eq!(contents(rim).packing.labels(), [1, 1]);
    }
}

#[test]
fn what_is_harmless_is_read() {
    assert_same(XYZ, "9 0 0 0 8 0 0 0 1", "9 0 0 8");
    assert_same(XYZ, "9 0 0 0 8 0 0 0 1", " 9   0 0  0 8 0 0 0 1 ");
    assert_same(XYZ, "pbc=\"T T F\"", "pbc=\"T T\" Origin=\"0 0\"");
    assert_same(XYZ, "2\n", "\u{feff}2\n");
    // Fortran.
    assert_same(XYZ, "2.1 2.0", "2.1D0 0.2d+01");
    // A plane, whatever its height, also up to rounding.
    assert_same(XYZ, "1.0 2.0 0 ", "1.0 2.0 1e-17 ");
    let lifted = |text: &str, from: &str, to: &str| contents(text.replace(from, to)).packing;
    assert_eq!(lifted(XYZ, "2.0 0 0.", "2.0 0.3 0."), packing());
    assert_eq!(lifted(DATA, "2.0 0.0", "2.0 -0.25"), packing());
    assert_eq!(lifted(DUMP, "2.0 0.0 0.", "2.0 0.25 0."), packing());
    // A box without height.
    assert_same(DUMP, "-0.5 0.5", "0 0");
    assert_same(DUMP, "-0.5 0.5", "0.0 0.0");
    // A box by its edge vectors and its origin, as OVITO writes it.
    let vectors =
        DUMP.replace("BOUNDS", "BOUNDS abc origin").replace("0.0 9.0", "9 0 0 0").replace("0.0 8.0", "0 8 0 0");
    for height in ["0 0 1 -0.5", "0 0 0 0"] {
        assert_eq!(contents(vectors.replace("-0.5 0.5", height)).packing, packing());
    }
    assert_change_refused::<3>(DUMP, "-0.5 0.5", "0 0", &["line 8", "zlo zhi is `0 0`"]);
}

#[test]
fn numbers_that_are_not_of_fortran_are_refused() {
    for wrong in ["d5", "1d", "1d5d3", "0x1d", "1.0-105", "nad", "-D2"] {
        assert_change_refused::<2>(XYZ, "2.1 2.0", &format!("{wrong} 2.0"), &["line 4", "pos x is", "a finite number"]);
    }
}

#[test]
fn what_should_be_known_is_a_warning() {
    let read = contents(XYZ.trim_end());
    assert_eq!((read.packing, read.warnings), (packing(), vec![ReadWarning::LastLineOpen { line: 4 }]));
    let read = contents(DUMP.replace(" pp pp pp", ""));
    assert_eq!((read.packing, read.warnings), (packing(), vec![ReadWarning::NoBoundaryFlags { line: 5 }]));
    for flags in ["ff ff pp", "mm ff pp", "fs ss ff"] {
        let read = contents(DUMP.replace("pp pp pp", flags));
        assert_eq!(read.packing.domain(), &Domain::Open);
        assert_eq!(read.packing.positions(), packing().positions());
        assert_eq!(read.warnings, [ReadWarning::Walls { line: 5, flags: flags.into() }]);
    }
}

#[test]
fn compressed_files_are_read_and_damaged_ones_refused() {
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    gzip.write_all(XYZ.as_bytes()).expect("in memory");
    let gzip = gzip.finish().expect("in memory");
    let zstd = ruzstd::encoding::compress_to_vec(XYZ.as_bytes(), ruzstd::encoding::CompressionLevel::Fastest);
    for compressed in [&gzip, &zstd] {
        assert_eq!(contents(compressed).packing, packing());
        // Two members, one after the other, are one text.
        let (first, second) = (XYZ.replace("0.7 2", "0.7 3"), [&compressed[..], &compressed[..]].concat());
        assert_eq!(contents(&second).packing, packing());
        assert_ne!(contents(&first).packing, packing());
        assert_refused::<2>(&compressed[..compressed.len() - 6], &["damaged or cut"]);
        // A bit of the checksum, the last eight bytes of gzip and the last four of zstd.
        let mut wrong = compressed.clone();
        let place = wrong.len() - if compressed == &gzip { 8 } else { 1 };
        wrong[place] ^= 4;
        assert_refused::<2>(wrong, &["damaged or cut"]);
    }
    // A skippable frame of three bytes, before, after and alone.
    let skippable = [&[0x5a, 0x2a, 0x4d, 0x18, 3, 0, 0, 0][..], b"abc"].concat();
    for frames in [[&skippable[..], &zstd], [&zstd, &skippable[..]]] {
        assert_eq!(contents(frames.concat()).packing, packing());
    }
    assert_refused::<2>(&skippable, &["the file is empty"]);
    assert_refused::<2>(&skippable[..10], &["damaged or cut", "a skippable frame is cut"]);
    assert_refused::<2>([0x1f, 0x8b], &["damaged or cut"]);
    assert_refused::<2>([0x28, 0xb5, 0x2f, 0xfd, 1], &["damaged or cut"]);
}

#[test]
fn the_frames_of_a_file_are_counted() {
    assert_eq!(frame_count(fixture("formats/disks_two_frames.dump")).expect("a dump"), 2);
    let scratch = Scratch::new();
    for (text, expected) in [(XYZ.repeat(3), 3), (DATA.into(), 1), (DUMP.into(), 1)] {
        std::fs::write(scratch.path(), text).expect("writable folder");
        assert_eq!(frame_count(scratch.path()).expect("a packing"), expected);
    }
}
