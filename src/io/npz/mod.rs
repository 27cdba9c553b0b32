//! Packings in NumPy archives (`.npz`): what [`read_packing`](crate::io::read_packing) reads and [`write_npz`] writes.
//!
//! | array | shape | names read | written |
//! |---|---|---|---|
//! | centres \[length\] | (N, D), or (N, 3) in a plane; frames: (F, N, D) | `positions`, `position`, `R`, `points`, `pos`, `x`, `coordinates` | `positions` |
//! | radii \[length\] | (N,), or one number; frames: (F, N) | `radii`, `radius`, `rad` | `radii` |
//! | diameters \[length\] | the same, if there are no radii | `diameters`, `diameter`, `sigma` | no |
//! | box \[length\] | sides (D,) or (3,), one side, a triangular matrix (lower: its rows are the edges; upper: its columns), or six numbers of HOOMD; frames: a first axis F | `box`, `BoxMatrix`, `cell_lengths`, `L` | `box`: the sides, or a matrix with the edges of a tilted box as rows |
//! | lower corner of the box \[length\] | (D,) or (3,) | `origin` | `origin` |
//! | whether it is periodic | (), (D,) or (3,) | `pbc`, `periodic` | `pbc` |
//! | labels | (N,) | `labels`, `label`, `ids`, `id` | `labels` |
//! | held disks | (N,) | `held` | `held` |
//! | low parts of the centres, [`corrections`](crate::packing::Packing::corrections) \[length\] | (N, D) | `corrections` | if there are any |
//! | sites and their low parts \[length\] | (N, D) | `sites`, `site_corrections` | if there are any |
//! | constant forces on the disks \[force\] | (N, D) | `loads` | if there are any |
//!
//! Other arrays without an axis, of shape (), are the key-value pairs of the packing: `law`, `stiffness`. All others are ignored. Values are little-endian
//! floats, integers or booleans in C or Fortran order, stored or compressed; arrays of Python objects are refused.

mod archive;
mod array;
mod contents;
pub(super) mod error;
mod write_packing;

use std::path::Path;

pub(crate) use contents::is_reserved;
pub use error::ArchiveError;
pub use write_packing::write_npz;

use crate::io::contents::Contents;
use crate::io::frame::Frame;
use crate::io::plane::FLATNESS;
use crate::io::read_error::{ReadError, spacing};
use crate::io::read_warning::ReadWarning;
use crate::io::source::FARTHEST;
use crate::packing::{Domain, LARGEST_RADIUS, Packing, SMALLEST_RADIUS};
use crate::vector::{Vector, larger};
use array::{Array, Values};
use contents::{
    Arrays, BOX, CENTRES, CORRECTIONS, DIAMETERS, DIMENSION, HELD, LABELS, LOADS, Meaning, ORIGIN, PERIODIC, RADII,
    SITE_CORRECTIONS, SITES,
};

/// Whether a file is a zip archive or a single NumPy array, by its first bytes.
pub(super) fn is_archive(bytes: &[u8]) -> bool {
    [&archive::MEMBER[..], &archive::END, &array::MAGIC].iter().any(|start| bytes.starts_with(start))
}

/// Reads one frame.
pub(super) fn parse<const D: usize>(path: &Path, bytes: &[u8], frame: Frame) -> Result<Contents<D>, ReadError> {
    let named = |error| in_file(path, error);
    let arrays = Arrays::new(bytes).map_err(named)?;
    let count = count(&arrays).map_err(named)?;
    let frame = frame.index_of(path, count)?;
    let reader = Reader { arrays: &arrays, frame, frame_count: count };
    let parts = reader.parts::<D>().map_err(named)?;
    let of_packing = |source| ReadError::Packing { path: path.into(), source };
    let mut packing = Packing::new(parts.domain, parts.positions, parts.radii).map_err(of_packing)?;
    if let Some(labels) = parts.labels {
        packing = packing.with_labels(labels).map_err(of_packing)?;
    }
    packing = packing.with_held(parts.held).map_err(of_packing)?;
    for (disk, correction) in parts.corrections.into_iter().enumerate() {
        // A correction of zero is left out: adding it would turn a coordinate −0 into 0.
        if correction.iter().any(|&low| low != 0.0) {
            packing.displace(disk, correction);
        }
    }
    if let Some(sites) = parts.sites {
        packing = packing.with_sites(sites).map_err(of_packing)?;
    }
    if let Some(loads) = parts.loads {
        packing = packing.with_loads(loads).map_err(of_packing)?;
    }
    Ok(Contents { packing, properties: arrays.properties(), warnings: parts.warnings })
}

/// Number of frames.
pub(super) fn frame_count(path: &Path, bytes: &[u8]) -> Result<usize, ReadError> {
    Arrays::new(bytes).and_then(|arrays| count(&arrays)).map_err(|error| in_file(path, error))
}

