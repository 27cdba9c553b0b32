//! A verdict needs a state at rest: from the command line, with every kind of state that is not.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

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

/// What an analysis gave.
struct Analysed {
    code: Option<i32>,
    table: String,
    json: Value,
    page: String,
}

/// `jamscope analyse BEFORE AFTER` with these arguments.
fn analysed(before: &Path, after: &Path, arguments: &[&str]) -> Analysed {
    let out = tempfile::tempdir().expect("a temporary folder");
    let fixed = ["analyse", text(before), text(after), "--out", text(out.path())];
    let output = jamscope(&[&fixed, arguments].concat());
    let read = |name: &str| std::fs::read_to_string(out.path().join(name));
    let json: Value = serde_json::from_str(&read("analysis.json").expect("written all the same")).expect("JSON");
    Analysed {
        code: output.status.code(),
        table: String::from_utf8(output.stdout).expect("Unicode"),
        json: json["analyses"][0].clone(),
        page: if cfg!(feature = "plot") { read("analysis.html").expect("a page") } else { String::new() },
    }
}

/// The ring of LAMMPS with these arguments.
fn ring(arguments: &[&str]) -> Analysed {
    analysed(&fixture("verdict/ring.before.xyz"), &fixture("verdict/ring.after.xyz"), arguments)
}

/// No phase and no fit, said first in every form, with this cause as the likeliest and these words of it.
fn refused(found: &Analysed, cause: &str, words: &[&str]) {
    assert_eq!(found.code, Some(3), "{}", found.table);
    let first: Vec<&str> = found.table.split_whitespace().take(9).collect();
    assert_eq!(first[1..], ["NOT", "AT", "REST:", "no", "phase", "and", "no", "fit."], "{}", found.table);
    // Lines are broken between words.
    let said = found.table.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in words.iter().chain(&["Residual under other laws: "]) {
        assert!(said.contains(part), "no {part:?} in {said}");
    }
    for phase in ["plastic", "unjammed"] {
        assert!(!said.contains(phase), "{phase} in {said}");
    }
    let verdict = &found.json["verdict"];
    assert_eq!(verdict["decision"], "not_at_rest");
    assert_eq!(verdict["residual_limit"].as_f64(), Some(1e-3));
    let likely = &verdict["likely"][0];
    assert!(likely.get(cause).is_some() || likely == cause, "{likely}");
    assert_eq!(found.json["phase"], serde_json::json!({ "outcome": "not_at_rest" }));
    if cfg!(feature = "fit") {
        let spectrum = &found.json["angular_correlation"]["measured"];
        let mut fits = vec![&found.json["profile_fit"]];
        fits.extend(found.json.get("elastic_modes"));
        fits.extend([spectrum.get("slope"), spectrum.get("crossover")].into_iter().flatten());
        for fit in fits {
            let reason = fit["refused"].as_str().unwrap_or_default();
            assert!(reason.contains("at rest it is at most 1e-3"), "{fit}");
        }
    }
    assert!(found.json["radial_profile"]["rings"].as_array().is_some_and(|rings| !rings.is_empty()), "measured");
    if cfg!(feature = "plot") {
        let (said, shown) = (found.page.find("NOT AT REST: no phase"), found.page.find("<figure"));
        assert!(said.zip(shown).is_some_and(|(said, shown)| said < shown), "the page says so first");
    }
}

#[test]
fn a_wall_inside_the_outer_radius_is_named() {
    for radius in ["12", "13"] {
        let found = ring(&["--outer-radius", radius]);
        let place = format!("disks lie within a contact of R = {radius}, pushed outwards.");
        refused(&found, "boundary", &["a wall or a rim inside R", &place, "--outer-radius"]);
        let cause = &found.json["verdict"]["likely"][0]["boundary"];
        assert_eq!(cause["outward_count"], cause["unbalanced_count"]);
        let count = |name: &str| cause[name].as_u64().expect("a count");
        assert!(count("held_count") < count("expected_count"), "{cause}");
    }
}

#[test]
fn the_same_states_are_at_rest_inside_the_wall() {
    let found = ring(&["--outer-radius", "11"]);
    assert_eq!(found.code, Some(0), "{}", found.table);
    assert!(!found.table.contains("NOT AT REST") && !found.page.contains("NOT AT REST"), "{}", found.table);
    let verdict = &found.json["verdict"];
    assert_eq!((&verdict["decision"], verdict.get("likely")), (&Value::from("at_rest"), None));
    for state in verdict["states"].as_array().expect("two") {
        // LAMMPS relaxed them to 10⁻¹².
        assert!(state["relative_residual"].as_f64().is_some_and(|residual| residual < 1e-11), "{state}");
    }
    assert_ne!(found.json["phase"]["outcome"], "not_at_rest");
}

