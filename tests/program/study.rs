//! Studies: the same bytes however they are run, failures as data, and folders that are not what they should be.

use std::collections::BTreeMap;
use std::path::Path;

use jamscope::inflation::Boundary;
use jamscope::law::{Hertzian, Hookean, LawChoice};
use jamscope::processor::Processor;
use jamscope::relax::{Fire, RelaxerChoice};
use jamscope::run::{SampleOutcome, run};
use jamscope::scene::{Observables, ProtocolChoice, Sample, Scene, Source};
use jamscope::study::{
    ExecuteError, FailureKind, MergeError, Part, Plan, Record, RecordOutcome, Seeds, Shard, StoreError, Study,
    StudyError, Target, execute, merge,
};

/// Two pressures, two increases, five seeds of 80 disks: ten packings, twenty samples.
fn study() -> Study {
    let mut scene = Scene { disk_count: 80, sample: Vec::new(), ..Scene::default() };
    scene.observables = Observables {
        radial_profile: Observables::default().radial_profile,
        contact_changes: Some(Default::default()),
        ..Observables::none()
    };
    Study {
        scene,
        targets: vec![Target::Pressure(500.0), Target::ReducedPressure(1e6)],
        increases: vec![0.1, 0.02],
        seeds: Seeds { first: 1, count: 5 },
        ..Study::default()
    }
}

fn whole(study: &Study, folder: &Path) -> jamscope::study::Execution {
    execute(study, folder, Shard::default(), false, &()).expect("it runs")
}

/// The bytes of everything a merge writes.
fn merged(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let merged = merge(folder).expect("a study is there");
    let read = |path: &std::path::PathBuf| {
        let name = path.file_name().expect("a file").to_string_lossy().into_owned();
        (name, std::fs::read(path).expect("written"))
    };
    merged.files.iter().map(read).collect()
}

fn records(folder: &Path) -> Vec<Record> {
    let text = String::from_utf8(merged(folder).remove("records.jsonl").expect("written")).expect("text");
    text.lines().map(|line| serde_json::from_str(line).expect("a record")).collect()
}

/// Files of samples, in the order of their names.
fn samples(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = std::fs::read_dir(folder.join("samples")).expect("a folder");
    let mut all: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    all.sort();
    all
}

#[test]
fn threads_shards_and_extensions_give_the_same_bytes() {
    let folders: Vec<_> = (0..4).map(|_| tempfile::tempdir().expect("a temporary folder")).collect();
    let [one, two, shards, extended] = [0, 1, 2, 3].map(|i| folders[i].path());
    #[cfg(feature = "parallel")]
    for (folder, threads) in [(one, 1), (two, 2)] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| whole(&study(), folder));
    }
    #[cfg(not(feature = "parallel"))]
    for folder in [one, two] {
        whole(&study(), folder);
    }
    for index in [2, 0, 3, 1] {
        let part = execute(&study(), shards, Shard { index, count: 4 }, false, &()).expect("it runs");
        assert!(part.run_count > 0 && part.found_count == 0, "{part:?}");
    }
    // Two seeds first, then the five of the study.
    let fewer = Study { seeds: Seeds { first: 1, count: 2 }, ..study() };
    assert_eq!(whole(&fewer, extended).run_count, 8);
    let all = execute(&study(), extended, Shard::default(), true, &()).expect("it takes the other's place");
    assert_eq!((all.run_count, all.found_count, all.foreign.len()), (12, 8, 0));
    let reference = merged(one);
    assert_eq!(reference.len(), 3);
    for folder in [two, shards, extended] {
        assert!(merged(folder) == reference, "the merged bytes differ");
    }
    let again = whole(&study(), one);
    assert_eq!((again.run_count, again.found_count), (0, 20));
}

