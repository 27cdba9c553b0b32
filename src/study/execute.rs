//! [`execute()`]: runs the missing tasks of a study.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::memory::Memory;
use crate::run::{self, Progress};
use crate::scene::Scene;
use crate::study::lock::StudyLock;
use crate::study::merge::{MergeError, Merged, merge_in};
use crate::study::plan::{Plan, Shard, Task};
use crate::study::record::{FailureKind, Record, RecordOutcome};
use crate::study::settings::{Study, StudyError};
use crate::study::store::{Problem, Store, TaskState};
use crate::study::store_error::StoreError;

/// Progress of a study; `()` ignores it.
pub trait StudyProgress: Sync {
    /// A task is done. `records` are its samples; `seconds` is its wall time, none if its file already existed.
    fn task(&self, task: &Task, records: &[Record], seconds: Option<f64>) {
        let _ = (task, records, seconds);
    }
}

impl StudyProgress for () {}

/// Summary of an execution.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Execution {
    /// Samples of the requested part.
    pub sample_count: usize,
    /// Samples whose records already existed.
    pub found_count: usize,
    /// Samples run now.
    pub run_count: usize,
    /// Samples that failed, earlier or now, by type of failure.
    pub failures: BTreeMap<FailureKind, usize>,
    /// Invalid files: not changed, and their samples not run.
    pub damaged: Vec<Problem>,
    /// Files of no sample of this study: not changed.
    pub foreign: Vec<Problem>,
}

/// Why a study was not completed; finished tasks are kept.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExecuteError {
    /// The study is invalid.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The folder cannot be used.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Runs all tasks of a part of a study whose files are missing in `folder`, with the feature `parallel` on all threads.
///
/// `replace` lets the study replace another one in the folder.
///
/// # Errors
/// An invalid study; a folder that cannot be written or is in use. A sample that fails gives a record, not an error.
pub fn execute(
    study: &Study,
    folder: &Path,
    shard: Shard,
    replace: bool,
    progress: &dyn StudyProgress,
) -> Result<Execution, ExecuteError> {
    let plan = Plan::of(study)?;
    plan.check_memory(Memory::of_machine(), run::thread_count()).map_err(StudyError::from)?;
    let (store, _lock) = Store::open(folder, study, replace)?;
    execute_in(&store, &plan, shard, progress)
}

/// The result of [`execute_and_merge()`].
#[derive(Debug)]
pub struct Whole {
    /// Summary of the execution.
    pub execution: Execution,
    /// All records and their statistics; none if files are damaged.
    pub merged: Option<Merged>,
    /// Lock that prevents another study from replacing this one.
    pub lock: StudyLock,
}

/// Like [`execute()`] for the whole study, then merges it. The lock of the study is held throughout, so that this study
/// is merged.
///
/// # Errors
/// See [`execute()`] and [`merge()`](crate::study::merge()).
pub fn execute_and_merge(
    study: &Study,
    folder: &Path,
    replace: bool,
    progress: &dyn StudyProgress,
) -> Result<Whole, MergeError> {
    let plan = Plan::of(study)?;
    plan.check_memory(Memory::of_machine(), run::thread_count()).map_err(StudyError::from)?;
    let (store, lock) = Store::open(folder, study, replace)?;
    let execution = execute_in(&store, &plan, Shard::default(), progress).map_err(|error| match error {
        ExecuteError::Study(error) => MergeError::Study(error),
        ExecuteError::Store(error) => MergeError::Store(error),
    })?;
    let merged = if execution.damaged.is_empty() { Some(merge_in(&store, study.clone(), &plan)?) } else { None };
    Ok(Whole { execution, merged, lock })
}

/// Runs the missing tasks in a locked folder.
fn execute_in(
    store: &Store,
    plan: &Plan,
    shard: Shard,
    progress: &dyn StudyProgress,
) -> Result<Execution, ExecuteError> {
    let _lock = store.lock(shard)?;
    let tasks: Vec<&Task> = plan.tasks.iter().filter(|task| shard.has(task.index)).collect();
    let done = Mutex::new(Execution {
        sample_count: tasks.iter().map(|task| task.scene_count()).sum(),
        foreign: store.foreign(&plan.tasks)?,
        ..Execution::default()
    });
    let note = |change: &dyn Fn(&mut Execution)| {
        // After a panic of another thread only counts may be wrong.
        change(&mut done.lock().unwrap_or_else(std::sync::PoisonError::into_inner));
    };
    let one = |task: &&Task| -> Result<(), StoreError> {
        let (records, seconds) = match store.state(task) {
            TaskState::Damaged(problem) => {
                note(&|execution| execution.damaged.push(problem.clone()));
                return Ok(());
            }
            TaskState::Finished(records, ..) => (records, None),
            TaskState::Missing => {
                let start = Instant::now();
                let records = run_task(task, plan.time_limit);
                let seconds = start.elapsed().as_secs_f64();
                store.write(task, &records, seconds)?;
                (records, Some(seconds))
            }
        };
        note(&|execution| {
            let count = if seconds.is_some() { &mut execution.run_count } else { &mut execution.found_count };
            *count += records.len();
            for record in &records {
                if let RecordOutcome::Failed { kind, .. } = record.outcome {
                    *execution.failures.entry(kind).or_default() += 1;
                }
            }
        });
        progress.task(task, &records, seconds);
        Ok(())
    };
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        tasks.par_iter().with_max_len(1).try_for_each(one)?;
    }
    #[cfg(not(feature = "parallel"))]
    tasks.iter().try_for_each(one)?;
    let mut execution = done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    execution.damaged.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(execution)
}

/// Ends a sample when its time limit is reached.
struct Deadline(Option<Instant>);

impl Progress for Deadline {
    fn interrupted(&self, _sample: usize) -> bool {
        self.0.is_some_and(|end| Instant::now() >= end)
    }
}

/// The records of a task: the packing is prepared once, then used for every inflation.
fn run_task(task: &Task, time_limit: Option<f64>) -> Vec<Record> {
    let allowed = time_limit.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    let deadline = Deadline(allowed.and_then(|allowed| Instant::now().checked_add(allowed)));
    let deadline = &deadline;
    let scenes = task.scenes();
    match scenes.first().map(|scene| scene.dimension) {
        Some(3) => records::<3>(task, &scenes, deadline),
        _ => records::<2>(task, &scenes, deadline),
    }
}

fn records<const D: usize>(task: &Task, scenes: &[Scene], deadline: &Deadline) -> Vec<Record> {
    let (law, Some(first)) = (&task.law, scenes.first()) else { return Vec::new() };
    let prepared = run::prepared::<D>(first, &first.sample[0], law, 0, deadline);
    let record = |scene: &Scene| match &prepared {
        Ok((packing, summary)) => {
            let made = (packing.clone(), summary.clone());
            let result = run::measure(scene, &scene.sample[0], made, law, 0, deadline);
            Record::of(task, scene, result.as_ref())
        }
        Err(error) => Record::of(task, scene, Err(error)),
    };
    scenes.iter().map(record).collect()
}
