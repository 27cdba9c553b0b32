//! NumPy archives: read to the bit, written to the bit, and what is said about those that are no packings.

use std::fs;
use std::io::Write;

use jamscope::io::{
    Column, Frame, ReadWarning, WriteError, frame_count, read_contents, read_frame, read_packing, write_npz,
};
use jamscope::packing::{Domain, Packing};

use super::refusals::assert_refused;
use super::{Scratch, fixture};

/// The disks that the archives of NumPy hold too.
fn dumped() -> Packing<2> {
    read_packing(fixture("formats/disks_wrapped.dump")).expect("a dump")
}

fn archive(name: &str) -> Vec<u8> {
    fs::read(fixture("formats").join(name)).expect("a fixture")
}

/// An archive of stored arrays: the smallest that NumPy would read, made by hand.
fn stored(arrays: &[(&str, &str, &str, &[u8])]) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for &(name, dtype, shape, data) in arrays {
        let header = format!("{{'descr': '{dtype}', 'fortran_order': False, 'shape': ({shape}), }}\n");
        let mut content = b"\x93NUMPY\x01\x00".to_vec();
        content.extend((header.len() as u16).to_le_bytes());
        content.extend(header.as_bytes());
        content.extend(data);
        let mut crc = flate2::Crc::new();
        crc.update(&content);
        let (name, place) = (format!("{name}.npy"), bytes.len() as u32);
        let size = (content.len() as u32).to_le_bytes();
        let known = [
            &[20, 0, 0, 0, 0, 0, 0, 0, 0x21, 0][..],
            &crc.sum().to_le_bytes(),
            &size,
            &size,
            &[name.len() as u8, 0, 0, 0],
        ];
        let known = known.concat();
        bytes.extend([b"PK\x03\x04", &known[..], name.as_bytes(), &content].concat());
        directory.extend([b"PK\x01\x02\x14\x00", &known[..], &[0; 10], &place.to_le_bytes(), name.as_bytes()].concat());
    }
    let (start, count) = (bytes.len() as u32, arrays.len() as u8);
    bytes.extend(&directory);
    let length = (directory.len() as u32).to_le_bytes();
    bytes.extend([b"PK\x05\x06\0\0\0\0", &[count, 0, count, 0][..], &length, &start.to_le_bytes(), &[0, 0]].concat());
    bytes
}

