//! Scenes, studies and packings damaged at random: no panic, no hang, and a refusal that names file and field or line.
//!
//! ```text
//! JAMSCOPE_FUZZ_SEED=7 JAMSCOPE_FUZZ_COUNT=20000 cargo test --test program fuzz
//! ```
//!
//! Without these variables the seed is [`SEED`] and each kind has [`COUNT`] cases. A case that fails is written to the folder for
//! temporary files; its path, seed and number are printed. What ends the whole process is left there in a folder `jamscope-fuzz-…`.

mod commands;
#[path = "../../../src/cli/contact_law.rs"]
mod contact_law;
mod corpus;
mod mutation;
#[path = "../../../src/cli/scene_file.rs"]
mod scene_file;
mod subjects;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;
use std::time::Duration;

use mutation::{Random, mutated};

/// Seed of the cases.
const SEED: u64 = 45;

/// Cases of each kind.
const COUNT: u64 = 1000;

/// Longest time for one case: they take milliseconds.
const TIME_LIMIT: Duration = Duration::from_secs(10);

/// So many failures are collected before the test ends.
const FAILURES: usize = 10;

/// What is wrong with how a case was met; nothing, where nothing is.
type Fault = Option<String>;

/// A number from the environment.
fn from_environment(name: &str, default: u64) -> u64 {
    match std::env::var(name) {
        Ok(text) => text.parse().unwrap_or_else(|_| panic!("{name} is `{text}`, not a whole number")),
        Err(_) => default,
    }
}

/// Mutates the texts of a corpus and hands each to `meet`, as a file of this name.
fn fuzz(name: &str, corpus: &[Vec<u8>], share: u64, meet: fn(&Path) -> Fault) {
    let seed = from_environment("JAMSCOPE_FUZZ_SEED", SEED);
    let count = from_environment("JAMSCOPE_FUZZ_COUNT", COUNT) / share;
    let folder = tempfile::Builder::new().prefix("jamscope-fuzz-").tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    for (index, text) in corpus.iter().enumerate() {
        std::fs::write(&path, text).expect("a temporary file");
        assert_eq!(met(&path, meet), None, "text {index} of the corpus is met badly before anything is changed");
    }
    let mut faults = Vec::new();
    for case in 0..count {
        let mut random = Random::of(seed, case);
        let text = mutated(&corpus[random.below(corpus.len())], &mut random);
        std::fs::write(&path, &text).expect("a temporary file");
        if let Some(fault) = met(&path, meet) {
            let kept = std::env::temp_dir().join(format!("jamscope-fuzz-{seed}-{case}-{name}"));
            std::fs::write(&kept, &text).expect("a temporary file");
            faults.push(format!("seed {seed}, case {case}, {}: {fault}", kept.display()));
        }
        if faults.len() == FAILURES {
            break;
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The fault of one case, panics and hangs included.
fn met(path: &Path, meet: fn(&Path) -> Fault) -> Fault {
    let (sender, receiver) = channel();
    let path: PathBuf = path.into();
    // A thread that hangs cannot be ended from outside; it goes with the process.
    let thread = std::thread::spawn(move || {
        let fault = catch_unwind(AssertUnwindSafe(|| meet(&path)));
        let said = |panic: Box<dyn std::any::Any + Send>| {
            let text = panic.downcast_ref::<String>().cloned();
            text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned())).unwrap_or_default()
        };
        let _ = sender.send(fault.unwrap_or_else(|panic| Some(format!("panicked: {}", said(panic)))));
    });
    let fault = receiver.recv_timeout(TIME_LIMIT);
    if fault.is_ok() {
        let _ = thread.join();
    }
    fault.unwrap_or_else(|_| Some(format!("nothing after {} s", TIME_LIMIT.as_secs())))
}

#[test]
fn mutated_packings_are_read_or_refused() {
    fuzz("case.packing", corpus::packings(), 1, subjects::packing);
}

#[test]
fn mutated_scenes_are_read_or_refused() {
    fuzz("case.scene.toml", &corpus::scenes(), 1, subjects::scene);
}

#[test]
fn mutated_studies_are_read_or_refused() {
    fuzz("case.study.toml", &corpus::studies(), 1, subjects::study);
}

/// Starting the program takes longer than reading: one in so many of the cases.
const STARTED: u64 = 25;

#[test]
fn the_program_meets_mutated_packings() {
    fuzz("case.inspected", corpus::packings(), STARTED, commands::inspect);
}

#[test]
fn the_program_meets_mutated_states() {
    fuzz("case.after.xyz", &corpus::run_files()[1..2], STARTED, commands::analyse);
}

#[test]
fn the_program_meets_mutated_studies() {
    fuzz("case.planned.toml", &corpus::studies(), STARTED, commands::plan);
}

#[test]
fn a_panic_and_a_hang_are_found() {
    fn panics(_: &Path) -> Fault {
        panic!("on purpose")
    }
    fn sleeps(_: &Path) -> Fault {
        std::thread::sleep(TIME_LIMIT + Duration::from_secs(60));
        None
    }
    assert_eq!(met(Path::new("x"), panics), Some("panicked: on purpose".into()));
    assert_eq!(met(Path::new("x"), sleeps), Some("nothing after 10 s".into()));
}
