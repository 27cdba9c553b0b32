//! [`StoreError`]: why the folder of a study could not be used.

use std::path::PathBuf;

use crate::io::WriteError;

/// Why a folder cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The system refused.
    #[error("{path}: {source}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Another study lives there.
    #[error(
        "{path}: the folder holds another study; give this one a folder of its own, or say that it takes that one's place \
         (samples both have are kept, those of the other are left alone)"
    )]
    OtherStudy {
        /// The file that says so.
        path: PathBuf,
    },
    /// No study lives there.
    #[error("{path}: not there, so the folder holds no study")]
    NoStudy {
        /// The file looked for.
        path: PathBuf,
    },
    /// The study of the folder cannot be understood.
    #[error("{path}: {reason}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Somebody else runs the same part of it.
    #[error("{path}: locked, another process runs the study in this folder, or this part of it; nothing was changed")]
    Locked {
        /// The lock.
        path: PathBuf,
    },
}
