//! Moving a complete report to its place, in an order that can be interrupted anywhere: [`complete`].

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::io::read_properties;
use crate::report::error::ReportError;
use crate::report::output::manifest::Manifest;
use crate::report::output::report_kind::{Kind, READY};

/// Longest wait for a lock. Moving files takes less time; a process that holds its lock longer is suspended.
const PATIENCE: Duration = Duration::from_secs(30);

/// Moves a complete report to its place, if a process was killed before doing so.
///
/// # Errors
/// [`ReportError::Place`] with the file that cannot be moved or removed; the report stays complete.
pub fn complete(folder: &Path, kind: Kind) -> Result<(), ReportError> {
    if ready(folder, kind)?.is_empty() {
        return Ok(());
    }
    let _lock = lock(folder)?;
    for one in ready(folder, kind)? {
        for step in steps(folder, &one, kind)? {
            step.take()?;
        }
    }
    // Writes the directory entries to disk. Not every system supports it, and the contents are already safe.
    #[cfg(unix)]
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
    Ok(())
}

/// Whether `analyse` takes a packing from the folder of a run: it is listed by the last report, or it is not from a
/// jamscope report. Files of earlier runs are neither.
pub fn is_of_the_last_report(folder: &Path, name: &str) -> bool {
    let Some(manifest) = Manifest::read(&folder.join(Kind::Report.manifest())) else { return true };
    let from_a_report = |path: &Path| {
        // Unreadable files are included, so that the reader reports the error.
        read_properties(path).is_ok_and(|it| it.iter().any(|(key, _)| key == "jamscope_version"))
    };
    manifest.lists(name) || !from_a_report(&folder.join(name))
}

/// Complete reports still to be moved, the oldest first.
pub(super) fn ready(folder: &Path, kind: Kind) -> Result<Vec<PathBuf>, ReportError> {
    let failed = |source| ReportError::Place { path: folder.into(), source };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with(&kind.prefix()) && name.ends_with(READY) {
            // Another process may have moved it already.
            let Ok(written) = entry.metadata().and_then(|it| it.modified()) else { continue };
            found.push((written, entry.path()));
        }
    }
    found.sort();
    Ok(found.into_iter().map(|(_, path)| path).collect())
}

/// The lock of the folder itself; none if the system cannot lock folders.
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

/// One change of the folder.
#[derive(Debug)]
pub(super) enum Step {
    /// A file of the last report is removed.
    Remove(PathBuf),
    /// A file that no report wrote is renamed, because this report needs its name.
    SetAside(PathBuf),
    /// A file of this report is moved.
    Move { from: PathBuf, to: PathBuf },
    /// The folder, now empty, is removed.
    RemoveFolder(PathBuf),
}

impl Step {
    pub(super) fn take(self) -> Result<(), ReportError> {
        let (path, result) = match self {
            Step::Remove(path) => (path.clone(), std::fs::remove_file(path)),
            Step::SetAside(path) => (path.clone(), set_aside(&path)),
            Step::Move { from, to } => (to.clone(), std::fs::rename(from, to)),
            Step::RemoveFolder(path) => (path.clone(), std::fs::remove_dir(path)),
        };
        result.map_err(|source| ReportError::Place { path, source })
    }
}

/// The remaining steps for a complete report. After an interruption at any step, a new call returns the rest.
pub(super) fn steps(folder: &Path, ready: &Path, kind: Kind) -> Result<Vec<Step>, ReportError> {
    let (document, list) = (kind.document(), kind.manifest());
    let failed = |source| ReportError::Place { path: ready.into(), source };
    let mut steps = Vec::new();
    let mut removed = Vec::new();
    // The list of this report is moved after all files except the document; from then on no old file is left.
    let old = if ready.join(&list).exists() { Manifest::read(&folder.join(&list)) } else { None };
    if let Some(old) = old {
        removed.extend(old.unchanged(folder).map(str::to_string));
        removed.sort_by_key(|name| *name != document);
        removed.push(list.clone());
        steps.extend(removed.iter().map(|name| Step::Remove(folder.join(name))));
    }
    let mut names = Vec::new();
    for entry in std::fs::read_dir(ready).map_err(failed)? {
        names.push(entry.map_err(failed)?.file_name());
    }
    names.sort_by_key(|name| (*name == *document.as_str(), *name == *list.as_str(), name.clone()));
    for name in names {
        let to = folder.join(&name);
        if to.symlink_metadata().is_ok() && !removed.iter().any(|removed| name == *removed.as_str()) {
            steps.push(Step::SetAside(to.clone()));
        }
        steps.push(Step::Move { from: ready.join(&name), to });
    }
    steps.push(Step::RemoveFolder(ready.into()));
    Ok(steps)
}

