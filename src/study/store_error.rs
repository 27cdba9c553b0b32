//! [`StoreError`]: why the folder of a study could not be used.

use std::path::PathBuf;

use crate::io::WriteError;

/// Why a folder cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// An error of the operating system.
    #[error("{path}: {source}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The folder contains another study.
    #[error(
        "{path}: the folder contains another study; choose another folder, or replace that study with --replace \
         (samples of both studies are kept)"
    )]
    OtherStudy {
        /// The file of that study.
        path: PathBuf,
    },
    /// The folder contains no study.
    #[error("{path}: not found, so the folder contains no study")]
    NoStudy {
        /// The missing file.
        path: PathBuf,
    },
    /// The study of the folder cannot be read.
    #[error("{path}: {reason}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The problem.
        reason: String,
    },
    /// Another process runs the same part.
    #[error(
        "{path}: locked: another process is running the study in this folder, or this part of it; nothing was changed"
    )]
    Locked {
        /// The lock.
        path: PathBuf,
    },
}