/// The key-value pairs, the same for all frames.
pub(super) fn properties(path: &Path, bytes: &[u8], frame: Frame) -> Result<Vec<(String, String)>, ReadError> {
    let named = |error| in_file(path, error);
    let arrays = Arrays::new(bytes).map_err(named)?;
    frame.index_of(path, count(&arrays).map_err(named)?)?;
    Ok(arrays.properties())
}

/// The error with the file.
fn in_file(path: &Path, error: ArchiveError) -> ReadError {
    ReadError::Archive { path: path.into(), source: Box::new(error) }
}

fn count(arrays: &Arrays) -> Result<usize, ArchiveError> {
    let centres = arrays.need(&CENTRES)?;
    Ok(if centres.shape.len() == 3 { centres.shape[0] } else { 1 })
}

/// The parts of a packing.
struct Parts<const D: usize> {
    domain: Domain<D>,
    positions: Vec<Vector<D>>,
    corrections: Vec<Vector<D>>,
    radii: Vec<f64>,
    labels: Option<Vec<u64>>,
    held: Vec<bool>,
    sites: Option<Vec<(Vector<D>, Vector<D>)>>,
    loads: Option<Vec<Vector<D>>>,
    warnings: Vec<ReadWarning>,
}

/// One frame of the arrays.
struct Reader<'a> {
    arrays: &'a Arrays,
    frame: usize,
    frame_count: usize,
}

impl Reader<'_> {
    /// An array, which has a first axis of frames if it has more than `axes`.
    fn find(&self, meaning: &Meaning, axes: usize) -> Result<Option<Array>, ArchiveError> {
        let found = self.arrays.find(meaning)?;
        Ok(found.map(|array| match array.shape[..] {
            [first, ..] if array.shape.len() > axes && first == self.frame_count => array.frame(self.frame),
            _ => array,
        }))
    }

    fn parts<const D: usize>(&self) -> Result<Parts<D>, ArchiveError> {
        let centres = self.find(&CENTRES, 2)?.ok_or_else(|| self.arrays.missing(CENTRES.what, &[&CENTRES]))?;
        if let Some(dimension) = self.arrays.find(&DIMENSION)? {
            let value = dimension.text(0);
            if value != D.to_string() {
                return Err(ArchiveError::Dimension { array: dimension.name, value, dimension: D });
            }
        }
        let positions = vectors_or_plane::<D>(&centres)?;
        let (count, places) = (positions.len(), centres.shape[1]);
        let radii = self.radii(count)?;
        let largest = radii.iter().copied().fold(0.0, larger);
        check_plane::<D>(&centres, places, largest)?;
        check_reach(&centres, places, &positions, largest)?;
        let domain = self.domain::<D>()?;
        let held = match self.find(&HELD, 1)? {
            Some(array) => flags(&array, count)?,
            None => vec![false; count],
        };
        let labels = self.find(&LABELS, 1)?.map(|array| labels(&array, &held)).transpose()?;
        let corrections = self.low_parts(&CORRECTIONS, &positions)?;
        let sites = match self.find(&SITES, 2)? {
            Some(array) => {
                let sites = vectors::<D>(&array, count)?;
                check_reach(&array, D, &sites, largest)?;
                let low = self.low_parts(&SITE_CORRECTIONS, &sites)?;
                Some(sites.into_iter().zip(low).collect())
            }
            None => None,
        };
        let loads = self.find(&LOADS, 2)?.map(|array| vectors::<D>(&array, count)).transpose()?;
        let is_single = centres.is_single;
        let warnings = is_single.then_some(ReadWarning::SinglePrecision { array: centres.name }).into_iter().collect();
        Ok(Parts { domain, positions, corrections, radii, labels, held, sites, loads, warnings })
    }

    /// The radii, or half the diameters.
    fn radii(&self, count: usize) -> Result<Vec<f64>, ArchiveError> {
        let (radii, diameters) = (self.find(&RADII, 1)?, self.find(&DIAMETERS, 1)?);
        let (array, factor) = match (radii, diameters) {
            (Some(radii), _) => (radii, 1.0),
            (None, Some(diameters)) => (diameters, 0.5),
            (None, None) => return Err(self.arrays.missing("radii or diameters", &[&RADII, &DIAMETERS])),
        };
        if array.shape.len() > 1 || !(array.len() == 1 || array.len() == count) {
            return Err(array.wrong_shape(format!("({count},), one value per disk, or ()")));
        }
        let radius = |at: usize| {
            let radius = factor * array.finite(at)?;
            let is_radius = (SMALLEST_RADIUS..=LARGEST_RADIUS).contains(&radius);
            if is_radius { Ok(radius) } else { Err(array.wrong_value(at, "a radius from 1e-130 to 1e150")) }
        };
        (0..count).map(|disk| radius(if array.len() == 1 { 0 } else { disk })).collect()
    }

    /// The box, or the open plane.
    fn domain<const D: usize>(&self) -> Result<Domain<D>, ArchiveError> {
        let flags = self.find(&PERIODIC, 1)?;
        if let Some(array) = &flags {
            if ![1, D, 3].contains(&array.len()) {
                return Err(array.wrong_shape(format!("() or ({D},)")));
            }
            let first = flag(array, 0)?;
            for at in 1..array.len().min(D) {
                if flag(array, at)? != first {
                    return Err(array.wrong_value(at, "the same in all directions of the packing"));
                }
            }
            if !first {
                return Ok(Domain::Open);
            }
        }
        let absent = || self.arrays.missing("sides of the box (or pbc=False for the open plane)", &[&BOX]);
        let array = self.arrays.find(&BOX)?.ok_or_else(absent)?;
        // Sides or a matrix, or the same with a first axis of frames. A square array is a matrix.
        let has_frames = match array.shape[..] {
            [first, _, _] => first == self.frame_count,
            [first, second] => first == self.frame_count && first != second,
            _ => false,
        };
        let array = if has_frames { array.frame(self.frame) } else { array };
        let edges = edges::<D>(&array)?;
        let corner = match self.find(&ORIGIN, 1)? {
            Some(array) => corner::<D>(&array, &edges)?,
            None => [0.0; D],
        };
        Ok(Domain::Periodic { corner, edges })
    }

    /// Low parts of coordinates, which are below the spacing of numbers there; 0 without such an array.
    fn low_parts<const D: usize>(&self, meaning: &Meaning, high: &[Vector<D>]) -> Result<Vec<Vector<D>>, ArchiveError> {
        let Some(array) = self.find(meaning, 2)? else { return Ok(vec![[0.0; D]; high.len()]) };
        let low = vectors::<D>(&array, high.len())?;
        for (at, (low, high)) in low.as_flattened().iter().zip(high.as_flattened()).enumerate() {
            if low.abs() >= spacing(*high) {
                return Err(
                    array.wrong_value(at, format!("below {:e}, the spacing of numbers at {high:?}", spacing(*high)))
                );
            }
        }
        Ok(low)
    }
}

