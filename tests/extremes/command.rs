//! The program with numbers nobody means: an error that names the field and the value, or a report; never a panic.
//!
//! The program is started as a user would start it, so this file needs the feature `cli`.
#![cfg(feature = "cli")]

use std::path::Path;
use std::process::{Command, Output};

/// Runs a scene of 60 disks with these lines in it; the report goes into a folder of its own.
fn run(folder: &Path, lines: &str) -> Output {
    let scene = folder.join("scene.toml");
    std::fs::write(&scene, lines).expect("a folder to write to");
    Command::new(env!("CARGO_BIN_EXE_jamscope"))
        .arg("run")
        .arg(&scene)
        .arg("--out")
        .arg(folder.join("out"))
        .output()
        .expect("the program starts")
}

/// The sample every scene here has, and the limits that keep it short.
const SAMPLE: &str = "[[sample]]\nname = \"one\"\nsource = { packing_fraction = 0.95 }\n\
    relaxer = { fire = { step_limit = 20000 } }\n";

#[test]
fn numbers_nobody_means_are_named_or_survived() {
    let quick = "[preparation]\nrelaxer = { fire = { step_limit = 20000 } }\n";
    // What stands in the scene, and what the error has to name where there is one.
    let refused = [
        ("law = { hertzian = { stiffness = -1.0 } }", "-1"),
        ("law = { hertzian = { stiffness = inf } }", "inf"),
        ("law = { hookean = { stiffness = nan } }", "NaN"),
        ("law = { power_law = { energy_scale = 1.0, exponent = 1.0 } }", "exponent"),
        ("law = { hookean = { stiffness = 1e308 } }", "NonFinite"),
        ("law = { hookean = { stiffness = 1e-200 } }", "Underflow"),
        ("law = { hertzian = { stiffness = 1e-320 } }", "Underflow"),
        ("mixture = [{ radius = 1e-120, share = 1.0 }]", "Underflow"),
        ("mixture = [{ radius = 1e300, share = 1.0 }]", "1e300"),
        ("mixture = [{ radius = 1e-300, share = 1.0 }]", "1e-300"),
        ("mixture = [{ radius = 0.5, share = nan }]", "NaN"),
        ("inflation = { increase = 1e300 }", "increase"),
        ("inflation = { increase = nan }", "increase"),
        ("inflation = { increase = -0.5 }", "increase"),
        ("observables = { radial_profile = { ring_width = 0.0 } }", "ring_width"),
        ("observables = { radial_profile = { ring_width = -1e-300 } }", "ring_width"),
    ];
    for (line, named) in refused {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let output = run(folder.path(), &format!("disk_count = 60\n{line}\n{quick}{SAMPLE}"));
        // A scene that is refused says so in the error; a sample that fails has its reason in the table.
        let said = [output.stdout, output.stderr].concat();
        let said = String::from_utf8_lossy(&said);
        assert!(!output.status.success() && said.contains(named), "{line}: {said}");
        assert!(!said.contains("TOML parse error"), "{line}: {said}");
        assert!(!said.contains("panicked") && !said.contains("overflow"), "{line}: {said}");
    }
    let survived = [
        "law = { hertzian = { stiffness = 1e-20 } }",
        "law = { hookean = { stiffness = 1e20 } }",
        "inflation = { increase = 1e-14 }",
        "inflation = { increase = 0.0 }",
        "observables = { radial_profile = { ring_width = 1e300 } }",
        "observables = { radial_profile = { ring_width = 1e-300 } }",
    ];
    for line in survived {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let output = run(folder.path(), &format!("disk_count = 60\n{line}\n{quick}{SAMPLE}"));
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{line}: {error}");
        assert!(folder.path().join("out/report.json").exists(), "{line}: no report");
    }
}
