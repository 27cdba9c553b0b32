//! The program as its user meets it: what it prints, what it writes, and what it says of bad input.

#[cfg(all(feature = "fit", feature = "linear", feature = "plot"))]
mod first_run;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use jamscope::scene::ProtocolChoice;
use serde_json::Value;

fn jamscope(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_jamscope")).args(arguments).output().expect("the program starts")
}

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path in Unicode")
}

/// Writes a scene into a folder of its own; the folder goes with the value returned.
fn scene(content: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("scene.toml");
    let end = if content.is_empty() || content.ends_with('\n') { "" } else { "\n" };
    std::fs::write(&path, format!("{content}{end}")).expect("a temporary file");
    (folder, path)
}

fn complaint(arguments: &[&str]) -> String {
    let output = jamscope(arguments);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}");
    String::from_utf8(output.stderr).expect("Unicode") + &String::from_utf8(output.stdout).expect("Unicode")
}

/// An end to write to whose reader has gone away.
fn unread() -> std::io::PipeWriter {
    let (reader, writer) = std::io::pipe().expect("a pipe");
    drop(reader);
    writer
}

#[test]
fn a_reader_that_has_gone_away_changes_no_exit_code() {
    let status = |arguments: &[&str]| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_jamscope"));
        program.args(arguments).stdout(unread()).stderr(unread()).status().expect("the program starts").code()
    };
    assert_eq!(status(&["scene"]), Some(0));
    assert_eq!(status(&["inspect", "no_such_packing.xyz"]), Some(1));
}

#[test]
fn inspect_gives_the_stored_numbers_of_every_packing() {
    let expected: Value =
        serde_json::from_slice(&std::fs::read(fixture("packings/expected.json")).expect("a fixture")).expect("JSON");
    let expected = expected.as_object().expect("a table by name");
    assert!(expected.len() >= 16);
    for (name, stored) in expected {
        let path = fixture(&format!("packings/{name}.xyz"));
        let law = if name.starts_with("hooke") { "hookean" } else { "hertzian" };
        let output = jamscope(&["inspect", text(&path), "--law", law, "--json"]);
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        for (ours, theirs) in [
            ("contact_count", "contacts"),
            ("rattler_count", "rattlers"),
            ("backbone_contact_count", "contacts_backbone"),
        ] {
            assert_eq!(found[ours].as_u64(), stored[theirs].as_u64(), "{name}: {ours}");
        }
        for (ours, theirs) in [("energy", "energy"), ("pressure", "p"), ("coordination", "Z")] {
            let (a, b) = (found[ours].as_f64().expect("a number"), stored[theirs].as_f64().expect("a number"));
            // Unjammed packings have energies and pressures of rounding only, below 10⁻¹³.
            assert!((a - b).abs() <= 1e-10 * b.abs() + 1e-13, "{name}: {ours} {a}, stored {b}");
        }
    }
}

#[test]
fn a_run_on_a_packing_from_a_file_writes_the_whole_report() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("report");
    let packing = fixture("packings/hertz_N1000_p800.xyz");
    let output = jamscope(&["run", "--packing", text(&packing), "--out", text(&out), "--threads", "1"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty(), "progress must be silent where nobody looks");
    let table = String::from_utf8(output.stdout).expect("Unicode");
    assert!(table.contains("hertz_N1000_p800"), "{table}");
    let report: Value =
        serde_json::from_slice(&std::fs::read(out.join("report.json")).expect("a report")).expect("JSON");
    let done = &report["samples"][0]["done"];
    // The header of the packing: p = 799.634…, relaxed by LAMMPS to 10⁻¹¹ of the mean force; nothing moves it here.
    let pressure = done["packing"]["pressure"].as_f64().expect("a number");
    assert!((pressure / 799.6342106591023 - 1.0).abs() < 1e-10, "{pressure}");
    assert!(done["inflation"]["after"]["rest"]["relative_residual"].as_f64().expect("a number") <= 1e-8);
    // Jammed, so by the protocol of the study, and not by FIRE as the first sample of the built-in scene.
    let relaxer = &report["scene"]["sample"][0]["relaxer"];
    let study = serde_json::to_value(ProtocolChoice::default().relaxer()).expect("JSON");
    assert_eq!(*relaxer, study);
}

