//! The folder of a study: one file per task, which is either valid or reported with its problem.
//!
//! ```text
//! study.json             the study, for the merge samples/IDENTITY.jsonl  {"jamscope_version", "vectors", "identity",
//! "checksum"} / the records / the wall time, one line each
//! ```

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::io::{remove_unfinished, write_atomically};
use crate::processor::{Processor, Vectors};
use crate::study::lock::{self, PATIENCE, PAUSE, StudyLock};
use crate::study::plan::{Shard, Task, hash};
use crate::study::record::Record;
use crate::study::settings::Study;
use crate::study::store_error::StoreError;

/// An invalid file of the folder; it is not changed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Problem {
    /// The file.
    pub path: PathBuf,
    /// The problem.
    pub reason: String,
}

/// State of a task in the folder.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum TaskState {
    /// No file.
    Missing,
    /// All its records, their wall time \[s\], and the vector instructions that computed them, if the file contains
    /// them.
    Finished(Vec<Record>, f64, Option<Vectors>),
    /// A file that cannot be used.
    Damaged(Problem),
}

/// First line of a file of records.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    jamscope_version: String,
    /// Absent in older files.
    #[serde(default)]
    vectors: Option<Vectors>,
    identity: String,
    checksum: String,
}

/// Last line.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Timing {
    seconds: f64,
}

/// Files of a study besides its samples.
const RESULTS: [&str; 6] =
    ["records.jsonl", "summary.json", "summary.csv", "transition.json", "transition.csv", "report.html"];

/// Length of the file name of samples.
const SAMPLE_NAME_LENGTH: usize = 24 + ".jsonl".len();

/// The folder of a study.
#[derive(Debug, Clone)]
pub(super) struct Store {
    folder: PathBuf,
}

impl Store {
    /// Opens the folder of this study with its lock, and creates it if necessary. `replace` lets the study replace
    /// another one.
    ///
    /// An existing study is not changed before it is certain that no process runs it.
    pub(super) fn open(folder: &Path, study: &Study, replace: bool) -> Result<(Self, StudyLock), StoreError> {
        let store = Store { folder: folder.into() };
        let samples = store.samples();
        std::fs::create_dir_all(&samples).map_err(|source| StoreError::Io { path: samples, source })?;
        let start = Instant::now();
        loop {
            // A file is replaced atomically, so it can be read without a lock. It may have changed before the lock is
            // acquired.
            if store.has(study, replace)? {
                let lock = StudyLock::shared(folder)?;
                if store.has(study, replace)? {
                    return store.ready(lock);
                }
            } else {
                match StudyLock::exclusive(folder) {
                    Ok(_lock) => {
                        if !store.has(study, replace)? {
                            store.take_over(study)?;
                        }
                    }
                    // Another part of this study may have been started at the same time and be writing it.
                    Err(StoreError::Locked { .. }) if start.elapsed() < PATIENCE => std::thread::sleep(PAUSE),
                    Err(error) => return Err(error),
                }
            }
        }
    }

    /// Whether the folder contains this study; false if it contains none or one that may be replaced.
    fn has(&self, study: &Study, replace: bool) -> Result<bool, StoreError> {
        match self.study() {
            Ok(found) if found == *study => Ok(true),
            Ok(_) if !replace => Err(StoreError::OtherStudy { path: self.study_path() }),
            Err(error @ StoreError::Unreadable { .. }) if !replace => Err(error),
            Err(error @ StoreError::Io { .. }) => Err(error),
            _ => Ok(false),
        }
    }

