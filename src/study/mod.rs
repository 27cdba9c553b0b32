//! [`Study`]: one experiment for several sizes, pressures, inflations, laws, relaxers and seeds. An interruption loses
//! no results.
//!
//! ```text
//! Study → Plan: one task per packing, with all its inflations → records, one file per task → Merged → statistics by
//! cell
//! ```
//!
//! A task writes one file, either complete or not at all, and is not repeated while that file is valid. Its results
//! depend only on the study and, in the last digits of results of factorisations, on the processor. So the merged bytes
//! do not depend on the number of threads, shards and interruptions on processors of one type. A sample that fails also
//! gives a record.
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
mod study_input;

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

/// The wall time of the samples of a task \[s\], if the folder contains a valid file of it.
pub fn measured_seconds(folder: &Path, task: &Task) -> Option<f64> {
    match store::Store::existing(folder).state(task) {
        store::TaskState::Finished(_, seconds, _) => Some(seconds),
        store::TaskState::Missing | store::TaskState::Damaged(_) => None,
    }
}