#[test]
fn an_unjammed_packing_from_a_file_is_relaxed_by_fire() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (packing, out) = (folder.path().join("loose.xyz"), folder.path().join("report"));
    // 16 disks on a square lattice, a gap of 0.5 between them.
    let disks: String =
        (0..16).map(|k| format!("{} {} 0.5\n", 1.5 * f64::from(k % 4), 1.5 * f64::from(k / 4))).collect();
    let header = r#"Lattice="6 0 0 0 6 0 0 0 1" Properties=pos:R:2:radius:R:1 pbc="T T F""#;
    std::fs::write(&packing, format!("16\n{header}\n{disks}")).expect("a file");
    let output = jamscope(&["run", "--packing", text(&packing), "--out", text(&out)]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value =
        serde_json::from_slice(&std::fs::read(out.join("report.json")).expect("a report")).expect("JSON");
    assert!(report["scene"]["sample"][0]["relaxer"]["fire"].is_object(), "{}", report["scene"]["sample"][0]);
}

#[test]
fn the_printed_scene_is_a_scene() {
    let output = jamscope(&["scene"]);
    let (_folder, path) = scene(&String::from_utf8(output.stdout).expect("Unicode").replace("5548", "0"));
    let said = complaint(&["run", text(&path)]);
    assert!(said.contains("scene.toml") && said.contains("at least one disk"), "{said}");
}

#[test]
fn bad_scenes_are_refused_by_file_field_and_value() {
    for (content, parts) in [
        ("disk_cuont = 5", vec!["disk_cuont", "line 1"]),
        ("[[mixture]]\nradius = -0.5\nshare = 1.0", vec!["radius", "-0.5"]),
        ("[[sample]]\nname = \"x\"\nsource = { packing_fraction = 4.0 }", vec!["\"x\"", "packing_fraction", "4"]),
        ("[[sample]]\nname = \"x\"\nsource = { pressure = -1.0 }", vec!["\"x\"", "pressure", "-1"]),
        ("[[sample]]\nname = \"../x\"\nsource = { pressure = 1.0 }", vec!["name", "../x"]),
        ("[law.hertzian]\nstiffness = nan", vec!["stiffness", "NaN"]),
        ("disk_count = 0", vec!["disk_count"]),
        ("", vec!["empty"]),
        ("[inflation", vec!["line 1"]),
    ] {
        let (_folder, path) = scene(content);
        let said = complaint(&["run", text(&path)]);
        for part in ["scene.toml"].iter().chain(&parts) {
            assert!(said.contains(part), "{content:?}: no {part:?} in {said}");
        }
    }
}

#[test]
fn a_scene_that_may_have_been_cut_is_refused_and_nothing_is_written() {
    let (folder, path) = scene("[[sample]]\nname = \"x\"\nsource = { pressure = 10.0 }\n[inflation]\nincrease = 0.1");
    let whole = std::fs::read_to_string(&path).expect("written");
    let out = folder.path().join("out");
    std::fs::write(&path, whole.trim_end()).expect("a temporary file");
    let said = complaint(&["run", text(&path), "--out", text(&out)]);
    assert!(said.contains("scene.toml: line 5") && said.contains("may have been cut"), "{said}");
    let study = "disk_counts = [300]\nseeds = { first = 1, count = 1 }";
    std::fs::write(&path, study).expect("a temporary file");
    let said = complaint(&["study", text(&path), "--out", text(&out)]);
    assert!(said.contains("scene.toml: line 2") && said.contains("may have been cut"), "{said}");
    assert!(!out.exists());
}

