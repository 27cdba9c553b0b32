//! `--threads`: how many threads a command takes.

#[cfg(feature = "parallel")]
use jamscope::memory::Limit;

use crate::Failure;

/// Threads that are useful: more of them than processors gain nothing, and thousands spend their time waiting for each other.
#[cfg(feature = "parallel")]
fn limit() -> Limit {
    let processors = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    Limit { largest: (4 * processors as u64).max(256), reason: "four a processor, at least 256" }
}

/// The stack of a thread \[bytes\].
#[cfg(feature = "parallel")]
const STACK: f64 = 2.0 * 1024.0 * 1024.0;

/// Starts the threads: as many as asked for, or as `RAYON_NUM_THREADS` says, or one a processor.
#[cfg(feature = "parallel")]
pub fn set_threads(threads: Option<usize>) -> Result<(), Failure> {
    let (field, count) = match threads {
        Some(count) => ("--threads", Some(count)),
        // Zero and what is not a number mean one a processor.
        None => ("RAYON_NUM_THREADS", std::env::var("RAYON_NUM_THREADS").ok().and_then(|text| text.parse().ok())),
    };
    if threads == Some(0) {
        return Err("--threads 0: at least one thread is needed".into());
    }
    let count: usize = count.unwrap_or(0);
    limit().check(field, count, STACK)?;
    let started = rayon::ThreadPoolBuilder::new().num_threads(count).build_global();
    started.map_err(|error| format!("{field} {count}: the threads could not be started: {error}").into())
}

/// Without the feature `parallel` there is one thread.
#[cfg(not(feature = "parallel"))]
pub fn set_threads(threads: Option<usize>) -> Result<(), Failure> {
    match threads {
        None | Some(1) => Ok(()),
        Some(count) => Err(format!("--threads {count}: built without the feature `parallel`, one thread only").into()),
    }
}
