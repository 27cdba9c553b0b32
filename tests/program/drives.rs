//! Runs and studies of drives other than an inflation: what they write, what they refuse, the same bytes on one thread and two.

use serde_json::Value;

use crate::spheres::{done, jamscope, same_files, text};

const DRIVES: [(&str, &str); 5] = [
    ("point_force", "{ point_force = { force_over_mean = 0.1 } }"),
    ("force_dipole", "{ force_dipole = { force_over_mean = 0.1 } }"),
    ("displacement", "{ displacement = { distance = 0.005 } }"),
    ("shear", "{ shear = { strain = 0.001 } }"),
    ("compression", "{ compression = { strain = 0.001 } }"),
];

fn scene(drive: &str, more: &str) -> String {
    format!(
        "disk_count = 600\nprotocol = \"fire-newton\"\n[inflation]\ndrive = {drive}\n{more}\n[[sample]]\nname = \"a\"\nsource = {{ pressure = 2000.0 }}\n"
    )
}

#[test]
fn a_run_of_every_drive_has_its_numbers_its_page_and_the_same_bytes_on_two_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, drive) in DRIVES {
        std::fs::write(folder.path().join("scene.toml"), scene(drive, "deflate = true")).expect("written");
        done(folder.path(), &format!("run scene.toml --threads 1 --out {name}_one"));
        let printed = done(folder.path(), &format!("run scene.toml --threads 2 --out {name}_two"));
        let one = folder.path().join(format!("{name}_one"));
        same_files(&one, &folder.path().join(format!("{name}_two")));
        let report: Value = serde_json::from_str(&text(&one.join("report.json"))).expect("JSON");
        let sample = &report["samples"][0]["done"];
        assert!(
            sample["phase"]["outcome"].as_str().is_none_or(|phase| phase == "undecided"),
            "{name}: {}",
            sample["phase"]
        );
        #[cfg(feature = "fit")]
        assert!(printed.contains("no fit: the profiles fitted are those of an inflation"), "{name}: {printed}");
        let is_source = !matches!(name, "shear" | "compression");
        #[cfg(feature = "linear")]
        {
            let drive = &sample["drive"]["measured"];
            assert_eq!(drive.is_object(), is_source, "{name}");
            assert_eq!(one.join("a.drive_modes.csv").exists(), is_source, "{name}");
            let share = sample["plastic_part"]["measured"]["share"].as_f64().expect("a share");
            assert!((0.0..0.8).contains(&share), "{name}: {share}");
            if is_source {
                let modes = drive["modes"].as_array().expect("modes");
                let excited = if name == "force_dipole" { vec![0, 2] } else { vec![1] };
                let found: Vec<u64> =
                    excited.iter().copied().filter(|&n| modes.iter().any(|mode| mode["mode"] == n)).collect();
                assert_eq!(found, excited);
                assert!(modes.iter().all(|mode| excited.iter().any(|&n| mode["mode"] == n)));
                assert!(
                    drive["force"].as_f64().expect("F") > 0.0 && printed.contains("Poisson's ratio from the moduli")
                );
                assert_eq!(drive["moment"].is_number(), name == "force_dipole");
                assert_eq!(drive["distance"].as_f64(), (name == "displacement").then_some(0.005));
            }
        }
        // The affine part of a strain is left out of the field: 0.001 at R = 13 would be 0.013.
        let (before, after) = (text(&one.join("a.before.xyz")), text(&one.join("a.displacement.xyz")));
        let is_load = matches!(name, "point_force" | "force_dipole");
        assert_eq!((before.contains(":load:R:2"), after.contains(":load:R:2")), (false, is_load), "{name}");
        let deflated = text(&one.join("a.deflated.xyz"));
        assert!(!deflated.contains(":load:") && !deflated.contains(":site:"), "{name}");
        if is_load {
            // A state with its loads is at rest for every command.
            let inspected = done(folder.path(), &format!("inspect {name}_one/a.displacement.xyz --json"));
            let inspected: Value = serde_json::from_str(&inspected).expect("JSON");
            let residual = inspected["residual"]["relative"].as_f64().or(inspected["relative_residual"].as_f64());
            assert!(residual.is_none_or(|residual| residual < 1e-7), "{name}: {inspected}");
            done(folder.path(), &format!("relax {name}_one/a.displacement.xyz --out {name}.relaxed.xyz"));
        }
        #[cfg(feature = "plot")]
        {
            let page = text(&one.join("report.html"));
            assert!(page.contains("Response of a packing to a force, a displacement or a strain"));
            assert!(page.contains("a: map of r·d_r"));
            #[cfg(feature = "linear")]
            assert_eq!(page.contains("dashed the continuum"), is_source, "{name}");
        }
    }
}

