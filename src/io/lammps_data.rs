//! Reads LAMMPS data files of `atom_style sphere` (from `write_data` or from jamscope) to a [`Packing`](crate::packing::Packing).
//!
//! ```text
//! free text
//!
//! 2 atoms
//! 1 atom types
//! 0.0 9.0 xlo xhi
//! 0.0 8.0 ylo yhi
//! -0.5 0.5 zlo zhi
//!
//! Atoms # sphere
//!
//! 1 1 1.0 1.0 1.0 2.0 0.0
//! 2 1 1.4 1.0 2.1 2.0 0.0
//! ```
//!
//! Columns of `Atoms`: id, type, diameter \[length\], density, x, y, z \[length\] and optionally three image flags,
//! which are ignored. The style after `#` must be `sphere`; without it the file is refused, since other styles have rows of the
//! same length. A tilted box has a header line `xy xz yz`, or its edges in the lines `avec`, `bvec`, `cvec` and its corner in
//! `abc origin`. For D = 2 z must be the same for all disks. A data file does not
//! contain the periodicity: all directions are periodic, the default of LAMMPS. Other sections are skipped. Duplicate
//! header lines and sections are refused, where LAMMPS would use the last. Disks are in ascending order of their ids.
//!
//! # Source
//! LAMMPS manual, commands `read_data` and `write_data`.

use crate::io::contents::Contents;
use crate::io::frame::Frame;
use crate::io::plane::Plane;
use crate::io::read_error::ReadError;
use crate::io::read_warning::ReadWarning;
use crate::io::source::{Disk, SIDES, Source, largest_radius};
use crate::io::triclinic::{Triclinic, Turn, turn};
use crate::packing::Domain;

/// Number of columns of `Atoms` in style sphere, without and with image flags.
const COLUMN_COUNTS: [usize; 2] = [7, 10];

/// Whether a line of a data file starts a section: these begin with a letter, all other lines with a number.
pub(super) fn opens_section(line: &str) -> bool {
    line.trim_start().starts_with(|c: char| c.is_ascii_alphabetic())
}

/// Reads the only frame.
pub(super) fn parse<const D: usize>(source: &Source, frame: Frame) -> Result<Contents<D>, ReadError> {
    source.frame(frame, 1)?;
    // The first line is free text and may resemble anything.
    let sections: Vec<usize> = (1..source.lines.len()).filter(|&line| opens_section(source.lines[line])).collect();
    let header_end = sections.first().copied().unwrap_or(source.lines.len());
    // A header line whose first number is none looks like a section.
    if let Some(&line) = sections.iter().find(|&&line| {
        let last = source.row_without_comment(line).values.last().copied().unwrap_or_default().to_owned();
        ["yz", "avec", "bvec", "cvec", "origin", "xhi", "yhi", "zhi"].contains(&last.as_str())
    }) {
        return Err(source.bad(line, "header line", source.lines[line].trim(), "finite numbers before its keyword"));
    }
    let header = Header::<D>::new(source, header_end)?;
    let names: Vec<String> = sections.iter().map(|&line| source.row_without_comment(line).values.join(" ")).collect();
    for (place, name) in names.iter().enumerate() {
        if let Some(earlier) = names[..place].iter().position(|earlier| earlier == name) {
            return Err(source.repeated(sections[place], "section", name, sections[earlier]));
        }
    }
    let Some(place) = names.iter().position(|name| name == "Atoms") else {
        // Not `missing`: a file cut before its first disk also ends here.
        return Err(source.truncated(source.lines.len(), "disks of section Atoms", header.count, 0));
    };
    let start = sections[place];
    let style = source.lines[start].split('#').nth(1).unwrap_or("").trim();
    if style.is_empty() {
        return Err(ReadError::NoAtomStyle { path: source.path.into(), line: start + 1 });
    }
    if style != "sphere" {
        let style = crate::io::source::excerpt(style);
        return Err(ReadError::AtomStyle { path: source.path.into(), line: start + 1, style });
    }
    let end = sections.get(place + 1).copied().unwrap_or(source.lines.len());
    let mut disks: Vec<Disk<D>> = Vec::new();
    let mut columns = None;
    let mut plane = Plane::new();
    for line in start + 1..end {
        let row = source.row_without_comment(line);
        let found = row.values.len();
        if found == 0 {
            continue;
        }
        if disks.len() == header.count {
            return Err(ReadError::TooManyRows { path: source.path.into(), line: line + 1, expected: header.count });
        }
        if !COLUMN_COUNTS.contains(&found) || *columns.get_or_insert(found) != found {
            let sphere = "7 or, with image flags, 10 (style sphere), the same in every row";
            return Err(row.count_is_not(sphere.into()));
        }
        let label = row.whole(0, "id")?;
        let kind = row.whole(1, "type")?;
        if kind == 0 || header.type_count.is_some_and(|count| kind > count) {
            return Err(source.bad(line, "type", row.values[1], "one of the atom types announced"));
        }
        let radius = row.radius(2, "diameter", 0.5)?;
        row.positive(3, "density")?;
        let mut position = [0.0; D];
        for axis in 0..D {
            position[axis] = row.number(4 + axis, &SIDES[axis][..1])?;
        }
        if D == 2 {
            plane.take(row.number(6, "z")?, line, row.values[6]);
        }
        for column in 7..found {
            if row.values[column].parse::<i64>().is_err() {
                return Err(source.bad(line, "image flag", row.values[column], "a whole number"));
            }
        }
        disks.push(Disk { label, line, position, radius });
    }
    if disks.len() < header.count {
        return Err(source.truncated(end, "disks of section Atoms", header.count, disks.len()));
    }
    plane.check(source, "z", largest_radius(&disks), 0.0)?;
    source.order_by_id(&disks)?;
    disks.sort_by_key(|disk| disk.label);
    turn(&header.turn, &mut disks);
    let warnings = header.turn.map(|_| ReadWarning::Turned { line: header.line + 1 }).into_iter().collect();
    Ok(Contents { warnings, ..Contents::from(source.packing(header.domain, &disks, true)?) })
}

