//! The lines of a file and their values, with errors that contain the position.

use std::path::Path;

use crate::io::frame::Frame;
use crate::io::read_error::ReadError;
use crate::packing::{Domain, LARGEST_RADIUS, Packing, SMALLEST_RADIUS};
use crate::vector::Vector;

/// Names of the sides of a LAMMPS box.
pub(super) const SIDES: [&str; 3] = ["xlo xhi", "ylo yhi", "zlo zhi"];

/// Names of the axes.
pub(super) const AXES: [char; 3] = ['x', 'y', 'z'];

/// Largest coordinate over the largest radius, and largest corner of a box over its side \[1\].
///
/// The rounding of such a coordinate is 2·10⁻¹⁰ radii; overlaps at the lowest pressures of the study are 10⁻⁵ radii. No
/// packing near the origin extends so far: a box of a million radii has space for 10¹¹ disks, more than there are
/// indices.
pub(super) const FARTHEST: f64 = 1e6;

/// A file split into lines. Line indices start at 0 here and at 1 in errors.
pub(super) struct Source<'a> {
    pub path: &'a Path,
    pub lines: Vec<&'a str>,
    text: &'a str,
}

/// The values of one line, separated by blanks.
pub(super) struct Row<'a> {
    source: &'a Source<'a>,
    line: usize,
    pub values: Vec<&'a str>,
}

/// A disk with its line.
pub(super) struct Disk<const D: usize> {
    pub label: u64,
    pub line: usize,
    pub position: Vector<D>,
    pub radius: f64,
}

/// The text, shortened to 60 characters so that a message stays readable.
pub(super) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// A number; its exponent may begin with d or D, as in Fortran.
fn parsed(text: &str) -> Option<f64> {
    text.parse().ok().or_else(|| {
        let is_digit = |at: usize| text.as_bytes().get(at).is_some_and(u8::is_ascii_digit);
        let at = text.find(['d', 'D'])?;
        // A digit before and a number after it.
        let has_digits = at > 0 && (is_digit(at - 1) || text[..at].ends_with('.'));
        has_digits.then(|| text.replacen(['d', 'D'], "e", 1).parse().ok()).flatten()
    })
}

/// The largest radius \[length\].
pub(super) fn largest_radius<const D: usize>(disks: &[Disk<D>]) -> f64 {
    disks.iter().map(|disk| disk.radius).fold(0.0, f64::max)
}

impl<'a> Source<'a> {
    pub fn new(path: &'a Path, text: &'a str) -> Self {
        Source { path, lines: text.lines().collect(), text }
    }

    /// Whether the last line has no line break.
    pub fn is_open(&self) -> bool {
        !self.text.ends_with('\n')
    }

