//! The columns of extended XYZ, from the key `Properties`, and their values in the rows.

use crate::io::comment_line::CommentLine;
use crate::io::read_error::{ReadError, spacing};
use crate::io::source::{AXES, Disk, Row, Source, excerpt};
use crate::vector::Vector;

/// Largest number of values of a property; far above any use, far below an overflow of their sum.
const WIDTH_LIMIT: usize = 65_535;

/// Indices of the columns in a row.
pub(super) struct Columns<const D: usize> {
    position: usize,
    position_width: usize,
    radius: usize,
    id: Option<usize>,
    label: Option<usize>,
    held: Option<usize>,
    correction: Option<usize>,
    site: Option<usize>,
    site_correction: Option<usize>,
    pub total: usize,
}

impl<const D: usize> Columns<D> {
    /// Parses the key `Properties`.
    pub fn new(source: &Source, line: usize, comment: &CommentLine) -> Result<Self, ReadError> {
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

    /// Whether rows have labels or ids.
    pub fn has_labels(&self) -> bool {
        self.label.or(self.id).is_some()
    }

    /// Whether labels are ids, which are unique.
    pub fn has_ids(&self) -> bool {
        self.label.is_none() && self.id.is_some()
    }

    /// Whether disks have sites.
    pub fn has_sites(&self) -> bool {
        self.site.is_some()
    }

    pub fn disk(&self, source: &Source, row: &Row, line: usize) -> Result<Disk<D>, ReadError> {
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
        Ok(Disk { label, line, position, radius: row.radius(self.radius, "radius", 1.0)? })
    }

    pub fn held(&self, source: &Source, row: &Row, line: usize) -> Result<bool, ReadError> {
        let Some(column) = self.held else { return Ok(false) };
        let value = row.values[column];
        flag(value).ok_or_else(|| source.bad(line, "held", value, "1 or T, 0 or F"))
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
