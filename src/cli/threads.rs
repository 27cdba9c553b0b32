//! `--threads`: the number of threads of a command.

#[cfg(feature = "parallel")]
use jamscope::memory::Limit;

use crate::Failure;

/// Largest useful number of threads: more than the number of processors gain nothing, and thousands wait for each
/// other.
#[cfg(feature = "parallel")]
fn limit() -> Limit {
    let processors = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    Limit { largest: (4 * processors as u64).max(256), reason: "four per processor, but at least 256" }
}

/// The stack of a thread \[bytes\].
#[cfg(feature = "parallel")]
const STACK: f64 = 2.0 * 1024.0 * 1024.0;

/// The variable that sets the number of threads without an argument; zero and invalid values mean one per processor.
#[cfg(feature = "parallel")]
const VARIABLE: &str = "RAYON_NUM_THREADS";

#[cfg(feature = "parallel")]
fn of_environment() -> usize {
    std::env::var(VARIABLE).ok().and_then(|text| text.parse().ok()).unwrap_or(0)
}

/// Checks the number of threads of the environment, for commands without an argument for it.
pub fn check_environment() -> Result<(), Failure> {
    #[cfg(feature = "parallel")]
    limit().check(VARIABLE, of_environment(), STACK)?;
    Ok(())
}

/// Starts the threads: as many as given, or as the environment sets, or one per processor.
#[cfg(feature = "parallel")]
pub fn set_threads(threads: Option<usize>) -> Result<(), Failure> {
    let (field, count) = match threads {
        Some(0) => return Err("--threads 0: at least one thread is needed".into()),
        Some(count) => ("--threads", count),
        None => (VARIABLE, of_environment()),
    };
    limit().check(field, count, STACK)?;
    let started = rayon::ThreadPoolBuilder::new().num_threads(count).build_global();
    started.map_err(|error| format!("{field} {count}: the threads could not be started: {error}").into())
}

/// Without the feature `parallel` there is one thread.
#[cfg(not(feature = "parallel"))]
pub fn set_threads(threads: Option<usize>) -> Result<(), Failure> {
    match threads {
        None | Some(1) => Ok(()),
        Some(count) => {
            Err(format!("--threads {count}: this build has one thread only (feature `parallel` is off)").into())
        }
    }
}
