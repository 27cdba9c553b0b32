//! What a file says twice, or says of itself and cannot be, is refused with the line, the field and the value.

use jamscope::io::{read_packing, write_packing};
use jamscope::packing::{Domain, Packing};

use super::refusals::{DATA, DUMP, XYZ, assert_change_refused, assert_refused};
use super::{Scratch, fixture};

/// The message about a file of the repository.
fn refusal(name: &str) -> String {
    read_packing::<2>(fixture("refused").join(name)).expect_err("a file that is refused").to_string()
}

#[test]
fn a_correction_is_below_the_spacing_of_its_coordinate() {
    // A byte of the file lost: 1.13 for 1.13e-16. Numbers near 2.63 are 2⁻⁵¹ apart.
    let said = refusal("correction_too_large.xyz");
    let spacing = "below 4.440892098500626e-16, the spacing";
    for part in ["xyz, line 6", "correction x is `1.1303315867929736`", spacing, "coordinate 2.6305249225699034"] {
        assert!(said.contains(part), "no {part:?} in {said}");
    }
    let low = |high: &str, low: &str| {
        format!("1\npbc=\"F F F\" Properties=pos:R:2:radius:R:1:correction:R:2\n{high} 1.0 0.5 {low} 0\n")
    };
    // From 1 to the next number it is 2⁻⁵²; half of it is what is written at most, and that of 0 has none.
    let scratch = Scratch::new();
    for below in ["1e-16", "-1.11e-16", "2.22e-16"] {
        assert!(scratch.read::<2>(low("1.0", below)).is_ok(), "{below}");
    }
    assert_refused::<2>(low("1.0", "2.221e-16"), &["line 3", "correction x is `2.221e-16`", "2.220446049250313e-16"]);
    assert_refused::<2>(low("1.0", "-0.5"), &["line 3", "correction x is `-0.5`"]);
    assert_refused::<2>(low("0.0", "1e-30"), &["line 3", "correction x is `1e-30`", "coordinate 0.0"]);
    assert_refused::<2>(low("1.7e308", "1.7e308"), &["line 3", "correction x is `1.7e308`"]);
    let site = "1\npbc=\"F F F\" Properties=pos:R:2:radius:R:1:site:R:2:site_correction:R:2\n1 1 0.5 1 1 0 1e-3\n";
    assert_refused::<2>(site, &["line 3", "site_correction y is `1e-3`", "spacing"]);
}

#[test]
fn every_correction_that_is_written_is_read_again() {
    // The largest there is: half of the spacing, just above a power of two, where numbers below are nearer.
    let scratch = Scratch::new();
    for high in [1.0f64, 2.0, 64.0, -4096.0, 1.0f64.next_down(), 3e5] {
        for low in [0.5, -0.5, 0.49, -0.25] {
            let spacing = high.abs().next_up() - high.abs();
            let packing = Packing::<2>::new(Domain::Open, vec![[high, 0.0]], vec![0.5])
                .and_then(|packing| packing.with_corrections(vec![[low * spacing, 0.0]]))
                .expect("valid");
            write_packing(scratch.path(), &packing, &[], &[]).expect("writable");
            assert_eq!(read_packing::<2>(scratch.path()).expect("readable"), packing, "{high} {low}");
        }
    }
}

