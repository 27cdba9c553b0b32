//! Analyses of spheres: exact solutions written to files, the files of a run, frames, and what is refused.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;

use jamscope::reference::elastic::Elastic;
use jamscope::reference::poles::pole;
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};
use serde_json::Value;

use crate::spheres::{done, jamscope, text};

fn refused(folder: &Path, arguments: &str, parts: &[&str]) {
    let output = jamscope(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{arguments}: {message}");
    for part in parts {
        assert!(message.contains(part), "{arguments}: no `{part}` in: {message}");
    }
}

fn analysis(folder: &Path) -> Value {
    let json: Value = serde_json::from_str(&text(&folder.join("analysis.json"))).expect("JSON");
    json["analyses"][0].clone()
}

/// R of the synthetic shell; a = 0.5.
const RIM: f64 = 40.0;

/// Writes `NAME.before.xyz` and `NAME.after.xyz`: spheres of diameter 1 that do not touch, up to 150 in each of 19 thin
/// shells two diameters apart, and their positions after the displacement d_r(r) of a medium.
fn write_pair(folder: &Path, name: &str, keys: &str, displacement: impl Fn(f64) -> f64) {
    let mut files = ["before", "after"].map(|state| (state, Vec::new()));
    for (step, grown) in [0.5, 0.55].into_iter().enumerate() {
        files[step].1.push(([0.0; 3], grown));
    }
    for shell in 1..20 {
        // The middle of a ring of width 1/2 that begins at a = 1/2.
        let radius = 0.75 + 2.0 * f64::from(shell);
        let count = (2.0 * radius * radius).min(150.0).floor();
        for index in 0..count as usize {
            // A spiral of equal areas.
            let (z, angle) = (1.0 - (2 * index + 1) as f64 / count, PI * (3.0 - 5f64.sqrt()) * index as f64);
            let across = (1.0 - z * z).sqrt();
            let direction = [across * angle.cos(), across * angle.sin(), z];
            for (moved, file) in [0.0, displacement(radius)].into_iter().zip(&mut files) {
                file.1.push((direction.map(|part| (radius + moved) * part), 0.5));
            }
        }
    }
    for (state, spheres) in files {
        let mut file = format!("{}\npbc=\"F F F\" Properties=pos:R:3:radius:R:1:id:I:1{keys}\n", spheres.len());
        for (label, ([x, y, z], radius)) in spheres.into_iter().enumerate() {
            let _ = writeln!(file, "{x:?} {y:?} {z:?} {radius:?} {label}");
        }
        std::fs::write(folder.join(format!("{name}.{state}.xyz")), file).expect("written");
    }
}

// A displacement at the rim is 10⁻⁶ and a coordinate there is rounded by 4·10⁻¹⁵: the displacements have 8 digits or
// more, and all spheres of a shell the same one. The fitted numbers are asked for 6.
#[cfg(feature = "fit")]
#[test]
fn exact_solutions_of_a_shell_are_recovered_from_two_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let annulus = Annulus::new(0.5, RIM).expect("a < R");
    let close = |value: &Value, exact: f64| {
        let value = value.as_f64().expect("a number");
        assert!((value / exact - 1.0).abs() < 1e-6, "{value} for {exact}");
    };
    // The file leaves the dimension open: it is given.
    let elastic = Elastic::<3>::new(annulus, 0.05).expect("finite");
    write_pair(folder.path(), "elastic", "", |radius| elastic.value(radius));
    let given = "elastic.before.xyz elastic.after.xyz --outer-radius 40";
    let printed = done(folder.path(), &format!("analyse {given} --dimension 3 --out elastic"));
    assert!(printed.contains("radius of the shell, R") && printed.contains("[force/length^2]"), "{printed}");
    let found = analysis(&folder.path().join("elastic"));
    let fit = &found["profile_fit"]["measured"];
    assert_eq!(fit["decision"], "elastic", "{fit}");
    close(&fit["elastic"]["amplitude"]["value"], 0.05);
    refused(folder.path(), &format!("analyse {given}"), &["not a packing in 2 dimensions", "--dimension 3"]);
    // The file gives it. κ is beyond the first pole, κ_1 = 0.112.
    let screened = Screened::<3>::new(annulus, 0.05, 0.2).expect("no pole");
    write_pair(folder.path(), "screened", " dimension=3", |radius| screened.value(radius));
    let given = "screened.before.xyz screened.after.xyz --outer-radius 40";
    let printed = done(folder.path(), &format!("analyse {given} --out screened"));
    // κ_1 is the pole of the shell.
    let row = printed.lines().find(|line| line.contains("screened: κ/κ_1")).expect("a row");
    let ratio = row.split_whitespace().find_map(|word| word.parse::<f64>().ok()).expect("a number");
    assert!((ratio * pole::<3>(annulus, 1) / 0.2 - 1.0).abs() < 0.01, "{row}: three digits are printed");
    let found = analysis(&folder.path().join("screened"));
    let fit = &found["profile_fit"]["measured"];
    assert_eq!(fit["decision"], "screened", "{fit}");
    close(&fit["screened"]["wavenumber"]["value"], 0.2);
    close(&fit["screened"]["amplitude"]["value"], 0.05);
    // The rings have the displacement of the solution: its mean over a ring of one distance.
    let ring = &found["radial_profile"]["rings"][5];
    close(&ring["mean"], screened.value(ring["radius"].as_f64().expect("a radius")));
}

