//! Commands on one packing file: `relax`, `compress`, frames of a trajectory, the standard input.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use jamscope::io::{Frame, read_contents, read_packing, write_packing};
use jamscope::law::Hertzian;
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::preparation::Target;
use jamscope::vector::larger;
use jamscope::{Inflation, Preparation, inflate, prepare};
use serde_json::Value;

pub fn fixture(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name).to_string_lossy().into_owned()
}

/// The program with these arguments in a folder, and this text on its standard input.
pub fn jamscope(folder: &Path, arguments: &[&str], input: &[u8]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_jamscope"));
    program.args(arguments).current_dir(folder).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = program.spawn().expect("the program starts");
    // A program that refuses its arguments does not read.
    let _ = child.stdin.take().expect("a pipe").write_all(input);
    child.wait_with_output().expect("the program ends")
}

pub fn done(folder: &Path, arguments: &[&str], input: &[u8]) -> String {
    let output = jamscope(folder, arguments, input);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments:?}: {message}");
    String::from_utf8(output.stdout).expect("Unicode")
}

pub fn refused(folder: &Path, arguments: &[&str], parts: &[&str]) {
    let output = jamscope(folder, arguments, b"");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
    for part in parts {
        assert!(message.contains(part), "no `{part}` in: {message}");
    }
}

/// The columns of a file written by the program, by name.
fn column(path: &Path, name: &str) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).expect("a file");
    let comment = text.lines().nth(1).expect("a comment line");
    let layout = comment.split("Properties=").nth(1).and_then(|rest| rest.split(' ').next()).expect("columns");
    let parts: Vec<&str> = layout.split(':').collect();
    let mut start = 0;
    for part in parts.chunks(3) {
        let width: usize = part[2].parse().expect("a width");
        if part[0] == name {
            let rows = text.lines().skip(2).map(|line| line.split_whitespace().skip(start).take(width));
            return rows.map(|row| row.map(|word| word.parse().expect("a number")).collect()).collect();
        }
        start += width;
    }
    panic!("no column {name} in {layout}");
}

#[test]
fn a_relaxed_file_is_at_rest_and_holds_the_results_of_each_disk() {
    let folder = tempfile::tempdir().expect("a folder");
    // A packing with one disk moved by a hundredth of a diameter.
    let packing = read_packing::<2>(fixture("packings/hertz_N1000_p100.xyz")).expect("a fixture");
    let pressure_before = {
        let network = ContactNetwork::new(&packing, &Hertzian::default()).expect("no coincidence");
        network.pressure(packing.domain().volume().expect("a box"))
    };
    let mut positions = packing.positions().to_vec();
    positions[17][0] += 0.01;
    let packing = Packing::new(*packing.domain(), positions, packing.radii().to_vec()).expect("valid");
    let start = folder.path().join("moved.xyz");
    write_packing(&start, &packing, &[], &[("law", "hertzian"), ("author", "me")]).expect("written");
    for relaxer in ["fire", "quasi_newton", "conjugate_gradients"] {
        let printed = done(folder.path(), &["relax", "moved.xyz", "--relaxer", relaxer, "--limit", "1e-9"], b"");
        assert!(printed.contains("moved.relaxed.xyz") && printed.contains("Converged"), "{printed}");
        refused(folder.path(), &["relax", "moved.xyz"], &["moved.relaxed.xyz: exists", "--out"]);
        let path = folder.path().join(format!("{relaxer}.xyz"));
        std::fs::rename(folder.path().join("moved.relaxed.xyz"), &path).expect("renamed");
        let contents = read_contents::<2>(&path, Frame::Last).expect("readable");
        let value = |key: &str| {
            let found = contents.properties.iter().find(|(other, _)| other == key).map(|(_, value)| value.clone());
            found.unwrap_or_else(|| panic!("no key {key}"))
        };
        assert_eq!((value("author"), value("law")), ("me".into(), "hertzian".into()));
        let network = ContactNetwork::new(&contents.packing, &Hertzian::default()).expect("no coincidence");
        let volume = contents.packing.domain().volume().expect("a box");
        // The disk returns to the minimum it came from: pressures agree to the residuals, 10⁻⁸ and 10⁻⁹.
        let pressure: f64 = value("pressure").parse().expect("a number");
        assert_eq!(pressure, network.pressure(volume));
        assert!((pressure / pressure_before - 1.0).abs() < 1e-7, "{relaxer}: {pressure} and {pressure_before}");
        // The results of the disks add up to those of the packing.
        let contacts: f64 = column(&path, "contacts").into_iter().flatten().sum();
        assert_eq!(contacts, 2.0 * network.contacts.len() as f64);
        let rattlers: f64 = column(&path, "rattler").into_iter().flatten().sum();
        assert_eq!(rattlers, network.rattlers().count() as f64);
        let stress = network.stress(volume);
        let virials = column(&path, "virial");
        for component in 0..4 {
            let sum: f64 = virials.iter().map(|virial| virial[component]).sum::<f64>() / volume;
            let expected = stress[component / 2][component % 2];
            // Two thousand terms, each with a rounding error of 10⁻¹⁶ of the pressure.
            assert!((sum - expected).abs() < 1e-12 * pressure, "{component}: {sum} and {expected}");
        }
        let largest = column(&path, "net_force").iter().map(|force| force[0].hypot(force[1])).fold(0.0, larger);
        assert!((largest / network.largest_net_force() - 1.0).abs() < 1e-15);
    }
}