#[test]
fn positions_a_million_boxes_away_are_refused() {
    // The largest radius is 0.7: a coordinate of 7·10⁵ is the last. A box of two radii or more is nearer than a million boxes.
    let parts =
        |line: &'static str, x: &'static str| [line, "coordinate x is", x, "700000.0", "a million times", "lost"];
    assert_change_refused::<2>(XYZ, "2.1", "9000002.1", &parts("line 4", "9000002.1"));
    assert_change_refused::<2>(DATA, "2.1", "9000002.1", &parts("line 12", "9000002.1"));
    assert_change_refused::<2>(DUMP, "2.1", "-8999997.9", &parts("line 11", "-8999997.9"));
    let scaled = DUMP.replace("x y z", "xs ys z").replace("1.0 2.0", "0.1 0.25").replace("2.1 2.0", "1000000.1 0.25");
    assert_refused::<2>(scaled, &parts("line 11", "9000000.9"));
    assert_change_refused::<3>(DATA, "2.0 0.0\n", "2.0 1e300\n", &["line 11", "coordinate z is 1e300"]);
    let open = "1\npbc=\"F F F\" Properties=pos:R:2:radius:R:1\n1 1e7 0.5\n";
    assert_refused::<2>(open, &["line 3", "coordinate y is 10000000.0", "500000.0", "the largest radius"]);
    let site = "1\npbc=\"F F F\" Properties=pos:R:2:radius:R:1:site:R:2\n1 1 0.5 1 -1e7\n";
    assert_refused::<2>(site, &["line 3", "site y is -10000000.0", "500000.0"]);
    // A few thousand boxes are what a long run leaves of unwrapped coordinates.
    let scratch = Scratch::new();
    assert!(scratch.read::<2>(XYZ.replace("2.1", "27002.1")).is_ok());
    assert!(scratch.read::<2>(XYZ.replace("2.1", "700000.0")).is_ok());
}

#[test]
fn boxes_a_million_sides_away_are_refused() {
    let far = |line: &'static str, field: &'static str| [line, field, "a million times the side of the box"];
    assert_change_refused::<2>(XYZ, "pbc", "Origin=\"0 -1e8 0\" pbc", &far("line 2", "Origin y is -100000000.0"));
    assert_change_refused::<2>(DATA, "0.0 9.0", "1e8 100000009", &far("line 5", "xlo xhi is 100000000.0"));
    assert_change_refused::<2>(DUMP, "0.0 9.0", "1e8 100000009", &far("line 6", "xlo xhi is 100000000.0"));
}

#[test]
fn header_lines_and_sections_that_stand_twice_are_refused() {
    let said = refusal("side_twice.data");
    for part in ["side_twice.data, line 7", "header line `xlo xhi`", "already in line 6"] {
        assert!(said.contains(part), "no {part:?} in {said}");
    }
    for line in ["2 atoms", "2 atom types", "0.0 9.0 xlo xhi", "0.0 8.0 ylo yhi", "-0.5 0.5 zlo zhi"] {
        // In other numbers too: it is the second that LAMMPS would take.
        let keyword = line.trim_start_matches(|c: char| !c.is_ascii_alphabetic());
        for second in [line.to_owned(), line.replacen(|c: char| c.is_ascii_digit(), "7", 1)] {
            let shown = format!("header line `{keyword}`");
            assert_change_refused::<2>(DATA, line, &format!("{line}\n{second}"), &["is already in line", &shown]);
        }
    }
    let tilts = "-0.5 0.5 zlo zhi\n0 0 0 xy xz yz\n0 0 0 xy xz yz";
    assert_change_refused::<2>(DATA, "-0.5 0.5 zlo zhi", tilts, &["line 9", "`xy xz yz`", "already in line 8"]);
    let bonds = "2 atoms\n0 bonds\n3 bonds";
    assert_change_refused::<2>(DATA, "2 atoms", bonds, &["line 5", "`bonds`", "already in line 4"]);
    let twice = format!("{DATA}\nVelocities\n\n1 0 0 0 0 0 0\n\nVelocities # again\n\n1 0 0 0 0 0 0\n");
    assert_refused::<2>(twice, &["line 18", "section `Velocities`", "already in line 14"]);
    let twice = format!("{DATA}\nAtoms # sphere\n\n1 1 1.0 1.0 1.0 2.0 0.0\n");
    assert_refused::<2>(twice, &["line 14", "section `Atoms`", "already in line 9"]);
    // Sections of names of several words are not one another.
    let scratch = Scratch::new();
    let coefficients = format!("{DATA}\nPair Coeffs # zero\n\n1\n\nPairIJ Coeffs # zero\n\n1 1\n");
    assert!(scratch.read::<2>(coefficients).is_ok());
}

