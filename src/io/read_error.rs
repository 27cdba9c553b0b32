//! [`ReadError`]: why a file was not read as a packing.

use std::path::PathBuf;

use crate::packing::PackingError;

/// Why a file was not read as a packing. Lines count from 1; long values are shortened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file could not be opened or read.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Nothing but blank lines.
    #[error("{path}: the file is empty")]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// Not UTF-8, so none of the text formats.
    #[error("{path}, line {line}: not text; binary and compressed files are not read")]
    NotText {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
    },
    /// None of the formats known.
    #[error(
        "{path}: no known format; it starts with `{first_line}`. Known are extended XYZ (first line: the number of disks), LAMMPS data (a line `N atoms` before the sections) and LAMMPS text dump (first line: `ITEM: ...`)"
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// Its first line that is not blank.
        first_line: String,
    },
    /// No line break at the end.
    #[error(
        "{path}, line {line}: the last line has no line break, so the file may have been cut; add one if it is complete"
    )]
    LineCut {
        /// The file.
        path: PathBuf,
        /// The last line, from 1.
        line: usize,
    },
    /// The file ends too early.
    #[error("{path}, line {line}: the file or section ends after {found} of {expected} {what}")]
    Truncated {
        /// The file.
        path: PathBuf,
        /// The last line there is, from 1.
        line: usize,
        /// What was being counted.
        what: &'static str,
        /// Number announced.
        expected: usize,
        /// Number found.
        found: usize,
    },
    /// More disks than announced.
    #[error("{path}, line {line}: a disk more than the {expected} announced")]
    TooManyRows {
        /// The file.
        path: PathBuf,
        /// The first line too many, from 1.
        line: usize,
        /// Number announced.
        expected: usize,
    },
    /// A row with more or fewer values than there are columns.
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
    /// A value that is not what it must be.
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
        /// What it must be.
        expected: &'static str,
    },
    /// Something the packing cannot be known without.
    #[error("{path}, line {line}: {field} is missing; found: {found}")]
    Missing {
        /// The file.
        path: PathBuf,
        /// Line where it belongs, from 1.
        line: usize,
        /// The column, key or header line.
        field: &'static str,
        /// What there is instead.
        found: String,
    },
    /// An id, column, key, header line, section or item that stands twice.
    #[error("{path}, line {line}: {field} `{value}` stands already in line {first_line}")]
    Repeated {
        /// The file.
        path: PathBuf,
        /// The later line, from 1.
        line: usize,
        /// What is repeated.
        field: &'static str,
        /// Its value.
        value: String,
        /// The earlier line, from 1.
        first_line: usize,
    },
    /// A low part of a coordinate that is too large for one.
    #[error(
        "{path}, line {line}: {field} {axis} is `{value}`, expected a low part of the coordinate {coordinate:?}: below {:e}, the spacing of numbers there", spacing(*.coordinate)
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
        /// The coordinate it belongs to \[length\].
        coordinate: f64,
    },
    /// A coordinate so far out that its rounding is not small.
    #[error(
        "{path}, line {line}: {field} is {value:?}, beyond {limit:?}, a million times {unit}: six of its 16 digits are lost there, and overlaps with them"
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
        /// Largest value on either side of the origin \[length\].
        limit: f64,
        /// The length it is a million times of.
        unit: &'static str,
    },
    /// A box that is not a rectangle along the axes.
    #[error(
        "{path}, line {line}: the box is tilted ({field} is `{value}`, not 0); only rectangular boxes are supported"
    )]
    Tilted {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The component.
        field: String,
        /// Its value.
        value: String,
    },
    /// A direction that is not periodic while others are, or a LAMMPS box with walls or free sides.
    #[error(
        "{path}, line {line}: {field} is `{value}`, so axis {axis} is not periodic; a packing is periodic in all its directions or lies in the open plane (extended XYZ with pbc=\"F F F\")"
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
    /// A packing of another dimension.
    #[error("{path}, line {line}: {field} is `{value}`: this is not a packing in {dimension} dimensions")]
    Dimension {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What shows it.
        field: &'static str,
        /// Its value.
        value: String,
        /// The dimension asked for.
        dimension: usize,
    },
    /// A LAMMPS data file of another atom style.
    #[error("{path}, line {line}: atom style is `{style}`, only `sphere` has diameters of disks that can be read")]
    AtomStyle {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The style named.
        style: String,
    },
    /// A frame beyond the last.
    #[error("{path}: no frame {frame} (counted from 0), the file has {frame_count}")]
    NoSuchFrame {
        /// The file.
        path: PathBuf,
        /// The frame asked for, from 0.
        frame: usize,
        /// Number of frames.
        frame_count: usize,
    },
    /// The disks do not make a packing.
    #[error("{path}: {source}")]
    Packing {
        /// The file.
        path: PathBuf,
        /// What is wrong with them.
        source: PackingError,
    },
}

/// From a number to the next one that is larger in size.
pub(super) fn spacing(number: f64) -> f64 {
    number.abs().next_up() - number.abs()
}