#[test]
fn a_record_has_the_numbers_of_its_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    whole(&study(), folder.path());
    let records = records(folder.path());
    assert_eq!(records.len(), 20);
    let record = records.iter().find(|it| it.seed == 3 && it.cell.increase == 0.02).expect("in the study");
    let sample = Sample {
        name: "one".into(),
        seed: 3,
        source: Source::Pressure(500.0),
        relaxer: ProtocolChoice::default().relaxer(),
    };
    let mut scene = Scene { sample: vec![sample], ..study().scene };
    scene.inflation.increase = 0.02;
    let report = run(&scene, &()).expect("the scene makes sense");
    let SampleOutcome::Done(result) = &report.samples[0].result else { panic!("it comes to rest") };
    assert_eq!(record.number("pressure"), Some(result.packing.pressure));
    assert_eq!(record.number("pressure_change"), Some(result.inflation.pressure_change));
    let contacts = result.response.contact_changes.as_ref().expect("asked for");
    assert_eq!(record.number("contacts_kept"), Some(contacts.inflation.kept_count as f64));
    let RecordOutcome::Done { curves, .. } = &record.outcome else { panic!("done") };
    let profile = result.response.radial_profile.as_ref().expect("asked for");
    let rings: Vec<[f64; 2]> = profile.rings.iter().map(|ring| [ring.radius, ring.mean]).collect();
    // A curve is kept to six digits: half a unit of the last one over the least number of six digits.
    assert_eq!(curves["radial_profile"].len(), rings.len());
    for (kept, measured) in curves["radial_profile"].iter().flatten().zip(rings.iter().flatten()) {
        assert!((kept - measured).abs() <= 5.001e-6 * measured.abs(), "{kept} {measured}");
    }
    // p̂ = p N^(3/2), N = π 0.48² 80 = 57.9 disks in the circle by area; prepared within 1 % of what was asked.
    let reduced = records.iter().find(|it| it.cell.target == Target::ReducedPressure(1e6)).expect("in the study");
    let (p, reduced) =
        (reduced.number("pressure").expect("jammed"), reduced.number("reduced_pressure").expect("jammed"));
    let disks: f64 = std::f64::consts::PI * 0.48 * 0.48 * 80.0;
    assert!((reduced / (p * disks.powf(1.5)) - 1.0).abs() < 1e-12 && (reduced / 1e6 - 1.0).abs() < 0.01);
}

#[test]
fn statistics_stand_by_cell_in_the_order_of_the_plan() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    whole(&study(), folder.path());
    let merged = merge(folder.path()).expect("a study is there");
    assert_eq!((merged.sample_count, merged.record_count, merged.cells.len()), (20, 20, 4));
    let increases: Vec<f64> = merged.cells.iter().map(|cell| cell.cell.increase).collect();
    assert_eq!(increases, [0.1, 0.02, 0.1, 0.02]);
    let records = records(folder.path());
    for cell in &merged.cells {
        let values: Vec<f64> =
            records.iter().filter(|it| it.cell == cell.cell).filter_map(|it| it.number("pressure_change")).collect();
        let found = cell.numbers["pressure_change"];
        assert_eq!((cell.done_count, found.count), (5, 5));
        assert_eq!(found.mean, values.iter().sum::<f64>() / 5.0);
        let [low, high] = found.mean_interval.expect("five values");
        assert!(low <= found.mean && found.mean <= high);
    }
}

#[test]
fn every_row_of_the_table_has_its_columns() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    #[cfg(feature = "linear")]
    let relaxers = vec![RelaxerChoice::default(), RelaxerChoice::Staged(Default::default())];
    #[cfg(not(feature = "linear"))]
    let relaxers = vec![RelaxerChoice::default()];
    let few = Study { relaxers, seeds: Seeds { first: 1, count: 1 }, ..study() };
    whole(&few, folder.path());
    let text = String::from_utf8(merged(folder.path()).remove("summary.csv").expect("written")).expect("text");
    // Commas within quotes are no ends of fields.
    let count = |line: &str| line.split('"').step_by(2).map(|part| part.matches(',').count()).sum::<usize>();
    let expected = count(text.lines().next().expect("a header"));
    assert!(text.lines().count() > 20 && text.lines().all(|line| count(line) == expected));
    #[cfg(feature = "linear")]
    assert!(text.contains("\"FIRE, then Newton\""));
}

#[test]
fn failures_are_records_and_are_counted() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let no_steps = RelaxerChoice::Fire(Fire { step_limit: 1, ..Fire::default() });
    let few = Study {
        relaxers: vec![RelaxerChoice::default(), no_steps],
        seeds: Seeds { first: 1, count: 2 },
        targets: vec![Target::Pressure(500.0)],
        increases: vec![0.1],
        ..study()
    };
    let done = whole(&few, folder.path());
    assert_eq!(done.failures, BTreeMap::from([(FailureKind::InflationNotAtRest, 2)]));
    let merged = merge(folder.path()).expect("a study is there");
    assert_eq!(merged.cells[1].failures, done.failures);
    assert_eq!((merged.cells[0].done_count, merged.cells[1].done_count), (2, 0));
    // A nanosecond is over at the first look.
    let hurried = Study { time_limit: Some(1e-9), ..few.clone() };
    let folder = tempfile::tempdir().expect("a temporary folder");
    assert_eq!(whole(&hurried, folder.path()).failures, BTreeMap::from([(FailureKind::TimeLimit, 4)]));
}

