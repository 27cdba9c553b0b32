//! [`OutputFolder`]: writes all files of a report into a folder together.
//!
//! ```text
//! DIR/.report-XXXXXX.part/         being filled; locked by the process that fills it
//! DIR/.report-XXXXXX.part.ready/   complete; its files are moved to DIR, after those of the last report are removed
//! DIR/.report.files.json           the list of files of the last report, with checksums
//! ```
//!
//! If a process is killed at any time, the files in `DIR` belong to one report: the last one before the rename to
//! `.ready`, and this one, possibly incomplete, after it. The next command that uses the folder then moves the rest.
//! `report.json` is removed first and moved last: if it exists, all files exist.
//!
//! Files that no report wrote, or that were changed since, are never removed. If the name of one is needed, it is
//! renamed to `NAME.~1~`.

mod manifest;
mod move_into_place;
mod report_kind;

use std::fs::File;
use std::path::{Path, PathBuf};

use crate::io::{remove_unfinished, try_name};
use crate::report::error::ReportError;
use crate::report::output::report_kind::{PART, READY};
use manifest::Manifest;
pub use move_into_place::{complete, is_of_the_last_report};
pub use report_kind::Kind;

/// A folder for a report, created and tested before the computation of the report.
///
/// If it is dropped without a report, nothing is left behind.
#[derive(Debug)]
pub struct OutputFolder {
    folder: PathBuf,
    kind: Kind,
    /// Removed when dropped.
    part: Option<tempfile::TempDir>,
    /// Shows that the folder is in use, while it exists.
    _lock: Option<File>,
    /// Folders created, the deepest first.
    made: Vec<PathBuf>,
}

impl OutputFolder {
    /// Creates the folder if necessary, moves a complete report of a killed process, removes incomplete ones, and tests
    /// writing.
    ///
    /// # Errors
    /// [`ReportError`] with the folder and the error of the system.
    pub fn open(folder: &Path, kind: Kind) -> Result<Self, ReportError> {
        let made = make(folder).map_err(|source| ReportError::Folder { folder: folder.into(), source })?;
        let mut output = OutputFolder { folder: folder.into(), kind, part: None, _lock: None, made };
        complete(folder, kind)?;
        let refused = |source| ReportError::NotWritable { folder: folder.into(), source };
        output.clear().map_err(refused)?;
        let (part, lock) = locked_part(folder, kind).map_err(refused)?;
        try_name(part.path(), "trial".as_ref()).map_err(refused)?;
        (output.part, output._lock) = (Some(part), lock);
        Ok(output)
    }

    /// Checks whether all files of these samples can be created here, by the longest name; `field` is the origin of the
    /// names.
    ///
    /// # Errors
    /// [`ReportError::Name`], usually for a name that is too long for the file system.
    pub fn try_samples<'a>(
        &self,
        field: &'static str,
        samples: impl Iterator<Item = &'a str>,
    ) -> Result<(), ReportError> {
        let Some(sample) = samples.max_by_key(|sample| sample.len()) else { return Ok(()) };
        let name = format!("{sample}.{}", self.kind.longest_ending());
        try_name(self.inside(), name.as_ref()).map_err(|source| ReportError::Name {
            field,
            value: sample.into(),
            name,
            folder: self.folder.clone(),
            source,
        })
    }

    /// The folder in which files are written until all exist.
    pub(crate) fn inside(&self) -> &Path {
        // It exists after `open`.
        self.part.as_ref().map_or(&self.folder, |part| part.path())
    }

    /// Moves the files to their place; returns their paths, in the order of `names`.
    pub(crate) fn commit(mut self, names: Vec<String>) -> Result<Vec<PathBuf>, ReportError> {
        self.make_ready(&names)?;
        complete(&self.folder, self.kind)?;
        Ok(names.iter().map(|name| self.folder.join(name)).collect())
    }

    /// Writes the list of files and marks the folder as complete. Returns the complete folder.
    fn make_ready(&mut self, names: &[String]) -> Result<PathBuf, ReportError> {
        let manifest = Manifest::of(self.inside(), names)?;
        manifest.write(&self.inside().join(self.kind.manifest()))?;
        let part = self.part.take().map(tempfile::TempDir::keep).unwrap_or_default();
        let mut ready = part.clone().into_os_string();
        ready.push(READY);
        std::fs::rename(&part, &ready).map_err(|source| ReportError::Place { path: part, source })?;
        self.made.clear();
        Ok(ready.into())
    }

    /// Removes incomplete folders of killed processes.
    fn clear(&self) -> std::io::Result<()> {
        for entry in std::fs::read_dir(&self.folder)? {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.starts_with(&self.kind.prefix()) && name.ends_with(PART) && entry.file_type()?.is_dir() {
                let dead = File::open(entry.path()).is_ok_and(|folder| folder.try_lock().is_ok());
                if dead {
                    // Another process may remove it at the same time.
                    let _ = std::fs::remove_dir_all(entry.path());
                }
            }
        }
        // Single partial files are from earlier versions.
        let known = Manifest::read(&self.folder.join(self.kind.manifest()));
        remove_unfinished(&self.folder, |name| known.as_ref().is_some_and(|known| known.lists(name)))?;
        Ok(())
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        self.part = None;
        for folder in &self.made {
            // Only if it is empty.
            if std::fs::remove_dir(folder).is_err() {
                break;
            }
        }
    }
}

/// Creates a folder and its parents; returns those created, the deepest first.
fn make(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let missing = folder.ancestors().take_while(|it| !it.as_os_str().is_empty() && !it.exists());
    let missing = missing.map(Path::to_path_buf).collect();
    std::fs::create_dir_all(folder)?;
    Ok(missing)
}

/// Creates a folder to fill, locked if the system can lock folders.
fn locked_part(folder: &Path, kind: Kind) -> std::io::Result<(tempfile::TempDir, Option<File>)> {
    loop {
        let part = tempfile::Builder::new().prefix(&kind.prefix()).suffix(PART).tempdir_in(folder)?;
        let Ok(lock) = File::open(part.path()) else { return Ok((part, None)) };
        // A process that removes incomplete folders may have locked it.
        match lock.try_lock() {
            Err(std::fs::TryLockError::WouldBlock) => {}
            _ if !part.path().exists() => {}
            _ => return Ok((part, Some(lock))),
        }
    }
}