#[test]
fn a_limit_below_rounding_ends_at_the_rounding_floor() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = fixture("packings/hertz_N1000_p100.xyz");
    let printed = done(folder.path(), &["relax", &path, "--limit", "1e-17", "--out", "floor.xyz"], b"");
    assert!(printed.contains("RoundingFloor"), "{printed}");
    assert!(done(folder.path(), &["inspect", "floor.xyz"], b"").starts_with("disks "));
}

#[test]
fn keys_of_a_state_do_not_outlive_it_and_free_text_is_no_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = std::fs::read_to_string(fixture("packings/hertz_N1000_p100.xyz")).expect("a fixture");
    let keys = "bucklers=4 state=prepared rounding_floor=1e-9 author=me made by hand (version 1.2), größe=3 law=";
    std::fs::write(folder.path().join("a.xyz"), text.replacen("law=", keys, 1)).expect("written");
    done(folder.path(), &["compress", "a.xyz", "--packing-fraction", "0.7"], b"");
    let path = folder.path().join("a.compressed.xyz");
    let properties = read_contents::<2>(&path, Frame::Last).expect("readable").properties;
    let names: Vec<&str> = properties.iter().map(|(key, _)| key.as_str()).collect();
    for stale in ["bucklers", "state", "rounding_floor", "(version", "größe"] {
        assert!(!names.contains(&stale), "{names:?}");
    }
    for kept in ["author", "law", "rattlers"] {
        assert!(names.contains(&kept), "{names:?}");
    }
}

#[test]
fn a_run_takes_the_law_of_its_packing() {
    let folder = tempfile::tempdir().expect("a folder");
    let packing = prepare(&Preparation { disk_count: 200, ..Preparation::default() }).expect("prepared");
    // The same packing under a law that is 200 times as soft: pressures too.
    let properties = [("law", "hertzian"), ("stiffness", "1000.0")];
    write_packing(folder.path().join("soft.xyz"), packing.packing.get(), &[], &properties).expect("written");
    done(folder.path(), &["run", "--packing", "soft.xyz", "--out", "report"], b"");
    let text = std::fs::read_to_string(folder.path().join("report/report.json")).expect("a report");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(report["scene"]["law"]["hertzian"]["stiffness"], 1000.0);
    std::fs::write(folder.path().join("scene.toml"), "[law.hookean]\nstiffness = 2.0\n").expect("written");
    let arguments = ["run", "scene.toml", "--packing", "soft.xyz"];
    refused(folder.path(), &arguments, &["soft.xyz", "the file gives law hertzian, but hookean is asked for"]);
}

#[test]
fn a_compressed_file_has_the_pressure_or_the_packing_fraction_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = fixture("packings/hertz_N1000_p100.xyz");
    for pressure in [50.0, 300.0] {
        let asked = pressure.to_string();
        done(folder.path(), &["compress", &path, "--pressure", &asked, "--tolerance", "1e-3", "--out", "p.xyz"], b"");
        let packing = read_packing::<2>(folder.path().join("p.xyz")).expect("readable");
        let network = ContactNetwork::new(&packing, &Hertzian::default()).expect("no coincidence");
        let reached = network.pressure(packing.domain().volume().expect("a box"));
        assert!((reached / pressure - 1.0).abs() <= 1e-3, "{reached}");
        assert!(network.largest_net_force() <= 1e-3 * network.mean_contact_force());
    }
    done(folder.path(), &["compress", &path, "--packing-fraction", "0.9"], b"");
    let packing = read_packing::<2>(folder.path().join("hertz_N1000_p100.compressed.xyz")).expect("readable");
    assert!((packing.packing_fraction().expect("a box") - 0.9).abs() < 1e-14);
}

