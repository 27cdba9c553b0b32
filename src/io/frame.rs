//! [`Frame`]: selects a packing of a file with several frames.

/// Selects a packing of a file with several frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Frame {
    /// The last one.
    #[default]
    Last,
    /// By index in the file, from 0.
    Index(usize),
}
