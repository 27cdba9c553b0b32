//! Reads LAMMPS text dumps (`dump custom`) to a [`Packing`](crate::packing::Packing).
//!
//! ```text
//! ITEM: TIMESTEP
//! 0
//! ITEM: NUMBER OF ATOMS
//! 2
//! ITEM: BOX BOUNDS pp pp pp
//! 0.0 9.0
//! 0.0 8.0
//! -0.5 0.5
//! ITEM: ATOMS id x y z radius
//! 1 1.0 2.0 0.0 0.5
//! 2 2.1 2.0 0.0 0.7
//! ```
//!
//! Required: `id`, `radius` or `diameter` (`radius` has precedence), and a position in one of four forms. If several
//! forms are complete, the first of this list is used:
//!
//! | columns | position |
//! |---|---|
//! | `x y z` | the value |
//! | `xu yu zu` | the value; unwrapped, so possibly outside the box, which nearest images take into account |
//! | `xs ys zs`, `xsu ysu zsu` | lower end of the box + value × side |
//!
//! For D = 2 z is not required, and must be the same for all disks if given; the box may have no height. Other columns
//! are ignored, and case in the names of columns. LAMMPS writes six digits by default (see `dump_modify format float
//! %.17g`). Disks are in ascending order of their ids. Duplicate items in a frame are refused.
//!
//! A box that is periodic in no direction of the packing is the open plane: a dump does not contain its walls. A box
//! that is periodic in some of them is refused. Without boundary flags, as in old dumps, the box is periodic.
//!
//! # Source
//! LAMMPS manual, commands `dump` and `dump_modify`.

use crate::io::contents::Contents;
use crate::io::frame::Frame;
use crate::io::plane::Plane;
use crate::io::read_error::ReadError;
use crate::io::read_warning::ReadWarning;
use crate::io::source::{AXES, Disk, Source, largest_radius};
use crate::packing::Domain;

/// The forms of a position, in order of preference, and whether they are fractions of the box.
const KINDS: [([&str; 3], bool); 4] =
    [(["x", "y", "z"], false), (["xu", "yu", "zu"], false), (["xs", "ys", "zs"], true), (["xsu", "ysu", "zsu"], true)];

/// Spacing of a scaled z; LAMMPS writes six digits by default.
const SCALED_SPACING: f64 = 1e-5;

/// Reads one frame.
pub(super) fn parse<const D: usize>(source: &Source, frame: Frame) -> Result<Contents<D>, ReadError> {
    let lines = &source.lines;
    let starts = starts(source);
    if starts.is_empty() {
        return Err(source.missing(0, "ITEM: TIMESTEP", lines[0]));
    }
    let place = source.frame(frame, starts.len())?;
    let end = starts.get(place + 1).copied().unwrap_or(lines.len());
    let mut parts = Parts::<D>::default();
    let mut known: Vec<(&str, usize)> = Vec::new();
    let mut line = starts[place];
    while line < end {
        let next = (line + 1..end).find(|&next| lines[next].starts_with("ITEM:")).unwrap_or(end);
        if let Some(item) = lines[line].strip_prefix("ITEM:") {
            let name = ["BOX BOUNDS", "ATOMS"].into_iter().find(|name| item.trim().starts_with(name));
            let name = name.unwrap_or(item.trim());
            if let Some((_, earlier)) = known.iter().find(|(earlier, _)| *earlier == name) {
                return Err(source.repeated(line, "item", name, *earlier));
            }
            known.push((name, line));
            parts.take(source, item.trim(), line, next)?;
        }
        line = next;
    }
    let Some(disks) = parts.disks else {
        return Err(source.missing(end - 1, "ITEM: ATOMS", "a frame that ends before it"));
    };
    let Some(Bounds { domain, warning, .. }) = parts.bounds else {
        return Err(source.missing(end - 1, "ITEM: BOX BOUNDS", "a frame without it"));
    };
    let packing = source.packing(domain, &disks, true)?;
    Ok(Contents { warnings: warning.into_iter().collect(), ..Contents::from(packing) })
}

/// The line index of the first item of every frame.
pub(super) fn starts(source: &Source) -> Vec<usize> {
    (0..source.lines.len()).filter(|&line| source.lines[line].trim() == "ITEM: TIMESTEP").collect()
}

/// The items of a frame read so far.
struct Parts<const D: usize> {
    count: Option<usize>,
    bounds: Option<Bounds<D>>,
    disks: Option<Vec<Disk<D>>>,
}

impl<const D: usize> Default for Parts<D> {
    fn default() -> Self {
        Parts { count: None, bounds: None, disks: None }
    }
}

