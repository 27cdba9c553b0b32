//! [`RunError`]: why a run, or one sample of it, failed.

use std::path::PathBuf;

use crate::inflation::InflationError;
use crate::io::ReadError;
use crate::packing::PackingError;
use crate::preparation::PreparationError;
use crate::relax::Stop;
use crate::scene::SceneError;

/// Why a run, or one sample of it, has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The scene is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A packing could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A packing could not be prepared.
    #[error("preparation: {0}")]
    Preparation(#[from] PreparationError),
    /// A packing is invalid.
    #[error("packing: {0}")]
    Packing(#[from] PackingError),
    /// A packing from a file is invalid.
    #[error("{}: {source}", path.display())]
    PackingOfFile {
        /// The file.
        path: PathBuf,
        /// The problem.
        source: PackingError,
    },
    /// A packing from a file did not come to rest.
    #[error("{}: the relaxation stopped with {stop:?} after {step_count} steps, residual {residual:e}", path.display())]
    NotAtRest {
        /// The file.
        path: PathBuf,
        /// Why it stopped.
        stop: Stop,
        /// Steps taken.
        step_count: usize,
        /// Relative residual reached.
        residual: f64,
    },
    /// The inflation failed.
    #[error("inflation: {0}")]
    Inflation(#[from] InflationError),
}
