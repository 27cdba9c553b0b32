//! What is not a packing is refused with the file, the line, the field and the value.

use super::Scratch;

/// The message about a file, which must hold all of `parts`.
pub(super) fn assert_refused<const D: usize>(content: impl AsRef<[u8]>, parts: &[&str]) {
    let message = Scratch::new().read::<D>(content).expect_err("a file that is no packing").to_string();
    for part in ["packing.txt"].iter().chain(parts) {
        assert!(message.contains(part), "no `{part}` in: {message}");
    }
}

pub(super) const XYZ: &str = r#"2
Lattice="9 0 0 0 8 0 0 0 1" pbc="T T F" Properties=species:S:1:pos:R:3:radius:R:1:id:I:1
X 1.0 2.0 0 0.5 1
X 2.1 2.0 0 0.7 2
"#;

pub(super) const DATA: &str = "free text

2 atoms
2 atom types
0.0 9.0 xlo xhi
0.0 8.0 ylo yhi
-0.5 0.5 zlo zhi

Atoms # sphere

1 1 1.0 1.0 1.0 2.0 0.0
2 2 1.4 1.0 2.1 2.0 0.0
";

pub(super) const DUMP: &str = "ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS pp pp pp
0.0 9.0
0.0 8.0
-0.5 0.5
ITEM: ATOMS id x y z radius
1 1.0 2.0 0.0 0.5
2 2.1 2.0 0.0 0.7
";

/// The text with its first `from` made `to`, and the message about it.
pub(super) fn assert_change_refused<const D: usize>(text: &str, from: &str, to: &str, parts: &[&str]) {
    assert!(text.contains(from), "`{from}` stands in the valid file");
    assert_refused::<D>(text.replacen(from, to, 1), parts);
}

#[test]
fn the_examples_themselves_are_valid() {
    let scratch = Scratch::new();
    let [xyz, data, dump] = [XYZ, DATA, DUMP].map(|text| scratch.read::<2>(text).expect("valid example"));
    assert_eq!((&xyz, &data), (&data, &dump));
    // Windows line ends make no difference.
    assert_eq!(scratch.read::<2>(XYZ.replace('\n', "\r\n")).expect("line ends"), xyz);
}

#[test]
fn files_that_are_no_packing_at_all() {
    assert_refused::<2>("", &["the file is empty"]);
    assert_refused::<2>("\n \n", &["the file is empty"]);
    assert_refused::<2>("id,x,y\n1,2,3\n", &["no known format", "`id,x,y`", "extended XYZ", "LAMMPS data", "dump"]);
    assert_refused::<2>("-3\nX 0 0\n", &["no known format", "`-3`"]);
    assert_refused::<2>(b"2\n\xff\xfe\n", &["line 2", "not text"]);
    let absent = jamscope::io::read_packing::<2>("no/such/file.xyz").expect_err("absent").to_string();
    assert!(absent.contains("no/such/file.xyz: "), "{absent}");
}

#[test]
fn files_that_end_too_early_or_too_late() {
    assert_change_refused::<2>(XYZ, "2\n", "3\n", &["line 4", "after 2 of 3 disks"]);
    assert_change_refused::<2>(XYZ, "2\n", "1\n", &["line 4", "more disks than the 1 announced"]);
    assert_change_refused::<2>(
        XYZ,
        "2\n",
        "99999999999999999999\n",
        &["line 1", "number of disks", "99999999999999999999"],
    );
    assert_change_refused::<2>(XYZ, "2\n", "9999999999999999999\n", &["after 2 of 9999999999999999999 disks"]);
    assert_refused::<2>("0\npbc=\"F F F\" Properties=pos:R:3:radius:R:1\n", &["at least one disk"]);
    assert_change_refused::<2>(DATA, "2 atoms", "3 atoms", &["line 12", "after 2 of 3 disks of section Atoms"]);
    assert_change_refused::<2>(DATA, "2 atoms", "1 atoms", &["line 12", "more disks than the 1 announced"]);
    assert_change_refused::<2>(DATA, "Atoms # sphere", "", &["after 0 of 2 disks of section Atoms"]);
    assert_change_refused::<2>(DUMP, "ATOMS\n2", "ATOMS\n3", &["line 11", "after 2 of 3 disks of ITEM: ATOMS"]);
    assert_change_refused::<2>(DUMP, "ATOMS\n2", "ATOMS\n1", &["line 11", "more disks than the 1 announced"]);
    assert_change_refused::<2>(DUMP, "-0.5 0.5\n", "", &["line 7", "after 2 of 3 sides of the box"]);
}

