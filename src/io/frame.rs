//! [`Frame`]: which of the packings in one file.

/// Which of the packings in one file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Frame {
    /// The last one.
    #[default]
    Last,
    /// By position in the file, from 0.
    Index(usize),
}
