//! Tilted boxes of LAMMPS (`fixtures/formats/tilted*`), with its energy, stress and forces, and of extended XYZ.

use jamscope::io::{Frame, ReadWarning, read_contents, read_packing, write_lammps_data, write_packing};
use jamscope::law::Hookean;
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Packing};
use jamscope::vector::{difference, larger, norm};

use super::{Scratch, fixture};

const LAW: Hookean = Hookean { stiffness: 2e5 };

fn read<const D: usize>(name: &str) -> Packing<D> {
    read_packing(fixture("formats").join(name)).expect("a file of LAMMPS is read")
}

/// The numbers of a file after its comment lines.
fn numbers(name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(fixture("formats").join(name)).expect("text");
    let rows = text.lines().filter(|line| !line.starts_with('#')).flat_map(str::split_ascii_whitespace);
    rows.map(|word| word.parse().expect("a number")).collect()
}

/// Coordinates up to 15 are rounded to 1.8·10⁻¹⁵ in LAMMPS; overlaps are 0.1 on average, so 2·10⁻¹⁴ in each force, and
/// errors of many contacts are of either sign.
const TOLERANCE: f64 = 1e-13;

fn check_mechanics<const D: usize>(packing: &Packing<D>, name: &str, turned: bool) {
    let network = ContactNetwork::new(packing, &LAW).expect("apart");
    let stress = network.stress(packing.domain().volume().expect("a box"));
    let expected = numbers(&format!("{name}.txt"));
    let pressure = expected[1];
    assert!((network.energy() / expected[0] - 1.0).abs() < TOLERANCE, "{} {}", network.energy(), expected[0]);
    for (place, (a, b)) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
        if a < D && b < D && !turned {
            let off = (stress[a][b] - expected[1 + place]).abs() / pressure;
            assert!(off < TOLERANCE, "{name} {a}{b}: {} and {}, {off:e}", stress[a][b], expected[1 + place]);
        }
    }
    let text = std::fs::read_to_string(fixture("formats").join(format!("{name}.dump"))).expect("text");
    let rows = text.lines().skip_while(|line| !line.starts_with("ITEM: ATOMS")).skip(1);
    let largest = network.forces().iter().map(|&force| norm(force)).fold(0.0, larger);
    for (row, force) in rows.zip(network.forces()) {
        let values: Vec<f64> = row.split_ascii_whitespace().map(|word| word.parse().expect("a number")).collect();
        let off = norm(difference(*force, std::array::from_fn(|d| values[5 + d])));
        assert!(off < 10.0 * TOLERANCE * largest, "{name}: {off:e} of {largest}");
    }
}

#[test]
fn energy_stress_and_forces_of_lammps_in_a_tilted_box() {
    check_mechanics(&read::<2>("tilted.dump"), "tilted", false);
    check_mechanics(&read::<2>("tilted_scaled.dump"), "tilted", false);
    check_mechanics(&read::<2>("tilted.data"), "tilted", false);
    check_mechanics(&read::<2>("tilted_general.dump"), "tilted", false);
    check_mechanics(&read::<2>("tilted_turned.dump"), "tilted_turned", false);
    check_mechanics(&read::<3>("tilted_balls.dump"), "tilted_balls", false);
    check_mechanics(&read::<3>("tilted_balls_scaled.dump"), "tilted_balls", false);
    check_mechanics(&read::<3>("tilted_balls.data"), "tilted_balls", false);
}

#[test]
fn edges_of_a_dump_are_those_of_the_data_file() {
    // The ends in the dump are those of the rectangle around the box.
    assert_eq!(read::<2>("tilted.dump").domain(), read::<2>("tilted.data").domain());
    let domain = Domain::Periodic { corner: [-1.0, 0.5], edges: [[11.0, 0.0], [4.3, 10.0]] };
    assert_eq!(read::<2>("tilted.dump").domain(), &domain);
    let balls = Domain::Periodic { corner: [0.0; 3], edges: [[6.0, 0.0, 0.0], [2.0, 5.5, 0.0], [-1.5, 1.2, 5.0]] };
    assert_eq!(read::<3>("tilted_balls.data").domain(), &balls);
    assert_eq!(read::<3>("tilted_balls.dump").domain(), &balls);
}

#[test]
fn a_box_whose_first_edge_is_not_along_x_is_turned_with_a_warning() {
    let plain = read::<2>("tilted_turned.dump");
    for (name, line) in [("tilted_turned_general.dump", 5), ("tilted_turned_general.data", 6)] {
        let contents = read_contents::<2>(fixture("formats").join(name), Frame::Last).expect("read");
        assert_eq!(contents.warnings, [ReadWarning::Turned { line }]);
        // LAMMPS turns about the corner of the box, jamscope about the origin: the packings differ by a shift.
        let shift = difference(contents.packing.positions()[0], plain.positions()[0]);
        for disk in 0..plain.len() {
            let (found, expected) = (contents.packing.positions()[disk], plain.positions()[disk]);
            let moved = [expected[0] + shift[0], expected[1] + shift[1]];
            let apart = plain.domain().separation((found, [0.0; 2]), (moved, [0.0; 2]));
            // Turned twice with coordinates up to 12.
            assert!(norm(apart) < 1e-14 * 12.0, "disk {disk}: {apart:?}");
        }
        check_mechanics(&contents.packing, "tilted_turned", true);
        let stress = ContactNetwork::new(&contents.packing, &LAW)
            .expect("apart")
            .stress(contents.packing.domain().volume().expect("a box"));
        let expected = numbers("tilted_turned.txt");
        assert!((stress[0][1] - expected[4]).abs() < TOLERANCE * expected[1]);
    }
}