#[test]
fn items_of_a_frame_that_stand_twice_or_have_a_value_too_many_are_refused() {
    let sides = "ITEM: BOX BOUNDS pp pp pp\n0.0 9.0\n0.0 8.0\n-0.5 0.5\n";
    let other = sides.replace("9.0", "99.0");
    assert_change_refused::<2>(DUMP, sides, &format!("{sides}{other}"), &["line 9", "`BOX BOUNDS`", "in line 5"]);
    let count = "ITEM: NUMBER OF ATOMS\n2\n";
    assert_change_refused::<2>(DUMP, count, &count.repeat(2), &["line 5", "`NUMBER OF ATOMS`", "in line 3"]);
    let time = "ITEM: TIME\n0\n";
    assert_change_refused::<2>(DUMP, count, &format!("{time}{time}{count}"), &["line 5", "`TIME`", "in line 3"]);
    let atoms = &DUMP[DUMP.find("ITEM: ATOMS").expect("an item")..];
    assert_refused::<2>(format!("{DUMP}{atoms}"), &["line 12", "item `ATOMS`", "already in line 9"]);
    assert_change_refused::<2>(DUMP, "-0.5 0.5\n", "-0.5 0.5\n0.0 99.0\n", &["line 9", "BOX BOUNDS", "`0.0 99.0`"]);
    assert_change_refused::<2>(DUMP, "ATOMS\n2\n", "ATOMS\n2\n3\n", &["line 5", "NUMBER OF ATOMS", "`3`", "further"]);
}

#[test]
fn keys_that_are_malformed_or_stand_twice_are_refused() {
    for value in ["abc", "", "-2", "2.0", "two"] {
        let shown = format!("dimension is `{value}`");
        let said = if value.is_empty() { "dimension=\"\" pbc".into() } else { format!("dimension={value} pbc") };
        assert_change_refused::<2>(XYZ, "pbc", &said, &["line 2", &shown, "2 or 3"]);
    }
    assert_change_refused::<2>(XYZ, "pbc", "dimension pbc", &["line 2", "dimension is `T`", "2 or 3"]);
    assert_change_refused::<2>(XYZ, "pbc", "dimension=3 pbc", &["line 2", "dimension is `3`", "2 dimensions"]);
    assert_change_refused::<2>(XYZ, "pbc", "Origin=here pbc", &["line 2", "Origin is `here`", "three numbers"]);
    assert_change_refused::<2>(XYZ, "pbc", "Origin=\"0 nan 0\" pbc", &["line 2", "Origin is `nan`", "finite"]);
    for again in ["Lattice=\"8 0 0 0 8 0 0 0 1\"", "PBC=\"F F F\"", "properties=pos:R:3", "pbc"] {
        let key = again.split('=').next().expect("a key");
        let shown = format!("key `{key}`");
        assert_change_refused::<2>(XYZ, "id:I:1\n", &format!("id:I:1 {again}\n"), &["line 2", &shown, "is already"]);
    }
    for key in ["dimension=2", "Origin=\"0 0 0\""] {
        let name = format!("key `{}`", key.split('=').next().expect("a key"));
        assert_change_refused::<2>(XYZ, "pbc", &format!("{key} {key} pbc"), &["line 2", &name, "is already"]);
    }
}

#[test]
fn radii_beyond_those_of_disks_and_files_of_no_disk_have_their_line() {
    for radius in ["1e-131", "1e151"] {
        let shown = format!("radius is `{radius}`");
        assert_change_refused::<2>(XYZ, "0.7", radius, &["line 4", &shown, "from 1e-130 to 1e150"]);
        assert_change_refused::<2>(DUMP, "0.7", radius, &["line 11", &shown, "from 1e-130 to 1e150"]);
        assert_change_refused::<2>(DATA, "1.4", radius, &["line 12", "diameter is", "from 1e-130 to 1e150"]);
    }
    assert_refused::<2>("0\npbc=\"F F F\" Properties=pos:R:3:radius:R:1\n", &["line 1", "at least one disk"]);
    assert_change_refused::<2>(DATA, "2 atoms", "0 atoms", &["line 3", "at least one disk"]);
    assert_change_refused::<2>(DUMP, "ATOMS\n2\n", "ATOMS\n0\n", &["line 4", "at least one disk"]);
}