#[test]
fn files_that_are_not_what_they_should_be_are_named_and_left_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    whole(&study(), folder.path());
    let reference = merged(folder.path());
    let files = samples(folder.path());
    assert_eq!(files.len(), 10);
    let text = |path: &Path| std::fs::read_to_string(path).expect("text");
    let (cut, changed, swapped) = (text(&files[0]), text(&files[1]), text(&files[2]));
    std::fs::write(&files[0], &cut[..cut.len() / 2]).expect("written");
    std::fs::write(&files[1], changed.replacen("\"seed\":", "\"seed\":1", 1)).expect("written");
    std::fs::write(&files[2], text(&files[3])).expect("written");
    std::fs::write(folder.path().join("samples").join("notes.txt"), "mine").expect("written");
    let done = whole(&study(), folder.path());
    assert_eq!((done.run_count, done.damaged.len(), done.foreign.len()), (0, 3, 1));
    let reasons: Vec<&str> = done.damaged.iter().map(|problem| problem.reason.as_str()).collect();
    assert_eq!(reasons[0], "incomplete: the file must have three lines");
    assert_eq!(reasons[1], "line 2: changed since it was written (checksum)");
    assert_eq!(reasons[2], "contains the records of another sample");
    assert_eq!(text(&files[0]), cut[..cut.len() / 2], "left alone");
    let partial = merge(folder.path()).expect("a study is there");
    assert_eq!((partial.record_count, partial.damaged.len(), partial.foreign.len()), (14, 3, 1));
    // Moved away, they are run again, and all is as before.
    for path in [&files[0], &files[1], &files[2], &folder.path().join("samples").join("notes.txt")] {
        std::fs::remove_file(path).expect("removed");
    }
    assert_eq!(whole(&study(), folder.path()).run_count, 6);
    assert_eq!(text(&files[2]).lines().nth(1), swapped.lines().nth(1));
    assert!(merged(folder.path()) == reference);
}

#[test]
fn records_of_processors_with_other_vectors_are_told_apart() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    whole(&study(), folder.path());
    let own = Processor::own().vectors().name();
    let alike = merge(folder.path()).expect("a study is there");
    assert_eq!(alike.records_by_vectors, BTreeMap::from([(own.to_string(), alike.record_count)]));
    assert_eq!(alike.mixed_vectors(), None);
    // One file as another processor would write it, one as before files said so.
    let files = samples(folder.path());
    let named = format!("\"vectors\":\"{own}\"");
    let change = |file: &Path, with: &str| {
        let text = std::fs::read_to_string(file).expect("text");
        assert!(text.lines().next().is_some_and(|line| line.contains(&named)), "the first line names them");
        std::fs::write(file, text.replacen(&named, with, 1)).expect("written");
    };
    change(&files[0], "\"vectors\":\"neon\"");
    change(&files[1], "\"vectors\":null");
    let mixed = merge(folder.path()).expect("a study is there");
    assert_eq!(mixed.record_count, alike.record_count);
    assert_eq!((mixed.records_by_vectors["neon"], mixed.records_by_vectors["not recorded"]), (2, 2));
    let words = mixed.mixed_vectors().expect("three kinds");
    assert!(words.contains("neon: 2") && words.contains("factorisation"), "{words}");
    let summary = String::from_utf8(merged(folder.path()).remove("summary.json").expect("written")).expect("text");
    assert!(summary.contains("\"neon\": 2"), "the summary counts them");
    // What no processor has is damage, with its line.
    let text = std::fs::read_to_string(&files[2]).expect("text");
    std::fs::write(&files[2], text.replacen(&named, "\"vectors\":\"avx3\"", 1)).expect("written");
    let damaged = merge(folder.path()).expect("a study is there").damaged;
    assert!(damaged.len() == 1 && damaged[0].reason.starts_with("line 1: unknown variant `avx3`"), "{damaged:?}");
}

#[test]
fn another_study_and_another_process_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let small = Study { seeds: Seeds { first: 1, count: 1 }, ..study() };
    whole(&small, folder.path());
    let other = Study { increases: vec![0.05], ..small.clone() };
    let refused = execute(&other, folder.path(), Shard::default(), false, &()).expect_err("another study");
    assert!(matches!(refused, ExecuteError::Store(StoreError::OtherStudy { .. })), "{refused}");
    // In its place, what the two have not in common is left alone and not mixed in.
    let done = execute(&other, folder.path(), Shard::default(), true, &()).expect("it takes the other's place");
    assert_eq!((done.run_count, done.foreign.len()), (2, 2));
    assert_eq!(merge(folder.path()).expect("a study is there").record_count, 2);
    let lock = std::fs::File::options().write(true).open(folder.path().join(".lock-0-of-1")).expect("left behind");
    lock.lock().expect("nobody has it");
    let refused = execute(&other, folder.path(), Shard::default(), false, &()).expect_err("locked");
    assert!(matches!(refused, ExecuteError::Store(StoreError::Locked { .. })), "{refused}");
    // Another part of it is no conflict.
    execute(&other, folder.path(), Shard { index: 1, count: 2 }, false, &()).expect("it runs");
    drop(lock);
    whole(&other, folder.path());
}