    pub fn row(&'a self, line: usize) -> Row<'a> {
        Row { source: self, line, values: self.lines[line].split_ascii_whitespace().collect() }
    }

    /// A line without its comment, separated by blanks.
    pub fn row_without_comment(&'a self, line: usize) -> Row<'a> {
        let text = self.lines[line].split('#').next().unwrap_or("");
        Row { source: self, line, values: text.split_ascii_whitespace().collect() }
    }

    pub fn bad(&self, line: usize, field: &str, value: &str, expected: &'static str) -> ReadError {
        ReadError::Value {
            path: self.path.into(),
            line: line + 1,
            field: excerpt(field),
            value: excerpt(value),
            expected,
        }
    }

    pub fn no_disks(&self, line: usize, field: &str) -> ReadError {
        self.bad(line, field, "0", "at least one disk")
    }

    pub fn missing(&self, line: usize, field: &'static str, found: impl Into<String>) -> ReadError {
        ReadError::Missing { path: self.path.into(), line: line + 1, field, found: excerpt(&found.into()) }
    }

    pub fn repeated(&self, line: usize, field: &'static str, value: &str, first_line: usize) -> ReadError {
        let value = excerpt(value);
        ReadError::Repeated { path: self.path.into(), line: line + 1, field, value, first_line: first_line + 1 }
    }

    pub fn truncated(&self, line: usize, what: &'static str, expected: usize, found: usize) -> ReadError {
        ReadError::Truncated { path: self.path.into(), line, what, expected, found }
    }

    pub fn out_of_plane(&self, line: usize, field: &str, value: &str) -> ReadError {
        ReadError::OutOfPlane { path: self.path.into(), line: line + 1, field: field.to_owned(), value: excerpt(value) }
    }

    pub fn not_periodic(&self, line: usize, field: &'static str, value: &str, axis: usize) -> ReadError {
        let value = excerpt(value);
        ReadError::NotPeriodic { path: self.path.into(), line: line + 1, field, value, axis: AXES[axis] }
    }

    pub fn dimension(&self, line: usize, field: &'static str, value: &str, dimension: usize) -> ReadError {
        let value = excerpt(value);
        ReadError::Dimension { path: self.path.into(), line: line + 1, field, value, dimension }
    }

    /// Parses a finite number.
    pub fn number(&self, line: usize, field: &str, value: &str) -> Result<f64, ReadError> {
        match parsed(value) {
            Some(number) if number.is_finite() => Ok(number),
            _ => Err(self.bad(line, field, value, "a finite number")),
        }
    }

    /// Parses a positive finite number.
    pub fn positive(&self, line: usize, field: &str, value: &str) -> Result<f64, ReadError> {
        match parsed(value) {
            Some(number) if number.is_finite() && number > 0.0 => Ok(number),
            _ => Err(self.bad(line, field, value, "a positive finite number")),
        }
    }

    /// Parses a non-negative integer.
    pub fn whole(&self, line: usize, field: &str, value: &str) -> Result<u64, ReadError> {
        value.parse().map_err(|_| self.bad(line, field, value, "a whole number, 0 or more"))
    }

    /// Parses the two ends of a side of the box; returns the lower end and the length of the side.
    pub fn side(&self, line: usize, field: &str, low: &str, high: &str) -> Result<(f64, f64), ReadError> {
        let start = self.number(line, field, low)?;
        let length = self.number(line, field, high)? - start;
        if length.is_finite() && length > 0.0 {
            self.check_corner(line, field, start, length)?;
            return Ok((start, length));
        }
        Err(self.bad(line, field, &format!("{low} {high}"), "a lower end below the upper one"))
    }

    /// Like [`Source::side`], for the third side of a plane, which may have no length.
    pub fn height(&self, line: usize, field: &str, low: &str, high: &str) -> Result<(f64, f64), ReadError> {
        let (start, end) = (self.number(line, field, low)?, self.number(line, field, high)?);
        if start == end { Ok((start, 0.0)) } else { self.side(line, field, low, high) }
    }

    /// Index of the requested frame among `count`.
    pub fn frame(&self, frame: Frame, count: usize) -> Result<usize, ReadError> {
        frame.index_of(self.path, count)
    }

    /// Refuses the corner of a box that is more than [`FARTHEST`] sides away from the origin.
    pub fn check_corner(&self, line: usize, field: &str, corner: f64, side: f64) -> Result<(), ReadError> {
        self.check_far(line, field, corner, (side, "the side of the box"))
    }

    /// Refuses a point that is more than [`FARTHEST`] of the largest radii away from the origin.
    pub fn check_reach<const D: usize>(
        &self,
        line: usize,
        field: &str,
        point: &Vector<D>,
        largest_radius: f64,
    ) -> Result<(), ReadError> {
        for axis in 0..D {
            let unit = (largest_radius, "the largest radius");
            self.check_far(line, &format!("{field} {}", AXES[axis]), point[axis], unit)?;
        }
        Ok(())
    }

    fn check_far(&self, line: usize, field: &str, value: f64, unit: (f64, &'static str)) -> Result<(), ReadError> {
        let limit = FARTHEST * unit.0;
        if value.abs() <= limit {
            return Ok(());
        }
        let (path, field) = (self.path.into(), field.to_owned());
        Err(ReadError::TooFar { path, line: line + 1, field, value, limit, unit: unit.1 })
    }

    /// The packing of disks in the given order.
    pub fn packing<const D: usize>(
        &self,
        domain: Domain<D>,
        disks: &[Disk<D>],
        labelled: bool,
    ) -> Result<Packing<D>, ReadError> {
        let largest_radius = largest_radius(disks);
        for disk in disks {
            self.check_reach(disk.line, "coordinate", &disk.position, largest_radius)?;
        }
        let positions = disks.iter().map(|disk| disk.position).collect();
        let radii = disks.iter().map(|disk| disk.radius).collect();
        let packing = Packing::new(domain, positions, radii);
        let labels = || disks.iter().map(|disk| disk.label).collect();
        let packing = if labelled { packing.and_then(|packing| packing.with_labels(labels())) } else { packing };
        packing.map_err(|source| ReadError::Packing { path: self.path.into(), source })
    }

    /// Refuses an id that two mobile disks have. Held disks may repeat ids, as the periodic images of a rim do.
    pub fn check_ids<const D: usize>(
        &self,
        disks: &[Disk<D>],
        is_held: impl Fn(usize) -> bool,
    ) -> Result<(), ReadError> {
        let mut mobile: Vec<usize> = (0..disks.len()).filter(|&disk| !is_held(disk)).collect();
        mobile.sort_by_key(|&disk| disks[disk].label);
        for pair in mobile.windows(2) {
            let (first, second) = (&disks[pair[0]], &disks[pair[1]]);
            if first.label == second.label {
                return Err(self.repeated(second.line, "id", &second.label.to_string(), first.line));
            }
        }
        Ok(())
    }

    /// The indices of the disks in ascending order of their labels, which must be unique.
    pub fn order_by_id<const D: usize>(&self, disks: &[Disk<D>]) -> Result<Vec<usize>, ReadError> {
        let mut order: Vec<usize> = (0..disks.len()).collect();
        order.sort_by_key(|&place| disks[place].label);
        for pair in order.windows(2) {
            let (first, second) = (&disks[pair[0]], &disks[pair[1]]);
            if first.label == second.label {
                return Err(self.repeated(second.line, "id", &second.label.to_string(), first.line));
            }
        }
        Ok(order)
    }
}

impl Row<'_> {
    pub fn expect_count(&self, expected: usize) -> Result<(), ReadError> {
        if self.values.len() == expected { Ok(()) } else { Err(self.count_is_not(expected.to_string())) }
    }

    pub fn count_is_not(&self, expected: String) -> ReadError {
        let path = self.source.path.into();
        ReadError::ColumnCount { path, line: self.line + 1, expected, found: self.values.len() }
    }

    pub fn number(&self, column: usize, field: &str) -> Result<f64, ReadError> {
        self.source.number(self.line, field, self.values[column])
    }

    /// The first three values, before their keyword.
    pub fn three(&self, field: &str) -> Result<[f64; 3], ReadError> {
        let mut numbers = [0.0; 3];
        for (column, number) in numbers.iter_mut().enumerate() {
            let value = self.values.get(column).copied().unwrap_or("");
            *number = self.source.number(self.line, field, value)?;
        }
        Ok(numbers)
    }

    pub fn positive(&self, column: usize, field: &str) -> Result<f64, ReadError> {
        self.source.positive(self.line, field, self.values[column])
    }

    /// A radius, `factor` times the value.
    pub fn radius(&self, column: usize, field: &str, factor: f64) -> Result<f64, ReadError> {
        let radius = factor * self.positive(column, field)?;
        if (SMALLEST_RADIUS..=LARGEST_RADIUS).contains(&radius) {
            return Ok(radius);
        }
        Err(self.source.bad(self.line, field, self.values[column], "a radius from 1e-130 to 1e150"))
    }

    pub fn whole(&self, column: usize, field: &str) -> Result<u64, ReadError> {
        self.source.whole(self.line, field, self.values[column])
    }
}
