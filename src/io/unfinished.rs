//! Temporary files of processes that ended before their file was complete: [`remove_unfinished`].
//!
//! A temporary file `.NAMEXXXXXX.part` is locked by the process that writes it, and the system releases the lock when that
//! process ends. So a file that can be locked belongs to nobody.

use std::fs::File;
use std::path::{Path, PathBuf};

/// Letters and digits between the name and the ending.
const RANDOM_LENGTH: usize = 6;

/// The ending.
const ENDING: &str = ".part";

/// The name of the file that a temporary file stands for.
pub(super) fn final_name(temporary: &str) -> Option<&str> {
    let stem = temporary.strip_prefix('.')?.strip_suffix(ENDING)?;
    let at = stem.len().checked_sub(RANDOM_LENGTH).filter(|&at| at > 0 && stem.is_char_boundary(at))?;
    let (name, random) = stem.split_at(at);
    random.bytes().all(|byte| byte.is_ascii_alphanumeric()).then_some(name)
}

/// A new temporary file beside `name` in `folder`, locked until it is closed.
///
/// Where the system has no locks the file is not locked, and [`remove_unfinished`] leaves it alone.
pub(super) fn temporary(folder: &Path, name: &std::ffi::OsStr) -> std::io::Result<tempfile::NamedTempFile> {
    let mut prefix = std::ffi::OsString::from(".");
    prefix.push(name);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(ENDING).rand_bytes(RANDOM_LENGTH);
    #[cfg(unix)]
    {
        // As any new file, less the umask; the crate's own default would keep other users of a group from reading it.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    loop {
        let file = builder.tempfile_in(folder)?;
        // Between the two lines above and below, a cleaning process may have taken it for one that belongs to nobody.
        match file.as_file().try_lock() {
            Err(std::fs::TryLockError::WouldBlock) => {}
            _ if !file.path().exists() => {}
            _ => return Ok(file),
        }
    }
}

/// Whether [`write_atomically`](crate::io::write_atomically) could make a file of this name; leaves nothing behind.
///
/// # Errors
/// What the system says: no permission, no room, a name too long.
pub fn try_name(folder: &Path, name: &std::ffi::OsStr) -> std::io::Result<()> {
    temporary(folder, name)?.close()
}

/// Removes the temporary files in `folder` that belong to no process; `known` tells whether the file that one was to become is a
/// file of the caller's.
///
/// Files that are still written are left, and all where the system has no locks. Gives what was removed.
///
/// # Errors
/// A folder that cannot be read. A file that cannot be removed is left.
pub fn remove_unfinished(folder: &Path, known: impl Fn(&str) -> bool) -> std::io::Result<Vec<PathBuf>> {
    let mut removed = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let ours = name.to_str().and_then(final_name).is_some_and(&known);
        if ours && entry.file_type()?.is_file() {
            let path = entry.path();
            let free = File::options().write(true).open(&path).is_ok_and(|file| {
                // Removed while locked: who has just made it sees that it is gone and makes another one.
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
