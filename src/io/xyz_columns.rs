//! The columns of extended XYZ, from the key `Properties`, and their values in the rows.

use crate::io::comment_line::CommentLine;
use crate::io::plane::Plane;
use crate::io::read_error::{ReadError, spacing};
use crate::io::source::{AXES, Disk, Row, Source, excerpt};
use crate::vector::Vector;

/// Largest number of values of a property; far above any use, far below an overflow of their sum.
const WIDTH_LIMIT: usize = 65_535;

/// Other names of columns, without case, `_`, `-` and `.`.
const POSITION: &[&str] = &["pos", "position", "positions", "coordinates"];
const RADIUS: &[&str] = &["radius", "radii"];
const DIAMETER: &[&str] = &["diameter", "diameters"];
const LABEL: &[&str] =
    &["id", "ids", "label", "labels", "identifier", "identifiers", "particleidentifier", "particleid", "atomid"];

/// A name without case, `_`, `-` and `.`.
fn plain(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, '_' | '-' | '.')).map(|c| c.to_ascii_lowercase()).collect()
}

/// A column of the key `Properties`.
#[derive(Debug, Clone, Copy)]
struct Column<'a> {
    name: &'a str,
    kind: &'a str,
    width: usize,
    start: usize,
}

/// Indices of the columns in a row.
pub(super) struct Columns<const D: usize> {
    position: [usize; D],
    /// z of a plane.
    third: Option<usize>,
    /// Column, name, and factor to the radius.
    radius: (usize, &'static str, f64),
    /// Column and name.
    label: Option<(usize, &'static str)>,
    held: Option<usize>,
    /// The opposite of `held`, as ASE writes it.
    mobile: Option<usize>,
    correction: Option<usize>,
    site: Option<usize>,
    site_correction: Option<usize>,
    load: Option<usize>,
    pub total: usize,
}

/// The columns of the first D coordinates, and of z in a plane.
type Place<const D: usize> = ([usize; D], Option<usize>);

/// The columns of a comment line, with the place for messages.
struct Layout<'a, 'b> {
    source: &'a Source<'b>,
    line: usize,
    columns: Vec<Column<'a>>,
    total: usize,
}

impl<'a, 'b> Layout<'a, 'b> {
    fn new(source: &'a Source<'b>, line: usize, properties: &'a str) -> Result<Self, ReadError> {
        let parts: Vec<&str> = properties.split(':').collect();
        let mut layout = Layout { source, line, columns: Vec::new(), total: 0 };
        for part in parts.chunks(3) {
            let width = part.get(2).and_then(|width| width.parse().ok());
            let width = width.filter(|width| (1..=WIDTH_LIMIT).contains(width));
            let (&[name, kind @ ("S" | "R" | "I" | "L"), _], Some(width)) = (part, width) else {
                return Err(source.bad(line, "Properties", &part.join(":"), "name:S, R, I or L:number of values"));
            };
            if layout.columns.iter().any(|earlier| earlier.name == name) {
                return Err(source.repeated(line, "column", name, line));
            }
            layout.columns.push(Column { name, kind, width, start: layout.total });
            layout.total += width;
        }
        Ok(layout)
    }

    /// The column with one of these names; two are refused.
    fn find(
        &self,
        names: &[&str],
        kinds: &str,
        widths: &[usize],
        expected: &'static str,
    ) -> Result<Option<Column<'a>>, ReadError> {
        let mut found = self.columns.iter().filter(|column| names.contains(&plain(column.name).as_str()));
        let Some(&column) = found.next() else { return Ok(None) };
        if let Some(second) = found.next() {
            let both = format!("{} and {}", column.name, second.name);
            return Err(self.source.bad(self.line, "columns", &both, "one of them: their names mean the same"));
        }
        let Column { name, kind, width, .. } = column;
        if kinds.contains(kind) && widths.contains(&width) {
            return Ok(Some(column));
        }
        Err(self.source.bad(self.line, &format!("column {name}"), &format!("{name}:{kind}:{width}"), expected))
    }

    /// The columns of the centre.
    fn position<const D: usize>(&self) -> Result<Option<Place<D>>, ReadError> {
        let (widths, expected): (&[usize], _) =
            if D == 2 { (&[2, 3], "pos:R:3 or pos:R:2") } else { (&[3], "pos:R:3") };
        if let Some(column) = self.find(POSITION, "RI", widths, expected)? {
            let third = (column.width > D).then_some(column.start + D);
            return Ok(Some((std::array::from_fn(|axis| column.start + axis), third)));
        }
        let mut single = [None; 3];
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            single[axis] = self.find(&[name], "RI", &[1], "one number")?.map(|column| column.start);
        }
        if single[..D].iter().any(Option::is_none) {
            return Ok(None);
        }
        let third = if D == 2 { single[2] } else { None };
        Ok(Some((std::array::from_fn(|axis| single[axis].unwrap_or(0)), third)))
    }

    /// The column of the label; two that could be it are refused.
    fn label(&self) -> Result<Option<(usize, &'static str)>, ReadError> {
        let mut found = self.columns.iter().filter(|column| LABEL.contains(&plain(column.name).as_str()));
        let (first, second) = (found.next(), found.next());
        if let (Some(first), Some(second)) = (first, second) {
            return Err(ReadError::TwoLabels {
                path: self.source.path.into(),
                line: self.line + 1,
                first: excerpt(first.name),
                second: excerpt(second.name),
            });
        }
        let Some(column) = first else { return Ok(None) };
        let start = self.find(&[&plain(column.name)], "I", &[1], "id:I:1")?.map(|column| column.start);
        let name = if plain(column.name).starts_with("label") { "label" } else { "id" };
        Ok(start.map(|start| (start, name)))
    }
}