#[test]
fn an_inflation_beyond_the_neighbours_is_refused_with_the_largest_possible() {
    let (folder, path) = scene(
        "disk_count = 300\n[inflation]\nincrease = 0.9\n[[sample]]\nname = \"x\"\nsource = { pressure = 2000.0 }",
    );
    let out = folder.path().join("out");
    let said = complaint(&["run", text(&path), "--out", text(&out)]);
    for part in ["scene.toml", "x failed", "increase is 0.9", "must stay below"] {
        assert!(said.contains(part), "no {part:?} in {said}");
    }
}

#[test]
fn bad_packings_are_refused_by_file_line_and_value() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let good = std::fs::read_to_string(fixture("packings/hertz_N1000_p100.xyz")).expect("a fixture");
    let lines: Vec<&str> = good.lines().collect();
    let moved = |line: &str, onto: &str| {
        let (mut words, onto): (Vec<&str>, Vec<&str>) = (line.split(' ').collect(), onto.split(' ').collect());
        words[1..4].copy_from_slice(&onto[1..4]);
        words.join(" ")
    };
    let replaced = |index: usize, line: String| {
        let mut lines: Vec<String> = lines.iter().map(|line| line.to_string()).collect();
        lines[index] = line;
        lines.join("\n") + "\n"
    };
    for (content, part) in [
        (String::new(), "empty"),
        (lines[..100].join("\n") + "\n", "line 100"),
        (replaced(4, lines[4].replacen(" 0.5 ", " nan ", 1)), "line 5: radius is `nan`"),
        (replaced(4, lines[4].replacen(" 0.5 ", " -0.5 ", 1)), "line 5: radius is `-0.5`"),
        (replaced(4, moved(lines[4], lines[5])), "disks 3 and 4 have the same centre"),
    ] {
        let path = folder.path().join("packing.xyz");
        std::fs::write(&path, content).expect("a temporary file");
        let said = complaint(&["inspect", text(&path)]);
        assert!(said.contains("packing.xyz") && said.contains(part), "no {part:?} in {said}");
    }
}