#[test]
fn what_cannot_be_done_with_a_packing_is_refused_with_its_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = fixture("packings/hertz_N1000_p100.xyz");
    refused(folder.path(), &["relax", &path, "--relaxer", "magic"], &["--relaxer magic", "fire", "damped"]);
    for limit in ["-1", "0", "0.1", "nan"] {
        refused(folder.path(), &["relax", &path, "--limit", limit], &["--limit is", "above 0 and at most 0.001"]);
    }
    refused(folder.path(), &["relax", &path, "--relaxer", "fire = {} #"], &["--relaxer is `fire = {} #`"]);
    refused(folder.path(), &["relax", &path, "--out", "no/folder.xyz"], &["no/folder.xyz"]);
    refused(folder.path(), &["relax", &path, "--out", "/dev/no_such_device"], &["/dev/no_such_device", "a device"]);
    refused(folder.path(), &["relax", &path, "--out", &path], &["is the input"]);
    refused(folder.path(), &["inspect", &path, "--write", &path], &["is the input"]);
    refused(folder.path(), &["analyse", &path], &["one file", "--frames"]);
    refused(folder.path(), &["analyse", "-", "-"], &["given twice"]);
    refused(folder.path(), &["relax", &path, "--frame", "3"], &["no frame 3", "1 frames"]);
    refused(folder.path(), &["compress", &path, "--pressure", "-2"], &["hertz_N1000_p100.xyz", "pressure is -2"]);
    refused(folder.path(), &["compress", &path, "--packing-fraction", "5"], &["packing_fraction is 5"]);
    let open = "1\npbc=\"F F F\" Properties=species:S:1:pos:R:2:radius:R:1\nX 0 0 0.5\n";
    std::fs::write(folder.path().join("open.xyz"), open).expect("written");
    refused(folder.path(), &["compress", "open.xyz", "--pressure", "1"], &["open.xyz", "open plane"]);
    refused(folder.path(), &["relax", "open.xyz"], &["open.xyz", "no disk is held"]);
    let few = "1\nLattice=\"9 0 0 9\" Properties=pos:R:2:radius:R:1\n1 1 0.5\n";
    std::fs::write(folder.path().join("few.xyz"), few).expect("written");
    for target in [["--pressure", "10"], ["--packing-fraction", "0.8"]] {
        let arguments = [&["compress", "few.xyz"][..], &target].concat();
        refused(folder.path(), &arguments, &["few.xyz", "1 disks are too few", "use a larger packing"]);
    }
    let site = open.replace("radius:R:1", "radius:R:1:site:R:2").replace("0 0 0.5", "0 0 0.5 0 0");
    std::fs::write(folder.path().join("site.xyz"), site).expect("written");
    refused(folder.path(), &["relax", "site.xyz"], &["site.xyz", "sites"]);
    let exponent = open.replace("pbc", "exponent=2.2 pbc");
    std::fs::write(folder.path().join("exponent.xyz"), exponent).expect("written");
    refused(folder.path(), &["relax", "exponent.xyz"], &["exponent is `2.2`", "--law power:2.2"]);
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 4, "nothing is written");
}

#[test]
fn the_standard_input_and_compressed_files_are_read_like_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = fixture("packings/hertz_N1000_p100.xyz");
    let text = std::fs::read(&path).expect("a fixture");
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gzip.write_all(&text).expect("in memory");
    let gzip = gzip.finish().expect("in memory");
    let expected = done(folder.path(), &["inspect", &path], b"");
    assert_eq!(done(folder.path(), &["inspect", "-"], &text), expected);
    assert_eq!(done(folder.path(), &["inspect", "-"], &gzip), expected);
    done(folder.path(), &["relax", &path, "--out", "a.xyz"], b"");
    done(folder.path(), &["relax", "-", "--out", "b.xyz"], &text);
    let [a, b] = ["a.xyz", "b.xyz"].map(|name| std::fs::read(folder.path().join(name)).expect("a file"));
    assert!(a == b);
    done(folder.path(), &["inspect", &path, "--write", "c.xyz"], b"");
    let c = folder.path().join("c.xyz");
    assert_eq!(read_packing::<2>(&c).expect("readable"), read_packing::<2>(&path).expect("readable"));
    assert_eq!(column(&c, "virial").len(), 1000);
}