/// Renames a file to `NAME.~N~` with the first unused N.
fn set_aside(path: &Path) -> std::io::Result<()> {
    let mut number = 1u32;
    loop {
        let mut aside = path.as_os_str().to_os_string();
        aside.push(format!(".~{number}~"));
        if Path::new(&aside).symlink_metadata().is_err() {
            return std::fs::rename(path, &aside);
        }
        number += 1;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::report::OutputFolder;

    /// Files and their contents, without hidden ones and folders.
    fn visible(folder: &Path) -> BTreeMap<String, String> {
        let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry"));
        let files = entries.filter(|entry| entry.file_type().expect("a type").is_file());
        let pair = |path: PathBuf| {
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            (name, std::fs::read_to_string(path).expect("text"))
        };
        files.map(|entry| pair(entry.path())).filter(|(name, _)| !name.starts_with('.')).collect()
    }

    /// A complete report of these files, each containing `text`; returns its folder.
    fn made_ready(folder: &Path, names: &[&str], text: &str) -> PathBuf {
        let mut output = OutputFolder::open(folder, Kind::Report).expect("a folder");
        names.iter().for_each(|name| std::fs::write(output.inside().join(name), text).expect("written"));
        output.make_ready(&names.iter().map(|name| name.to_string()).collect::<Vec<_>>()).expect("ready")
    }

    #[test]
    fn interrupted_after_any_step_files_are_of_one_report_and_the_next_command_goes_on() {
        let old = ["report.json", "timings.json", "a.packing.xyz", "b.packing.xyz"];
        let new = ["report.json", "timings.json", "a.packing.xyz", "c.packing.xyz"];
        let mine = ["notes.txt", "c.packing.xyz"];
        let mut interruptions = 0;
        for step_count in 0.. {
            let folder = tempfile::tempdir().expect("a temporary folder");
            made_ready(folder.path(), &old, "old");
            complete(folder.path(), Kind::Report).expect("placed");
            mine.iter().for_each(|name| std::fs::write(folder.path().join(name), "mine").expect("written"));
            let ready = made_ready(folder.path(), &new, "new");
            let steps = steps(folder.path(), &ready, Kind::Report).expect("a plan");
            let all = steps.len();
            steps.into_iter().take(step_count).for_each(|step| step.take().expect("taken"));
            let found = visible(folder.path());
            let has = |text: &str| found.values().any(|it| it == text);
            assert!(!(has("old") && has("new")), "after {step_count} steps: {found:?}");
            // If the report exists, so do all its files.
            if let Some(text) = found.get("report.json") {
                let names = if text == "old" { old } else { new };
                assert!(names.iter().all(|name| found[*name] == *text), "after {step_count} steps: {found:?}");
            }
            complete(folder.path(), Kind::Report).expect("completed");
            let expected = BTreeMap::from(new.map(|name| (name.to_string(), "new".to_string())))
                .into_iter()
                .chain([("notes.txt", "mine"), ("c.packing.xyz.~1~", "mine")].map(|(a, b)| (a.into(), b.into())))
                .collect();
            assert_eq!(visible(folder.path()), expected, "after {step_count} steps");
            if step_count == all {
                break;
            }
            interruptions += 1;
        }
        // Five old files and lists are removed, five new ones moved, one renamed, one folder removed.
        assert_eq!(interruptions, 12);
    }

    #[test]
    fn files_that_were_changed_are_not_removed() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        made_ready(folder.path(), &["report.json", "a.csv", "b.csv"], "old");
        complete(folder.path(), Kind::Report).expect("placed");
        std::fs::write(folder.path().join("a.csv"), "with my remarks").expect("written");
        made_ready(folder.path(), &["report.json"], "new");
        complete(folder.path(), Kind::Report).expect("placed");
        let expected = [("a.csv", "with my remarks"), ("report.json", "new")];
        assert_eq!(visible(folder.path()), expected.map(|(a, b)| (a.to_string(), b.to_string())).into());
    }

    #[test]
    fn folders_of_dead_processes_go_and_those_of_live_ones_stay() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let dead = folder.path().join(".report-Ab3dEf.part");
        std::fs::create_dir(&dead).expect("made");
        std::fs::write(dead.join("a.csv"), "half").expect("written");
        let live = OutputFolder::open(folder.path(), Kind::Report).expect("a folder");
        assert!(!dead.exists());
        let other = OutputFolder::open(folder.path(), Kind::Report).expect("a folder");
        assert!(live.inside().exists() && other.inside() != live.inside());
        let inside = live.inside().to_path_buf();
        drop((live, other));
        assert!(!inside.exists() && folder.path().exists());
        // Folders created in vain are removed too.
        let deep = folder.path().join("not/there");
        drop(OutputFolder::open(&deep, Kind::Analysis).expect("a folder"));
        assert!(!folder.path().join("not").exists());
    }
}
