//! Reads extended XYZ, as written by ASE and OVITO, to a [`Packing`](crate::packing::Packing).
//!
//! ```text
//! 2
//! Lattice="9 0 0 0 8 0 0 0 1" Origin="0 0 0" pbc="T T F" Properties=species:S:1:pos:R:3:radius:R:1:id:I:1
//! X 1.0 2.0 0 0.5 1
//! X 2.1 2.0 0 0.7 2
//! ```
//!
//! | column | meaning | needed |
//! |---|---|---|
//! | `pos:R:3` (`R:2` for D = 2), or `x`, `y`, `z` | centre \[length\]; for D = 2 z must be the same for all disks | yes |
//! | `radius:R:1`, or `diameter:R:1` | radius or diameter \[length\]; the radius has precedence | yes |
//! | `id:I:1` | label; only held disks may repeat it, as images in a rim do | no |
//! | `label:I:1` | label that any disk may repeat | no |
//! | `held:I:1` or `held:L:1` | 1 or T: held in place; or ASE's `move_mask:L:1`, F: held | no |
//! | `correction:R:D` | low part of the centre, below the spacing of numbers there \[length\], [`corrections`](crate::packing::Packing::corrections) | no |
//! | `site:R:D` | site of the disk \[length\], [`sites`](crate::packing::Packing::sites) | no |
//! | `site_correction:R:D` | low part of the site \[length\]; requires `site` | no |
//! | `load:R:D` | constant force on the disk \[force\], [`loads`](crate::packing::Packing::loads) | no |
//!
//! Names are compared without case, `_`, `-` and `.`. Other names of the first three, as programs of the field write
//! them: `Position`, `coordinates`; `radii`; `Identifier`, `particle_identifier`, `particle_id`, `atom_id`. Two
//! columns that could both be the label are refused. Columns may be in any order; others are ignored. `pbc` is all T in
//! the directions of the packing (a periodic box, with sides from `Lattice` and corner from `Origin`) or all F (the open
//! plane; the lattice is ignored). Without `pbc` a lattice is periodic, as in ASE; without both the file is refused. For
//! D = 2 the third direction is ignored; `pbc` may then have two flags and `Lattice` four numbers. `dimension`, if given,
//! must be D. Duplicate keys and columns are refused.
//!
//! ASE reads all digits of a file but writes eight decimals. A packing written by it is no longer at rest, and its
//! corrections are lost.
//!
//! # Source
//! ASE, `ase.io.extxyz`; OVITO manual, "XYZ file reader".

use crate::io::comment_line::{CommentLine, Problem, list};
use crate::io::contents::Contents;
use crate::io::frame::Frame;
use crate::io::plane::Plane;
use crate::io::read_error::ReadError;
use crate::io::read_warning::ReadWarning;
use crate::io::source::{AXES, Source, largest_radius};
use crate::io::triclinic::{Triclinic, Turn, turn, turned};
use crate::io::xyz_columns::{Columns, flag};
use crate::packing::Domain;

/// Reads one frame.
pub(super) fn parse<const D: usize>(source: &Source, frame: Frame) -> Result<Contents<D>, ReadError> {
    let frames = frames(source)?;
    let (line, count) = frames[source.frame(frame, frames.len())?];
    if count == 0 {
        return Err(source.no_disks(line - 1, "number of disks"));
    }
    let comment = comment_of(source, line)?;
    if let Some(value) = comment.value("dimension") {
        match value.parse::<usize>() {
            Ok(dimension) if dimension == D => {}
            Ok(_) => return Err(source.dimension(line, "dimension", value, D)),
            Err(_) => return Err(source.bad(line, "dimension", value, "2 or 3")),
        }
    }
    let columns = Columns::<D>::new(source, line, &comment)?;
    let (domain, axes) = domain(source, line, &comment)?;
    let mut disks = Vec::with_capacity(count);
    let mut extras = Vec::with_capacity(count);
    let mut sites = Vec::with_capacity(if columns.has_sites() { count } else { 0 });
    let mut loads = Vec::with_capacity(if columns.has_loads() { count } else { 0 });
    let mut plane = Plane::new();
    for row_line in line + 1..line + 1 + count {
        let row = source.row(row_line);
        row.expect_count(columns.total)?;
        let disk = columns.disk(&row, row_line)?;
        columns.take_third(&row, row_line, &mut plane)?;
        let correction = columns.correction(source, &row, &disk)?;
        extras.push((columns.held(source, &row, row_line)?, turned(&axes, correction)));
        disks.push(disk);
        if columns.has_loads() {
            loads.push(turned(&axes, columns.load(&row)?));
        }
        let site = columns.site(source, &row, row_line)?;
        sites.extend(site.map(|(site, rest)| (turned(&axes, site), turned(&axes, rest))));
    }
    plane.check(source, "pos z", largest_radius(&disks), 0.0)?;
    if columns.has_ids() {
        source.check_ids(&disks, |disk| extras[disk].0)?;
    }
    turn(&axes, &mut disks);
    let mut packing = source
        .packing(domain, &disks, columns.has_labels())?
        .with_held(extras.iter().map(|&(held, _)| held).collect())
        .map_err(|error| ReadError::Packing { path: source.path.into(), source: error })?;
    for (disk, (_, correction)) in extras.iter().enumerate() {
        // A correction of zero is left out: adding it would turn a coordinate −0 into 0.
        if correction.iter().any(|&low| low != 0.0) {
            packing.displace(disk, *correction);
        }
    }
    if columns.has_sites() {
        let largest_radius = largest_radius(&disks);
        for (disk, (site, _)) in disks.iter().zip(&sites) {
            source.check_reach(disk.line, "site", site, largest_radius)?;
        }
        packing = packing
            .with_sites(sites)
            .map_err(|error| ReadError::Packing { path: source.path.into(), source: error })?;
    }
    if columns.has_loads() {
        packing = packing
            .with_loads(loads)
            .map_err(|error| ReadError::Packing { path: source.path.into(), source: error })?;
    }
    let warnings = axes.map(|_| ReadWarning::Turned { line: line + 1 }).into_iter().collect();
    Ok(Contents { packing, properties: comment.into_pairs(), warnings })
}

