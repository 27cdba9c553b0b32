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
        "{path}: the folder holds another study; give this one a folder of its own, or say that it takes that one's place \
         (samples both have are kept, those of the other are left alone)"
    )]
    OtherStudy {
        /// The file of that study.
        path: PathBuf,
    },
    /// The folder contains no study.
    #[error("{path}: not there, so the folder holds no study")]
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
    #[error("{path}: locked, another process runs the study in this folder, or this part of it; nothing was changed")]
    Locked {
        /// The lock.
        path: PathBuf,
    },
}