/// `jamscope inspect --json` with these arguments.
fn inspected(arguments: &[&str]) -> Value {
    let output = jamscope(&[&["inspect", "--json"], arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn inspect_certifies_and_gives_forces_moduli_and_modes() {
    let path = fixture("packings/hertz_N1000_p100.xyz");
    let found = inspected(&[text(&path)]);
    // What the file says: the law and its stiffness.
    assert_eq!(found["law"]["hertzian"]["stiffness"].as_f64(), Some(2e5));
    let certificate = &found["certificate"];
    assert_eq!(certificate["contacts"]["support"], "box_under_pressure");
    assert_eq!(certificate["contacts"]["contact_count"], found["backbone_contact_count"]);
    assert!(certificate["relative_residual"].as_f64().expect("a number") < 1e-10);
    assert!(certificate.get("criterion").is_none(), "nobody relaxed it here");
    let forces = &found["force_over_mean_contact_force"];
    assert_eq!(forces["contact_count"], found["backbone_contact_count"]);
    assert_eq!(forces["mean_contact_force"], found["mean_contact_force"]);
    let sum: f64 = forces["density"].as_array().expect("bins").iter().map(|bin| bin.as_f64().expect("a number")).sum();
    // Some forty bins of whole numbers over the count.
    assert!((sum * forces["bin_width"].as_f64().expect("a number") - 1.0).abs() < 1e-13);
    let plain = String::from_utf8(jamscope(&["inspect", text(&path)]).stdout).expect("Unicode");
    for line in [
        "contacts - isostatic",
        "bucklers",
        "rounding floor",
        "virial",
        "force over mean contact force percentiles",
        "Hertzian, stiffness 200000",
    ] {
        assert!(plain.contains(line), "no {line:?} in {plain}");
    }
    if cfg!(feature = "linear") {
        let found = inspected(&[text(&path), "--modes", "3"]);
        assert_eq!(certificate["stability"]["counted"]["negative_eigenvalue_count"].as_u64(), Some(0));
        let relaxed = &found["moduli"]["found"]["relaxed"];
        let number = |name: &str| relaxed[name].as_f64().expect("a number");
        assert!(0.0 < number("shear_smallest") && number("shear_largest") < number("bulk"));
        assert_eq!(relaxed["constants"].as_object().expect("by name").len(), 6);
        let modes = found["modes"]["found"]["lowest"].as_array().expect("modes").clone();
        assert_eq!((modes.len(), found["modes"]["found"]["translation_count"].as_u64()), (3, Some(2)));
        assert!(modes.iter().all(|mode| mode["residual"].as_f64().expect("a number") < 1e-13));
        assert!(plain.contains("bulk modulus") && plain.contains("negative eigenvalues") && plain.contains("C_xyxy"));
    }
}

#[test]
fn inspect_of_an_unjammed_packing_has_no_residual_and_says_why() {
    let output = jamscope(&["inspect", text(&fixture("packings/hertz_N1000_phi082.xyz"))]);
    let plain = String::from_utf8(output.stdout).expect("Unicode");
    let line = plain.lines().find(|line| line.starts_with("relative residual")).expect("a line for it");
    assert!(line.ends_with(" none: there is no backbone"), "{line}");
}

#[test]
fn the_law_is_that_of_the_file_then_of_the_command_line_then_of_the_model() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("packing.xyz");
    let good = std::fs::read_to_string(fixture("packings/hertz_N1000_p100.xyz")).expect("a fixture");
    let write = |law: &str| {
        let said = good.replacen("law=hertz stiffness=200000.0", law, 1);
        assert!(law.contains("hertz stiff") || said != good, "the header of the fixture is another");
        std::fs::write(&path, said).expect("a temporary file");
    };
    // Hertzian disks are at rest under no other law.
    let law = |arguments: &[&str]| inspected(&[&[text(&path), "--not-at-rest"], arguments].concat())["law"].clone();
    write("law=hookean stiffness=3.0");
    assert_eq!(law(&[])["hookean"]["stiffness"].as_f64(), Some(3.0));
    assert_eq!(law(&["--law", "hookean", "--stiffness", "3"])["hookean"]["stiffness"].as_f64(), Some(3.0));
    write("law=hookean");
    assert_eq!(law(&["--stiffness", "7"])["hookean"]["stiffness"].as_f64(), Some(7.0));
    assert_eq!(law(&[])["hookean"]["stiffness"].as_f64(), Some(2e5));
    write("law=\"power-law contacts\" stiffness=2.0 exponent=2.5");
    assert_eq!(law(&[])["power_law"]["exponent"].as_f64(), Some(2.5));
    assert_eq!(law(&[])["power_law"]["energy_scale"].as_f64(), Some(2.0));
    // What the law says in words counts where no key says it, and agrees where one does.
    write("law=\"Hookean contacts, stiffness 7\"");
    assert_eq!(law(&[])["hookean"]["stiffness"].as_f64(), Some(7.0));
    write("law=\"Hertzian contacts, stiffness 200000\" stiffness=200000.0 exponent=2.5");
    assert_eq!(law(&[])["hertzian"]["stiffness"].as_f64(), Some(2e5));
    write("law=other stiffness=9.0");
    assert_eq!(law(&["--law", "power:3"])["power_law"]["exponent"].as_f64(), Some(3.0));
    assert_eq!(law(&["--law", "power:3"])["power_law"]["energy_scale"].as_f64(), Some(1.0));
    write("note=none");
    assert_eq!(law(&[])["hertzian"]["stiffness"].as_f64(), Some(2e5));
    assert_eq!(law(&["--law", "hookean"])["hookean"]["stiffness"].as_f64(), Some(2e5));

    for (said, arguments, parts) in [
        ("law=hertz stiffness=200000.0", vec!["--law", "hookean"], vec!["law", "hertzian", "hookean"]),
        ("law=hookean stiffness=3.0", vec!["--stiffness", "4"], vec!["stiffness", "3", "4"]),
        ("law=power stiffness=3.0", vec![], vec!["power", "exponent"]),
        ("law=other", vec![], vec!["other", "--law"]),
        ("law=hookean stiffness=three", vec![], vec!["stiffness", "three"]),
        ("law=hookean stiffness=-3", vec![], vec!["stiffness", "-3"]),
        ("law=hookean stiffness=nan", vec![], vec!["packing.xyz", "stiffness", "nan"]),
        ("law=hertz exponent=2", vec![], vec!["packing.xyz", "law is `hertz`", "exponent is 2"]),
        ("law=hookean exponent=two", vec![], vec!["packing.xyz", "exponent", "two"]),
        (
            "law=\"Hertzian contacts, stiffness 200000\" stiffness=3.0",
            vec![],
            vec!["packing.xyz", "`Hertzian contacts, stiffness 200000`", "stiffness is 3"],
        ),
        (
            "law=\"power-law contacts, scale 1, exponent 2.5\" stiffness=1.0 exponent=2",
            vec![],
            vec!["packing.xyz", "exponent 2.5", "exponent is 2"],
        ),
        (
            "law=\"power-law contacts, scale 1, exponent 2\" stiffness=2.0 exponent=2",
            vec![],
            vec!["packing.xyz", "scale 1", "stiffness is 2"],
        ),
    ] {
        write(said);
        let complaint = complaint(&[&["inspect", text(&path)], arguments.as_slice()].concat());
        for part in parts {
            assert!(complaint.contains(part), "{said}: no {part:?} in {complaint}");
        }
    }
    let wrong = jamscope(&["inspect", text(&path), "--law", "power:much"]);
    assert!(!wrong.status.success() && String::from_utf8_lossy(&wrong.stderr).contains("much"));
}

#[test]
fn a_run_certifies_its_states_and_writes_packings_that_inspect_takes_as_they_are() {
    let (folder, path) = scene(
        "disk_count = 300\n[law.hookean]\nstiffness = 5e4\n[[sample]]\nname = \"x\"\nsource = { pressure = 2000.0 }",
    );
    let out = folder.path().join("out");
    let output = jamscope(&["run", text(&path), "--out", text(&out)]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = String::from_utf8(output.stdout).expect("Unicode");
    assert!(table.contains("Certificate") && table.contains("contacts − isostatic, after"), "{table}");
    let report: Value =
        serde_json::from_slice(&std::fs::read(out.join("report.json")).expect("a report")).expect("JSON");
    let done = &report["samples"][0]["done"];
    let states = [
        (&done["packing"], "box_under_pressure"),
        (&done["inflation"]["before"], "held_disks"),
        (&done["inflation"]["after"], "held_disks"),
    ];
    for (state, support) in states {
        let certificate = &state["certificate"];
        assert_eq!(certificate["criterion"], "relative_force");
        assert_eq!(certificate["contacts"]["support"], support);
        // 1e-8 is the limit of the scene; the relaxer's own look had displacements from other anchors.
        assert!(certificate["relative_residual"].as_f64().expect("a number") < 1.01e-8);
        if cfg!(feature = "linear") {
            assert_eq!(certificate["stability"]["counted"]["negative_eigenvalue_count"].as_u64(), Some(0), "{support}");
        }
    }
    let files = std::fs::read_dir(&out).expect("a folder").map(|entry| entry.expect("an entry").path());
    let packing = files.into_iter().find(|path| text(path).ends_with("packing.xyz")).expect("a packing");
    let header = std::fs::read_to_string(&packing).expect("a file");
    let header = header.lines().nth(1).expect("a comment line");
    for key in ["stiffness=50000.0", "relative_residual=", "rounding_floor=", "bucklers=", "excess_contacts="] {
        assert!(header.contains(key), "no {key} in {header}");
    }
    let found = inspected(&[text(&packing)]);
    assert_eq!(found["law"]["hookean"]["stiffness"].as_f64(), Some(5e4));
    assert_eq!(found["certificate"]["contacts"], done["packing"]["certificate"]["contacts"]);
    assert_eq!(found["certificate"]["relative_residual"], done["packing"]["certificate"]["relative_residual"]);
}

#[cfg(feature = "linear")]
#[test]
fn precision_refuses_a_sample_that_is_not_there_and_no_steps() {
    let said = complaint(&["precision", "--sample", "nothing"]);
    assert!(said.contains("--sample nothing: the scene has \"unjammed\", \"plastic\", \"quasielastic\""), "{said}");
    let said = complaint(&["precision", "--steps", "0"]);
    assert!(said.contains("at least one step"), "{said}");
    let said = complaint(&["precision", "no-such-scene.toml"]);
    assert!(said.contains("no-such-scene.toml"), "{said}");
}

#[test]
fn analyse_of_a_run_gives_the_observables_of_that_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (out, analysis) = (folder.path().join("report"), folder.path().join("analysis"));
    let packing = fixture("packings/hertz_N1000_p800.xyz");
    assert!(jamscope(&["run", "--packing", text(&packing), "--out", text(&out)]).status.success());
    let output = jamscope(&["analyse", text(&out), "--out", text(&analysis)]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = String::from_utf8(output.stdout).expect("Unicode");
    assert!(table.contains("hertz_N1000_p800") && table.contains("G* = −G(π)"), "{table}");
    let read = |path: PathBuf| std::fs::read(path).expect("a file");
    for ending in ["radial_profile", "angular_correlation", "power_spectrum", "radial_dependence", "multipoles"]
        .into_iter()
        .chain(["contact_changes", "bond_changes", "isostatic_length", "angular_profiles"])
    {
        let name = format!("hertz_N1000_p800.{ending}.csv");
        assert_eq!(read(analysis.join(&name)), read(out.join(&name)), "{name}");
    }
    let json: Value = serde_json::from_slice(&read(analysis.join("analysis.json"))).expect("JSON");
    let run: Value = serde_json::from_slice(&read(out.join("report.json"))).expect("JSON");
    let (ours, theirs) = (&json["analyses"][0], &run["samples"][0]["done"]);
    assert_eq!(ours["pressure_change"], theirs["inflation"]["pressure_change"]);
    assert_eq!(ours["phase"], theirs["phase"]);
}

#[test]
fn analyse_says_what_is_missing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name);
    let out = path("out");
    let of_folder = || complaint(&["analyse", text(folder.path()), "--out", text(&out)]);
    assert!(of_folder().contains("the folder contains no file NAME.before.*"), "{}", of_folder());
    let packing = fixture("packings/hertz_N1000_p800.xyz");
    std::fs::copy(&packing, path("one.before.xyz")).expect("copied");
    assert!(of_folder().contains("no one.after.* or one.displacement.* in the same folder"), "{}", of_folder());
    std::fs::copy(&packing, path("one.after.xyz")).expect("copied");
    let message = of_folder();
    assert!(message.contains("one.before.xyz") && message.contains("no disk changed its radius"), "{message}");
    std::fs::copy(fixture("packings/hertz_N1000_p100.xyz"), path("one.after.xyz")).expect("copied");
    assert!(of_folder().contains("the box before and the one after differ"), "{}", of_folder());
    std::fs::copy(fixture("packings/hooke_N1000_p100.xyz"), path("one.after.xyz")).expect("copied");
    assert!(of_folder().contains("the files give different laws"), "{}", of_folder());
    std::fs::copy(&packing, path("one.displacement.xyz")).expect("copied");
    assert!(of_folder().contains("are both files of the state"), "{}", of_folder());
    assert!(!out.exists(), "nothing was written");
}