#[test]
fn folders_that_cannot_be_used_are_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let taken = folder.path().join("taken");
    std::fs::write(&taken, "").expect("written");
    let message = execute(&study(), &taken, Shard::default(), false, &()).expect_err("a file").to_string();
    assert!(message.contains("taken"), "{message}");
    assert!(matches!(merge(folder.path()), Err(MergeError::Store(StoreError::NoStudy { .. }))));
    std::fs::write(folder.path().join("study.json"), "{").expect("written");
    assert!(matches!(merge(folder.path()), Err(MergeError::Store(StoreError::Unreadable { .. }))));
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let held = folder.path().join("held");
    std::fs::create_dir(&held).expect("made");
    let mut permissions = std::fs::metadata(&held).expect("there").permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&held, permissions).expect("set");
    // Who may write everywhere may not write to the system's own tree.
    let writable = std::fs::write(held.join("probe"), "").is_ok();
    let out = if writable { std::path::PathBuf::from("/sys/jamscope-study") } else { held.join("study") };
    let refused = execute(&study(), &out, Shard::default(), false, &()).expect_err("nobody writes there");
    assert!(matches!(refused, ExecuteError::Store(_)), "{refused}");
    assert!(refused.to_string().contains("study"), "{refused}");
}

#[test]
fn parts_have_lists_of_their_own_and_share_the_rest() {
    let boundary = Boundary::HeldRim { outer_radius_over_side: 0.45 };
    let part = |disk_counts: Vec<usize>, seeds, boundary| Part { disk_counts, seeds, boundary, ..Part::default() };
    let two = Seeds { first: 5, count: 2 };
    let parts = vec![part(vec![60], Some(two), None), part(vec![70, 90], None, Some(boundary))];
    let parted = Study { parts, ..study() };
    let plan = Plan::of(&parted).expect("it makes sense");
    // Two targets of two seeds, and two sizes of two targets of five seeds.
    assert_eq!(plan.tasks.len(), 4 + 20);
    let scene = |index: usize| plan.tasks[index].scenes().swap_remove(0);
    assert_eq!((scene(0).disk_count, scene(0).sample[0].seed, scene(4).disk_count), (60, 5, 70));
    assert_eq!((scene(3).inflation.boundary, scene(4).inflation.boundary), (Boundary::default(), boundary));
    assert!(plan.tasks.iter().enumerate().all(|(index, task)| task.index == index && task.scene_count() == 2));
    // A part that says all there is is the study itself, sample for sample.
    let whole = Study { parts: vec![Part::default()], ..study() };
    assert_eq!(Plan::of(&whole), Plan::of(&study()));
    let twice = Study { parts: vec![part(vec![60], None, None), part(vec![60], Some(two), None)], ..study() };
    let Err(StudyError::PartsOverlap { part, disk_count, seed, .. }) = Plan::of(&twice) else {
        panic!("the same packing twice")
    };
    assert_eq!((part, disk_count, seed), (2, 60, 5));
    let message = Plan::of(&Study { parts: vec![Part { disk_counts: vec![0], ..Part::default() }], ..study() });
    assert!(message.expect_err("no disks").to_string().contains("disk_count"));
}

#[test]
fn a_study_that_makes_no_sense_says_where() {
    let wrong = |change: fn(&mut Study)| {
        let mut study = study();
        change(&mut study);
        Plan::of(&study).expect_err("it makes no sense").to_string()
    };
    assert_eq!(wrong(|it| it.targets.clear()), "targets: must not be empty");
    assert_eq!(wrong(|it| it.seeds.count = 0), "seeds.count: must not be empty");
    assert_eq!(wrong(|it| it.increases.push(0.1)), "increases: 0.1 occurs twice");
    assert_eq!(wrong(|it| it.time_limit = Some(0.0)), "time_limit = 0: must be a positive number");
    assert!(wrong(|it| it.targets.push(Target::Pressure(-1.0))).contains("source.pressure = -1"));
    assert!(wrong(|it| it.seeds.first = u64::MAX).contains("beyond the largest seed"));
    let mut named = study();
    named.scene.sample = Scene::default().sample;
    assert_eq!(Plan::of(&named), Err(StudyError::SamplesNamed));
    let laws = vec![LawChoice::Hertzian(Hertzian::default()), LawChoice::Hookean(Hookean::default())];
    let plan = Plan::of(&Study { laws, ..study() }).expect("it makes sense");
    assert_eq!((plan.tasks.len(), plan.sample_count()), (20, 40));
}