impl<const D: usize> Parts<D> {
    /// Reads the item whose title is at line `title` and whose values are in the lines after it, before `end`.
    fn take(&mut self, source: &Source, item: &str, title: usize, end: usize) -> Result<(), ReadError> {
        let first = title + 1;
        if item == "NUMBER OF ATOMS" {
            if first == end {
                return Err(source.truncated(end, "values of ITEM: NUMBER OF ATOMS", 1, 0));
            }
            let value = source.lines[first].trim();
            self.count = match value.parse() {
                Ok(0) => return Err(source.no_disks(first, item)),
                Ok(count) => Some(count),
                Err(_) => return Err(source.bad(first, item, value, "a whole number, 0 or more")),
            };
            expect_end(source, item, first + 1, end)?;
        } else if let Some(flags) = item.strip_prefix("BOX BOUNDS") {
            self.bounds = Some(bounds(source, flags, title, end)?);
        } else if let Some(columns) = item.strip_prefix("ATOMS") {
            let Some(count) = self.count else {
                return Err(source.missing(title, "ITEM: NUMBER OF ATOMS", "ITEM: ATOMS before it"));
            };
            let Some(Bounds { sides, .. }) = &self.bounds else {
                return Err(source.missing(title, "ITEM: BOX BOUNDS", "ITEM: ATOMS before it"));
            };
            let columns = Columns::new(source, columns, title)?;
            self.disks = Some(columns.disks(source, sides, first, end, count)?);
        }
        Ok(())
    }
}

/// The box of a frame.
struct Bounds<const D: usize> {
    domain: Domain<D>,
    /// Lower end and length of all three sides.
    sides: [(f64, f64); 3],
    warning: Option<ReadWarning>,
}

fn bounds<const D: usize>(source: &Source, flags: &str, title: usize, end: usize) -> Result<Bounds<D>, ReadError> {
    let words: Vec<&str> = flags.split_ascii_whitespace().collect();
    let (form, flags) = match words[..] {
        ["xy", "xz", "yz", ..] => (Form::Tilts, &words[3..]),
        ["abc", "origin", ..] => (Form::Vectors, &words[2..]),
        _ => (Form::Bounds, &words[..]),
    };
    if !matches!(flags.len(), 0 | 3) {
        return Err(source.missing(title, "three boundary flags after ITEM: BOX BOUNDS", flags.join(" ")));
    }
    let is_open = |flag: &&str| *flag != "pp";
    let open_count = flags.iter().take(D).filter(|flag| is_open(flag)).count();
    if open_count > 0 && open_count < D {
        let axis = flags.iter().position(is_open).unwrap_or(0);
        return Err(source.not_periodic(title, "ITEM: BOX BOUNDS", flags[axis], axis));
    }
    let mut sides = [(0.0, 0.0); 3];
    for axis in 0..3 {
        let line = title + 1 + axis;
        if line >= end {
            return Err(source.truncated(end, "sides of the box", 3, axis));
        }
        sides[axis] = side(source, &form, line, axis, axis >= D)?;
    }
    expect_end(source, "ITEM: BOX BOUNDS", title + 4, end)?;
    let corner = std::array::from_fn(|axis| sides[axis].0);
    let lengths = std::array::from_fn(|axis| sides[axis].1);
    let line = title + 1;
    let (domain, warning) = match flags {
        [] => (Domain::Periodic { corner, lengths }, Some(ReadWarning::NoBoundaryFlags { line })),
        _ if open_count > 0 => (Domain::Open, Some(ReadWarning::Walls { line, flags: flags.join(" ") })),
        _ => (Domain::Periodic { corner, lengths }, None),
    };
    Ok(Bounds { domain, sides, warning })
}

/// How the lines of a box are written.
enum Form {
    /// Lower and upper end.
    Bounds,
    /// The ends and a tilt factor.
    Tilts,
    /// An edge vector and a component of the origin.
    Vectors,
}