fn reals(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// Two disks, with the array `name` replaced or added.
fn two_disks(name: &str, dtype: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let (positions, radii, sides) = (reals(&[1.0, 2.0, 2.1, 2.0]), reals(&[0.5, 0.7]), reals(&[9.0, 8.0]));
    let mut arrays: Vec<(&str, &str, &str, &[u8])> =
        vec![("positions", "<f8", "2, 2", &positions), ("radii", "<f8", "2,", &radii), ("box", "<f8", "2,", &sides)];
    arrays.retain(|array| array.0 != name);
    if !dtype.is_empty() {
        arrays.push((name, dtype, shape, data));
    }
    stored(&arrays)
}

#[test]
fn an_archive_of_numpy_is_the_packing_to_the_bit() {
    let plain = read_contents::<2>(fixture("formats/plain.npz"), Frame::Last).expect("an archive");
    assert_eq!((plain.packing, plain.warnings), (dumped(), Vec::new()));
    let properties = [("law", "hertzian"), ("stiffness", "10000.0"), ("steps", "12")];
    assert_eq!(plain.properties, properties.map(|(key, value)| (key.to_string(), value.to_string())));
}

#[test]
fn compressed_arrays_in_fortran_order_and_frames_are_read() {
    let path = fixture("formats/compressed.npz");
    assert_eq!(frame_count(&path).expect("an archive"), 2);
    assert_eq!(read_packing::<2>(&path).expect("an archive"), dumped());
    let first = read_frame::<2>(&path, Frame::Index(0)).expect("a frame");
    for (moved, position) in first.positions().iter().zip(dumped().positions()) {
        assert_eq!(*moved, [position[0] + 0.25, position[1] + 0.25]);
    }
    let message = read_frame::<2>(&path, Frame::Index(2)).expect_err("two frames").to_string();
    assert!(message.contains("no frame 2") && message.contains("2 frames"), "{message}");
}

#[test]
fn single_precision_a_height_and_a_matrix_are_read() {
    let contents = read_contents::<2>(fixture("formats/single.npz"), Frame::Last).expect("an archive");
    assert_eq!(contents.warnings, [ReadWarning::SinglePrecision { array: "pos".into() }]);
    let single = contents.packing;
    let narrow = |value: &f64| f64::from(*value as f32);
    assert_eq!(single.radii(), dumped().radii().iter().map(narrow).collect::<Vec<_>>());
    assert_eq!(
        single.positions().as_flattened(),
        dumped().positions().as_flattened().iter().map(narrow).collect::<Vec<_>>()
    );
    // The lengths are differences in double precision, made single after.
    assert_eq!(single.domain().lengths().map(|sides| sides.to_vec()), Some(vec![narrow(&6.3), narrow(&5.1)]));
    // Without labels a disk has the number of its row, from 0.
    assert_eq!(single.labels(), [0, 1, 2, 3, 4, 5, 6]);
}

/// A packing with all that a packing has.
fn full<const D: usize>() -> Packing<D> {
    let low = |value: f64| std::array::from_fn(|axis| if axis == 0 { value } else { 0.0 });
    let sites = vec![([1.5; D], low(1e-17)), ([2.5; D], [0.0; D])];
    Packing::<D>::new(
        Domain::cube(9.0),
        vec![[0.1; D], std::array::from_fn(|axis| -0.0 - axis as f64)],
        vec![0.5, 1.0 / 3.0],
    )
    .and_then(|packing| packing.with_corrections(vec![low(1e-18), [0.0; D]]))
    .and_then(|packing| packing.with_held(vec![true, false]))
    .and_then(|packing| packing.with_labels(vec![u64::MAX, 7]))
    .and_then(|packing| packing.with_sites(sites))
    .and_then(|packing| packing.with_loads(vec![[-0.0; D], [1e-3; D]]))
    .expect("valid packing")
}

fn comes_back<const D: usize>(packing: &Packing<D>) {
    let scratch = Scratch::new();
    let values: Vec<f64> = (0..packing.len() * D).map(|at| 0.1 * at as f64).collect();
    let columns = [
        Column { name: "force", width: D, values: &values },
        Column { name: "one", width: 1, values: &values[..packing.len()] },
    ];
    let properties = [("law", "hooke"), ("stiffness", "1e4"), ("pressure", "0.1"), ("seed", "-3"), ("note", "größe ")];
    write_npz(scratch.path(), packing, &columns, &properties).expect("written");
    let read = read_contents::<D>(scratch.path(), Frame::Last).expect("readable");
    assert_eq!(&read.packing, packing);
    let bits =
        |packing: &Packing<D>| packing.positions().as_flattened().iter().map(|it| it.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&read.packing), bits(packing));
    // A key comes back as it was written, whether it was a number or not.
    assert_eq!(read.properties, properties.map(|(key, value)| (key.to_string(), value.to_string())));
    let first = fs::read(scratch.path()).expect("written");
    write_npz(scratch.path(), packing, &columns, &properties).expect("written");
    assert_eq!(fs::read(scratch.path()).expect("written"), first);
}

#[test]
fn packings_come_back_to_the_same_bits() {
    comes_back(&full::<2>());
    comes_back(&full::<3>());
    comes_back(&dumped());
    let open = Packing::<2>::new(Domain::Open, vec![[0.5, 0.25]], vec![0.5]).expect("a disk");
    comes_back(&open);
}

/// The layout of the format, byte by byte, as `numpy.save` writes it.
#[test]
fn an_array_is_written_as_numpy_writes_it() {
    let scratch = Scratch::new();
    let packing = dumped();
    write_npz(scratch.path(), &packing, &[], &[]).expect("written");
    let (ours, theirs) = (fs::read(scratch.path()).expect("written"), archive("plain.npz"));
    let array = |bytes: &[u8]| {
        let at = bytes.windows(6).position(|part| part == b"\x93NUMPY").expect("an array");
        bytes[at..at + 128 + 16 * packing.len()].to_vec()
    };
    // The positions are first in both.
    assert_eq!(array(&ours), array(&theirs));
}

