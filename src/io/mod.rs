//! Packings in files: [`read_packing`] recognises the format by the content, [`write_packing`] writes extended XYZ,
//! [`write_lammps_data`] LAMMPS data, [`write_npz`] NumPy archives.
//!
//! | format | read | written | radii from |
//! |---|---|---|---|
//! | extended XYZ (ASE, OVITO) | yes | yes, to the same bits | column `radius` |
//! | LAMMPS data, `atom_style sphere` | yes | yes, without corrections | column `diameter` |
//! | LAMMPS text dump | yes | no | column `radius` or `diameter` |
//! | NumPy archive `.npz` | yes | yes, to the same bits | array `radii` or `diameters` |
//!
//! Files compressed by gzip or zstd are decompressed.
//!
//! Missing information is an error and never guessed: radii, sides of the box, the style of atoms. Duplicate
//! information is also refused: a key, a header line, a section, an item of a frame. So are coordinates beyond a
//! million of the largest radii: a number has 16 digits, and six of them are lost there. Each [`ReadError`] contains
//! the file, the line, the field and the text found. What is read but should be known is a [`ReadWarning`]: a last line
//! without a line break, which may have been cut; a box without boundary flags; walls that are not in the file.

pub mod atomic;
mod comment_line;
mod contents;
mod decompress;
pub mod extended_xyz;
mod frame;
pub mod lammps_data;
pub mod lammps_dump;
pub mod npz;
mod plane;
mod read_error;
mod read_warning;
mod source;
mod triclinic;
mod unfinished;
mod write_lammps_data;
mod write_packing;
mod xyz_columns;

use std::path::Path;

pub use atomic::{WriteError, check_place, write_atomically};
pub use contents::Contents;
pub use frame::Frame;
pub use npz::{ArchiveError, write_npz};
pub use read_error::ReadError;
pub use read_warning::ReadWarning;
pub use unfinished::{remove_unfinished, try_name};
pub use write_lammps_data::write_lammps_data;
pub use write_packing::{Column, write_packing};

use crate::packing::Packing;
use source::Source;

/// The formats that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    ExtendedXyz,
    LammpsData,
    LammpsDump,
}

/// Reads a packing from extended XYZ, LAMMPS data, a LAMMPS text dump or a NumPy archive, recognised by the content. Of several frames
/// the last is read.
///
/// Disks are in the order of the file for extended XYZ, and in ascending order of their ids for LAMMPS (whose own order
/// changes between outputs). Ids become [`Packing::labels`]. Positions are not wrapped into the box.
///
/// # Errors
/// [`ReadError`] with the file, the line, the field and the value.
///
/// # Cost
/// The whole file is in memory, once.
///
/// # Example
/// ```
/// let packing = jamscope::io::read_packing::<2>("fixtures/packings/hertz_N1000_p100.xyz")?;
/// assert_eq!(packing.len(), 1000);
/// # Ok::<(), jamscope::io::ReadError>(())
/// ```
pub fn read_packing<const D: usize>(path: impl AsRef<Path>) -> Result<Packing<D>, ReadError> {
    read_frame(path, Frame::Last)
}

/// Like [`read_packing`], for a given frame.
///
/// # Errors
/// See [`read_packing`]; also [`ReadError::NoSuchFrame`].
pub fn read_frame<const D: usize>(path: impl AsRef<Path>, frame: Frame) -> Result<Packing<D>, ReadError> {
    read_contents(path, frame).map(|contents| contents.packing)
}

/// Like [`read_frame`], with the key-value pairs of the frame and the warnings.
///
/// # Errors
/// See [`read_frame`].
///
/// # Example
/// ```
/// use jamscope::io::{Frame, read_contents};
/// let contents = read_contents::<2>("fixtures/packings/hooke_N1000_p100.xyz", Frame::Last)?;
/// assert!(contents.properties.contains(&("law".into(), "hooke".into())));
/// assert!(contents.warnings.is_empty());
/// # Ok::<(), jamscope::io::ReadError>(())
/// ```
pub fn read_contents<const D: usize>(path: impl AsRef<Path>, frame: Frame) -> Result<Contents<D>, ReadError> {
    const { assert!(D == 2 || D == 3, "packings have two or three dimensions") };
    let path = path.as_ref();
    let bytes = bytes_of(path)?;
    if npz::is_archive(&bytes) {
        return npz::parse(path, &bytes, frame);
    }
    with_source(path, &bytes, |source, format| {
        let mut contents = match format {
            Format::ExtendedXyz => extended_xyz::parse(source, frame),
            Format::LammpsData => lammps_data::parse(source, frame),
            Format::LammpsDump => lammps_dump::parse(source, frame),
        }?;
        if source.is_open() {
            contents.warnings.insert(0, ReadWarning::LastLineOpen { line: source.lines.len() });
        }
        Ok(contents)
    })
}

