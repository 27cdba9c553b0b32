//! Moving a complete report to its place, in an order that can be interrupted anywhere: [`complete`].

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::io::read_properties;
use crate::report::ReportError;
use crate::report::output::manifest::Manifest;
use crate::report::output::{Kind, READY};

/// Moving files takes less time; whoever holds the lock of a folder longer has been stopped.
const PATIENCE: Duration = Duration::from_secs(30);

/// Moves what is complete in a folder to its place, if a process was killed before it had done so.
///
/// # Errors
/// [`ReportError::Place`] names the file that cannot be moved or removed; what is complete stays so.
pub fn complete(folder: &Path, kind: Kind) -> Result<(), ReportError> {
    if ready(folder, kind)?.is_empty() {
        return Ok(());
    }
    let _lock = lock(folder)?;
    for one in ready(folder, kind)? {
        place(folder, &one, kind)?;
    }
    Ok(())
}

/// Whether a packing is one that `analyse` takes from the folder of a run: listed by the last report, or no jamscope report's.
/// Files of earlier runs that were left behind are neither.
pub fn is_of_the_last_report(folder: &Path, name: &str) -> bool {
    let Some(manifest) = Manifest::read(&folder.join(Kind::Report.manifest())) else { return true };
    let from_a_report = |path: &Path| {
        // What cannot be read is taken, so that whoever reads it says why.
        read_properties(path).is_ok_and(|it| it.iter().any(|(key, _)| key == "jamscope_version"))
    };
    manifest.lists(name) || !from_a_report(&folder.join(name))
}

/// Complete reports that wait to be moved, the oldest first.
fn ready(folder: &Path, kind: Kind) -> Result<Vec<PathBuf>, ReportError> {
    let failed = |source| ReportError::Place { path: folder.into(), source };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with(&kind.prefix()) && name.ends_with(READY) {
            // Another process may have moved it meanwhile.
            let Ok(written) = entry.metadata().and_then(|it| it.modified()) else { continue };
            found.push((written, entry.path()));
        }
    }
    found.sort();
    Ok(found.into_iter().map(|(_, path)| path).collect())
}

/// The lock of the folder itself; none where the system cannot lock folders.
fn lock(folder: &Path) -> Result<Option<File>, ReportError> {
    let Ok(file) = File::open(folder) else { return Ok(None) };
    let start = Instant::now();
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(Some(file)),
            Err(TryLockError::WouldBlock) if start.elapsed() < PATIENCE => {
                std::thread::sleep(Duration::from_millis(10));
            }
            Err(TryLockError::WouldBlock) => return Err(ReportError::Busy { folder: folder.into() }),
            Err(TryLockError::Error(_)) => return Ok(None),
        }
    }
}

/// Moves one complete report. Every step may be the last one: done again from the start, it goes on where it was.
fn place(folder: &Path, ready: &Path, kind: Kind) -> Result<(), ReportError> {
    let (document, list) = (kind.document(), kind.manifest());
    let failed = |path: PathBuf| move |source| ReportError::Place { path, source };
    // The list is moved after all that comes before it, so without it there is nothing old to remove.
    if ready.join(&list).exists() {
        let there = folder.join(&list);
        if let Some(old) = Manifest::read(&there) {
            let mut names: Vec<&str> = old.unchanged(folder).collect();
            names.sort_by_key(|name| *name != document);
            for name in names {
                remove(&folder.join(name))?;
            }
            remove(&there)?;
        }
    }
    let mut names = Vec::new();
    for entry in std::fs::read_dir(ready).map_err(failed(ready.into()))? {
        names.push(entry.map_err(failed(ready.into()))?.file_name());
    }
    names.sort_by_key(|name| (*name == *document.as_str(), *name == *list.as_str(), name.clone()));
    for name in names {
        let to = folder.join(&name);
        set_aside(&to)?;
        std::fs::rename(ready.join(&name), &to).map_err(failed(to))?;
    }
    std::fs::remove_dir(ready).map_err(failed(ready.into()))?;
    // The names reach the disk with their folder. Not every system can do that, and the content is safe already.
    #[cfg(unix)]
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
    Ok(())
}

fn remove(path: &Path) -> Result<(), ReportError> {
    match std::fs::remove_file(path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(ReportError::Place { path: path.into(), source })
        }
        _ => Ok(()),
    }
}

/// Renames a file that no report wrote and that has the name of one of this report.
fn set_aside(path: &Path) -> Result<(), ReportError> {
    if path.symlink_metadata().is_err() {
        return Ok(());
    }
    let mut number = 1u32;
    loop {
        let mut aside = path.as_os_str().to_os_string();
        aside.push(format!(".~{number}~"));
        if Path::new(&aside).symlink_metadata().is_err() {
            return std::fs::rename(path, &aside).map_err(|source| ReportError::Place { path: path.into(), source });
        }
        number += 1;
    }
}