#[test]
fn a_drive_without_a_meaning_is_refused_by_its_field() {
    let folder = tempfile::tempdir().expect("a folder");
    let refused = |drive: &str, more: &str, part: &str| {
        std::fs::write(folder.path().join("wrong.toml"), scene(drive, more)).expect("written");
        let output = jamscope(folder.path(), "run wrong.toml");
        let message = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(1), "{drive}: {message}");
        assert!(message.contains(part), "no `{part}` in: {message}");
    };
    refused("{ shear = { strain = 0.5 } }", "", "inflation.drive.shear.strain is 0.5");
    refused("{ point_force = { force_over_mean = nan } }", "", "drive.point_force.force_over_mean");
    refused("{ pull = { force = 1.0 } }", "", "unknown variant `pull`");
    refused("{ shear = { strain = 0.001, angle = 1.0 } }", "", "angle = 1.0");
    for (name, drive) in DRIVES {
        let walls = "boundary = { held_walls = { distance_over_side = 0.4, length_over_side = 1.0 } }";
        refused(drive, walls, &format!("drive.{name} needs boundary = {{ held_rim"));
        if name != "force_dipole" {
            refused(drive, "boundary = \"periodic\"", &format!("drive.{name} needs boundary = {{ held_rim"));
        }
    }
    let study = "targets = [{ pressure = 100.0 }]\nseeds = { first = 1, count = 2 }\n[scene.inflation]\ndrive = { shear = { strain = 0.001 } }\n";
    std::fs::write(folder.path().join("study.toml"), study).expect("written");
    let output = jamscope(folder.path(), "study study.toml --out study");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        output.status.code() == Some(1) && message.contains("scene.inflation.drive: a study inflates"),
        "{message}"
    );
    refused("{ displacement = { distance = 0.7 } }", "", "displacement.distance is 0.7: must be below 0.5");
}

/// The relaxers of the comparison start from the drive, not from an inflation: at p = 2000 all end in one minimum, that of the run.
#[cfg(feature = "linear")]
#[test]
fn protocols_and_precision_start_from_the_drive() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, drive) in DRIVES {
        let scene = scene(drive, "").replace("600", "200") + "[observables.protocol]\n[observables.contact_changes]\n";
        std::fs::write(folder.path().join("scene.toml"), scene).expect("written");
        done(folder.path(), &format!("run scene.toml --out {name}"));
        let report: Value = serde_json::from_str(&text(&folder.path().join(name).join("report.json"))).expect("JSON");
        let sample = &report["samples"][0]["done"];
        let compared = &sample["protocol"]["measured"];
        let endings = compared["endings"].as_array().expect("endings");
        let run = sample["inflation"]["pressure_change"].as_f64().expect("Δp");
        let scale = sample["inflation"]["before"]["pressure"].as_f64().expect("p");
        for ending in endings {
            let change = ending["pressure_change"].as_f64().expect("Δp");
            // Both at rest to 10⁻⁸ of the mean contact force.
            assert!((change - run).abs() < 1e-6 * scale, "{name}: {change} and {run}");
        }
        assert!(endings.len() > 4, "{name}");
    }
}