/// D numbers per disk.
fn vectors<const D: usize>(array: &Array, count: usize) -> Result<Vec<Vector<D>>, ArchiveError> {
    if array.shape != [count, D] {
        return Err(array.wrong_shape(format!("({count}, {D})")));
    }
    let mut all = vec![[0.0; D]; count];
    for (at, value) in all.as_flattened_mut().iter_mut().enumerate() {
        *value = array.finite(at)?;
    }
    Ok(all)
}

/// The centres: D numbers per disk, or three in a plane.
fn vectors_or_plane<const D: usize>(array: &Array) -> Result<Vec<Vector<D>>, ArchiveError> {
    let (count, places) = match array.shape[..] {
        [count, places @ (2 | 3)] if count > 0 => (count, places),
        _ => return Err(array.wrong_shape(format!("(number of disks, {D})"))),
    };
    if places < D {
        let value = format!("of {places} columns");
        return Err(ArchiveError::Dimension { array: array.name.clone(), value, dimension: D });
    }
    let mut all = vec![[0.0; D]; count];
    for (disk, position) in all.iter_mut().enumerate() {
        for (axis, value) in position.iter_mut().enumerate() {
            *value = array.finite(disk * places + axis)?;
        }
    }
    Ok(all)
}

/// Refuses disks of a plane with different z.
fn check_plane<const D: usize>(array: &Array, places: usize, largest_radius: f64) -> Result<(), ArchiveError> {
    for disk in 0..if places > D { array.shape[0] } else { 0 } {
        let (first, z) = (array.finite(D)?, array.finite(disk * places + D)?);
        if (z - first).abs() > FLATNESS * largest_radius {
            let value = format!("{z:?} at {:?}", [disk, D]);
            return Err(ArchiveError::Dimension { array: array.name.clone(), value, dimension: D });
        }
    }
    Ok(())
}

/// Refuses points more than a million of the largest radii away.
fn check_reach<const D: usize>(
    array: &Array,
    places: usize,
    points: &[Vector<D>],
    largest_radius: f64,
) -> Result<(), ArchiveError> {
    let limit = FARTHEST * largest_radius;
    let far = |point: &Vector<D>| point.iter().position(|value| value.abs() > limit);
    match points.iter().enumerate().find_map(|(disk, point)| far(point).map(|axis| disk * places + axis)) {
        Some(at) => Err(array.wrong_value(at, format!("at most {limit:?}, a million times the largest radius"))),
        None => Ok(()),
    }
}

