//! [`execute()`]: runs what is missing of a study.

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

/// What a study tells while it runs; `()` hears nothing.
pub trait StudyProgress: Sync {
    /// A task is done; `records` are its samples, `seconds` its wall time, none if it was there already.
    fn task(&self, task: &Task, records: &[Record], seconds: Option<f64>) {
        let _ = (task, records, seconds);
    }
}

impl StudyProgress for () {}

/// What was done.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Execution {
    /// Samples of the part that was asked for.
    pub sample_count: usize,
    /// Those of them that were there already.
    pub found_count: usize,
    /// Those run now.
    pub run_count: usize,
    /// Samples that failed, found or run, by kind.
    pub failures: BTreeMap<FailureKind, usize>,
    /// Files that are not what they should be: left alone, and their samples not run.
    pub damaged: Vec<Problem>,
    /// Files of no sample of this study: left alone.
    pub foreign: Vec<Problem>,
}

/// Why a study was not run to its end; what is finished stays.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExecuteError {
    /// The study makes no sense.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The folder cannot be used.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Runs all tasks of a part of a study that are not in `folder` yet, with the feature `parallel` on all threads.
///
/// `replace` lets the study take the place of another one in the folder.
///
/// # Errors
/// A study that makes no sense; a folder that cannot be written or is in use. A sample that fails is a record, no error.
pub fn execute(
    study: &Study,
    folder: &Path,
    shard: Shard,
    replace: bool,
    progress: &impl StudyProgress,
) -> Result<Execution, ExecuteError> {
    let plan = Plan::of(study)?;
    plan.check_memory(Memory::of_machine(), run::thread_count()).map_err(StudyError::from)?;
    let (store, _lock) = Store::open(folder, study, replace)?;
    execute_in(&store, &plan, shard, progress)
}

/// What [`execute_and_merge()`] did.
#[derive(Debug)]
pub struct Whole {
    /// What was done.
    pub execution: Execution,
    /// All records and their statistics; none where files are damaged.
    pub merged: Option<Merged>,
    /// While it lives, no other study takes the place of this one.
    pub lock: StudyLock,
}

/// Like [`execute()`] of the whole study, then merges it, with the study's lock held throughout: what is merged is this study.
///
/// # Errors
/// As [`execute()`] and [`merge()`](crate::study::merge()).
pub fn execute_and_merge(
    study: &Study,
    folder: &Path,
    replace: bool,
    progress: &impl StudyProgress,
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

/// Runs what is missing in a folder that is locked.
fn execute_in(
    store: &Store,
    plan: &Plan,
    shard: Shard,
    progress: &impl StudyProgress,
) -> Result<Execution, ExecuteError> {
    let _lock = store.lock(shard)?;
    let tasks: Vec<&Task> = plan.tasks.iter().filter(|task| shard.has(task.index)).collect();
    let done = Mutex::new(Execution {
        sample_count: tasks.iter().map(|task| task.scene_count()).sum(),
        foreign: store.foreign(&plan.tasks)?,
        ..Execution::default()
    });
    let note = |change: &dyn Fn(&mut Execution)| {
        // A thread that panicked has left counts behind, nothing worse.
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

/// Ends a sample when its time is over.
struct Deadline(Option<Instant>);

impl Progress for Deadline {
    fn interrupted(&self, _sample: usize) -> bool {
        self.0.is_some_and(|end| Instant::now() >= end)
    }
}

/// The records of a task: the packing is prepared once, then inflated in every way.
fn run_task(task: &Task, time_limit: Option<f64>) -> Vec<Record> {
    let allowed = time_limit.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    let deadline = Deadline(allowed.and_then(|allowed| Instant::now().checked_add(allowed)));
    let (law, deadline) = (&task.law, &deadline);
    let scenes = task.scenes();
    let Some(first) = scenes.first() else { return Vec::new() };
    let prepared = run::prepared(first, &first.sample[0], law, 0, deadline);
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