/// Number of frames of a file.
///
/// # Errors
/// [`ReadError`] as for [`read_packing`], without those of the disks.
pub fn frame_count(path: impl AsRef<Path>) -> Result<usize, ReadError> {
    let path = path.as_ref();
    let bytes = bytes_of(path)?;
    if npz::is_archive(&bytes) {
        return npz::frame_count(path, &bytes);
    }
    with_source(path, &bytes, |source, format| match format {
        Format::ExtendedXyz => extended_xyz::frame_count(source),
        Format::LammpsData => Ok(1),
        Format::LammpsDump => Ok(lammps_dump::starts(source).len()),
    })
}

/// The key-value pairs of the packing that [`read_packing`] would read: those of the comment line of extended XYZ, in
/// its order, arrays without an axis of a NumPy archive; none in other formats.
///
/// # Errors
/// [`ReadError`] as for [`read_packing`], for the comment line alone.
///
/// # Example
/// ```
/// let properties = jamscope::io::read_properties("fixtures/packings/hooke_N1000_p100.xyz")?;
/// assert!(properties.contains(&("law".into(), "hooke".into())));
/// # Ok::<(), jamscope::io::ReadError>(())
/// ```
pub fn read_properties(path: impl AsRef<Path>) -> Result<Vec<(String, String)>, ReadError> {
    properties_of_frame(path, Frame::Last)
}

/// Like [`read_properties`], for a given frame.
///
/// # Errors
/// See [`read_properties`]; also [`ReadError::NoSuchFrame`].
pub fn properties_of_frame(path: impl AsRef<Path>, frame: Frame) -> Result<Vec<(String, String)>, ReadError> {
    let path = path.as_ref();
    let bytes = bytes_of(path)?;
    if npz::is_archive(&bytes) {
        return npz::properties(path, &bytes, frame);
    }
    with_source(path, &bytes, |source, format| match format {
        Format::ExtendedXyz => extended_xyz::properties(source, frame),
        Format::LammpsData | Format::LammpsDump => Ok(Vec::new()),
    })
}

/// The bytes of a file, decompressed.
fn bytes_of(path: &Path) -> Result<Vec<u8>, ReadError> {
    let bytes = std::fs::read(path).map_err(|source| ReadError::Io { path: path.into(), source })?;
    decompress::decompressed(path, bytes)
}

/// Recognises the format of a text and calls `read`.
fn with_source<T>(
    path: &Path,
    bytes: &[u8],
    read: impl FnOnce(&Source, Format) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    let text = std::str::from_utf8(bytes).map_err(|error| ReadError::NotText {
        path: path.into(),
        line: 1 + bytes[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count(),
    })?;
    // A byte-order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let source = Source::new(path, text);
    let Some(first) = source.lines.iter().find(|line| !line.trim().is_empty()) else {
        return Err(ReadError::Empty { path: path.into() });
    };
    let Some(format) = recognise(&source.lines, first) else {
        return Err(ReadError::UnknownFormat { path: path.into(), first_line: source::excerpt(first) });
    };
    read(&source, format)
}

/// The format of a file, from its first lines; `first` is the first that is not blank.
fn recognise(lines: &[&str], first: &str) -> Option<Format> {
    if first.starts_with("ITEM:") {
        return Some(Format::LammpsDump);
    }
    let is_count = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    // A data file begins with a line of free text, possibly a number, but its next line never contains `=`.
    if is_count(first.trim()) && lines.get(1).is_none_or(|comment| comment.contains('=')) {
        return Some(Format::ExtendedXyz);
    }
    let is_data_header = |line: &&str| {
        let mut words = line.split_ascii_whitespace();
        words.next().is_some_and(is_count) && words.next() == Some("atoms")
    };
    if lines.iter().skip(1).take_while(|line| !lammps_data::opens_section(line)).any(is_data_header) {
        return Some(Format::LammpsData);
    }
    is_count(first.trim()).then_some(Format::ExtendedXyz)
}