#[test]
fn an_outer_radius_beyond_the_data_is_named() {
    let found = ring(&["--outer-radius", "20"]);
    refused(&found, "nothing_held", &["R beyond the data; R is 20, but the farthest disk is at 13.03"]);
}

#[test]
fn a_forgotten_law_is_named_with_its_residual() {
    let found = ring(&["--outer-radius", "11", "--law", "hookean"]);
    refused(&found, "law", &["the contact law; under the law hertzian the residual is", "The stiffness scales all"]);
    let laws = found.json["verdict"]["other_laws"].as_array().expect("laws").clone();
    assert_eq!(laws.len(), 3, "hertzian, power:2, power:2.5");
    // Another stiffness alone changes no residual: all forces scale alike, to rounding.
    let residual =
        |found: &Analysed| found.json["verdict"]["states"][0]["relative_residual"].as_f64().expect("a number");
    let soft = ring(&["--outer-radius", "11", "--law", "hookean", "--stiffness", "3"]);
    assert!((residual(&soft) / residual(&found) - 1.0).abs() < 1e-12);
}

#[test]
fn six_digits_are_recognised_and_the_line_for_more_is_given() {
    let (before, after) = (fixture("verdict/six_digits.before.dump"), fixture("verdict/six_digits.after.dump"));
    let found = analysed(&before, &after, &[]);
    refused(
        &found,
        "few_digits",
        &["they were written with 6 digits, with a spacing of 1e-4", "dump_modify ID format float %.17g"],
    );
    let output = jamscope(&["inspect", text(&before)]);
    let said = String::from_utf8(output.stdout).expect("Unicode");
    assert_eq!(output.status.code(), Some(3));
    assert!(said.starts_with("NOT AT REST") && said.contains("dump_modify ID format float %.17g"), "{said}");
    let output = jamscope(&["inspect", text(&before), "--json", "--not-at-rest"]);
    assert_eq!(output.status.code(), Some(0));
    let json: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(json["verdict"]["decision"], "not_at_rest_but_given");
}

/// The ring before with one disk elsewhere: what a damaged line leaves.
fn damaged(folder: &Path) -> PathBuf {
    let whole = std::fs::read_to_string(fixture("verdict/ring.before.xyz")).expect("a fixture");
    let mut lines: Vec<String> = whole.lines().map(Into::into).collect();
    // Disk 5, 2.98 from the centre.
    let line = lines[6].replacen("2.2316713574273574", "2.8316713574273574", 1);
    assert_ne!(line, lines[6], "another fixture");
    lines[6] = line;
    let path = folder.join("ring.before.xyz");
    std::fs::write(&path, lines.join("\n") + "\n").expect("a temporary file");
    path
}

#[test]
fn a_disk_far_off_equilibrium_gives_no_phase() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let before = damaged(folder.path());
    let found = analysed(&before, &fixture("verdict/ring.after.xyz"), &["--outer-radius", "11"]);
    refused(&found, "few_disks", &["a damaged line", "disk"]);
    let states = found.json["verdict"]["states"].as_array().expect("two").clone();
    assert_eq!((&states[0]["at_rest"], &states[1]["at_rest"]), (&Value::from(false), &Value::from(true)));
}

/// The ring after with these disks, by label, of another radius.
fn with_radii(folder: &Path, radii: &[(usize, &str)]) -> PathBuf {
    let whole = std::fs::read_to_string(fixture("verdict/ring.after.xyz")).expect("a fixture");
    let mut lines: Vec<String> = whole.lines().map(Into::into).collect();
    for &(label, radius) in radii {
        // Two lines, then disk 1.
        let line = &mut lines[label + 1];
        let mut words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(words[4], label.to_string(), "another fixture");
        words[3] = radius;
        *line = words.join(" ");
    }
    let path = folder.join("ring.after.xyz");
    std::fs::write(&path, lines.join("\n") + "\n").expect("a temporary file");
    path
}