#[test]
fn names_of_arrays_are_unique_and_nothing_is_written_otherwise() {
    let (scratch, packing) = (Scratch::new(), dumped());
    let values = vec![0.0; packing.len()];
    let column = |name| [Column { name, width: 1, values: &values }];
    let refused = |columns: &[Column], properties: &[(&str, &str)], expected: &str| {
        match write_npz(scratch.path(), &packing, columns, properties) {
            Err(WriteError::Name { name, .. }) => assert_eq!(name, expected),
            other => panic!("{other:?}"),
        }
        assert!(!scratch.path().exists());
    };
    refused(&column("box"), &[], "box");
    refused(&[], &[("labels", "1")], "labels");
    refused(&column("law"), &[("law", "hooke")], "law");
}

/// Rows of a lower triangular matrix are the edges, columns of an upper one; tilts of HOOMD are over the side L_y.
#[test]
fn a_tilted_box_is_read_from_every_form_of_it() {
    let forms: [(&str, &[f64]); 5] = [
        ("2, 2", &[9.0, 0.0, 2.0, 8.0]),
        ("2, 2", &[9.0, 2.0, 0.0, 8.0]),
        ("3, 3", &[9.0, 0.0, 0.0, 2.0, 8.0, 0.0, 0.0, 0.0, 1.0]),
        ("3, 3", &[9.0, 2.0, 0.0, 0.0, 8.0, 0.0, 0.0, 0.0, 1.0]),
        ("6,", &[9.0, 8.0, 1.0, 0.25, 0.0, 0.0]),
    ];
    for (shape, numbers) in forms {
        let packing = Scratch::new().read::<2>(two_disks("box", "<f8", shape, &reals(numbers))).expect(shape);
        assert_eq!(packing.domain().edges(), Some([[9.0, 0.0], [2.0, 8.0]]), "{shape} {numbers:?}");
    }
    let out = reals(&[9.0, 0.0, 0.0, 2.0, 8.0, 0.0, 0.5, 0.0, 1.0]);
    assert_refused::<2>(two_disks("box", "<f8", "3, 3", &out), &["array box[2, 0] is 0.5", "out of the plane"]);
}

#[test]
fn what_is_missing_or_odd_is_named_with_its_value() {
    assert_refused::<2>(
        archive("objects.npz"),
        &["array radii", "Python objects", "numpy.asarray(radii, dtype=float)"],
    );
    let refused = |name: &str, dtype: &str, shape: &str, data: &[u8], parts: &[&str]| {
        assert_refused::<2>(two_disks(name, dtype, shape, data), parts);
    };
    refused("positions", "", "", &[], &["no array of centres", "positions, position, R", "found: radii, box"]);
    refused("radii", "", "", &[], &["no array of radii or diameters", "found: positions, box"]);
    refused("box", "", "", &[], &["no array of sides of the box (or pbc=False", "box, BoxMatrix"]);
    refused("radii", "<f8", "3,", &reals(&[1.0; 3]), &["array radii has shape [3]", "(2,), one value per disk"]);
    refused("radii", "<f8", "2,", &reals(&[0.5, -1.0]), &["array radii[1] is -1.0", "a radius from 1e-130"]);
    refused("radii", ">f8", "2,", &reals(&[0.5, 1.0]), &["array radii has dtype >f8", "little-endian"]);
    refused("radii", "<f8", "2,", &reals(&[0.5]), &["array radii is damaged", "1 values for shape [2]"]);
    refused("radii", "<f8", "2,", &[0; 15], &["array radii is damaged", "last value is cut"]);
    refused("radius", "<f8", "2,", &reals(&[0.5, 1.0]), &["arrays radii and radius both mean radii"]);
    let nan = reals(&[1.0, f64::NAN, 2.1, 2.0]);
    refused("positions", "<f8", "2, 2", &nan, &["array positions[0, 1] is NaN", "a finite number"]);
    let far = reals(&[1.0, 2.0, 2.1, 1e7]);
    refused(
        "positions",
        "<f8",
        "2, 2",
        &far,
        &["array positions[1, 1] is 10000000.0", "a million times the largest radius"],
    );
    refused("positions", "<f8", "4,", &far, &["array positions has shape [4]"]);
    refused("positions", "<f8", "0, 2", &[], &["array positions has shape [0, 2]"]);
    let uneven = reals(&[1.0, 2.0, 0.0, 2.1, 2.0, 0.5]);
    refused("positions", "<f8", "2, 3", &uneven, &["not a packing in 2 dimensions", "--dimension 3"]);
    assert_refused::<3>(two_disks("", "", "", &[]), &["not a packing in 3 dimensions", "--dimension 2"]);
    refused("box", "<f8", "2, 2", &reals(&[9.0, 0.1, 0.5, 8.0]), &["array box", "triangular matrix"]);
    refused("box", "<f8", "2,", &reals(&[9.0, 0.0]), &["array box[1] is 0.0", "a positive side"]);
    refused("box", "<f8", "5,", &reals(&[9.0; 5]), &["array box has shape [5]"]);
    refused("pbc", "|b1", "2,", &[1, 0], &["array pbc[1] is False", "the same in all directions"]);
    refused("pbc", "<U1", "", &[84, 0, 0, 0], &["array pbc[] is T", "0 or 1"]);
    refused("labels", "<f8", "2,", &reals(&[0.0, 1.0]), &["array labels[0] is 0.0", "an integer"]);
    refused("labels", "|i1", "2,", &[0, 255], &["array labels[1] is -1", "0 or more"]);
    refused("ids", "|i1", "2,", &[4, 4], &["array ids: label 4 occurs more than once"]);
    refused("held", "<f8", "2,", &reals(&[0.0, 0.5]), &["array held[1] is 0.5", "0 or 1"]);
    refused(
        "corrections",
        "<f8",
        "2, 2",
        &reals(&[0.0, 0.5, 0.0, 0.0]),
        &["array corrections[0, 1] is 0.5", "the spacing of numbers at 2.0"],
    );
    assert_refused::<2>(b"\x93NUMPY\x01\x00", &["a single NumPy array", "numpy.savez"]);
    assert!(Scratch::new().read::<2>(two_disks("labels", "<i8", "2,", &[0; 16])).is_ok(), "labels may repeat");
}