#[test]
fn radii_that_are_missing_or_wrong() {
    assert_change_refused::<2>(XYZ, "radius:R:1", "mass:R:1", &["line 2", "column radius", "is missing", "mass:R:1"]);
    assert_change_refused::<2>(DUMP, "radius", "mass", &["line 9", "column radius or diameter is missing", "mass"]);
    for (value, shown) in [("-0.7", "`-0.7`"), ("0", "`0`"), ("NaN", "`NaN`"), ("inf", "`inf`"), ("x", "`x`")] {
        let row = |value: &str| format!("2.0 0 {value} 2\n");
        assert_change_refused::<2>(XYZ, &row("0.7"), &row(value), &["line 4", "radius is", shown, "positive"]);
        assert_change_refused::<2>(DATA, "1.4", value, &["line 12", "diameter is", shown, "positive"]);
        assert_change_refused::<2>(DUMP, "0.7", value, &["line 11", "radius is", shown, "positive"]);
    }
}

#[test]
fn coordinates_that_are_no_numbers() {
    for value in ["nan", "-inf", "1e999", "1,5", "0x10"] {
        let shown = format!("`{value}`");
        assert_change_refused::<2>(XYZ, "2.1", value, &["line 4", "pos x is", &shown, "finite number"]);
        assert_change_refused::<2>(DATA, "2.1", value, &["line 12", "x is", &shown, "finite number"]);
        assert_change_refused::<2>(DUMP, "2.1", value, &["line 11", "x is", &shown, "finite number"]);
    }
    let huge = "9".repeat(5000) + "x";
    assert_change_refused::<2>(XYZ, "2.1", &huge, &["line 4", "pos x is `99999", "…`"]);
}

#[test]
fn rows_with_too_many_or_too_few_values() {
    assert_change_refused::<2>(XYZ, "0.7 2\n", "0.7 2 9\n", &["line 4", "7 values, expected 6"]);
    assert_change_refused::<2>(XYZ, "0.7 2\n", "0.7\n", &["line 4", "5 values, expected 6"]);
    assert_change_refused::<2>(DATA, "2.1 2.0 0.0", "2.1 2.0", &["line 12", "6 values, expected 7"]);
    assert_change_refused::<2>(
        DATA,
        "2.1 2.0 0.0",
        "2.1 2.0 0.0 0 0 0",
        &["line 12", "10 values", "the same in every"],
    );
    assert_change_refused::<2>(DUMP, "0.0 0.7", "0.7", &["line 11", "4 values, expected 5"]);
}

#[test]
fn ids_that_repeat_or_are_no_numbers() {
    assert_change_refused::<2>(XYZ, "0.7 2\n", "0.7 1\n", &["line 4", "id `1`", "already in line 3"]);
    assert_change_refused::<2>(XYZ, "0.7 2\n", "0.7 -2\n", &["line 4", "id is `-2`", "whole number"]);
    assert_change_refused::<2>(DATA, "2 2 1.4", "1 2 1.4", &["line 12", "id `1`", "already in line 11"]);
    assert_change_refused::<2>(DUMP, "2 2.1", "1 2.1", &["line 11", "id `1`", "already in line 10"]);
    assert_change_refused::<2>(DUMP, "2 2.1", "2.5 2.1", &["line 11", "id is `2.5`"]);
    assert_change_refused::<2>(DUMP, "ATOMS id", "ATOMS mol", &["line 9", "column id is missing"]);
}

