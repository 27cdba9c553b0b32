//! [`Frame`]: selects a packing of a file with several frames.

use std::path::Path;

use crate::io::read_error::ReadError;

/// Selects a packing of a file with several frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Frame {
    /// The last one.
    #[default]
    Last,
    /// By index in the file, from 0.
    Index(usize),
}

impl Frame {
    /// Its index among the `count` frames of a file.
    pub(super) fn index_of(self, path: &Path, count: usize) -> Result<usize, ReadError> {
        let index = match self {
            Frame::Last => count.saturating_sub(1),
            Frame::Index(index) => index,
        };
        if index < count {
            return Ok(index);
        }
        Err(ReadError::NoSuchFrame { path: path.into(), frame: index, frame_count: count })
    }
}
