//! The folder a run writes into: tried before the work, filled at once, and what is in it already.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

fn run(scene: &Path, out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_jamscope"));
    command.args(["run", "--threads", "1"]).arg(scene).arg("--out").arg(out);
    command
}

fn refused(command: &mut Command) -> String {
    let Output { status, stdout, stderr } = command.output().expect("the program starts");
    assert_eq!(status.code(), Some(1));
    assert!(stdout.is_empty(), "refused after the work: {}", String::from_utf8_lossy(&stdout));
    String::from_utf8_lossy(&stderr).into_owned()
}

/// A scene of samples with these names, all of one seed, in a file.
fn scene(folder: &Path, names: &[&str], seed: u64) -> PathBuf {
    let sample =
        |name: &&str| format!("[[sample]]\nname = \"{name}\"\nseed = {seed}\nsource = {{ pressure = 800.0 }}\n");
    let samples: String = names.iter().map(sample).collect();
    let observables = "[observables.radial_profile]\n[observables.displacement_field]\n";
    let path = folder.join(format!("seed_{seed}.toml"));
    std::fs::write(&path, format!("disk_count = 120\n{observables}{samples}")).expect("written");
    path
}

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
}

/// The seeds that the files of a folder tell, with the file.
fn seeds(folder: &Path) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for name in names(folder) {
        let text = || std::fs::read_to_string(folder.join(&name)).expect("text");
        if name == "report.json" {
            let report: serde_json::Value = serde_json::from_str(&text()).expect("JSON");
            found.insert(report["scene"]["sample"][0]["seed"].to_string());
        } else if name.ends_with(".xyz") {
            let text = text();
            let seed = text.split_whitespace().find_map(|word| word.strip_prefix("seed=")).expect("a packing of a run");
            found.insert(seed.trim_matches('"').to_string());
        }
    }
    found
}

#[test]
fn names_are_measured_before_the_work() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    let said = refused(&mut run(&fixture("refused/name-too-long.toml"), &out));
    for part in ["sample.name", "aaaaaaaa", "characters) cannot be created in", "out"] {
        assert!(said.contains(part), "no {part:?} in {said}");
    }
    assert!(!out.exists(), "nothing is left of what was tried");
}

#[test]
fn a_folder_that_cannot_be_used_is_refused_before_the_work() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scene = scene(folder.path(), &["a"], 1);
    let file = folder.path().join("FILE");
    std::fs::write(&file, "mine").expect("written");
    for out in [folder.path().join("FILE/"), folder.path().join("FILE/inner")] {
        let said = refused(&mut run(&scene, &out));
        assert!(said.contains("FILE") && said.contains("could not be created"), "{said}");
        let mut analyse = Command::new(env!("CARGO_BIN_EXE_jamscope"));
        let packing = fixture("packings/hertz_N1000_p800.xyz");
        let said = refused(analyse.arg("analyse").args([&packing, &packing]).arg("--out").arg(&out));
        assert!(said.contains("FILE") && said.contains("could not be created"), "{said}");
        let mut study = Command::new(env!("CARGO_BIN_EXE_jamscope"));
        let said = refused(study.arg("study").arg(fixture("studies/b.toml")).arg("--out").arg(&out));
        assert!(said.contains("FILE"), "{said}");
    }
    assert_eq!(std::fs::read_to_string(&file).expect("there"), "mine");
    if Path::new("/proc/self").is_dir() {
        let said = refused(&mut run(&scene, Path::new("/proc/self")));
        assert!(said.contains("cannot write into the folder"), "{said}");
    }
}