/// Number of frames.
pub(super) fn frame_count(source: &Source) -> Result<usize, ReadError> {
    frames(source).map(|frames| frames.len())
}

/// The pairs of the comment line of one frame.
pub(super) fn properties(source: &Source, frame: Frame) -> Result<Vec<(String, String)>, ReadError> {
    let frames = frames(source)?;
    let (line, _) = frames[source.frame(frame, frames.len())?];
    comment_of(source, line).map(CommentLine::into_pairs)
}

fn comment_of(source: &Source, line: usize) -> Result<CommentLine, ReadError> {
    CommentLine::parse(source.lines[line]).map_err(|problem| match problem {
        Problem::Unclosed { key, value } => source.bad(line, &key, &value, "a quote or bracket that is closed"),
        Problem::Repeated { key } => source.repeated(line, "key", &key, line),
    })
}

/// Line index of the comment and number of disks of every frame.
fn frames(source: &Source) -> Result<Vec<(usize, usize)>, ReadError> {
    let mut frames = Vec::new();
    let mut line = 0;
    while line < source.lines.len() {
        let text = source.lines[line].trim();
        if text.is_empty() {
            line += 1;
            continue;
        }
        let count: usize = text.parse().map_err(|_| match frames.last() {
            Some(&(_, expected)) if text.split_ascii_whitespace().count() > 1 => {
                ReadError::TooManyRows { path: source.path.into(), line: line + 1, expected }
            }
            _ => source.bad(line, "number of disks", text, "a whole number, 0 or more"),
        })?;
        let rows = source.lines.len().saturating_sub(line + 2);
        if line + 1 == source.lines.len() || rows < count {
            return Err(source.truncated(source.lines.len(), "disks", count, rows));
        }
        frames.push((line + 1, count));
        line += 2 + count;
    }
    Ok(frames)
}

fn domain<const D: usize>(
    source: &Source,
    line: usize,
    comment: &CommentLine,
) -> Result<(Domain<D>, Turn<D>), ReadError> {
    let lattice = comment.value("Lattice");
    if let Some(value) = comment.value("pbc") {
        let flags: Option<Vec<bool>> = list(value).into_iter().map(flag).collect();
        let Some(flags) = flags.filter(|flags| flags.len() == 3 || flags.len() == D) else {
            return Err(source.bad(line, "pbc", value, "three of T and F"));
        };
        if flags[..D].iter().all(|periodic| !periodic) {
            return Ok((Domain::Open, None));
        }
        if let Some(axis) = flags[..D].iter().position(|periodic| !periodic) {
            return Err(source.not_periodic(line, "pbc", value, axis));
        }
    } else if lattice.is_none() {
        return Err(source.missing(line, "Lattice (or pbc=\"F F F\" for the open plane)", comment.keys()));
    }
    let Some(lattice) = lattice else {
        return Err(source.missing(line, "Lattice", comment.keys()));
    };
    let cell = if D == 2 && list(lattice).len() == 4 {
        let [xx, xy, yx, yy] = components::<4>(source, line, "Lattice", lattice, "four numbers")?;
        [xx, xy, 0.0, yx, yy, 0.0, 0.0, 0.0, 1.0]
    } else {
        components::<9>(source, line, "Lattice", lattice, "nine numbers, or four in two dimensions")?
    };
    let corner = match comment.value("Origin") {
        Some(value) if D == 2 && list(value).len() == 2 => {
            let [x, y] = components::<2>(source, line, "Origin", value, "two numbers")?;
            [x, y, 0.0]
        }
        Some(value) => components::<3>(source, line, "Origin", value, "three numbers")?,
        None => [0.0; 3],
    };
    let edges = std::array::from_fn(|d| std::array::from_fn(|axis| cell[3 * d + axis]));
    let triclinic = Triclinic { corner, edges };
    let (domain, turn) = triclinic.domain(source, line, "Lattice")?;
    let lengths = domain.lengths().unwrap_or([f64::INFINITY; D]);
    for axis in 0..D {
        source.check_corner(line, &format!("Origin {}", AXES[axis]), corner[axis], lengths[axis])?;
    }
    Ok((domain, turn))
}

fn components<const N: usize>(
    source: &Source,
    line: usize,
    field: &str,
    value: &str,
    expected: &'static str,
) -> Result<[f64; N], ReadError> {
    let parts: [&str; N] = list(value).try_into().map_err(|_| source.bad(line, field, value, expected))?;
    let mut numbers = [0.0; N];
    for (number, part) in numbers.iter_mut().zip(parts) {
        *number = source.number(line, field, part)?;
    }
    Ok(numbers)
}