    /// Replaces the existing study. Its merged results are removed first, because they would be taken for those of this
    /// study. Its samples are kept.
    fn take_over(&self, study: &Study) -> Result<(), StoreError> {
        let path = self.study_path();
        let text = serde_json::to_string_pretty(study)
            .map_err(|error| StoreError::Unreadable { path: path.clone(), reason: error.to_string() })?;
        // Without a study, files with these names are not results of one.
        let results = if path.exists() { &RESULTS[..] } else { &[] };
        for name in results {
            let path = self.folder.join(name);
            match std::fs::remove_file(&path) {
                Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                    return Err(StoreError::Io { path, source });
                }
                _ => {}
            }
        }
        write_atomically(&path, |writer| writer.write_all((text + "\n").as_bytes()))?;
        Ok(())
    }

    /// Removes partial files of killed processes, and tests whether samples can be written.
    fn ready(self, lock: StudyLock) -> Result<(Self, StudyLock), StoreError> {
        let samples = self.samples();
        let failed = |path: &Path| {
            let path = path.to_path_buf();
            move |source| StoreError::Io { path, source }
        };
        let of_a_sample = |name: &str| name.len() == SAMPLE_NAME_LENGTH && name.ends_with(".jsonl");
        remove_unfinished(&samples, of_a_sample).map_err(failed(&samples))?;
        let of_the_study = |name: &str| name == "study.json" || RESULTS.contains(&name);
        remove_unfinished(&self.folder, of_the_study).map_err(failed(&self.folder))?;
        // Removed as soon as it is closed.
        tempfile::Builder::new().prefix(".trial").suffix(".part").tempfile_in(&samples).map_err(failed(&samples))?;
        Ok((self, lock))
    }

    /// Opens an existing folder: the store, its study and the lock.
    pub(super) fn held(folder: &Path) -> Result<(Self, Study, StudyLock), StoreError> {
        let store = Store::existing(folder);
        // No lock is created in a folder without a study.
        store.study()?;
        let lock = StudyLock::shared(folder)?;
        let study = store.study()?;
        Ok((store, study, lock))
    }

    /// The store of an existing folder, whatever its study.
    pub(super) fn existing(folder: &Path) -> Self {
        Store { folder: folder.into() }
    }

    /// A file of the folder.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    fn samples(&self) -> PathBuf {
        self.folder.join("samples")
    }

    fn study_path(&self) -> PathBuf {
        self.folder.join("study.json")
    }

    /// The study in the folder.
    pub(super) fn study(&self) -> Result<Study, StoreError> {
        let path = self.study_path();
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Err(StoreError::NoStudy { path }),
            Err(source) => return Err(StoreError::Io { path, source }),
        };
        serde_json::from_str(&text).map_err(|error| StoreError::Unreadable { path, reason: error.to_string() })
    }

    /// Locks a part: prevents other processes from running it while the file is open.
    pub(super) fn lock(&self, shard: Shard) -> Result<File, StoreError> {
        lock::part(&self.folder, shard)
    }

    /// The state of a task.
    pub(super) fn state(&self, task: &Task) -> TaskState {
        let path = self.samples().join(task.file_name());
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return TaskState::Missing,
            Err(error) => return TaskState::Damaged(Problem { path, reason: error.to_string() }),
        };
        match records(&text, &task.identity()) {
            Ok((records, seconds, vectors)) if records.len() == task.scene_count() => {
                TaskState::Finished(records, seconds, vectors)
            }
            Ok((records, ..)) => {
                let reason = format!("{} records, not {}", records.len(), task.scene_count());
                TaskState::Damaged(Problem { path, reason })
            }
            Err(reason) => TaskState::Damaged(Problem { path, reason }),
        }
    }

    /// Writes the records of a task.
    pub(super) fn write(&self, task: &Task, records: &[Record], seconds: f64) -> Result<(), StoreError> {
        let path = self.samples().join(task.file_name());
        let unreadable =
            |error: serde_json::Error| StoreError::Unreadable { path: path.clone(), reason: error.to_string() };
        let body = serde_json::to_string(records).map_err(unreadable)?;
        let header = Header {
            jamscope_version: env!("CARGO_PKG_VERSION").into(),
            vectors: Some(Processor::own().vectors()),
            identity: task.identity(),
            checksum: hash(&[&body]),
        };
        let header = serde_json::to_string(&header).map_err(unreadable)?;
        let timing = serde_json::to_string(&Timing { seconds }).map_err(unreadable)?;
        write_atomically(&path, |writer| write!(writer, "{header}\n{body}\n{timing}\n"))?;
        Ok(())
    }

    /// Files among the samples that belong to no task of the plan.
    pub(super) fn foreign(&self, tasks: &[Task]) -> Result<Vec<Problem>, StoreError> {
        let folder = self.samples();
        let failed = |source| StoreError::Io { path: folder.clone(), source };
        let known: std::collections::BTreeSet<String> = tasks.iter().map(Task::file_name).collect();
        let mut found = Vec::new();
        for entry in std::fs::read_dir(&folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            // A partial file of another process.
            let begun = name.starts_with('.') && name.ends_with(".part");
            if !known.contains(&name) && !begun {
                found.push(Problem { path: entry.path(), reason: "belongs to no sample of this study".into() });
            }
        }
        found.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(found)
    }

    /// Writes a file of results.
    pub(super) fn write_result(&self, name: &str, text: &str) -> Result<PathBuf, StoreError> {
        let path = self.folder.join(name);
        write_atomically(&path, |writer| writer.write_all(text.as_bytes()))?;
        Ok(path)
    }
}

/// The records of a file, their wall time, and the vector instructions that computed them.
fn records(text: &str, identity: &str) -> Result<(Vec<Record>, f64, Option<Vectors>), String> {
    let mut lines = text.split('\n');
    let (Some(header), Some(body), Some(timing), Some(""), None) =
        (lines.next(), lines.next(), lines.next(), lines.next(), lines.next())
    else {
        return Err("incomplete: the file must have three lines".into());
    };
    let header: Header = serde_json::from_str(header).map_err(|error| format!("line 1: {error}"))?;
    if header.jamscope_version != env!("CARGO_PKG_VERSION") {
        return Err(format!(
            "written by version {}, but this is version {}",
            header.jamscope_version,
            env!("CARGO_PKG_VERSION")
        ));
    }
    if header.identity != identity {
        return Err("contains the records of another sample".into());
    }
    if header.checksum != hash(&[body]) {
        return Err("line 2: changed since it was written (checksum)".into());
    }
    let records = serde_json::from_str(body).map_err(|error| format!("line 2: {error}"))?;
    let timing: Timing = serde_json::from_str(timing).map_err(|error| format!("line 3: {error}"))?;
    Ok((records, timing.seconds, header.vectors))
}