/// The lines before the first section.
struct Header<const D: usize> {
    count: usize,
    type_count: Option<u64>,
    domain: Domain<D>,
    turn: Turn<D>,
    /// Line of the box.
    line: usize,
}

impl<const D: usize> Header<D> {
    fn new(source: &Source, end: usize) -> Result<Self, ReadError> {
        let mut count = None;
        let mut type_count = None;
        let mut sides: [Option<(f64, f64)>; 3] = [None; 3];
        let mut edges: [Option<(usize, [f64; 3])>; 3] = [None; 3];
        let (mut tilts, mut origin, mut tilt_line) = ([0.0; 3], [0.0; 3], 0);
        let mut known: Vec<(String, usize)> = Vec::new();
        for line in 1..end {
            let row = source.row_without_comment(line);
            let keyword = keyword(&row.values);
            if let Some((_, earlier)) = known.iter().find(|(earlier, _)| *earlier == keyword) {
                return Err(source.repeated(line, "header line", &keyword, *earlier));
            }
            if !keyword.is_empty() {
                known.push((keyword, line));
            }
            match row.values[..] {
                [number, "atoms"] => {
                    count = match number.parse() {
                        Ok(0) => return Err(source.no_disks(line, "atoms")),
                        Ok(number) => Some(number),
                        Err(_) => return Err(source.bad(line, "atoms", number, "a whole number")),
                    };
                }
                [_, "atom", "types"] => type_count = Some(row.whole(0, "atom types")?),
                [_, _, _, "xy", "xz", "yz"] => (tilts, tilt_line) = (row.three("xy xz yz")?, line),
                [.., "avec"] => edges[0] = Some((line, row.three("avec")?)),
                [.., "bvec"] => edges[1] = Some((line, row.three("bvec")?)),
                [.., "cvec"] => edges[2] = Some((line, row.three("cvec")?)),
                [.., "abc", "origin"] => origin = row.three("abc origin")?,
                [low, high, first, second] => {
                    let name = format!("{first} {second}");
                    if let Some(axis) = SIDES.iter().position(|&side| side == name) {
                        sides[axis] = Some(source.side(line, &name, low, high)?);
                    }
                }
                _ => {
                    // A tilt that is not understood is not left out.
                    let is_tilt = |word: &str| ["xy", "xz", "yz"].iter().any(|tilt| word.eq_ignore_ascii_case(tilt));
                    if row.values.iter().any(|word| is_tilt(word)) {
                        let text = source.lines[line].trim();
                        return Err(source.bad(line, "xy xz yz", text, "three numbers, then xy xz yz"));
                    }
                }
            }
        }
        let last = end.saturating_sub(1);
        let Some(count) = count else { return Err(source.missing(last, "header line `N atoms`", "none")) };
        let (line, triclinic) = match edges {
            [Some((line, a)), Some((_, b)), Some((_, c))] => (line, Triclinic { corner: origin, edges: [a, b, c] }),
            [None, None, None] => {
                let (mut corner, mut lengths) = ([0.0; 3], [0.0; 3]);
                for axis in 0..3 {
                    (corner[axis], lengths[axis]) = match sides[axis] {
                        Some(side) => side,
                        None if axis < D => return Err(source.missing(last, SIDES[axis], "a header without it")),
                        None => (0.0, 0.0),
                    };
                }
                let mut triclinic = Triclinic::rectangular(corner, lengths);
                let [xy, xz, yz] = tilts;
                (triclinic.edges[1][0], triclinic.edges[2][0], triclinic.edges[2][1]) = (xy, xz, yz);
                (tilt_line, triclinic)
            }
            _ => {
                return Err(source.missing(last, "one of the header lines avec, bvec and cvec", "a header without it"));
            }
        };
        let (domain, turn) = triclinic.domain(source, line, "the box")?;
        Ok(Header { count, type_count, domain, turn, line })
    }
}

/// The keyword of a header line: its words after the last number.
fn keyword(values: &[&str]) -> String {
    let start = values.iter().rposition(|word| !word.starts_with(|c: char| c.is_ascii_alphabetic()));
    values[start.map_or(0, |last| last + 1)..].join(" ")
}