#[test]
fn a_second_run_replaces_the_files_of_the_first_and_no_others() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    assert!(run(&scene(folder.path(), &["a", "b"], 1), &out).status().expect("it starts").success());
    let first = names(&out);
    assert!(first.contains("b.before.xyz") && first.contains("report.json"));
    for name in ["notes.txt", "c.before.xyz"] {
        std::fs::write(out.join(name), "mine").expect("written");
    }
    std::fs::write(out.join("b.radial_profile.csv"), "with my remarks").expect("written");
    assert!(run(&scene(folder.path(), &["a", "c"], 2), &out).status().expect("it starts").success());
    let second = names(&out);
    assert_eq!(second.iter().filter(|name| name.starts_with("b.")).collect::<Vec<_>>(), ["b.radial_profile.csv"]);
    let read = |name: &str| std::fs::read_to_string(out.join(name)).expect("there");
    assert_eq!([read("notes.txt"), read("c.before.xyz.~1~")], ["mine", "mine"]);
    assert_eq!(read("b.radial_profile.csv"), "with my remarks");
    // Nothing temporary is left.
    let hidden: Vec<&String> = second.iter().filter(|name| name.starts_with('.')).collect();
    assert_eq!(hidden, [".report.files.json"]);
}

#[test]
fn analyse_takes_no_files_of_earlier_runs() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (out, analysis) = (folder.path().join("out"), folder.path().join("analysis"));
    let analyse = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_jamscope"));
        let output = command.arg("analyse").arg(&out).arg("--out").arg(&analysis).output().expect("it starts");
        let said = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
        assert!(output.status.success(), "{said}");
        let text = std::fs::read_to_string(analysis.join("analysis.json")).expect("an analysis");
        let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let of = json["analyses"].as_array().expect("a list").iter();
        (said, of.map(|it| it["name"].as_str().expect("a name").to_string()).collect::<Vec<_>>())
    };
    assert!(run(&scene(folder.path(), &["a", "b"], 1), &out).status().expect("it starts").success());
    assert_eq!(analyse().1, ["a", "b"]);
    // Kept under another name, as whoever compares two runs might.
    for state in ["before", "displacement"] {
        std::fs::copy(out.join(format!("b.{state}.xyz")), out.join(format!("old.{state}.xyz"))).expect("copied");
    }
    // A pair that no run wrote is the user's own.
    for state in ["before", "displacement"] {
        let text = std::fs::read_to_string(out.join(format!("b.{state}.xyz"))).expect("text");
        let own = text.replacen("jamscope_version=", "made_by=", 1);
        std::fs::write(out.join(format!("own.{state}.xyz")), own).expect("written");
    }
    assert!(run(&scene(folder.path(), &["a"], 2), &out).status().expect("it starts").success());
    let (said, analysed) = analyse();
    assert_eq!(analysed, ["a", "own"]);
    assert!(said.contains("left out") && said.contains("old.before.xyz"), "{said}");
    assert_eq!(analyse().1, ["a", "own"]);
}

#[test]
fn killed_at_any_time_the_files_are_of_one_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    let scenes = [scene(folder.path(), &["a", "b"], 1), scene(folder.path(), &["a", "c"], 2)];
    assert!(run(&scenes[0], &out).status().expect("it starts").success());
    // What a whole run takes here, so that kills fall all over it.
    let start = std::time::Instant::now();
    assert!(run(&scenes[1], &out).status().expect("it starts").success());
    let whole = start.elapsed().as_millis() as u64;
    let mut random = Pcg64::seed_from_u64(45);
    let mut found = Vec::new();
    for round in 0..30 {
        let scene = &scenes[round % 2];
        let mut running = run(scene, &out).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts");
        std::thread::sleep(Duration::from_millis(random.random_range(1..whole + whole / 4)));
        running.kill().expect("it is killed, or done");
        running.wait().expect("it is gone");
        let seeds = seeds(&out);
        // Killed while files are moved: those of the last report may be gone and those of this one wait in a folder.
        let waits = names(&out).iter().any(|name| name.ends_with(".part.ready"));
        let least = if waits { 0 } else { 1 };
        assert!((least..=1).contains(&seeds.len()), "round {round}: {:?} of the seeds {seeds:?}", names(&out));
        found.extend(seeds);
        std::fs::write(out.join("notes.txt"), "mine").expect("written");
    }
    println!("seeds of the files after each kill: {found:?}");
    assert!(run(&scenes[0], &out).status().expect("it starts").success());
    let hidden: Vec<String> = names(&out).into_iter().filter(|name| name.starts_with('.')).collect();
    assert_eq!(hidden, [".report.files.json"], "what killed runs left is gone");
    assert_eq!((seeds(&out), names(&out).contains("notes.txt")), (BTreeSet::from(["1".to_string()]), true));
}