#[test]
fn messages_about_the_standard_input_do_not_name_its_copy() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = fixture("packings/hertz_N1000_p100.xyz");
    let text = std::fs::read_to_string(&path).expect("a fixture").replacen("0.7", "-0.7", 1);
    for arguments in [&["inspect", "-"][..], &["relax", "-"], &["run", "--packing", "-"], &["analyse", "-", &path]] {
        let output = jamscope(folder.path(), arguments, text.as_bytes());
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).expect("Unicode")).concat();
        assert!(said.contains("standard input, line ") && !said.contains("/standard-input"), "{arguments:?}: {said}");
    }
}

/// A packing before and after an inflation, as files and as the two frames of one.
fn trajectory(folder: &Path) -> [PathBuf; 3] {
    let target = Target::Pressure(1000.0);
    let prepared = prepare(&Preparation { disk_count: 300, target, ..Preparation::default() }).expect("prepared");
    let inflated = inflate(&Inflation::default(), prepared.packing.get()).expect("inflated");
    let paths = ["before.xyz", "after.xyz", "both.xyz"].map(|name| folder.join(name));
    write_packing(&paths[0], inflated.before.packing.get(), &[], &[]).expect("written");
    write_packing(&paths[1], inflated.after.packing.get(), &[], &[]).expect("written");
    let both = [&paths[0], &paths[1]].map(|path| std::fs::read_to_string(path).expect("text")).concat();
    std::fs::write(&paths[2], both).expect("written");
    paths
}

#[test]
fn frames_of_one_file_are_analysed_like_two_files() {
    let folder = tempfile::tempdir().expect("a folder");
    trajectory(folder.path());
    done(folder.path(), &["analyse", "before.xyz", "after.xyz", "--out", "two"], b"");
    done(folder.path(), &["analyse", "both.xyz", "--frames", "0,1", "--out", "one"], b"");
    let read = |out: &str, name: &str| {
        let text = std::fs::read_to_string(folder.path().join(out).join(name)).expect("a file");
        serde_json::from_str::<Value>(&text).expect("JSON")
    };
    let [two, one] = ["two", "one"].map(|out| read(out, "analysis.json").to_string());
    // A pair is named after its first file.
    assert_eq!(one.replace("\"name\":\"both\"", "\"name\":\"before\""), two);
    refused(folder.path(), &["analyse", "both.xyz", "--frames", "0,2"], &["no frame 2", "2 frames"]);
    refused(folder.path(), &["analyse", "both.xyz", "--frames", "0"], &["--frames A,B"]);
    refused(folder.path(), &["analyse", "before.xyz", "after.xyz", "--frames", "0,0"], &["--frames A,B"]);
}

#[test]
fn frames_are_inspected_one_by_one() {
    let folder = tempfile::tempdir().expect("a folder");
    trajectory(folder.path());
    let one = |arguments: &[&str]| done(folder.path(), &[&["inspect", "--json"], arguments].concat(), b"");
    let [before, after] = ["before.xyz", "after.xyz"].map(|name| one(&[name]));
    assert_eq!(one(&["both.xyz", "--frame", "0"]), before);
    assert_eq!(one(&["both.xyz"]), after);
    let all: Vec<Value> = serde_json::from_str(&one(&["both.xyz", "--frame", "all"])).expect("JSON");
    let expected = [before, after].map(|text| serde_json::from_str::<Value>(&text).expect("JSON"));
    assert_eq!(all, expected);
    let shown = done(folder.path(), &["inspect", "both.xyz", "--frame", "all"], b"");
    assert!(shown.contains("both.xyz, frame 0") && shown.contains("both.xyz, frame 1"), "{shown}");
}

#[test]
fn the_lengths_of_the_defaults_follow_the_packing() {
    let folder = tempfile::tempdir().expect("a folder");
    let paths = trajectory(folder.path());
    // The same states with all lengths four times as large: each bit of a length stays, but for its exponent.
    for (path, name) in paths.iter().zip(["before4.xyz", "after4.xyz"]) {
        let packing = read_packing::<2>(path).expect("readable");
        let grown = |vectors: &[[f64; 2]]| vectors.iter().map(|it| it.map(|value| 4.0 * value)).collect::<Vec<_>>();
        let radii = packing.radii().iter().map(|radius| 4.0 * radius).collect();
        let scaled = Packing::new(*packing.domain(), grown(packing.positions()), radii)
            .and_then(|it| it.with_corrections(grown(packing.corrections())))
            .and_then(|it| it.with_held(packing.held().to_vec()))
            .and_then(|it| it.with_labels(packing.labels().to_vec()))
            .expect("valid");
        write_packing(folder.path().join(name), &scaled, &[], &[]).expect("written");
    }
    done(folder.path(), &["analyse", "before.xyz", "after.xyz", "--out", "one"], b"");
    done(folder.path(), &["analyse", "before4.xyz", "after4.xyz", "--out", "four"], b"");
    let rows = |out: &str, name: &str| {
        let text = std::fs::read_to_string(folder.path().join(out).join(name)).expect("a file");
        let rows = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        rows.map(|row| row.split(',').map(|word| word.parse().unwrap_or(f64::NAN)).collect()).collect::<Vec<Vec<f64>>>()
    };
    let (one, four) = (rows("one", "before.radial_profile.csv"), rows("four", "before4.radial_profile.csv"));
    assert!(one.len() > 5 && one.len() == four.len(), "{} and {} rings", one.len(), four.len());
    // Radius and mean displacement of the rings.
    assert!(one.iter().zip(&four).all(|(one, four)| 4.0 * one[0] == four[0]));
}