#[test]
fn radii_other_than_those_at_rest_are_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let before = fixture("verdict/ring.before.xyz");
    let after = with_radii(folder.path(), &[(205, "0.62")]);
    let found = analysed(&before, &after, &["--outer-radius", "11"]);
    refused(&found, "centre", &["are neighbours of the inflated disk 205"]);
    let after = with_radii(folder.path(), &[(5, "0.55"), (6, "0.75")]);
    let found = analysed(&before, &after, &["--outer-radius", "11", "--centre", "205"]);
    refused(&found, "other_radii", &["2 other disks changed their radius too, disk 5 among them"]);
}

#[test]
fn one_flag_overrides_and_the_report_still_says_so_first() {
    let found = ring(&["--outer-radius", "12", "--not-at-rest"]);
    assert_eq!(found.code, Some(0), "{}", found.table);
    let said = found.table.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.starts_with("ring: NOT AT REST: phase and fits are given only on request."), "{said}");
    assert_eq!(found.json["verdict"]["decision"], "not_at_rest_but_given");
    assert_ne!(found.json["phase"]["outcome"], "not_at_rest");
    assert!(found.json["phase"].get("by_pressure_change").is_some());
}

#[test]
fn the_limit_is_a_setting() {
    // Coordinates cut to 10⁻⁵ of overlaps of some 10⁻²: a residual of some 10⁻³.
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cut = |name: &str| {
        let whole = std::fs::read_to_string(fixture(&format!("verdict/{name}"))).expect("a fixture");
        let line = |(index, line): (usize, &str)| {
            let words: Vec<&str> = line.split_whitespace().collect();
            let number = |place: usize| words[place].parse::<f64>().expect("a number");
            if index < 2 {
                return line.to_owned();
            }
            format!("X {:.5} {:.5} {} {}", number(1), number(2), words[3], words[4])
        };
        let lines: Vec<String> = whole.lines().enumerate().map(line).collect();
        let path = folder.path().join(name);
        std::fs::write(&path, lines.join("\n") + "\n").expect("a temporary file");
        path
    };
    let (before, after) = (cut("ring.before.xyz"), cut("ring.after.xyz"));
    let scene = folder.path().join("scene.toml");
    let with = |limit: f64| {
        std::fs::write(&scene, format!("[verdict]\nresidual_limit = {limit:e}\n")).expect("a temporary file");
        analysed(&before, &after, &["--outer-radius", "11", "--scene", text(&scene)])
    };
    let found = with(1e-9);
    assert_eq!(found.code, Some(3));
    let states = found.json["verdict"]["states"].as_array().expect("two").clone();
    let residual = states.iter().filter_map(|state| state["relative_residual"].as_f64()).fold(0.0, f64::max);
    assert!(residual > 1e-4 && residual < 9e-3, "{residual}");
    assert_eq!(with(0.9 * residual).code, Some(3));
    assert_eq!(with(1.1 * residual).code, Some(0));
    for value in ["0.02", "0.0", "-1e-3", "nan"] {
        std::fs::write(&scene, format!("[verdict]\nresidual_limit = {value}\n")).expect("a temporary file");
        let output = jamscope(&["analyse", text(&before), text(&after), "--scene", text(&scene)]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{value}: {said}");
        assert!(said.contains("verdict.residual_limit = ") && said.contains("above 0 and at most 0.01"), "{said}");
    }
}

#[test]
fn a_centre_whose_radius_did_not_change_is_refused() {
    let (before, after) = (fixture("verdict/ring.before.xyz"), fixture("verdict/ring.after.xyz"));
    let output = jamscope(&["analyse", text(&before), text(&after), "--outer-radius", "11", "--centre", "7"]);
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    for part in
        ["disk 7 is named as the inflated one", "its radius is 0.5 before and after", "that of disk 205 changed"]
    {
        assert!(said.contains(part), "no {part:?} in {said}");
    }
}

#[test]
fn a_deflation_reads_the_sign_of_the_pressure_change_the_other_way_round() {
    let (before, after) = (fixture("verdict/ring.before.xyz"), fixture("verdict/ring.after.xyz"));
    let arguments = ["--outer-radius", "11"];
    let (grown, shrunk) = (analysed(&before, &after, &arguments), analysed(&after, &before, &arguments));
    let change = |found: &Analysed| found.json["pressure_change"].as_f64().expect("a number");
    // R = 11 is measured from the centre, which moved by 0.1: the circles differ a little.
    assert!(change(&grown) > 0.0 && change(&shrunk) < 0.0, "{} {}", change(&grown), change(&shrunk));
    assert!(shrunk.json["increase"].as_f64().is_some_and(|increase| increase < 0.0));
    for found in [grown, shrunk] {
        assert_eq!(found.json["phase"]["by_pressure_change"], "quasielastic");
    }
}

#[test]
fn a_run_on_a_packing_that_is_not_at_rest_has_no_phase() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (scene, out) = (folder.path().join("scene.toml"), folder.path().join("out"));
    // A Hookean packing that does not say so, in a Hertzian scene.
    let packing = folder.path().join("hooke_N1000_p800.xyz");
    let known = std::fs::read_to_string(fixture("packings/hooke_N1000_p800.xyz")).expect("a fixture");
    let unknown = known.replacen(" law=hooke stiffness=200000.0", "", 1);
    assert_ne!(unknown, known, "law and stiffness are left out");
    std::fs::write(&packing, unknown).expect("a temporary file");
    std::fs::write(&scene, "disk_count = 1000\n[law.hertzian]\nstiffness = 2e5\n").expect("a temporary file");
    let run = |flag: &[&str]| {
        let fixed = ["run", text(&scene), "--packing", text(&packing), "--out", text(&out)];
        let output = jamscope(&[&fixed, flag].concat());
        let json: Value =
            serde_json::from_slice(&std::fs::read(out.join("report.json")).expect("a report")).expect("JSON");
        (output.status.code(), String::from_utf8(output.stdout).expect("Unicode"), json["samples"][0]["done"].clone())
    };
    let (code, table, done) = run(&[]);
    assert_eq!(code, Some(3), "{table}");
    let said = table.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.starts_with("hooke_N1000_p800: NOT AT REST: no phase and no fit."), "{said}");
    assert!(said.contains("as read") && said.contains("under the law hookean the residual is"), "{said}");
    assert_eq!(done["packing"]["as_read"]["decision"], "not_at_rest");
    assert_eq!(
        (&done["verdict"]["decision"], &done["phase"]["outcome"]),
        (&"not_at_rest".into(), &"not_at_rest".into())
    );
    if cfg!(feature = "plot") {
        let page = std::fs::read_to_string(out.join("report.html")).expect("a page");
        let (said, shown) = (page.find("NOT AT REST: no phase"), page.find("<figure"));
        assert!(said.zip(shown).is_some_and(|(said, shown)| said < shown), "the page says so first");
    }
    let (code, _, done) = run(&["--not-at-rest"]);
    assert_eq!((code, &done["verdict"]["decision"]), (Some(0), &"not_at_rest_but_given".into()));
    assert_ne!(done["phase"]["outcome"], "not_at_rest");
}

