//! [`ReportError`]: why a report was not written.

use std::path::PathBuf;

use crate::io::WriteError;
#[cfg(feature = "plot")]
use crate::report::figures;

/// Why a report was not written; the files of an earlier one are then untouched, unless the error says otherwise.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The folder could not be made.
    #[error("{folder}: the folder could not be made: {source}")]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Nothing can be written into the folder.
    #[error("{folder}: nothing can be written into the folder: {source}")]
    NotWritable {
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file of this name cannot be made.
    #[error("{field} = \"{value}\": no file `{name}` ({} letters) can be made in {folder}: {source}", name.chars().count())]
    Name {
        /// What the name comes from.
        field: &'static str,
        /// Its value.
        value: String,
        /// The name.
        name: String,
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A complete report could not be put in its place; it stays complete, and the next command on the folder tries again.
    #[error(
        "{path}: {source}; the report is complete in a hidden folder beside it, and the next run or analysis of the folder moves it"
    )]
    Place {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Another process puts a report into the same folder and does not end.
    #[error(
        "{folder}: locked by another process; the report is complete in a hidden folder in it, and the next run or analysis of the folder moves it"
    )]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The report has no form as JSON.
    #[error("{path}: {source}")]
    Json {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: serde_json::Error,
    },
    /// A figure could not be drawn.
    #[cfg(feature = "plot")]
    #[error(transparent)]
    Figure(#[from] figures::FigureError),
}
