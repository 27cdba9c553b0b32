//! [`PackingError`]: invalid disks, and the range of radii.

/// Smallest radius \[length\]: the square of its rounding, 10⁻¹⁶ of the radius, is still a normal number.
pub const SMALLEST_RADIUS: f64 = 1e-130;

/// Largest radius \[length\]: the square of ten radii does not overflow, nor do forces for stiffness constants up to
/// 10¹⁵⁰.
pub const LARGEST_RADIUS: f64 = 1e150;

/// Why disks do not form a packing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PackingError {
    /// There is no disk.
    #[error("a packing needs at least one disk")]
    NoDisks,
    /// The columns differ in length.
    #[error("{positions} positions but {radii} radii")]
    LengthsDiffer {
        /// Number of positions.
        positions: usize,
        /// Number of radii.
        radii: usize,
    },
    /// More disks than an index can count.
    #[error("{count} disks: at most {} are supported", u32::MAX)]
    TooManyDisks {
        /// Number of disks.
        count: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("disk {disk}: coordinate {axis} is {value}, not a finite number")]
    PositionNotFinite {
        /// Index of the disk, from 0.
        disk: usize,
        /// Axis, from 0.
        axis: usize,
        /// The value found.
        value: f64,
    },
    /// A load is NaN or infinite.
    #[error("disk {disk}: component {axis} of its load is {value}, not a finite number")]
    LoadNotFinite {
        /// Index of the disk, from 0.
        disk: usize,
        /// Axis, from 0.
        axis: usize,
        /// The value found.
        value: f64,
    },
    /// A radius is so small or large that squares of lengths underflow or overflow.
    #[error(
        "disk {disk}: radius is {radius:e}, outside {SMALLEST_RADIUS:e} to {LARGEST_RADIUS:e}, where squares of lengths keep their digits"
    )]
    RadiusOutOfRange {
        /// Index of the disk, from 0.
        disk: usize,
        /// The value found.
        radius: f64,
    },
    /// A component of a mixture has an invalid radius.
    #[error(
        "mixture component {component}: radius is {radius:?}, not a number from {SMALLEST_RADIUS:e} to {LARGEST_RADIUS:e}"
    )]
    MixtureRadiusOutOfRange {
        /// Index of the component, from 0.
        component: usize,
        /// The value found.
        radius: f64,
    },
    /// The share of a component of a mixture is not positive and finite.
    #[error("mixture component {component}: share is {share}, not a positive number")]
    MixtureShareNotPositive {
        /// Index of the component, from 0.
        component: usize,
        /// The value found.
        share: f64,
    },
    /// A side of the box is not positive.
    #[error("box axis {axis}: side {length} from {corner} is not a finite box of positive length")]
    BoxNotPositive {
        /// Axis, from 0.
        axis: usize,
        /// The side given.
        length: f64,
        /// The lower end given.
        corner: f64,
    },
    /// An edge of the box has a component along an axis after its own, or one that is no number.
    #[error(
        "box edge {edge}: component {value} along axis {axis}; an edge may have finite components up to its own axis only"
    )]
    EdgeNotTriangular {
        /// The edge, from 0.
        edge: usize,
        /// Axis of the component, from 0.
        axis: usize,
        /// The component given.
        value: f64,
    },
    /// The box is so small that a disk would touch two images of one neighbour.
    #[error(
        "box axis {axis}: side {length} is below twice the longest contact range {range}, so a pair has more than one image in contact"
    )]
    BoxTooSmall {
        /// Axis, from 0.
        axis: usize,
        /// The side given.
        length: f64,
        /// Largest distance of two touching disks.
        range: f64,
    },
    /// Two centres at one point: the direction of their force is undefined.
    #[error("disks {first} and {second} have the same centre: the direction of their contact force is undefined")]
    CoincidentCentres {
        /// The first disk: its index, from 0, or its label if a command reports the error.
        first: usize,
        /// The second disk.
        second: usize,
    },
}

impl PackingError {
    /// The same error with disks named by their labels, as a file numbers them.
    #[must_use]
    pub fn with_labels(self, labels: &[u64]) -> Self {
        let label = |disk: usize| labels.get(disk).and_then(|&label| usize::try_from(label).ok()).unwrap_or(disk);
        match self {
            PackingError::CoincidentCentres { first, second } => {
                PackingError::CoincidentCentres { first: label(first), second: label(second) }
            }
            other => other,
        }
    }
}