/// Lower end and length of one side. A height may be 0.
fn side(source: &Source, form: &Form, line: usize, axis: usize, is_height: bool) -> Result<(f64, f64), ReadError> {
    let row = source.row(line);
    let field = ["xlo xhi", "ylo yhi", "zlo zhi"][axis];
    match form {
        Form::Bounds => row.expect_count(2)?,
        Form::Tilts => {
            row.expect_count(3)?;
            let field = ["xy", "xz", "yz"][axis];
            if row.number(2, field)? != 0.0 {
                return Err(source.tilted(line, field, row.values[2]));
            }
        }
        Form::Vectors => {
            row.expect_count(4)?;
            let vector = ["a", "b", "c"][axis];
            for other in (0..3).filter(|&other| other != axis) {
                let field = format!("{vector} {}", AXES[other]);
                if row.number(other, &field)? != 0.0 {
                    return Err(source.tilted(line, &field, row.values[other]));
                }
            }
            let start = row.number(3, "origin")?;
            if is_height && row.number(axis, vector)? == 0.0 {
                return Ok((start, 0.0));
            }
            let length = row.positive(axis, vector)?;
            source.check_corner(line, "origin", start, length)?;
            return Ok((start, length));
        }
    }
    if is_height {
        source.height(line, field, row.values[0], row.values[1])
    } else {
        source.side(line, field, row.values[0], row.values[1])
    }
}

/// Refuses lines after the last value of an item.
fn expect_end(source: &Source, item: &str, first: usize, end: usize) -> Result<(), ReadError> {
    match (first..end).find(|&line| !source.lines[line].trim().is_empty()) {
        Some(line) => Err(source.bad(line, item, source.lines[line], "no further value")),
        None => Ok(()),
    }
}

/// Indices of the columns in a row.
struct Columns {
    total: usize,
    id: usize,
    radius: (usize, &'static str, f64),
    position: Position,
}

/// The columns of the selected form of the position.
struct Position {
    names: [&'static str; 3],
    columns: [Option<usize>; 3],
    scaled: bool,
}

impl Columns {
    fn new(source: &Source, names: &str, title: usize) -> Result<Self, ReadError> {
        let names: Vec<&str> = names.split_ascii_whitespace().collect();
        for (column, name) in names.iter().enumerate() {
            if names[..column].iter().any(|earlier| earlier.eq_ignore_ascii_case(name)) {
                return Err(source.repeated(title, "column", name, title));
            }
        }
        let find = |wanted: &str| names.iter().position(|name| name.eq_ignore_ascii_case(wanted));
        let missing = |field| source.missing(title, field, names.join(" "));
        let radius = match (find("radius"), find("diameter")) {
            (Some(column), _) => (column, "radius", 1.0),
            (None, Some(column)) => (column, "diameter", 0.5),
            (None, None) => return Err(missing("column radius or diameter")),
        };
        let mut kinds = KINDS.iter().map(|&(names, scaled)| Position { names, columns: names.map(find), scaled });
        // x and y are sufficient in two dimensions; a missing z in three is reported below.
        let Some(position) = kinds.find(|kind| kind.columns[0].is_some() && kind.columns[1].is_some()) else {
            return Err(missing("columns x and y (or xu yu, xs ys, xsu ysu)"));
        };
        let id = find("id").ok_or_else(|| missing("column id"))?;
        Ok(Columns { total: names.len(), id, radius, position })
    }

    fn disks<const D: usize>(
        &self,
        source: &Source,
        sides: &[(f64, f64); 3],
        first: usize,
        end: usize,
        count: usize,
    ) -> Result<Vec<Disk<D>>, ReadError> {
        let mut disks: Vec<Disk<D>> = Vec::new();
        let mut plane = Plane::new();
        for line in first..end {
            if source.lines[line].trim().is_empty() {
                continue;
            }
            if disks.len() == count {
                return Err(ReadError::TooManyRows { path: source.path.into(), line: line + 1, expected: count });
            }
            let row = source.row(line);
            row.expect_count(self.total)?;
            let mut all = [0.0; 3];
            for axis in 0..3 {
                let name = self.position.names[axis];
                all[axis] = match self.position.columns[axis] {
                    Some(column) if self.position.scaled => sides[axis].0 + row.number(column, name)? * sides[axis].1,
                    Some(column) => row.number(column, name)?,
                    None if axis < D => return Err(source.missing(first - 1, "column z", source.lines[first - 1])),
                    None => 0.0,
                };
            }
            if D == 2 {
                plane.take(all[2], line, &all[2].to_string());
            }
            let (column, name, factor) = self.radius;
            let radius = row.radius(column, name, factor)?;
            let label = row.whole(self.id, "id")?;
            disks.push(Disk { label, line, position: std::array::from_fn(|axis| all[axis]), radius });
        }
        if disks.len() < count {
            return Err(source.truncated(end, "disks of ITEM: ATOMS", count, disks.len()));
        }
        let spacing = if self.position.scaled { SCALED_SPACING * sides[2].1 } else { 0.0 };
        plane.check(source, self.position.names[2], largest_radius(&disks), spacing)?;
        source.order_by_id(&disks)?;
        disks.sort_by_key(|disk| disk.label);
        Ok(disks)
    }
}