impl<const D: usize> Columns<D> {
    /// Parses the key `Properties`.
    pub fn new(source: &Source, line: usize, comment: &CommentLine) -> Result<Self, ReadError> {
        let Some(properties) = comment.value("Properties") else {
            return Err(source.missing(line, "Properties", comment.keys()));
        };
        let layout = Layout::new(source, line, properties)?;
        let start = |name: &str, kinds: &str, width: usize, expected: &'static str| {
            layout.find(&[name], kinds, &[width], expected).map(|found| found.map(|column| column.start))
        };
        let (position, third) =
            layout.position()?.ok_or_else(|| source.missing(line, "column pos in Properties", properties))?;
        let radius = layout.find(RADIUS, "RI", &[1], "radius:R:1")?.map(|column| (column.start, "radius", 1.0));
        let diameter = layout.find(DIAMETER, "RI", &[1], "diameter:R:1")?.map(|column| (column.start, "diameter", 0.5));
        let radius = radius
            .or(diameter)
            .ok_or_else(|| source.missing(line, "column radius or diameter in Properties", properties))?;
        let site = start("site", "R", D, "site:R with D values")?;
        let site_correction = start("sitecorrection", "R", D, "site_correction:R with D values")?;
        if site.is_none() && site_correction.is_some() {
            return Err(source.missing(line, "column site in Properties", properties));
        }
        Ok(Columns {
            position,
            third,
            radius,
            label: layout.label()?,
            held: start("held", "IL", 1, "held:I:1 or held:L:1")?,
            mobile: start("movemask", "IL", 1, "move_mask:L:1")?,
            correction: start("correction", "R", D, "correction:R with D values")?,
            site,
            site_correction,
            load: start("load", "R", D, "load:R with D values")?,
            total: layout.total,
        })
    }

    /// Whether rows have labels.
    pub fn has_labels(&self) -> bool {
        self.label.is_some()
    }

    /// Whether labels are ids, which mobile disks do not repeat.
    pub fn has_ids(&self) -> bool {
        self.label.is_some_and(|(_, name)| name == "id")
    }

    /// Whether disks have sites.
    pub fn has_sites(&self) -> bool {
        self.site.is_some()
    }

    pub fn disk(&self, row: &Row, line: usize) -> Result<Disk<D>, ReadError> {
        let mut position = [0.0; D];
        for axis in 0..D {
            position[axis] = row.number(self.position[axis], &format!("pos {}", AXES[axis]))?;
        }
        let label = match self.label {
            Some((column, name)) => row.whole(column, name)?,
            None => 0,
        };
        let (column, name, factor) = self.radius;
        Ok(Disk { label, line, position, radius: row.radius(column, name, factor)? })
    }

    /// Takes z of a disk in a plane.
    pub fn take_third(&self, row: &Row, line: usize, plane: &mut Plane) -> Result<(), ReadError> {
        if let Some(column) = self.third {
            plane.take(row.number(column, "pos z")?, line, row.values[column]);
        }
        Ok(())
    }

    pub fn held(&self, source: &Source, row: &Row, line: usize) -> Result<bool, ReadError> {
        let (column, name, is_mobile) = match (self.held, self.mobile) {
            (Some(column), _) => (column, "held", false),
            (None, Some(column)) => (column, "move_mask", true),
            (None, None) => return Ok(false),
        };
        let value = row.values[column];
        let flag = flag(value).ok_or_else(|| source.bad(line, name, value, "1 or T, 0 or F"))?;
        Ok(flag != is_mobile)
    }

    /// The low part of the centre of a disk; 0 without such a column.
    pub fn correction(&self, source: &Source, row: &Row, disk: &Disk<D>) -> Result<Vector<D>, ReadError> {
        let low = self.vector(row, self.correction, "correction")?;
        self.check_low(source, row, (self.correction, "correction"), (disk.line, &disk.position, &low))?;
        Ok(low)
    }

    /// The site of a disk and its low part, if there are sites.
    pub fn site(&self, source: &Source, row: &Row, line: usize) -> Result<Option<(Vector<D>, Vector<D>)>, ReadError> {
        if self.site.is_none() {
            return Ok(None);
        }
        let site = self.vector(row, self.site, "site")?;
        let low = self.vector(row, self.site_correction, "site_correction")?;
        self.check_low(source, row, (self.site_correction, "site_correction"), (line, &site, &low))?;
        Ok(Some((site, low)))
    }

    /// Whether disks have loads.
    pub fn has_loads(&self) -> bool {
        self.load.is_some()
    }

    /// The load of a disk; 0 without such a column.
    pub fn load(&self, row: &Row) -> Result<Vector<D>, ReadError> {
        self.vector(row, self.load, "load")
    }

    /// Refuses a low part that is not below the spacing of numbers at its coordinate; a written low part is at most
    /// half of it.
    fn check_low(
        &self,
        source: &Source,
        row: &Row,
        (start, name): (Option<usize>, &'static str),
        (line, high, low): (usize, &Vector<D>, &Vector<D>),
    ) -> Result<(), ReadError> {
        for axis in 0..D {
            if let Some(start) = start
                && low[axis].abs() >= spacing(high[axis])
            {
                return Err(ReadError::CorrectionTooLarge {
                    path: source.path.into(),
                    line: line + 1,
                    field: name,
                    axis: AXES[axis],
                    value: excerpt(row.values[start + axis]),
                    coordinate: high[axis],
                });
            }
        }
        Ok(())
    }

    /// The D values from a column on; zero without such a column.
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

pub(super) fn flag(text: &str) -> Option<bool> {
    match text {
        "T" | "True" | "true" | "1" => Some(true),
        "F" | "False" | "false" | "0" => Some(false),
        _ => None,
    }
}