#[test]
fn boxes_that_are_missing_flat_or_empty() {
    assert_change_refused::<2>(XYZ, "Lattice=\"9 0 0 0 8 0 0 0 1\"", "", &["line 2", "Lattice is missing", "pbc"]);
    assert_change_refused::<2>(
        XYZ,
        "Lattice=\"9 0 0 0 8 0 0 0 1\" pbc=\"T T F\"",
        "",
        &["line 2", "Lattice (or pbc=\"F F F\" for the open plane) is missing", "Properties"],
    );
    assert_change_refused::<2>(XYZ, "9 0 0 0 8 0", "9 0 0 0 8 1", &["line 2", "out of the plane", "edge 2 along z"]);
    assert_change_refused::<2>(XYZ, "9 0 0", "0 0 0", &["line 2", "Lattice is", "span a box"]);
    assert_change_refused::<2>(XYZ, "9 0 0 0 8", "9 3 0 18 6", &["line 2", "Lattice is", "span a box"]);
    assert_change_refused::<2>(XYZ, "9 0 0 0 8", "9 0 0 1e8 8", &["line 2", "tilt of edge 2", "100000000"]);
    assert_change_refused::<2>(XYZ, "9 0 0", "9 0", &["line 2", "Lattice is `9 0 0 8 0 0 0 1`", "nine numbers"]);
    assert_change_refused::<2>(DATA, "0.0 9.0 xlo xhi\n", "", &["xlo xhi is missing"]);
    assert_change_refused::<2>(DATA, "0.0 9.0", "9.0 0.0", &["line 5", "xlo xhi is `9.0 0.0`"]);
    let tilts = "-0.5 0.5 zlo zhi\n0.1 0.2 0 xy xz yz";
    assert_change_refused::<2>(
        DATA,
        "-0.5 0.5 zlo zhi",
        tilts,
        &["line 8", "out of the plane", "edge 3 along x", "`0.2`"],
    );
    let tilts = "-0.5 0.5 zlo zhi\n0.1 no 0 xy xz yz";
    assert_change_refused::<2>(DATA, "-0.5 0.5 zlo zhi", tilts, &["line 8", "xy xz yz is `no`", "finite number"]);
    for tilts in ["1.2 0 0 xy xz", "1.2 0 0 XY XZ YZ", "1.2 0 0 0 xy xz yz"] {
        let changed = format!("-0.5 0.5 zlo zhi\n{tilts}");
        assert_change_refused::<2>(DATA, "-0.5 0.5 zlo zhi", &changed, &["line 8", "xy xz yz is", "three numbers"]);
    }
    for tilts in ["nan 0 0 xy xz yz", "inf 0 0 xy xz yz", "abc 0 0 xy xz yz"] {
        let changed = format!("-0.5 0.5 zlo zhi\n{tilts}");
        assert_change_refused::<2>(DATA, "-0.5 0.5 zlo zhi", &changed, &["line 8", "header line is", "finite numbers"]);
    }
    assert_change_refused::<2>(DATA, "0.0 9.0 xlo xhi", "9 0 0 avec", &["header lines avec, bvec and cvec is missing"]);
    assert_change_refused::<2>(DUMP, "0.0 9.0", "0.0 -9.0", &["line 6", "xlo xhi is `0.0 -9.0`"]);
    let vectors = DUMP.replace("BOUNDS", "BOUNDS abc origin").replace("0.0 9.0", "9 0 0.5 0");
    let vectors = vectors.replace("0.0 8.0", "0 8 0 0").replace("-0.5 0.5", "0 0 1 -0.5");
    assert_refused::<2>(vectors, &["line 6", "out of the plane", "edge 1 along z", "`0.5`"]);
    assert_change_refused::<2>(DUMP, "BOUNDS", "BOUNDS abc origin", &["line 6", "2 values, expected 4"]);
    let tilted = DUMP.replace("BOUNDS", "BOUNDS xy xz yz").replace("9.0", "9.0 0.1").replace("8.0", "8.0 0.2");
    assert_refused::<2>(tilted.replace("-0.5 0.5", "-0.5 0.5 0"), &["line 6", "out of the plane", "edge 3 along x"]);
    assert_refused::<2>(tilted, &["line 8", "2 values, expected 3"]);
}

#[test]
fn directions_that_are_not_periodic() {
    assert_change_refused::<2>(XYZ, "T T F", "T F F", &["line 2", "pbc is `T F F`", "axis y is not periodic"]);
    assert_change_refused::<3>(XYZ, "T T F", "T T F", &["line 2", "pbc is `T T F`", "axis z is not periodic"]);
    assert_change_refused::<2>(XYZ, "T T F", "T", &["line 2", "pbc is `T`", "three of T and F"]);
    assert_change_refused::<2>(XYZ, "T T F", "T maybe F", &["line 2", "pbc is `T maybe F`"]);
    assert_change_refused::<2>(DUMP, "pp pp pp", "ff pp pp", &["line 5", "BOX BOUNDS is `ff`", "axis x"]);
    assert_change_refused::<3>(DUMP, "pp pp pp", "pp pp fs", &["line 5", "BOX BOUNDS is `fs`", "axis z"]);
    assert_change_refused::<2>(DUMP, " pp pp pp", " pp", &["line 5", "three boundary flags", "is missing"]);
}

