//! [`Study`]: one experiment over sizes, pressures, inflations, laws, relaxers and seeds, run so that an interruption loses
//! nothing.
//!
//! ```text
//! Study → Plan: one task a packing, with all inflations done to it → records, one file a task → Merged → statistics by cell
//! ```
//!
//! A task writes one file, whole or not at all, and is never run again while that file is sound. What a task computes depends on
//! the study and, in the last digits of what goes through a factorisation, on the processor, so any number of threads, shards and
//! interruptions gives the same merged bytes on processors of one kind. A sample that fails is a record too.
//!
//! Start from [`execute()`] and [`merge()`].

mod curves;
mod execute;
mod lock;
mod merge;
mod plan;
mod recipe;
mod record;
mod samples;
mod settings;
mod statistics;
mod store;
mod store_error;

pub use execute::{ExecuteError, Execution, StudyProgress, Whole, execute, execute_and_merge};
pub use lock::StudyLock;
pub use merge::{MergeError, Merged, merge};
pub use plan::{Plan, Shard, Task};
pub use recipe::{Recipe, Scale};
pub use record::{Cell, FailureKind, Record, RecordOutcome};
pub use samples::{CellSamples, MeanCurve, MeanPoint, Single, StretchingRow};
pub use settings::{Part, Seeds, Study, StudyError, Target};
pub use statistics::{CellStatistics, NumberStatistics, PhaseCounts};
pub use store::Problem;
pub use store_error::StoreError;

use std::path::Path;

/// The wall time the samples of a task took \[s\], where they are in the folder and sound.
pub fn measured_seconds(folder: &Path, task: &Task) -> Option<f64> {
    match store::Store::there(folder).state(task) {
        store::TaskState::Finished(_, seconds, _) => Some(seconds),
        store::TaskState::Missing | store::TaskState::Damaged(_) => None,
    }
}
