//! Extended XYZ as ASE and OVITO read and write it, to a [`Packing`].
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
//! | `pos:R:3` (`R:2` for D = 2) | centre \[length\]; for D = 2 z must be 0 | yes |
//! | `radius:R:1` | radius \[length\] | yes |
//! | `id:I:1` | label, no two alike | no |
//! | `label:I:1` | label, repeats allowed; goes before `id` | no |
//! | `held:I:1` or `held:L:1` | 1 or T: held in place | no |
//! | `correction:R:D` | low part of the centre \[length\], [`Packing::corrections`] | no |
//! | `site:R:D` | site of the disk \[length\], [`Packing::sites`] | no |
//! | `site_correction:R:D` | low part of the site \[length\]; goes with `site` | no |
//!
//! Columns stand in any order, others are ignored. `pbc` is all T in the directions of the packing (a periodic box, its
//! sides from `Lattice`, its corner from `Origin`) or all F (the open plane, whatever the lattice). Without `pbc` a
//! lattice is periodic, as in ASE; without either the file is refused. For D = 2 the third direction counts for
//! nothing. `dimension`, where given, must be D.
//!
//! ASE reads all digits of a file but writes eight decimals: a packing that went through it is no longer at rest, and its
//! corrections are gone.
//!
//! # Source
//! ASE, `ase.io.extxyz`; OVITO manual, "XYZ file reader".

use crate::io::comment_line::{CommentLine, Problem, list};
use crate::io::source::{AXES, Disk, Row, Source};
use crate::io::{Frame, ReadError};
use crate::packing::{Domain, Packing};
use crate::vector::Vector;

/// Largest number of values one property may have; far above any use, far below an overflow of their sum.
const WIDTH_LIMIT: usize = 65_535;

