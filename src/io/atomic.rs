//! [`write_atomically`]: a file is there whole or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::io::unfinished::temporary;

/// Why a file was not written. A file of that name from before is then untouched.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The folder, the disk or the writer refused.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A folder or device of that name, which a file must not replace.
    #[error("{path}: there is something of that name that is not a file")]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// A column with another number of values than disks × width.
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
    /// A column or key that is taken or cannot be written.
    #[error("{path}: name `{name}` is reserved, repeated or not made of letters, digits, `_`, `-` and `.`")]
    Name {
        /// The file.
        path: PathBuf,
        /// Name of the column or key.
        name: String,
    },
    /// A value with a line break or another control character.
    #[error("{path}: the value of `{key}` has a line break or control character: {value:?}")]
    PropertyValue {
        /// The file.
        path: PathBuf,
        /// Its key.
        key: String,
        /// The value.
        value: String,
    },
    /// What the format cannot say, and a reader would not know of.
    #[error("{path}: LAMMPS data has no place for {what}")]
    NoPlaceFor {
        /// The file.
        path: PathBuf,
        /// What of the packing would be lost.
        what: &'static str,
    },
}

/// Writes a file by way of a temporary one in the same folder, renamed when it is complete and on disk.
///
/// Whoever opens `path` sees the old content or the new one, also when the program is stopped half-way or the power
/// fails. A symbolic link is replaced, not followed.
///
/// # Errors
/// [`WriteError::Io`] with the path, from the folder, the disk or `write` itself; [`WriteError::NotAFile`] for folders
/// and devices.
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
    if path.metadata().is_ok_and(|there| !there.is_file()) {
        return Err(WriteError::NotAFile { path: path.into() });
    }
    replace(path, write).map_err(|source| WriteError::Io { path: path.into(), source })
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
    // The name itself reaches the disk with its folder. Not every system can do that, and the content is safe already.
    #[cfg(unix)]
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
    Ok(())
}
