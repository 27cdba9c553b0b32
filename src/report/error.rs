//! [`ReportError`]: why a report was not written.

use std::path::PathBuf;

use crate::io::WriteError;
#[cfg(feature = "plot")]
use crate::report::figures;

/// Why a report was not written. The files of an earlier report are then unchanged, unless the error states otherwise.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The folder could not be made.
    #[error("{folder}: the folder could not be created: {source}")]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// Nothing can be written into the folder.
    #[error("{folder}: cannot write into the folder: {source}")]
    NotWritable {
        /// The folder.
        folder: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// No file with this name can be created.
    #[error("{field} = \"{value}\": the file `{name}` ({} characters) cannot be created in {folder}: {source}", name.chars().count())]
    Name {
        /// The origin of the name.
        field: &'static str,
        /// Its value.
        value: String,
        /// The name.
        name: String,
        /// The folder.
        folder: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// A complete report could not be moved to its place; it stays complete, and the next command on the folder tries
    /// again.
    #[error(
        "{path}: {source}; the report is complete in a hidden folder beside it, and the next run or analysis of the folder moves it into place"
    )]
    Place {
        /// The file or folder.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// Another process is moving a report into the same folder and does not end.
    #[error(
        "{folder}: locked by another process; the report is complete in a hidden folder in it, and the next run or analysis of the folder moves it into place"
    )]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The report cannot be written as JSON.
    #[error("{path}: {source}")]
    Json {
        /// The file.
        path: PathBuf,
        /// The problem.
        source: serde_json::Error,
    },
    /// A figure could not be drawn.
    #[cfg(feature = "plot")]
    #[error(transparent)]
    Figure(#[from] figures::FigureError),
}
