//! Counts, radii and threads beyond what memory and index types allow: refused at once, with field, value, limit and memory.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_jamscope"))
}

/// What is said where a command is refused; it takes no time and leaves nothing.
fn refused(command: &mut Command) -> String {
    let start = Instant::now();
    let Output { status, stderr, .. } = command.output().expect("the program starts");
    let said = String::from_utf8_lossy(&stderr).into_owned();
    // Not a signal, not a panic, which ends with 101.
    assert_eq!(status.code(), Some(1), "{said}");
    // A start of the program takes hundredths of a second; a minute of silence is what is not to be.
    assert!(start.elapsed() < Duration::from_secs(10), "{said}");
    said
}

fn assert_says(said: &str, parts: &[&str]) {
    for part in parts {
        assert!(said.contains(part), "no {part:?} in {said}");
    }
}

#[test]
fn counts_of_a_scene_or_study_name_field_value_limit_and_memory() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    let said = refused(program().arg("run").arg(fixture("refused/disk-count-1e12.toml")).arg("--out").arg(&out));
    assert_says(&said, &["disk-count-1e12.toml", "disk_count = 1000000000000", "4294967295", "TB of memory"]);
    let said = refused(program().arg("run").arg(fixture("refused/step-count.toml")).arg("--out").arg(&out));
    let parts = ["step-count.toml", "angular_correlation", "step_count = 9223372036854775807", "at most 1000000", "TB"];
    assert_says(&said, &parts);
    let seeds = fixture("refused/seed-count.toml");
    for more in [&["--dry-run"][..], &[], &["--shard", "1/1000000000000"]] {
        let said = refused(program().arg("study").arg(&seeds).args(more).arg("--out").arg(&out));
        assert_says(&said, &["seed-count.toml", "seeds.count = 1000000000000", "at most 1000000", "of memory"]);
    }
    assert!(!out.exists());
}

#[test]
fn threads_are_counted_before_they_are_started() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    for command in ["run", "study"] {
        let file = if command == "run" { "refused/name-too-long.toml" } else { "studies/b.toml" };
        let with = |threads: &str| {
            refused(program().arg(command).arg(fixture(file)).args(["--threads", threads]).arg("--out").arg(&out))
        };
        assert_says(&with("5000"), &["--threads = 5000", "at most", "GB of memory"]);
        assert_says(&with("1000000000000"), &["--threads = 1000000000000", "at most"]);
        assert_says(&with("0"), &["--threads 0"]);
    }
    let said = refused(program().arg("scene").env("RAYON_NUM_THREADS", "5000"));
    assert_says(&said, &["RAYON_NUM_THREADS = 5000", "at most"]);
    assert!(!out.exists());
}

#[test]
fn radii_that_rounding_hides_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (path, out) = (folder.path().join("scene.toml"), folder.path().join("out"));
    let complaint = |mixture: &str| {
        let sample = "[[sample]]\nname = \"one\"\nsource = { pressure = 1.0 }\n";
        std::fs::write(&path, format!("mixture = [{mixture}]\n{sample}")).expect("written");
        refused(program().arg("run").arg(&path).arg("--out").arg(&out))
    };
    let said = complaint("{ radius = 0.5, share = 1.0 }, { radius = 1e15, share = 1.0 }");
    assert_says(&said, &["scene.toml", "mixture", "1e15", "at most 1e8"]);
    let said = complaint("{ radius = 1e15, share = 1.0 }");
    assert_says(&said, &["scene.toml", "\"one\"", "source.pressure = 1", "radius 1e15", "at least 1e-12"]);
    assert!(!out.exists());
}

#[cfg(feature = "linear")]
#[test]
fn more_modes_than_coordinates_are_refused() {
    let packing = fixture("packings/hertz_N1000_p100.xyz");
    let said = refused(program().arg("inspect").arg(packing).args(["--modes", "1000000000000"]));
    assert_says(&said, &["--modes = 1000000000000", "at most 2000"]);
}

#[cfg(target_os = "linux")]
#[test]
fn the_limit_is_that_of_the_process() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (path, out) = (folder.path().join("scene.toml"), folder.path().join("out"));
    let sample = "[[sample]]\nname = \"one\"\nsource = { packing_fraction = 0.5 }\n";
    std::fs::write(&path, format!("disk_count = 20000000\n{sample}")).expect("written");
    // 2 GB of address space, for 20 million disks of 500 bytes and more.
    let script = format!(
        "ulimit -v 2000000; exec '{}' run '{}' --threads 1 --out '{}'",
        env!("CARGO_BIN_EXE_jamscope"),
        path.display(),
        out.display()
    );
    let said = refused(Command::new("bash").args(["-c", &script]));
    assert_says(&said, &["disk_count = 20000000: must be at most", "the limit on its address space", "GB of memory"]);
    assert!(!out.exists());
}