#[test]
fn limits_that_are_no_rest_are_refused_with_field_value_and_limit() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scene = folder.path().join("scene.toml");
    let sample = "[[sample]]\nname = \"x\"\nsource = { pressure = 1.0 }\n";
    let mut relaxers = vec!["fire", "damped", "conjugate_gradients", "quasi_newton"];
    if cfg!(feature = "linear") {
        relaxers.extend(["implicit", "gradient_flow", "newton", "staged"]);
    }
    for relaxer in relaxers {
        for (limit, value, largest) in [("relative", 0.011, "1.000e-2"), ("absolute", 1.0, "2.422e-2")] {
            for (table, field) in
                [("preparation.relaxer", "preparation.relaxer"), ("sample.relaxer", "sample \"x\": relaxer")]
            {
                let content = format!("{sample}[{table}.{relaxer}]\nlimit = {{ {limit} = {value} }}\n");
                std::fs::write(&scene, content).expect("a temporary file");
                let output = jamscope(&["run", text(&scene), "--out", text(&folder.path().join("out"))]);
                let said = String::from_utf8_lossy(&output.stderr).into_owned();
                assert_eq!(output.status.code(), Some(1), "{relaxer}: {said}");
                // A hundredth of ⟨F⟩ ≤ p π ⟨R²⟩/(0.8 ⟨R⟩) = 0.37 π/(0.8 · 0.6) at p = 1.
                let expected = format!(
                    "{field}.limit.{limit} = {value}: must be at most {largest}, because a packing with a residual above 0.01"
                );
                assert!(said.contains(&expected), "{relaxer}: no {expected:?} in {said}");
            }
        }
    }
    assert!(!folder.path().join("out").exists(), "nothing was run");
}

#[test]
fn the_exit_codes_stand_in_the_help() {
    let help = String::from_utf8(jamscope(&["--help"]).stdout).expect("Unicode");
    for line in ["Exit codes:", "0  success", "1  a file", "2  the command line", "3  a state is not at rest"] {
        assert!(help.contains(line), "no {line:?} in {help}");
    }
}