/// Reads one frame.
pub(super) fn parse<const D: usize>(source: &Source, frame: Frame) -> Result<Packing<D>, ReadError> {
    let frames = frames(source)?;
    let (line, count) = frames[source.frame(frame, frames.len())?];
    let comment = comment_of(source, line)?;
    if let Some(value) = comment.value("dimension")
        && value.parse::<usize>().is_ok_and(|dimension| dimension != D)
    {
        return Err(source.dimension(line, "dimension", value, D));
    }
    let columns = Columns::<D>::new(source, line, &comment)?;
    let domain = domain(source, line, &comment)?;
    let mut disks = Vec::with_capacity(count);
    let mut extras = Vec::with_capacity(count);
    let mut sites = Vec::with_capacity(if columns.site.is_some() { count } else { 0 });
    for row_line in line + 1..line + 1 + count {
        let row = source.row(row_line);
        row.expect_count(columns.total)?;
        disks.push(columns.disk(source, &row, row_line)?);
        extras.push((columns.held(source, &row, row_line)?, columns.vector(&row, columns.correction, "correction")?));
        if columns.site.is_some() {
            let rest = columns.vector(&row, columns.site_correction, "site_correction")?;
            sites.push((columns.vector(&row, columns.site, "site")?, rest));
        }
    }
    if columns.label.is_none() && columns.id.is_some() {
        source.order_by_id(&disks)?;
    }
    let labelled = columns.label.or(columns.id).is_some();
    let mut packing = source
        .packing(domain, &disks, labelled)?
        .with_held(extras.iter().map(|&(held, _)| held).collect())
        .map_err(|error| ReadError::Packing { path: source.path.into(), source: error })?;
    for (disk, (_, correction)) in extras.iter().enumerate() {
        // A correction of nothing is left out: adding it would turn a coordinate −0 into 0.
        if correction.iter().any(|&low| low != 0.0) {
            packing.displace(disk, *correction);
            if !packing.positions()[disk].iter().all(|value| value.is_finite()) {
                let value = format!("{correction:?}");
                return Err(source.bad(disks[disk].line, "correction", &value, "a number much below the coordinate"));
            }
        }
    }
    if columns.site.is_some() {
        packing = packing
            .with_sites(sites)
            .map_err(|error| ReadError::Packing { path: source.path.into(), source: error })?;
    }
    Ok(packing)
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

/// Line of the comment and number of disks of every frame.
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

fn domain<const D: usize>(source: &Source, line: usize, comment: &CommentLine) -> Result<Domain<D>, ReadError> {
    let lattice = comment.value("Lattice");
    if let Some(value) = comment.value("pbc") {
        let flags: Option<Vec<bool>> = list(value).into_iter().map(flag).collect();
        let Some(flags) = flags.filter(|flags| flags.len() == 3) else {
            return Err(source.bad(line, "pbc", value, "three of T and F"));
        };
        if flags[..D].iter().all(|periodic| !periodic) {
            return Ok(Domain::Open);
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
    let cell = components::<9>(source, line, "Lattice", lattice, "nine numbers")?;
    for (index, &component) in cell.iter().enumerate() {
        let (vector, axis) = (index / 3, index % 3);
        if vector != axis && component != 0.0 {
            let field = format!("Lattice vector {} along {}", vector + 1, AXES[axis]);
            return Err(source.tilted(line, &field, &component.to_string()));
        }
    }
    let corner = match comment.value("Origin") {
        Some(value) => components::<3>(source, line, "Origin", value, "three numbers")?,
        None => [0.0; 3],
    };
    let mut lengths = [0.0; D];
    for axis in 0..D {
        lengths[axis] = source.positive(line, "Lattice", &cell[4 * axis].to_string())?;
    }
    Ok(Domain::Periodic { corner: std::array::from_fn(|axis| corner[axis]), lengths })
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

fn flag(text: &str) -> Option<bool> {
    match text {
        "T" | "True" | "true" | "1" => Some(true),
        "F" | "False" | "false" | "0" => Some(false),
        _ => None,
    }
}

/// Where the columns stand in a row.
struct Columns<const D: usize> {
    position: usize,
    position_width: usize,
    radius: usize,
    id: Option<usize>,
    label: Option<usize>,
    held: Option<usize>,
    correction: Option<usize>,
    site: Option<usize>,
    site_correction: Option<usize>,
    total: usize,
}

impl<const D: usize> Columns<D> {
    fn new(source: &Source, line: usize, comment: &CommentLine) -> Result<Self, ReadError> {
        let Some(properties) = comment.value("Properties") else {
            return Err(source.missing(line, "Properties", comment.keys()));
        };
        let parts: Vec<&str> = properties.split(':').collect();
        let mut total = 0;
        let mut columns: Vec<(&str, &str, usize, usize)> = Vec::new();
        for part in parts.chunks(3) {
            let width = part.get(2).and_then(|width| width.parse().ok());
            let width = width.filter(|width| (1..=WIDTH_LIMIT).contains(width));
            let (&[name, kind @ ("S" | "R" | "I" | "L"), _], Some(width)) = (part, width) else {
                return Err(source.bad(line, "Properties", &part.join(":"), "name:S, R, I or L:number of values"));
            };
            if columns.iter().any(|&(earlier, ..)| earlier == name) {
                return Err(source.repeated(line, "column", name, line));
            }
            columns.push((name, kind, width, total));
            total += width;
        }
        let find = |wanted: &str, kinds: &str, widths: &[usize], expected: &'static str| {
            let Some(&(name, kind, width, start)) = columns.iter().find(|column| column.0 == wanted) else {
                return Ok(None);
            };
            if kinds.contains(kind) && widths.contains(&width) {
                return Ok(Some((start, width)));
            }
            Err(source.bad(line, &format!("column {name}"), &format!("{name}:{kind}:{width}"), expected))
        };
        let (widths, expected): (&[usize], _) =
            if D == 2 { (&[2, 3], "pos:R:3 or pos:R:2") } else { (&[3], "pos:R:3") };
        let (position, position_width) = find("pos", "RI", widths, expected)?
            .ok_or_else(|| source.missing(line, "column pos in Properties", properties))?;
        let (radius, _) = find("radius", "RI", &[1], "radius:R:1")?
            .ok_or_else(|| source.missing(line, "column radius in Properties", properties))?;
        let start = |found: Option<(usize, usize)>| found.map(|(start, _)| start);
        let site = start(find("site", "R", &[D], "site:R with D values")?);
        let site_correction = start(find("site_correction", "R", &[D], "site_correction:R with D values")?);
        if site.is_none() && site_correction.is_some() {
            return Err(source.missing(line, "column site in Properties", properties));
        }
        Ok(Columns {
            position,
            position_width,
            radius,
            id: start(find("id", "I", &[1], "id:I:1")?),
            label: start(find("label", "I", &[1], "label:I:1")?),
            held: start(find("held", "IL", &[1], "held:I:1 or held:L:1")?),
            correction: start(find("correction", "R", &[D], "correction:R with D values")?),
            site,
            site_correction,
            total,
        })
    }

    fn disk(&self, source: &Source, row: &Row, line: usize) -> Result<Disk<D>, ReadError> {
        let mut position = [0.0; D];
        for axis in 0..D {
            position[axis] = row.number(self.position + axis, &format!("pos {}", AXES[axis]))?;
        }
        if self.position_width > D && row.number(self.position + D, "pos z")? != 0.0 {
            return Err(source.dimension(line, "pos z", row.values[self.position + D], D));
        }
        let label = match self.label.or(self.id) {
            Some(column) => row.whole(column, if self.label.is_some() { "label" } else { "id" })?,
            None => 0,
        };
        Ok(Disk { label, line, position, radius: row.positive(self.radius, "radius")? })
    }

    fn held(&self, source: &Source, row: &Row, line: usize) -> Result<bool, ReadError> {
        let Some(column) = self.held else { return Ok(false) };
        let value = row.values[column];
        flag(value).ok_or_else(|| source.bad(line, "held", value, "1 or T, 0 or F"))
    }

    /// The D values from a column on; nothing where there is no such column.
    fn vector(&self, row: &Row, start: Option<usize>, name: &str) -> Result<Vector<D>, ReadError> {
        let mut vector = [0.0; D];
        if let Some(column) = start {
            for axis in 0..D {
                vector[axis] = row.number(column + axis, name)?;
            }
        }
        Ok(vector)
    }
}
