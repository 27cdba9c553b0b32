//! The folder of a study: its lock, what is refused before anything is written, and what dead processes left.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

fn study(file: &Path, out: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_jamscope"));
    command.arg("study").arg(file).args(more).arg("--out").arg(out);
    command
}

/// A study that is refused, and what it says.
fn refused(command: &mut Command) -> String {
    refusal(command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts"))
}

fn refusal(started: Child) -> String {
    let output = started.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stdout));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A study that has begun: its samples are being made.
fn running(file: &Path, out: &Path, more: &[&str]) -> Child {
    let running = study(file, out, more).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("it starts");
    let start = Instant::now();
    while !out.join("study.json").exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "the study does not begin");
        std::thread::sleep(Duration::from_millis(2));
    }
    running
}

fn finished(running: Child) -> String {
    let output = running.wait_with_output().expect("it ends");
    assert!(output.status.success());
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_study_that_runs_is_not_replaced() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("s");
    // With twenty times the samples, on one thread, the first takes much longer than the others wait for its lock, on a busy machine too.
    let (a, b) = (folder.path().join("a.toml"), fixture("studies/b.toml"));
    let text = std::fs::read_to_string(fixture("studies/a.toml")).expect("a fixture");
    std::fs::write(&a, text.replace("count=12", "count=240")).expect("written");
    let mut first = running(&a, &out, &["--threads", "1"]);
    let plan = std::fs::read(out.join("study.json")).expect("there");
    // A part of the other study is no way in either. All wait at once.
    let tries = [&["--replace"][..], &[], &["--replace", "--shard", "1/7"]].map(|more| {
        let mut command = study(&b, &out, more);
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts")
    });
    let [replacing, other, part] = tries.map(refusal);
    assert!(replacing.contains("locked") && replacing.contains("nothing was changed"), "{replacing}");
    assert!(other.contains("another study"), "{other}");
    assert!(part.contains("locked"), "{part}");
    assert!(std::fs::read(out.join("study.json")).expect("there") == plan, "a refused study changes nothing");
    assert!(first.try_wait().expect("it can be asked").is_none(), "the first still runs");
    first.kill().expect("it is killed");
    first.wait().expect("it is gone");
    // Once it has ended, it may be replaced; its samples stay.
    let text = finished(study(&b, &out, &["--replace"]).stdout(Stdio::piped()).spawn().expect("it starts"));
    assert!(text.contains("5 samples: 5 run"), "{text}");
    let records = std::fs::read_to_string(out.join("records.jsonl")).expect("merged");
    assert_eq!(records.matches("\"disk_count\":300").count(), 5);
}

#[test]
fn parts_of_one_study_run_side_by_side() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (out, b) = (folder.path().join("s"), fixture("studies/b.toml"));
    let first = running(&b, &out, &["--shard", "1/2"]);
    let second = running(&b, &out, &["--shard", "2/2"]);
    assert!(finished(first).contains("3 samples: 3 run"));
    assert!(finished(second).contains("2 samples: 2 run"));
}

#[test]
fn parts_that_start_at_once_in_an_empty_folder_all_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let b = fixture("studies/b.toml");
    // The second time the study takes the place of another one, as where samples are added.
    for out in [folder.path().join("new"), folder.path().join("new")] {
        if out.exists() {
            let other = std::fs::read_to_string(out.join("study.json")).expect("there").replace("800.0", "700.0");
            std::fs::write(out.join("study.json"), other).expect("written");
        }
        let part = |index: usize| {
            let shard = format!("{index}/8");
            let mut command = study(&b, &out, &["--replace", "--threads", "1", "--shard", &shard]);
            command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts")
        };
        let parts: Vec<Child> = (1..=8).map(part).collect();
        for part in parts {
            let output = part.wait_with_output().expect("it ends");
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        }
    }
}

#[test]
fn a_killed_study_that_is_replaced_keeps_no_results_of_the_first() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (out, b) = (folder.path().join("s"), fixture("studies/b.toml"));
    // Where there is no study, a file of this name is none of a study.
    std::fs::create_dir(&out).expect("made");
    std::fs::write(out.join("transition.csv"), "mine").expect("written");
    finished(study(&b, &out, &["--shard", "1/5"]).stdout(Stdio::piped()).spawn().expect("it starts"));
    assert_eq!(std::fs::read_to_string(out.join("transition.csv")).expect("there"), "mine");
    finished(study(&b, &out, &[]).stdout(Stdio::piped()).spawn().expect("it starts"));
    let plan = std::fs::read(out.join("study.json")).expect("there");
    let mut second =
        study(&fixture("studies/a.toml"), &out, &["--replace"]).stdout(Stdio::null()).spawn().expect("it starts");
    let start = Instant::now();
    while std::fs::read(out.join("study.json")).expect("there") == plan && start.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(1));
    }
    second.kill().expect("killed");
    second.wait().expect("gone");
    assert!(std::fs::read(out.join("study.json")).expect("there") != plan);
    for name in ["records.jsonl", "summary.json", "summary.csv"] {
        assert!(!out.join(name).exists(), "{name} is of the study before");
    }
}

#[test]
fn numbers_that_cannot_be_written_and_empty_studies_are_refused_before_the_work() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    #[cfg(feature = "fit")]
    {
        let said = refused(&mut study(&fixture("refused/significance-nan.toml"), &out, &[]));
        assert!(said.contains("significance-nan.toml") && said.contains("profile_fit: significance NaN"), "{said}");
    }
    let said = refused(&mut study(&fixture("refused/threshold-inf.toml"), &out, &[]));
    let field = "observables.angular_correlation.correlation.thresholds[0] = -inf: must be a finite number";
    assert!(said.contains("threshold-inf.toml") && said.contains(field), "{said}");
    let empty = folder.path().join("empty.toml");
    for content in ["", " \n\n"] {
        std::fs::write(&empty, content).expect("written");
        let said = refused(&mut study(&empty, &out, &[]));
        assert!(said.contains("empty.toml: the file is empty") && said.contains("--recipe"), "{said}");
    }
    std::fs::write(&empty, "time_limit = inf\n").expect("written");
    let said = refused(&mut study(&empty, &out, &[]));
    assert!(said.contains("time_limit = inf"), "{said}");
    assert!(!out.exists());
}

#[test]
fn temporary_files_of_dead_processes_go_and_those_of_live_ones_stay() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (out, b) = (folder.path().join("s"), fixture("studies/b.toml"));
    finished(study(&b, &out, &[]).stdout(Stdio::piped()).spawn().expect("it starts"));
    let samples = out.join("samples");
    let part = |random: &str| samples.join(format!(".0123456789abcdef01234567.jsonl{random}.part"));
    let [dead, live, foreign] = [part("Ab3dEf"), part("Gh4jKl"), samples.join(".video.mp4Ab3dEf.part")];
    let of_results = out.join(".summary.jsonAb3dEf.part");
    for path in [&dead, &live, &foreign, &of_results] {
        std::fs::write(path, "half").expect("written");
    }
    let file = std::fs::File::open(&live).expect("there");
    file.lock().expect("nobody has it");
    finished(study(&b, &out, &[]).stdout(Stdio::piped()).spawn().expect("it starts"));
    assert!(!dead.exists() && !of_results.exists());
    assert!(live.exists() && foreign.exists());
    drop(file);
    finished(study(&b, &out, &[]).stdout(Stdio::piped()).spawn().expect("it starts"));
    assert!(!live.exists());
}
