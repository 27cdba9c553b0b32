//! `jamscope study` as its user meets it: killed and resumed, on a full disk, sharded by Slurm, and what it prints.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const STUDY: &str = "targets = [{ pressure = 500.0 }, { reduced_pressure = 1e6 }]
increases = [0.1, 0.02]
seeds = { first = 1, count = 12 }
[scene]
disk_count = 120
[scene.observables.radial_profile]
[scene.observables.contact_changes]
";

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_jamscope"))
}

fn study_in(folder: &Path) -> std::path::PathBuf {
    let path = folder.join("study.toml");
    std::fs::write(&path, STUDY).expect("written");
    path
}

/// All files but those of samples, locks and the study itself.
fn merged(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let output = program().arg("merge").arg(folder).output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| (name.to_string(), std::fs::read(folder.join(name)).expect("written"));
    ["records.jsonl", "summary.json", "summary.csv"].map(read).into_iter().collect()
}

fn whole(study: &Path, out: &Path) -> String {
    let output = program().arg("study").arg(study).arg("--out").arg(out).output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("Unicode")
}

/// Packings whose file is there.
fn packings_done(out: &Path) -> usize {
    let whole =
        |name: &std::ffi::OsStr| name.to_string_lossy().ends_with(".jsonl") && !name.to_string_lossy().starts_with('.');
    std::fs::read_dir(out.join("samples")).map_or(0, |entries| {
        entries.filter(|entry| entry.as_ref().is_ok_and(|entry| whole(&entry.file_name()))).count()
    })
}

#[test]
fn killed_twenty_times_and_resumed_it_gives_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let study = study_in(folder.path());
    let (reference, out) = (folder.path().join("reference"), folder.path().join("out"));
    let text = whole(&study, &reference);
    assert!(text.starts_with("48 samples: 48 run, 0 already present"), "{text}");
    let mut random = Pcg64::seed_from_u64(20);
    // Packings done after each kill.
    let mut done = Vec::new();
    for kill in 0..20 {
        let mut running = program()
            .args(["study", "--threads", "1"])
            .arg(&study)
            .arg("--out")
            .arg(&out)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts");
        // Half of the kills come at a random time, half after another packing is done, however busy the machine is.
        let (before, start) = (packings_done(&out), Instant::now());
        while kill % 2 == 1 && packings_done(&out) <= before.min(22) && start.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(random.random_range(2..80) / (1 + 7 * (kill % 2))));
        running.kill().expect("it is killed, or done");
        running.wait().expect("it is gone");
        done.push(packings_done(&out));
    }
    println!("packings done after each kill: {done:?}");
    assert!(done.iter().any(|&count| 0 < count && count < 24), "no kill came in the middle: {done:?}");
    whole(&study, &out);
    assert!(merged(&out) == merged(&reference), "the merged bytes differ");
}

#[cfg(unix)]
#[test]
fn a_full_disk_ends_in_a_message_and_half_a_file_is_none() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (study, out) = (study_in(folder.path()), folder.path().join("out"));
    // A limit on the size of files, 1 kB, refuses writes as a full disk does.
    let script = format!(
        "trap '' XFSZ; ulimit -f 1; exec '{}' study '{}' --out '{}'",
        env!("CARGO_BIN_EXE_jamscope"),
        study.display(),
        out.display()
    );
    let output = Command::new("bash").args(["-c", &script]).output().expect("a shell");
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("jamscope: ") && message.contains("out"), "{message}");
    // With room again it goes on, and what is there is sound.
    whole(&study, &out);
    let reference = folder.path().join("reference");
    whole(&study, &reference);
    assert!(merged(&out) == merged(&reference));
}

#[test]
fn shards_come_from_the_arguments_or_from_slurm() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (study, out) = (study_in(folder.path()), folder.path().join("out"));
    let reference = folder.path().join("reference");
    whole(&study, &reference);
    let part = |arguments: &[&str], environment: &[(&str, &str)]| {
        let mut command = program();
        command.arg("study").arg(&study).arg("--out").arg(&out).args(arguments).envs(environment.iter().copied());
        let output = command.output().expect("the program starts");
        (
            output.status.success(),
            String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr),
        )
    };
    let slurm = |task: &'static str| {
        [("SLURM_ARRAY_TASK_ID", task), ("SLURM_ARRAY_TASK_COUNT", "3"), ("SLURM_ARRAY_TASK_MIN", "5")]
    };
    assert!(part(&[], &slurm("5")).1.starts_with("16 samples: 16 run"));
    assert!(part(&[], &slurm("7")).0);
    let (there, text) = part(&[], &slurm("9"));
    assert!(!there && text.contains("SLURM_ARRAY_TASK_ID is 9"), "{text}");
    assert!(part(&["--shard", "2/3"], &[]).1.starts_with("16 samples: 16 run"));
    assert!(!part(&["--shard", "4/3"], &[]).0);
    assert!(merged(&out) == merged(&reference));
}