/// The edges of the box: from sides, from a triangular matrix, or from the six numbers of HOOMD.
fn edges<const D: usize>(array: &Array) -> Result<[Vector<D>; D], ArchiveError> {
    let numbers: Vec<f64> = (0..array.len()).map(|at| array.finite(at)).collect::<Result<_, _>>()?;
    // Where component `axis` of edge d is, if it is given.
    let at: Box<dyn Fn(usize, usize) -> Option<usize>> = match array.shape[..] {
        [] | [1] => Box::new(|d, axis| (d == axis).then_some(0)),
        [3] => Box::new(|d, axis| (d == axis).then_some(d)),
        [6] => Box::new(|d, axis| match (d, axis) {
            (1, 0) => Some(3),
            (2, 0) => Some(4),
            (2, 1) => Some(5),
            _ => (d == axis).then_some(d),
        }),
        [count] if count == D => Box::new(|d, axis| (d == axis).then_some(d)),
        [rows, columns] if rows == columns && (rows == D || rows == 3) => {
            let tilts = || {
                let places = (0..rows).flat_map(|row| (0..rows).map(move |column| (row, column)));
                places.filter(|&(row, column)| row != column && numbers[rows * row + column] != 0.0)
            };
            // A triangular matrix shows whether its rows or its columns are the edges.
            let is_upper = tilts().any(|(row, column)| column > row);
            if let (true, Some((row, column))) = (is_upper, tilts().find(|&(row, column)| column < row)) {
                return Err(array.wrong_value(rows * row + column, "0, or 0 above the diagonal: a triangular matrix"));
            }
            if let Some((row, column)) = tilts().find(|&(row, column)| row.max(column) >= D) {
                let expected = "0: a box tilted out of the plane has three dimensions";
                return Err(array.wrong_value(rows * row + column, expected));
            }
            Box::new(move |d, axis| Some(if is_upper { rows * axis + d } else { rows * d + axis }))
        }
        _ => return Err(array.wrong_shape(format!("({D},) or ({D}, {D}), sides or a triangular matrix"))),
    };
    let mut edges = [[0.0; D]; D];
    for d in 0..D {
        for axis in 0..=d {
            let Some(at) = at(d, axis) else { continue };
            if d == axis && numbers[at] <= 0.0 {
                return Err(array.wrong_value(at, "a positive side of the box"));
            }
            edges[d][axis] = numbers[at];
        }
    }
    if array.shape == [6] {
        // Tilts of HOOMD are over the side of their edge.
        (0..D).for_each(|d| (0..d).for_each(|axis| edges[d][axis] *= edges[d][d]));
    }
    Ok(edges)
}

/// The lower corner of the box.
fn corner<const D: usize>(array: &Array, edges: &[Vector<D>; D]) -> Result<[f64; D], ArchiveError> {
    if !(array.shape == [D] || array.shape == [3]) {
        return Err(array.wrong_shape(format!("({D},)")));
    }
    let mut corner = [0.0; D];
    for (axis, value) in corner.iter_mut().enumerate() {
        *value = array.finite(axis)?;
        if value.abs() > FARTHEST * edges[axis][axis] {
            return Err(array.wrong_value(axis, "within a million sides of the box"));
        }
    }
    Ok(corner)
}

/// One flag per disk.
fn flags(array: &Array, count: usize) -> Result<Vec<bool>, ArchiveError> {
    if array.shape != [count] {
        return Err(array.wrong_shape(format!("({count},)")));
    }
    (0..count).map(|at| flag(array, at)).collect()
}

fn flag(array: &Array, at: usize) -> Result<bool, ArchiveError> {
    match array.number(at) {
        Some(0.0) => Ok(false),
        Some(1.0) => Ok(true),
        _ => Err(array.wrong_value(at, "0 or 1")),
    }
}

/// The labels. Two mobile disks have no common id; held disks may repeat one, as the periodic images of a rim do.
fn labels(array: &Array, held: &[bool]) -> Result<Vec<u64>, ArchiveError> {
    if array.shape != [held.len()] {
        return Err(array.wrong_shape(format!("({},)", held.len())));
    }
    let Values::Whole(values) = &array.values else { return Err(array.wrong_value(0, "an integer")) };
    let label = |(at, value): (usize, &i128)| {
        u64::try_from(*value).map_err(|_| array.wrong_value(at, "a whole number, 0 or more"))
    };
    let labels: Vec<u64> = values.iter().enumerate().map(label).collect::<Result<_, _>>()?;
    if !array.name.starts_with("id") {
        return Ok(labels);
    }
    let mut mobile: Vec<u64> = labels.iter().zip(held).filter(|(_, held)| !**held).map(|(label, _)| *label).collect();
    mobile.sort_unstable();
    match mobile.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(ArchiveError::Repeated { array: array.name.clone(), label: pair[0] }),
        None => Ok(labels),
    }
}