/// Without the time, which a run has and an analysis has not.
fn shared(value: &Value, other: &Value) -> usize {
    let (ours, theirs) = (value.as_object().expect("an object"), other.as_object().expect("an object"));
    let same = ["verdict", "measured_on", "phase", "radial_profile", "profile_fit", "penetration_lengths"];
    let same = same.into_iter().chain(["shell_correlation", "contact_changes", "isostatic_length"]);
    let same: Vec<&str> = same.filter(|name| theirs.contains_key(*name)).collect();
    for name in &same {
        assert_eq!(ours.get(*name), theirs.get(*name), "{name}");
    }
    same.len()
}

#[test]
fn the_files_of_a_run_of_spheres_give_the_numbers_of_that_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let scene = "dimension = 3\ndisk_count = 4000\nprotocol = \"fire\"\n[[sample]]\nname = \"dense\"\nsource = { pressure = 2000.0 }\n";
    std::fs::write(path("scene.toml"), scene).expect("written");
    done(folder.path(), "run scene.toml --out run");
    let run: Value = serde_json::from_str(&text(&path("run/report.json"))).expect("JSON");
    let sample = &run["samples"][0]["done"];
    done(folder.path(), "analyse run --out folder");
    let of_folder = analysis(&path("folder"));
    // Three of nine need fits.
    assert_eq!(shared(&of_folder, sample), if cfg!(feature = "fit") { 9 } else { 8 });
    for state in ["before", "after"] {
        for number in ["pressure", "energy", "contact_count", "rattler_count"] {
            assert_eq!(of_folder[state][number], sample["inflation"][state][number], "{number} {state}");
        }
    }
    for number in ["centre_label", "inner_radius", "outer_radius", "mobile_count", "pressure_change"] {
        assert_eq!(of_folder[number], sample["inflation"][number], "{number}");
    }
    for ending in ["radial_profile", "shell_spectrum", "contact_changes", "bond_changes", "isostatic_length"] {
        let file = |out: &str| text(&path(out).join(format!("dense.{ending}.csv")));
        assert!(file("folder") == file("run"), "{ending}");
    }
    #[cfg(feature = "plot")]
    {
        let page = text(&path("folder/analysis.html"));
        for title in ["slice of r²·d_r", "d_r on a shell", "radial profile", "angular correlation"] {
            assert!(page.contains(&format!("dense: {title}")), "no {title}");
        }
    }
    // As two files with the columns of each sphere, as two frames, and by the settings of a scene.
    done(folder.path(), "analyse run/dense.before.xyz run/dense.displacement.xyz --out files --write response.xyz");
    let numbers = |value: Value| {
        let mut value = value;
        value["name"] = Value::Null;
        value
    };
    assert_eq!(numbers(analysis(&path("files"))), numbers(of_folder.clone()));
    let both = text(&path("run/dense.before.xyz")) + &text(&path("run/dense.displacement.xyz"));
    std::fs::write(path("both.xyz"), both).expect("written");
    done(folder.path(), "analyse both.xyz --frames 0,last --scene scene.toml --out frames");
    assert_eq!(numbers(analysis(&path("frames"))), numbers(of_folder));
    refused(folder.path(), "analyse both.xyz --frames 0,2", &["both.xyz", "no frame 2", "2 frames"]);
    // The columns are those of the run, to the bit; the comment lines have other keys.
    let rows = |name: &str| text(&path(name)).lines().skip(2).map(str::to_owned).collect::<Vec<_>>();
    assert!(rows("response.xyz") == rows("run/dense.displacement.xyz"));
    let head = text(&path("response.xyz")).lines().nth(1).expect("a comment line").to_owned();
    assert_eq!(head.contains(":linear:R:3:plastic:R:3"), cfg!(feature = "linear"), "{head}");
}

#[test]
fn spheres_and_disks_are_not_mixed() {
    let folder = tempfile::tempdir().expect("a folder");
    write_pair(folder.path(), "space", " dimension=3", |radius| 0.01 / (radius * radius));
    let disks = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N1000_p100.xyz");
    std::fs::copy(disks, folder.path().join("disks.xyz")).expect("copied");
    let path = |name: &str| folder.path().join(name);
    let plane = "dimension is `2`: this is not a packing in 3 dimensions";
    refused(folder.path(), "analyse disks.xyz disks.xyz --dimension 3", &["disks.xyz, line 2", plane]);
    refused(folder.path(), "analyse space.before.xyz disks.xyz", &["the files give different dimensions, 3 and 2"]);
    refused(folder.path(), "analyse disks.xyz space.after.xyz", &["the files give different dimensions, 2 and 3"]);
    let given = "space.before.xyz space.after.xyz";
    refused(folder.path(), &format!("analyse {given} --dimension 2"), &["dimension is `3`", "--dimension 3"]);
    refused(folder.path(), &format!("analyse {given}"), &["no box and no disk is held"]);
    refused(folder.path(), &format!("analyse {given} --outer-radius 0.4L"), &["0.4L", "open space"]);
    // A scene for disks, and one of spheres with what belongs to the plane.
    std::fs::write(path("plane.toml"), "disk_count = 500\n").expect("written");
    let other = "the scene has dimension = 2, but the packings have 3";
    refused(folder.path(), &format!("analyse {given} --outer-radius 40 --scene plane.toml"), &["--scene", other]);
    std::fs::write(path("rings.toml"), "dimension = 3\n[observables.angular_profiles]\n").expect("written");
    let scene = ["observables.angular_profiles", "with dimension = 3 there is no angle in the plane"];
    refused(folder.path(), &format!("analyse {given} --outer-radius 40 --scene rings.toml"), &scene);
    assert!(!path("jamscope-analysis").exists(), "nothing was written");
}
