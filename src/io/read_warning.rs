//! [`ReadWarning`]: what was read but should be known.

/// What was read but should be known. Line numbers start at 1.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadWarning {
    /// There is no line break at the end.
    #[error("line {line}: the last line has no line break, so its last number may have been cut")]
    LastLineOpen {
        /// The last line.
        line: usize,
    },
    /// A LAMMPS dump does not say whether its box is periodic.
    #[error("line {line}: ITEM: BOX BOUNDS has no boundary flags; the box is taken as periodic")]
    NoBoundaryFlags {
        /// Line of the item.
        line: usize,
    },
    /// The edges of the box do not lie along the axes as those of a packing do.
    #[error(
        "line {line}: the first edge of the box does not lie along x; the packing is turned so that it does, and all coordinates and directions are those after the turn"
    )]
    Turned {
        /// Line of the box.
        line: usize,
    },
    /// The centres of a NumPy archive have single precision.
    #[error(
        "array {array}: the centres have single precision (f4), so distances have errors of 1e-7 of the coordinates; relax the packing, or save them as f8"
    )]
    SinglePrecision {
        /// The array.
        array: String,
    },
    /// A LAMMPS box has walls or free sides.
    #[error(
        "line {line}: ITEM: BOX BOUNDS is `{flags}`: the packing lies in the open plane, and walls are not in the file; disks at a wall are not balanced, so give an outer radius R within the walls"
    )]
    Walls {
        /// Line of the item.
        line: usize,
        /// The flags.
        flags: String,
    },
}
