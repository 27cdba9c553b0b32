//! [`Shape`]: the shape of the region in which disks respond to an inflation.

/// The shape of the region of a displacement field.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Shape {
    /// A circle, a sphere or a box: distances and radial parts are from the inflated disk.
    #[default]
    Round,
    /// A strip along the first axis, of this length and periodic along it: distances and radial parts are from the line
    /// through the inflated disk, across the strip \[length\].
    Strip {
        /// Period along the strip \[length\].
        length: f64,
    },
}

/// The inflated disks and the region around them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Region<'a> {
    /// The disk, or that of the row through which the line runs.
    pub centre: usize,
    /// All inflated disks.
    pub grown: &'a [usize],
    pub inner_radius: f64,
    pub outer_radius: f64,
    pub shape: Shape,
}