#[test]
fn a_damaged_archive_is_refused_and_never_a_panic() {
    let whole = archive("compressed.npz");
    for end in 0..whole.len() {
        assert!(Scratch::new().read::<2>(&whole[..end]).is_err(), "cut after {end} bytes");
    }
    // A bit anywhere: refused, or, in what is not read (names, dates), the same disks or others without them.
    let scratch = Scratch::new();
    for at in 0..whole.len() {
        let mut wrong = whole.clone();
        wrong[at] ^= 4;
        if let Ok(packing) = scratch.read::<2>(&wrong) {
            assert_eq!(packing.positions(), dumped().positions(), "byte {at}");
            assert_eq!(packing.radii(), dumped().radii(), "byte {at}");
        }
    }
    // A large announced size costs nothing: the content shows its own.
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gzip.write_all(&whole).expect("in memory");
    assert_eq!(scratch.read::<2>(gzip.finish().expect("in memory")).expect("an archive in gzip"), dumped());
}

/// Every name with every type and shape, checksums right: a packing or a message, never a panic.
#[test]
fn odd_headers_are_refused_and_never_a_panic() {
    let names = [
        "positions",
        "radii",
        "diameters",
        "box",
        "origin",
        "pbc",
        "ids",
        "held",
        "corrections",
        "sites",
        "loads",
        "dimension",
    ];
    let dtypes = ["<f8", "<f4", "<i8", "|u1", "|b1", "<U2", "<U0", "|O", "|S4", "<c16", "[('a', '<f8')]"];
    let shapes = [
        "",
        "0,",
        "1,",
        "2,",
        "3,",
        "2, 2",
        "2, 3",
        "0, 2",
        "2, 0",
        "1, 2, 2",
        "2, 2, 2",
        "-1,",
        "x",
        "99999999999, 99999999999",
    ];
    let mut read = 0;
    for name in names {
        for dtype in dtypes {
            for shape in shapes {
                for length in [0, 1, 4, 8, 16, 32, 48, 64] {
                    let file = two_disks(name, dtype, shape, &[1; 64][..length]);
                    read += usize::from(Scratch::new().read::<2>(&file).is_ok());
                    let _ = Scratch::new().read::<3>(&file);
                }
            }
        }
    }
    assert!(read > 0, "some are packings, such as those with flags");
}
