//! Locks of the folder of a study, so that no process changes a study that another one runs.
//!
//! ```text
//! .lock          shared by all processes that run or merge the study; exclusive while study.json is written
//! .lock-I-of-N   exclusive, one for each part of the plan
//! ```
//!
//! The operating system releases a lock when its process ends for any reason.

use std::fs::{File, TryLockError};
use std::path::Path;
use std::time::{Duration, Instant};

use crate::study::plan::Shard;
use crate::study::store_error::StoreError;

/// Longest wait for a lock. Writing a study.json takes less time; a process that holds its lock longer is suspended.
pub(super) const PATIENCE: Duration = Duration::from_secs(3);

/// Time between two tries.
pub(super) const PAUSE: Duration = Duration::from_millis(10);

/// Opens the file of a lock, and creates it if necessary.
fn open(path: &Path) -> Result<File, StoreError> {
    let file = File::options().create(true).truncate(false).write(true).open(path);
    file.map_err(|source| StoreError::Io { path: path.into(), source })
}

/// The lock of the study: while it exists, no other study replaces this one.
#[derive(Debug)]
pub struct StudyLock {
    file: File,
}

impl StudyLock {
    /// The shared lock of an existing folder. Waits while a study.json is written.
    pub(super) fn shared(folder: &Path) -> Result<Self, StoreError> {
        let path = folder.join(".lock");
        let file = open(&path)?;
        let start = Instant::now();
        loop {
            match file.try_lock_shared() {
                Ok(()) => return Ok(StudyLock { file }),
                Err(TryLockError::WouldBlock) if start.elapsed() < PATIENCE => std::thread::sleep(PAUSE),
                Err(TryLockError::WouldBlock) => return Err(StoreError::Locked { path }),
                Err(TryLockError::Error(source)) => return Err(StoreError::Io { path, source }),
            }
        }
    }

    /// The exclusive lock of an existing folder.
    pub(super) fn exclusive(folder: &Path) -> Result<Self, StoreError> {
        let path = folder.join(".lock");
        exclusive(&path).map(|file| StudyLock { file })
    }
}

impl Drop for StudyLock {
    fn drop(&mut self) {
        // Closing the file also releases it, but later on some systems.
        let _ = self.file.unlock();
    }
}

/// The lock of one part of a study.
pub(super) fn part(folder: &Path, shard: Shard) -> Result<File, StoreError> {
    exclusive(&folder.join(format!(".lock-{}-of-{}", shard.index, shard.count)))
}

fn exclusive(path: &Path) -> Result<File, StoreError> {
    let file = open(path)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(StoreError::Locked { path: path.into() }),
        Err(TryLockError::Error(source)) => Err(StoreError::Io { path: path.into(), source }),
    }
}