#[test]
fn the_outer_radius_may_be_given_over_the_side_of_the_box() {
    let folder = tempfile::tempdir().expect("a folder");
    let target = Target::Pressure(1000.0);
    let prepared = prepare(&Preparation { disk_count: 300, target, ..Preparation::default() }).expect("prepared");
    let inflation = Inflation { boundary: jamscope::inflation::Boundary::Periodic, ..Inflation::default() };
    let inflated = inflate(&inflation, prepared.packing.get()).expect("inflated");
    for (name, state) in [("before.xyz", &inflated.before), ("after.xyz", &inflated.after)] {
        write_packing(folder.path().join(name), state.packing.get(), &[], &[]).expect("written");
    }
    let side = prepared.packing.get().domain().lengths().expect("a box")[0];
    let length = format!("{:?}", 0.25 * side);
    let table = |radius: &str| {
        let arguments =
            ["analyse", "before.xyz", "after.xyz", "--not-at-rest", "--outer-radius", radius, "--out", "out"];
        done(folder.path(), &arguments, b"")
    };
    assert_eq!(table("0.25L"), table(&length));
    trajectory(folder.path());
    refused(
        folder.path(),
        &["analyse", "both.xyz", "--frames", "0,1", "--outer-radius", "0.4L"],
        &["0.4L", "open plane"],
    );
}

#[test]
fn a_tilted_packing_goes_through_every_command() {
    let folder = tempfile::tempdir().expect("a folder");
    let input = fixture("packings/hertz_N1000_p100.xyz");
    done(folder.path(), &["strain", &input, "--shear", "0.3", "--steps", "1", "--out", "tilted.xyz"], b"");
    let seen: Value =
        serde_json::from_str(&done(folder.path(), &["inspect", "tilted.xyz", "--json"], b"")).expect("JSON");
    let edge = &seen["box_edges"][1];
    assert!((edge[0].as_f64().expect("a number") / edge[1].as_f64().expect("a number") - 0.3).abs() < 1e-15);
    done(folder.path(), &["relax", "tilted.xyz", "--out", "relaxed.xyz"], b"");
    done(folder.path(), &["compress", "tilted.xyz", "--pressure", "300", "--out", "compressed.xyz"], b"");
    let pressure = |name: &str| {
        let seen: Value = serde_json::from_str(&done(folder.path(), &["inspect", name, "--json"], b"")).expect("JSON");
        seen["pressure"].as_f64().expect("a pressure")
    };
    assert!((pressure("compressed.xyz") / 300.0 - 1.0).abs() < 0.01);
    // A run inflates a disk in a circle of the tilted box.
    done(folder.path(), &["run", "--packing", "compressed.xyz", "--out", "report"], b"");
    let field = std::fs::read_to_string(folder.path().join("report/compressed.displacement.xyz")).expect("a field");
    assert!(field.lines().count() > 600);
    let scene = "[[sample]]\nname = \"a\"\nsource = { file = \"tilted.xyz\", pressure = 500.0 }\n";
    std::fs::write(folder.path().join("scene.toml"), scene).expect("written");
    done(folder.path(), &["run", "scene.toml", "--out", "second"], b"");
    let report: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("second/report.json")).expect("a report"))
            .expect("JSON");
    let text = report.to_string();
    assert!(text.contains("tilted.xyz"));
    let state = std::fs::read_to_string(folder.path().join("second/a.packing.xyz")).expect("a packing");
    let pressure: f64 = state
        .split("pressure=")
        .nth(1)
        .and_then(|rest| rest.split(' ').next())
        .expect("a pressure")
        .parse()
        .expect("a number");
    assert!((pressure / 500.0 - 1.0).abs() < 0.01, "{pressure}");
}
