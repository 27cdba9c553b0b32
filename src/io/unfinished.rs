//! Temporary files of processes that ended before their file was complete: [`remove_unfinished`].
//!
//! A temporary file `.NAMEXXXXXX.part` is locked by the process that writes it, and the system releases the lock when
//! that process ends. So a file that can be locked is abandoned.

use std::fs::File;
use std::path::{Path, PathBuf};

/// Number of letters and digits between the name and the ending.
const RANDOM_LENGTH: usize = 6;

/// The ending.
const ENDING: &str = ".part";

/// The final name of a temporary file.
pub(super) fn final_name(temporary: &str) -> Option<&str> {
    let stem = temporary.strip_prefix('.')?.strip_suffix(ENDING)?;
    let at = stem.len().checked_sub(RANDOM_LENGTH).filter(|&at| at > 0 && stem.is_char_boundary(at))?;
    let (name, random) = stem.split_at(at);
    random.bytes().all(|byte| byte.is_ascii_alphanumeric()).then_some(name)
}

/// Creates a temporary file for `name` in `folder`, locked until it is closed.
///
/// If the system does not support locks, the file is not locked, and [`remove_unfinished`] does not remove it.
pub(super) fn temporary(folder: &Path, name: &std::ffi::OsStr) -> std::io::Result<tempfile::NamedTempFile> {
    let mut prefix = std::ffi::OsString::from(".");
    prefix.push(name);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(ENDING).rand_bytes(RANDOM_LENGTH);
    #[cfg(unix)]
    {
        // The permissions of any new file, by the umask; the default of the crate would exclude other users of a group.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    loop {
        let file = builder.tempfile_in(folder)?;
        // Between creation and lock, a process that removes abandoned files may have locked it.
        match file.as_file().try_lock() {
            Err(std::fs::TryLockError::WouldBlock) => {}
            _ if !file.path().exists() => {}
            _ => return Ok(file),
        }
    }
}

/// Checks whether [`write_atomically`](crate::io::write_atomically) could create a file with this name; leaves no file
/// behind.
///
/// # Errors
/// The error of the system: no permission, no space, a name that is too long.
pub fn try_name(folder: &Path, name: &std::ffi::OsStr) -> std::io::Result<()> {
    temporary(folder, name)?.close()
}

/// Removes the abandoned temporary files in `folder`; `known` decides whether a final name is one of the caller's
/// files.
///
/// Files still being written are kept, and so are all files if the system does not support locks. Returns the removed
/// files.
///
/// # Errors
/// A folder that cannot be read. A file that cannot be removed is kept.
pub fn remove_unfinished(folder: &Path, known: impl Fn(&str) -> bool) -> std::io::Result<Vec<PathBuf>> {
    let mut removed = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let ours = name.to_str().and_then(final_name).is_some_and(&known);
        if ours && entry.file_type()?.is_file() {
            let path = entry.path();
            let free = File::options().write(true).open(&path).is_ok_and(|file| {
                // Removed while locked: a process that has just created it notices the removal and creates another one.
                file.try_lock().is_ok() && std::fs::remove_file(&path).is_ok()
            });
            removed.extend(free.then_some(path));
        }
    }
    removed.sort();
    Ok(removed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn temporary_names_are_told_from_others() {
        assert_eq!(final_name(".a.xyzAb3dEf.part"), Some("a.xyz"));
        for other in ["a.xyzAb3dEf.part", ".a.xyz.part", ".Ab3dEf.part", ".a.xyzAb-dEf.part", ".a.xyzAb3dEf.parts"] {
            assert_ne!(final_name(other), Some("a.xyz"), "{other}");
        }
        assert_eq!(final_name(".Ab3dEf.part"), None);
    }

    #[test]
    fn only_files_of_nobody_are_removed() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let live = temporary(folder.path(), "a.csv".as_ref()).expect("a file");
        let (dead, foreign) = (folder.path().join(".a.csvAb3dEf.part"), folder.path().join(".b.csvAb3dEf.part"));
        std::fs::write(&dead, "half").expect("written");
        std::fs::write(&foreign, "mine").expect("written");
        assert_eq!(remove_unfinished(folder.path(), |name| name == "a.csv").expect("read"), [dead]);
        assert!(live.path().exists() && foreign.exists());
    }
}
