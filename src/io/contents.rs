//! [`Contents`]: what one frame of a file contains.

use crate::io::read_warning::ReadWarning;
use crate::packing::Packing;

/// What one frame of a file contains.
#[derive(Debug, Clone, PartialEq)]
pub struct Contents<const D: usize> {
    /// The packing.
    pub packing: Packing<D>,
    /// The key-value pairs of the comment line of extended XYZ, in its order, or the arrays without an axis of a NumPy archive; none in other
    /// formats.
    pub properties: Vec<(String, String)>,
    /// What was read but should be known.
    pub warnings: Vec<ReadWarning>,
}

impl<const D: usize> From<Packing<D>> for Contents<D> {
    fn from(packing: Packing<D>) -> Self {
        Contents { packing, properties: Vec::new(), warnings: Vec::new() }
    }
}
