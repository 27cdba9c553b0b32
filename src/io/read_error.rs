//! [`ReadError`]: why a file was not read as a packing.

use std::path::PathBuf;

use crate::io::npz::error::ArchiveError;
use crate::packing::PackingError;

/// Why a file was not read as a packing. Line numbers start at 1; long values are shortened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file could not be opened or read.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The file contains only blank lines.
    #[error("{path}: the file is empty")]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// A compressed file cannot be decompressed.
    #[error("{path}: the compressed file is damaged or cut: {source}")]
    Compressed {
        /// The file.
        path: PathBuf,
        /// The error of the decompression.
        source: std::io::Error,
    },
    /// The file is not UTF-8 text.
    #[error(
        "{path}, line {line}: not text; of binary files only NumPy archives (.npz) and those compressed by gzip or zstd are read"
    )]
    NotText {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
    },
    /// The format is unknown.
    #[error(
        "{path}: no known format; it starts with `{first_line}`. Known are extended XYZ (first line: the number of disks), LAMMPS data (a line `N atoms` before the sections), LAMMPS text dump (first line: `ITEM: ...`) and NumPy archives (.npz)"
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// Its first line that is not blank.
        first_line: String,
    },
    /// The file ends too early.
    #[error("{path}, line {line}: the file or section ends after {found} of {expected} {what}")]
    Truncated {
        /// The file.
        path: PathBuf,
        /// The last line, from 1.
        line: usize,
        /// The counted items.
        what: &'static str,
        /// Number announced.
        expected: usize,
        /// Number found.
        found: usize,
    },
    /// There are more disks than announced.
    #[error("{path}, line {line}: there are more disks than the {expected} announced")]
    TooManyRows {
        /// The file.
        path: PathBuf,
        /// The first additional line, from 1.
        line: usize,
        /// Number announced.
        expected: usize,
    },
    /// The number of values of a row differs from that of the columns.
    #[error("{path}, line {line}: {found} values, expected {expected}")]
    ColumnCount {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Number expected.
        expected: String,
        /// Number found.
        found: usize,
    },
    /// A value is invalid.
    #[error("{path}, line {line}: {field} is `{value}`, expected {expected}")]
    Value {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The column, key or header line.
        field: String,
        /// The text found.
        value: String,
        /// A valid value.
        expected: &'static str,
    },
    /// Required information is missing.
    #[error("{path}, line {line}: {field} is missing; found: {found}")]
    Missing {
        /// The file.
        path: PathBuf,
        /// Expected line, from 1.
        line: usize,
        /// The column, key or header line.
        field: &'static str,
        /// What was found instead.
        found: String,
    },
    /// A duplicate id, column, key, header line, section or item.
    #[error("{path}, line {line}: {field} `{value}` is already in line {first_line}")]
    Repeated {
        /// The file.
        path: PathBuf,
        /// The later line, from 1.
        line: usize,
        /// The repeated field.
        field: &'static str,
        /// Its value.
        value: String,
        /// The earlier line, from 1.
        first_line: usize,
    },
    /// The low part of a coordinate is too large.
    #[error(
        "{path}, line {line}: {field} {axis} is `{value}`, expected a correction of the coordinate {coordinate:?} below {:e}, the spacing of floating-point numbers there", spacing(*.coordinate)
    )]
    CorrectionTooLarge {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The column.
        field: &'static str,
        /// The axis: x, y or z.
        axis: char,
        /// The text found.
        value: String,
        /// The coordinate \[length\].
        coordinate: f64,
    },
    /// A coordinate is so large that its rounding is not negligible.
    #[error(
        "{path}, line {line}: {field} is {value:?}, beyond the limit {limit:?}, a million times {unit}: six of its 16 digits would be lost, and overlaps would be inaccurate"
    )]
    TooFar {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The coordinate.
        field: String,
        /// Its value \[length\].
        value: f64,
        /// Largest absolute value \[length\].
        limit: f64,
        /// The length of which the limit is a million times.
        unit: &'static str,
    },
    /// The box of a plane is tilted against the plane.
    #[error(
        "{path}, line {line}: {field} is `{value}`, not 0: the box is tilted out of the plane{}",
        other_dimension(2)
    )]
    OutOfPlane {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The component.
        field: String,
        /// Its value.
        value: String,
    },
    /// A direction is not periodic while others are, or a LAMMPS box has walls or free sides.
    #[error(
        "{path}, line {line}: {field} is `{value}`, so axis {axis} is not periodic while another is; a packing is periodic in all its directions or in none. If the disks within the outer radius touch no wall and no image, write all flags as not periodic (pbc=\"F F F\", or ff ff in a dump) and give --outer-radius"
    )]
    NotPeriodic {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The key or header line.
        field: &'static str,
        /// Its value.
        value: String,
        /// The axis: x, y or z.
        axis: char,
    },
    /// The packing has another dimension.
    #[error("{path}, line {line}: {field} is `{value}`: this is not a packing in {dimension} dimensions{}", other_dimension(*.dimension))]
    Dimension {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The field that shows it.
        field: &'static str,
        /// Its value.
        value: String,
        /// The dimension requested.
        dimension: usize,
    },
    /// Several columns could be the label of a disk.
    #[error(
        "{path}, line {line}: columns {first} and {second} could both be the label of a disk; leave out one of them or rename it"
    )]
    TwoLabels {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The first column.
        first: String,
        /// The second column.
        second: String,
    },
    /// A LAMMPS data file does not name its atom style.
    #[error(
        "{path}, line {line}: section Atoms names no style; several have rows of this length (sphere, full, ellipsoid, peri). If the columns are id type diameter density x y z, write `Atoms # sphere`"
    )]
    NoAtomStyle {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
    },
    /// A LAMMPS data file has another atom style.
    #[error("{path}, line {line}: atom style is `{style}`: must be `sphere`, the only supported style with diameters")]
    AtomStyle {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The style given.
        style: String,
    },
    /// The frame does not exist.
    #[error("{path}: no frame {frame} (counted from 0); the file has {frame_count} frames")]
    NoSuchFrame {
        /// The file.
        path: PathBuf,
        /// The frame requested, from 0.
        frame: usize,
        /// Number of frames.
        frame_count: usize,
    },
    /// A NumPy archive does not contain a packing.
    #[error("{path}: {source}")]
    Archive {
        /// The file.
        path: PathBuf,
        /// The problem.
        source: Box<ArchiveError>,
    },
    /// The disks are invalid.
    #[error("{path}: {source}")]
    Packing {
        /// The file.
        path: PathBuf,
        /// The problem.
        source: PackingError,
    },
}

/// The dimension to try instead.
fn other_dimension(dimension: usize) -> &'static str {
    if dimension == 2 { " (`--dimension 3` reads three)" } else { "" }
}

/// The distance from a number to the next larger one in absolute value.
pub(super) fn spacing(number: f64) -> f64 {
    number.abs().next_up() - number.abs()
}