#[test]
fn packings_of_another_dimension() {
    assert_change_refused::<2>(XYZ, "2.1 2.0 0", "2.1 2.0 0.3", &["line 4", "pos z is `0.3`", "2 dimensions"]);
    assert_change_refused::<2>(DATA, "2.1 2.0 0.0", "2.1 2.0 0.3", &["line 12", "z is `0.3`", "2 dimensions"]);
    assert_change_refused::<2>(DUMP, "2.1 2.0 0.0", "2.1 2.0 0.3", &["line 11", "z is `0.3`", "2 dimensions"]);
    assert_change_refused::<3>(XYZ, "pbc", "dimension=2 pbc", &["line 2", "dimension is `2`", "3 dimensions"]);
    assert_change_refused::<3>(
        XYZ,
        "T T F\" Properties=species:S:1:pos:R:3",
        "T T T\" Properties=s:S:2:pos:R:2",
        &["line 2", "column pos is `pos:R:2`", "pos:R:3"],
    );
    assert_change_refused::<3>(DUMP, "x y z", "x y vz", &["line 9", "column z is missing"]);
}

#[test]
fn columns_and_keys_that_make_no_sense() {
    assert_change_refused::<2>(XYZ, "id:I:1", "id:I", &["line 2", "Properties is `id:I`"]);
    assert_change_refused::<2>(XYZ, "id:I:1", "id:I:0", &["line 2", "Properties is `id:I:0`"]);
    assert_change_refused::<2>(XYZ, "id:I:1", "id:Q:1", &["line 2", "Properties is `id:Q:1`"]);
    assert_change_refused::<2>(XYZ, "id:I:1", "id:S:1", &["line 2", "column id is `id:S:1`", "id:I:1"]);
    assert_change_refused::<2>(XYZ, "id:I:1", "radius:R:1", &["line 2", "column `radius`", "already in line 2"]);
    assert_change_refused::<2>(XYZ, "id:I:1", "held:I:1", &["line 4", "held is `2`"]);
    assert_change_refused::<2>(XYZ, "Properties", "Columns", &["line 2", "Properties is missing", "Columns"]);
    assert_change_refused::<2>(XYZ, "pbc=", "PBC=\"F F F\" pbc=", &["line 2", "key `pbc`", "already in line 2"]);
    assert_change_refused::<2>(XYZ, "T T F\"", "T T F", &["line 2", "pbc is `\"T T F", "closed"]);
    assert_change_refused::<2>(DUMP, "x y z", "x x z", &["line 9", "column `x`", "already in line 9"]);
    assert_change_refused::<2>(DUMP, "x y z", "ix iy z", &["line 9", "columns x and y", "is missing", "ix iy"]);
    assert_change_refused::<2>(DUMP, "ITEM: BOX BOUNDS pp pp pp", "ITEM: BOX", &["line 9", "BOX BOUNDS is missing"]);
    assert_change_refused::<2>(DUMP, "TIMESTEP", "STEP", &["line 1", "ITEM: TIMESTEP is missing", "ITEM: STEP"]);
    assert_refused::<2>("2\nargon\nAr 0 0 0\nAr 1 0 0\n", &["line 2", "Properties is missing", "argon"]);
}

#[test]
fn atom_styles_without_diameters() {
    for style in ["full", "atomic", "bpm/sphere", "hybrid sphere"] {
        let shown = format!("atom style is `{style}`");
        assert_change_refused::<2>(DATA, "# sphere", &format!("# {style}"), &["line 9", &shown, "sphere"]);
    }
    // Without a name the columns could be those of style full: id, molecule, type, charge, x, y, z.
    assert_change_refused::<2>(DATA, " # sphere", "", &["line 9", "names no style", "`Atoms # sphere`"]);
    assert_change_refused::<2>(DATA, "2 2 1.4", "2 3 1.4", &["line 12", "type is `3`"]);
}