#[test]
fn tilted_boxes_are_written_and_read_again() {
    let scratch = Scratch::new();
    let (flat, balls) = (read::<2>("tilted.dump"), read::<3>("tilted_balls.dump"));
    write_packing(scratch.path(), &flat, &[], &[]).expect("written");
    assert_eq!(read_packing::<2>(scratch.path()).expect("read"), flat);
    write_packing(scratch.path(), &balls, &[], &[]).expect("written");
    assert_eq!(read_packing::<3>(scratch.path()).expect("read"), balls);
    write_lammps_data(scratch.path(), &balls).expect("written");
    assert_eq!(read_packing::<3>(scratch.path()).expect("read"), balls);
    // A tilt beyond half a side is written as the tilt of the same lattice that is below it.
    let edges = [[6.0, 0.0, 0.0], [8.0, 5.5, 0.0], [-1.5 + 2.0, 1.2 + 5.5, 5.0]];
    let leaning =
        Packing::new(Domain::Periodic { corner: [0.0; 3], edges }, balls.positions().to_vec(), balls.radii().to_vec())
            .expect("valid");
    write_lammps_data(scratch.path(), &leaning).expect("written");
    let Domain::Periodic { edges, .. } = *read_packing::<3>(scratch.path()).expect("read").domain() else {
        panic!("a box")
    };
    for (edge, expected) in edges.iter().zip([[6.0, 0.0, 0.0], [2.0, 5.5, 0.0], [-1.5, 1.2, 5.0]]) {
        assert!(norm(difference(*edge, expected)) < 1e-14, "{edge:?}");
    }
}

#[test]
fn lattices_of_extended_xyz_in_any_order_and_direction() {
    let scratch = Scratch::new();
    let content = |lattice: &str, first: &str, second: &str| {
        format!(
            "2\nLattice=\"{lattice}\" pbc=\"T T F\" Properties=species:S:1:pos:R:3:radius:R:1\nX {first} 0 0.5\nX {second} 0 0.7\n"
        )
    };
    let edges = |text: String| match *scratch.read::<2>(text).expect("read").domain() {
        Domain::Periodic { edges, .. } => edges,
        Domain::Open => panic!("a box"),
    };
    let points = ("1 2", "2 2.5");
    assert_eq!(edges(content("9 0 0 -2 8 0 0 0 1", points.0, points.1)), [[9.0, 0.0], [-2.0, 8.0]]);
    assert_eq!(edges(content("0 8 0 9 0 0 0 0 1", points.0, points.1)), [[9.0, 0.0], [0.0, 8.0]]);
    assert_eq!(edges(content("-9 0 0 2 -8 0 0 0 1", points.0, points.1)), [[9.0, 0.0], [-2.0, 8.0]]);
    // A poor basis of the square lattice of side 9.
    let short = edges(content("18 9 0 9 9 0 0 0 1", points.0, points.1));
    assert_eq!(short, [[9.0, 0.0], [0.0, 9.0]]);
    // Turned by the angle of 3 : 4 : 5, edges 10 and (−1, 5).
    let turned = scratch.read::<2>(content("8 6 0 -3.8 3.4 0 0 0 1", "1 2", "2 2.5")).expect("read");
    let Domain::Periodic { edges: [a, b], .. } = *turned.domain() else { panic!("a box") };
    assert!(norm(difference(a, [10.0, 0.0])) < 1e-14 && norm(difference(b, [-1.0, 5.0])) < 1e-14, "{a:?} {b:?}");
    let apart = difference(turned.positions()[1], turned.positions()[0]);
    assert!(norm(difference(apart, [0.8 + 0.3, -0.6 + 0.4])) < 1e-14, "{apart:?}");
}

#[test]
fn tilted_boxes_in_numpy_archives() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("packing.npz");
    for dimension in [2, 3] {
        if dimension == 2 {
            let packing = read::<2>("tilted.dump");
            jamscope::io::write_npz(&path, &packing, &[], &[]).expect("written");
            assert_eq!(read_packing::<2>(&path).expect("read"), packing);
        } else {
            let packing = read::<3>("tilted_balls.dump");
            jamscope::io::write_npz(&path, &packing, &[], &[]).expect("written");
            assert_eq!(read_packing::<3>(&path).expect("read"), packing);
        }
    }
}
