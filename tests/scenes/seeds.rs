//! Seeds of the property tests: fixed ones, or those of `JAMSCOPE_SEED`.
//!
//! `JAMSCOPE_SEED` is a number, or `fresh` for a number from the clock. A failing test prints the command that repeats it. proptest adds
//! the failing case to `NAME.regressions` beside the source of the test, and runs the cases of that file first from then on.

use std::sync::OnceLock;
use std::time::{SystemTime, UNIX_EPOCH};

use proptest::test_runner::{Config, FileFailurePersistence, RngSeed};

const VARIABLE: &str = "JAMSCOPE_SEED";

/// The seed that was asked for; one per process.
fn chosen() -> Option<u64> {
    static CHOSEN: OnceLock<Option<u64>> = OnceLock::new();
    *CHOSEN.get_or_init(|| {
        let text = std::env::var(VARIABLE).ok().filter(|text| !text.is_empty())?;
        if text == "fresh" {
            let since = SystemTime::now().duration_since(UNIX_EPOCH).expect("a clock after 1970");
            return Some(since.as_nanos() as u64);
        }
        Some(text.parse().unwrap_or_else(|_| panic!("{VARIABLE} is a number or \"fresh\", not {text:?}")))
    })
}

/// The seed of a property test: `fixed`, or the one that was asked for, printed with the command that repeats the test.
pub fn seed(fixed: u64) -> u64 {
    let Some(seed) = chosen() else { return fixed };
    // The output of a test is shown if it fails. The name of its thread is that of the test.
    let thread = std::thread::current();
    let name = thread.name().filter(|&name| name != "main").unwrap_or("");
    println!("to repeat: {VARIABLE}={seed} cargo test --test {} -- {name}", env!("CARGO_CRATE_NAME"));
    seed
}

/// Configuration of a property test with this number of cases.
pub fn config(cases: u32, fixed: u64) -> Config {
    Config {
        cases,
        rng_seed: RngSeed::Fixed(seed(fixed)),
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        ..Config::default()
    }
}