#[test]
fn a_dry_run_prints_the_plan_and_runs_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (study, out) = (study_in(folder.path()), folder.path().join("out"));
    let dry = || {
        let output = program().args(["study", "--dry-run"]).arg(&study).arg("--out").arg(&out).output();
        String::from_utf8(output.expect("the program starts").stdout).expect("Unicode")
    };
    let text = dry();
    assert!(text.contains("120 disks, pressure 500: 12 packings, 2 inflations each, 0 done"), "{text}");
    assert!(text.contains("24 packings, 48 samples") && !out.exists());
    let part = program().args(["study", "--shard", "1/4"]).arg(&study).arg("--out").arg(&out).output();
    assert!(part.expect("the program starts").status.success());
    assert!(dry().contains("3 done, "), "{}", dry());
}

#[test]
#[cfg(feature = "linear")]
#[ignore = "a packing of the book's study: the weekly tier runs it"]
fn the_study_of_seeds_has_the_plastic_sample_of_the_first_run() {
    use jamscope::processor::{Processor, Vectors};

    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/book/studies/plastic_seeds.toml");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    let study = |path: &std::path::Path, more: &[&str]| {
        let output = program().arg("study").arg(path).arg("--out").arg(&out).args(more).output();
        String::from_utf8(output.expect("the program starts").stdout).expect("Unicode")
    };
    let plan = study(file.as_ref(), &["--dry-run"]);
    assert!(plan.contains("5548 disks, pressure 10: 100 packings, 1 inflations each, 0 done"), "{plan}");
    // One of them alone: its seed in the built-in scene, where what evidence speaks says plastic.
    let one = folder.path().join("one.toml");
    let text = std::fs::read_to_string(file).expect("a file of the book");
    let all_seeds = "seeds = { first = 1, count = 100 }";
    assert!(text.contains(all_seeds));
    std::fs::write(&one, text.replace(all_seeds, "seeds = { first = 1, count = 1 }")).expect("written");
    study(&one, &[]);
    let summary = std::fs::read_to_string(out.join("summary.json")).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
    // On processors with other vectors a factorisation may lead to another minimum.
    let plastic = if Processor::own().vectors() == Vectors::Avx512 { vec![1] } else { vec![0, 1] };
    let found = summary["cells"][0]["phases"]["plastic"].as_u64().expect("a count");
    assert!(plastic.contains(&found), "{}", summary["cells"][0]["phases"]);
    assert_eq!(summary["cells"][0]["done_count"], 1);
}

#[test]
fn a_bad_study_is_refused_by_file_and_field() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("study.toml");
    let complaint = |content: &str| {
        std::fs::write(&path, content).expect("written");
        let output = program().arg("study").arg(&path).output().expect("the program starts");
        assert_eq!(output.status.code(), Some(1));
        String::from_utf8(output.stderr).expect("Unicode")
    };
    let unknown = complaint("presures = [1]");
    assert!(
        unknown.contains("study.toml: ") && unknown.contains("line 1") && unknown.contains("unknown field `presures`"),
        "{unknown}"
    );
    assert!(complaint("targets = [{ pressure = -3.0 }]").contains("source.pressure = -3"));
    assert!(complaint("increases = [0.1, 0.1]").contains("increases: 0.1 occurs twice"));
    assert!(
        complaint("[[scene.sample]]\nname = \"a\"\nsource = { pressure = 1.0 }")
            .contains("scene.sample: must be absent")
    );
}

