//! [`write_atomically`]: a file is written either completely or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::io::unfinished::temporary;

/// Why a file was not written. An earlier file with that name is then unchanged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// An error of the folder, the disk or the writer.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// A folder or device has that name; a file must not replace it.
    #[error("{path}: exists, but is not a file, or is a device")]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// The number of values of a column differs from disks × width.
    #[error("{path}: column {column} has {found} values, expected {expected} (disks × width)")]
    ColumnLength {
        /// The file.
        path: PathBuf,
        /// Name of the column.
        column: String,
        /// Number of values expected.
        expected: usize,
        /// Number of values given.
        found: usize,
    },
    /// The name of a column or key is reserved, repeated or invalid.
    #[error("{path}: name `{name}` is reserved, repeated or not made of letters, digits, `_`, `-` and `.`")]
    Name {
        /// The file.
        path: PathBuf,
        /// Name of the column or key.
        name: String,
    },
    /// A value contains a line break or another control character.
    #[error("{path}: the value of `{key}` has a line break or control character: {value:?}")]
    PropertyValue {
        /// The file.
        path: PathBuf,
        /// Its key.
        key: String,
        /// The value.
        value: String,
    },
    /// The packing has data that the format cannot contain and whose loss a reader would not notice.
    #[error("{path}: the format LAMMPS data cannot store {what}")]
    NoPlaceFor {
        /// The file.
        path: PathBuf,
        /// The data that would be lost.
        what: &'static str,
    },
}

/// Writes a temporary file in the same folder, and renames it when it is complete and on disk.
///
/// A reader of `path` sees either the old or the new content, even if the program is stopped or the power fails. A
/// symbolic link is replaced, not followed.
///
/// # Errors
/// [`WriteError::Io`] with the path, for errors of the folder, the disk or `write`; [`WriteError::NotAFile`] for
/// folders and devices.
///
/// # Example
/// ```
/// use std::io::Write;
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("numbers.txt");
/// jamscope::io::write_atomically(&path, |writer| writer.write_all(b"1 2 3\n"))?;
/// assert_eq!(std::fs::read(&path)?, b"1 2 3\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_atomically<F>(path: impl AsRef<Path>, write: F) -> Result<(), WriteError>
where
    F: FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
{
    let path = path.as_ref();
    check_place(path)?;
    replace(path, write).map_err(|source| WriteError::Io { path: path.into(), source })
}

/// Refuses a path that [`write_atomically`] would refuse: a folder, or a device.
///
/// # Errors
/// [`WriteError::NotAFile`].
pub fn check_place(path: &Path) -> Result<(), WriteError> {
    // A link such as /dev/stdout leads to a file now and then, but must not be replaced.
    let is_device = path.starts_with("/dev") || path.starts_with("/proc");
    if is_device || path.metadata().is_ok_and(|there| !there.is_file()) {
        return Err(WriteError::NotAFile { path: path.into() });
    }
    Ok(())
}

fn replace<F>(path: &Path, write: F) -> io::Result<()>
where
    F: FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
{
    let Some(name) = path.file_name() else {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "the path names no file"));
    };
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut temporary = temporary(folder, name)?;
    let mut writer = BufWriter::new(temporary.as_file_mut());
    write(&mut writer)?;
    writer.flush()?;
    drop(writer);
    temporary.as_file().sync_all()?;
    temporary.persist(path).map_err(|error| error.error)?;
    // Writes the directory entry to disk. Not every system supports it, and the content is already safe.
    #[cfg(unix)]
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
    Ok(())
}
