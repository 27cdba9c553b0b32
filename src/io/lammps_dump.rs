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
//! | `xs ys zs`, `xsu ysu zsu` | corner of the box + Σ value × edge |
//!
//! For D = 2 z is not required, and must be the same for all disks if given; the box may have no height. Other columns
//! are ignored, and case in the names of columns. LAMMPS writes six digits by default (see `dump_modify format float
//! %.17g`). Disks are in ascending order of their ids. Duplicate items in a frame are refused.
//!
//! A tilted box has the line `ITEM: BOX BOUNDS xy xz yz`, with the ends of the rectangle around the box, or `abc origin`,
//! with its edges.
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
use crate::io::source::{AXES, Disk, SIDES, Source, largest_radius};
use crate::io::triclinic::{Triclinic, Turn, turn};
use crate::packing::Domain;
use crate::vector::norm;

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
    let Some(mut disks) = parts.disks else {
        return Err(source.missing(end - 1, "ITEM: ATOMS", "a frame that ends before it"));
    };
    let Some(Bounds { domain, turn: axes, warnings, .. }) = parts.bounds else {
        return Err(source.missing(end - 1, "ITEM: BOX BOUNDS", "a frame without it"));
    };
    turn(&axes, &mut disks);
    Ok(Contents { warnings, ..Contents::from(source.packing(domain, &disks, true)?) })
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
            let Some(Bounds { triclinic, .. }) = &self.bounds else {
                return Err(source.missing(title, "ITEM: BOX BOUNDS", "ITEM: ATOMS before it"));
            };
            let columns = Columns::new(source, columns, title)?;
            self.disks = Some(columns.disks(source, triclinic, first, end, count)?);
        }
        Ok(())
    }
}

/// The box of a frame.
struct Bounds<const D: usize> {
    domain: Domain<D>,
    turn: Turn<D>,
    triclinic: Triclinic,
    warnings: Vec<ReadWarning>,
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
    if end < title + 4 {
        return Err(source.truncated(end, "sides of the box", 3, end.saturating_sub(title + 1)));
    }
    let triclinic = match form {
        Form::Bounds => sides::<D>(source, title + 1)?,
        Form::Tilts => tilted_sides::<D>(source, title + 1)?,
        Form::Vectors => vectors::<D>(source, title + 1)?,
    };
    expect_end(source, "ITEM: BOX BOUNDS", title + 4, end)?;
    let line = title + 1;
    if open_count > 0 {
        let warning = ReadWarning::Walls { line, flags: flags.join(" ") };
        return Ok(Bounds { domain: Domain::Open, turn: None, triclinic, warnings: vec![warning] });
    }
    let (domain, turn) = triclinic.domain(source, title + 1, "ITEM: BOX BOUNDS")?;
    let mut warnings = Vec::new();
    if flags.is_empty() {
        warnings.push(ReadWarning::NoBoundaryFlags { line });
    }
    if turn.is_some() {
        warnings.push(ReadWarning::Turned { line });
    }
    Ok(Bounds { domain, turn, triclinic, warnings })
}

/// How the lines of a box are written.
enum Form {
    /// Lower and upper end.
    Bounds,
    /// The ends of a rectangle around the box, and a tilt.
    Tilts,
    /// An edge and a component of the corner.
    Vectors,
}

/// A rectangular box. A height may be 0.
fn sides<const D: usize>(source: &Source, first: usize) -> Result<Triclinic, ReadError> {
    let (mut corner, mut lengths) = ([0.0; 3], [0.0; 3]);
    for axis in 0..3 {
        let row = source.row(first + axis);
        row.expect_count(2)?;
        let is_height = axis >= D;
        let read = if is_height { Source::height } else { Source::side };
        (corner[axis], lengths[axis]) = read(source, first + axis, SIDES[axis], row.values[0], row.values[1])?;
    }
    Ok(Triclinic::rectangular(corner, lengths))
}

/// A box with tilts xy, xz, yz: the ends are those of the rectangle around it.
fn tilted_sides<const D: usize>(source: &Source, first: usize) -> Result<Triclinic, ReadError> {
    let mut ends = [(0.0, 0.0); 3];
    let mut tilts = [0.0; 3];
    for axis in 0..3 {
        let row = source.row(first + axis);
        row.expect_count(3)?;
        ends[axis] = (row.number(0, SIDES[axis])?, row.number(1, SIDES[axis])?);
        tilts[axis] = row.number(2, ["xy", "xz", "yz"][axis])?;
    }
    let [xy, xz, yz] = tilts;
    let beyond = [vec![xy, xz, xy + xz], vec![yz], Vec::new()];
    let (mut corner, mut lengths) = ([0.0; 3], [0.0; 3]);
    for axis in 0..3 {
        let low = ends[axis].0 - beyond[axis].iter().fold(0.0, |least: f64, &tilt| least.min(tilt));
        let high = ends[axis].1 - beyond[axis].iter().fold(0.0, |most: f64, &tilt| most.max(tilt));
        let read = if axis >= D { Source::height } else { Source::side };
        (corner[axis], lengths[axis]) = read(source, first + axis, SIDES[axis], &low.to_string(), &high.to_string())?;
    }
    let mut triclinic = Triclinic::rectangular(corner, lengths);
    (triclinic.edges[1][0], triclinic.edges[2][0], triclinic.edges[2][1]) = (xy, xz, yz);
    Ok(triclinic)
}

/// A box of three edges and a corner.
fn vectors<const D: usize>(source: &Source, first: usize) -> Result<Triclinic, ReadError> {
    let mut triclinic = Triclinic::default();
    for d in 0..3 {
        let row = source.row(first + d);
        row.expect_count(4)?;
        for axis in 0..3 {
            triclinic.edges[d][axis] = row.number(axis, &format!("{} {}", ["a", "b", "c"][d], AXES[axis]))?;
        }
        triclinic.corner[d] = row.number(3, "origin")?;
        if d < D {
            source.check_corner(first + d, "origin", triclinic.corner[d], norm(triclinic.edges[d]))?;
        }
    }
    Ok(triclinic)
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
        triclinic: &Triclinic,
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
                    Some(column) => row.number(column, name)?,
                    None if axis < D => return Err(source.missing(first - 1, "column z", source.lines[first - 1])),
                    None => 0.0,
                };
            }
            if self.position.scaled {
                all = triclinic.point(all);
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
        let spacing = if self.position.scaled { SCALED_SPACING * triclinic.edges[2][2] } else { 0.0 };
        plane.check(source, self.position.names[2], largest_radius(&disks), spacing)?;
        source.order_by_id(&disks)?;
        disks.sort_by_key(|disk| disk.label);
        Ok(disks)
    }
}