#[test]
fn a_recipe_is_a_study_that_can_be_printed_changed_and_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let run = |arguments: &[&str]| {
        let output = program().args(arguments).current_dir(folder.path()).output().expect("the program starts");
        (
            output.status.success(),
            String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr),
        )
    };
    let (done, text) = run(&["study", "--recipe", "periodic", "--print"]);
    assert!(done, "{text}");
    // What is printed is read back as the same study: its plan is the recipe's.
    std::fs::write(folder.path().join("periodic.toml"), &text).expect("written");
    let plan = |arguments: &[&str]| run(arguments).1;
    let expected = plan(&["study", "--recipe", "periodic", "--dry-run"]);
    assert!(expected.contains("2774 disks, pressure 3500: 10 packings, 1 inflations each, 0 done"), "{expected}");
    assert_eq!(plan(&["study", "periodic.toml", "--dry-run"]), expected);
    // Another protocol, another relaxer and fewer seeds are other studies.
    let (done, other) = run(&["study", "--recipe", "kappa", "--seeds", "3", "--protocol", "fire", "--print"]);
    assert!(done && other.contains("count = 3\n") && other.contains("relaxers.fire"), "{other}");
    let (done, other) = run(&["study", "--recipe", "kappa", "--relaxer", "quasi_newton", "--print"]);
    assert!(done && other.contains("[relaxers.quasi_newton]"), "{other}");
    let (done, refusal) = run(&["study", "--recipe", "kappa", "--relaxer", "fier", "--print"]);
    assert!(!done && refusal.contains("unknown variant `fier`"), "{refusal}");
    #[cfg(feature = "linear")]
    {
        let (done, other) = run(&["study", "--recipe", "kappa", "--print"]);
        assert!(done && other.contains("relaxers.implicit.damping.viscoelastic]\nrate = 500.0"), "{other}");
        assert_eq!(run(&["study", "--recipe", "kappa", "--protocol", "study", "--print"]).1, other);
        // Two protocols, from the same packings.
        let (done, other) = run(&["study", "--recipe", "spheres", "--protocol", "study,constant", "--print"]);
        assert!(done && other.contains("dimension = 3\n") && other.matches("[[relaxers]]").count() == 2, "{other}");
        let (done, refusal) = run(&["study", "--recipe", "spheres", "--protocol", "fire,fire", "--print"]);
        assert!(!done && refusal.contains("relaxers: FIRE occurs twice"), "{refusal}");
        // A study file names a protocol or relaxers.
        let file = |text: &str| std::fs::write(folder.path().join("by_name.toml"), text).expect("written");
        file("protocol = \"constant\"\n");
        let (done, named) = run(&["study", "by_name.toml", "--print"]);
        assert!(done && named.contains("relaxers.implicit.damping.constant]\nrate = 500.0"), "{named}");
        file("protocol = \"constant\"\nrelaxers = [{ fire = {} }]\n");
        let (done, refusal) = run(&["study", "by_name.toml", "--print"]);
        assert!(!done && refusal.contains("protocol and relaxers: give only one of them"), "{refusal}");
        file("protocol = \"newton\"\n");
        let (done, refusal) = run(&["study", "by_name.toml", "--print"]);
        assert!(!done && refusal.contains("protocol") && refusal.contains("newton"), "{refusal}");
    }
    let (done, refusal) = run(&["study", "--recipe", "kappa", "--seeds", "0", "--dry-run"]);
    assert!(!done && refusal.contains("seeds.count"), "{refusal}");
    // Smaller, it is run, merged and reported in one go.
    let smaller = text.replace("2774", "150").replace("count = 10", "count = 4");
    std::fs::write(folder.path().join("smaller.toml"), smaller).expect("written");
    let (done, text) = run(&["study", "smaller.toml", "--out", "out"]);
    assert!(done && text.contains("4 samples: 4 run") && text.contains("4 of 4 samples"), "{text}");
    assert!(folder.path().join("out").join("summary.csv").exists());
    #[cfg(feature = "fit")]
    {
        let read = |name: &str| std::fs::read_to_string(folder.path().join("out").join(name)).expect("written");
        assert!(read("transition.csv").starts_with("quantity,of,value,low,high,published,verdict"));
        let parsed: serde_json::Value = serde_json::from_str(&read("transition.json")).expect("JSON");
        assert_eq!(parsed["series"].as_array().map(Vec::len), Some(1));
        #[cfg(feature = "plot")]
        {
            let page = read("report.html");
            assert!(page.contains("Angular modes, periodic box, 150 disks") && !page.contains("NaN"), "no modes");
            // Another merge gives the same bytes.
            assert!(run(&["merge", "out"]).0 && read("report.html") == page);
        }
    }
    let (done, text) = run(&["study", "--recipe", "nonsense"]);
    assert!(!done && text.contains("order-parameters"), "{text}");
    let (done, text) = run(&["study"]);
    assert!(!done && text.contains("--recipe"), "{text}");
}
