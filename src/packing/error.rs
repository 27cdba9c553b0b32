//! [`PackingError`]: what is wrong with the disks given, and which radii a disk can have.

/// Smallest radius \[length\]: the square of its rounding, 10⁻³² of its own, is still a normal number.
pub const SMALLEST_RADIUS: f64 = 1e-130;

/// Largest radius \[length\]: the square of ten of them is still a number, and so are forces of stiffness constants up to 10¹⁵⁰.
pub const LARGEST_RADIUS: f64 = 1e150;

/// What is wrong with the disks given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PackingError {
    /// Not a single disk.
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
    /// More disks than an index holds.
    #[error("{count} disks: at most {} are supported", u32::MAX)]
    TooManyDisks {
        /// Number of disks.
        count: usize,
    },
    /// NaN or infinite coordinate.
    #[error("disk {disk}: coordinate {axis} is {value}, not a finite number")]
    PositionNotFinite {
        /// Index of the disk, from 0.
        disk: usize,
        /// Axis, from 0.
        axis: usize,
        /// The value found.
        value: f64,
    },
    /// A radius whose square, or that of whose rounding, is not a number.
    #[error(
        "disk {disk}: radius is {radius:e}, outside {SMALLEST_RADIUS:e} to {LARGEST_RADIUS:e}, where squares of lengths keep their digits"
    )]
    RadiusOutOfRange {
        /// Index of the disk, from 0.
        disk: usize,
        /// The value found.
        radius: f64,
    },
    /// A kind of disk in a mixture with a radius that no disk can have.
    #[error(
        "mixture component {component}: radius is {radius:?}, not a number from {SMALLEST_RADIUS:e} to {LARGEST_RADIUS:e}"
    )]
    MixtureRadiusOutOfRange {
        /// Index of the component, from 0.
        component: usize,
        /// The value found.
        radius: f64,
    },
    /// A kind of disk in a mixture with a share that is not a positive finite number.
    #[error("mixture component {component}: share is {share}, not a positive number")]
    MixtureShareNotPositive {
        /// Index of the component, from 0.
        component: usize,
        /// The value found.
        share: f64,
    },
    /// A box without extent.
    #[error("box axis {axis}: side {length} from {corner} is not a finite box of positive length")]
    BoxNotPositive {
        /// Axis, from 0.
        axis: usize,
        /// Side found.
        length: f64,
        /// Lower end found.
        corner: f64,
    },
    /// The box is so small that a disk would touch two images of one neighbour.
    #[error(
        "box axis {axis}: side {length} is below twice the longest contact range {range}, so a pair has more than one image in contact"
    )]
    BoxTooSmall {
        /// Axis, from 0.
        axis: usize,
        /// Side found.
        length: f64,
        /// Largest distance of two touching disks.
        range: f64,
    },
    /// Two centres at one point: the direction of their force is undefined.
    #[error("disks {first} and {second} have the same centre: the direction of their contact force is undefined")]
    CoincidentCentres {
        /// Index of the first disk, from 0.
        first: usize,
        /// Index of the second disk, from 0.
        second: usize,
    },
}
