//! [`write_packing`]: writes a packing, with columns and key-value pairs of the caller, as extended XYZ.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use crate::io::atomic::{WriteError, write_atomically};
use crate::packing::{Domain, Packing};

/// Columns that [`write_packing`] itself writes, or that have a meaning in other programs (Z: atomic number).
const RESERVED_COLUMNS: [&str; 11] =
    ["species", "pos", "radius", "id", "label", "held", "correction", "site", "site_correction", "load", "Z"];

/// Keys that [`write_packing`] itself writes.
const RESERVED_KEYS: [&str; 5] = ["Lattice", "Origin", "pbc", "Properties", "dimension"];

/// An additional column of numbers, one row per disk: a displacement, a force.
#[derive(Debug, Clone, Copy)]
pub struct Column<'a> {
    /// Its name: letters, digits, `_`, `-` and `.`.
    pub name: &'a str,
    /// Number of values per disk, at least 1.
    pub width: usize,
    /// The values, disk by disk \[the caller's unit\].
    pub values: &'a [f64],
}

/// Writes a packing as extended XYZ, which ASE and OVITO can open and [`read_packing`](crate::io::read_packing) reads
/// to the same bits.
///
/// Numbers are the shortest decimals that reproduce the `f64`. The columns are `species pos radius id`, then `held` if
/// a disk is held, `correction` if a centre has one, `site` if disks have sites (`site_correction` if one of those has
/// a low part), `load` if there are loads, then `columns`. Labels that repeat (the periodic images of a rim) are written as `label`, since
/// programs expect a unique `id`. For D = 2 a coordinate z = 0 and a lattice of height 1 are added. In the open plane
/// there is no lattice and `pbc="F F F"`.
///
/// `properties` are key-value pairs for the comment line: law, seed, provenance.
///
/// # Shape
/// Every column has `packing.len() * width` values, disk by disk.
///
/// Centres, or a corner of the box, beyond a million of the largest radii are written, but the reader refuses them.
///
/// # Errors
/// [`WriteError`] with the file and the problem; nothing is written then.
pub fn write_packing<const D: usize>(
    path: impl AsRef<Path>,
    packing: &Packing<D>,
    columns: &[Column],
    properties: &[(&str, &str)],
) -> Result<(), WriteError> {
    const { assert!(D == 2 || D == 3, "packings have two or three dimensions") };
    let path = path.as_ref();
    check(path, packing.len(), columns, properties)?;
    write_atomically(path, |writer| write(writer, packing, columns, properties))
}

pub(super) fn check(
    path: &Path,
    disks: usize,
    columns: &[Column],
    properties: &[(&str, &str)],
) -> Result<(), WriteError> {
    check_names(path, &RESERVED_COLUMNS, columns.iter().map(|column| column.name))?;
    check_names(path, &RESERVED_KEYS, properties.iter().map(|&(key, _)| key))?;
    for column in columns {
        let (expected, found) = (disks.saturating_mul(column.width), column.values.len());
        if column.width == 0 || expected != found {
            return Err(WriteError::ColumnLength { path: path.into(), column: column.name.into(), expected, found });
        }
    }
    match properties.iter().find(|(_, value)| value.chars().any(char::is_control)) {
        Some((key, value)) => {
            Err(WriteError::PropertyValue { path: path.into(), key: (*key).into(), value: (*value).into() })
        }
        None => Ok(()),
    }
}

fn check_names<'a>(path: &Path, reserved: &[&'a str], names: impl Iterator<Item = &'a str>) -> Result<(), WriteError> {
    let mut seen = reserved.to_vec();
    for name in names {
        let plain = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-.".contains(&byte));
        if name.is_empty() || !plain || seen.iter().any(|earlier| earlier.eq_ignore_ascii_case(name)) {
            return Err(WriteError::Name { path: path.into(), name: name.into() });
        }
        seen.push(name);
    }
    Ok(())
}

fn write<const D: usize>(
    writer: &mut impl Write,
    packing: &Packing<D>,
    columns: &[Column],
    properties: &[(&str, &str)],
) -> io::Result<()> {
    let held = packing.held().contains(&true);
    let corrected = packing.corrections().iter().flatten().any(|&low| low != 0.0);
    let mut sorted = packing.labels().to_vec();
    sorted.sort_unstable();
    let label = if sorted.windows(2).any(|pair| pair[0] == pair[1]) { "label" } else { "id" };

    let mut layout = format!("species:S:1:pos:R:3:radius:R:1:{label}:I:1");
    if held {
        layout += ":held:I:1";
    }
    if corrected {
        layout += &format!(":correction:R:{D}");
    }
    let split = packing.sites().is_some_and(|sites| sites.iter().flat_map(|site| site.1).any(|low| low.to_bits() != 0));
    if packing.sites().is_some() {
        layout += &format!(":site:R:{D}");
    }
    if split {
        layout += &format!(":site_correction:R:{D}");
    }
    if packing.loads().is_some() {
        layout += &format!(":load:R:{D}");
    }
    for column in columns {
        layout += &format!(":{}:R:{}", column.name, column.width);
    }
    writeln!(writer, "{}", packing.len())?;
    write!(writer, "{} Properties={layout} dimension={D}", boundary(packing.domain()))?;
    for (key, value) in properties {
        write!(writer, " {key}={}", quoted(value))?;
    }
    writeln!(writer)?;

    let mut line = String::new();
    for disk in 0..packing.len() {
        line.clear();
        // X is ASE's symbol for an unknown element; OVITO accepts any word.
        line.push('X');
        numbers(&mut line, &packing.positions()[disk]);
        if D == 2 {
            line.push_str(" 0.0");
        }
        numbers(&mut line, &packing.radii()[disk..=disk]);
        line.push_str(&format!(" {}", packing.labels()[disk]));
        if held {
            line.push_str(if packing.held()[disk] { " 1" } else { " 0" });
        }
        if corrected {
            numbers(&mut line, &packing.corrections()[disk]);
        }
        if let Some(sites) = packing.sites() {
            numbers(&mut line, &sites[disk].0);
            if split {
                numbers(&mut line, &sites[disk].1);
            }
        }
        if let Some(loads) = packing.loads() {
            numbers(&mut line, &loads[disk]);
        }
        for column in columns {
            numbers(&mut line, &column.values[disk * column.width..(disk + 1) * column.width]);
        }
        line.push('\n');
        writer.write_all(line.as_bytes())?;
    }
    Ok(())
}

/// Appends numbers that are read to the same bits (NaN and infinities of the caller's columns by name).
fn numbers(line: &mut String, values: &[f64]) {
    for value in values {
        write!(line, " {value:?}").expect("a String takes all that is written to it");
    }
}

/// Lattice, origin and periodicity.
fn boundary<const D: usize>(domain: &Domain<D>) -> String {
    let Domain::Periodic { corner, edges } = domain else { return r#"pbc="F F F""#.into() };
    let edge = |d: usize, axis: usize| match (d < D, axis < D) {
        (true, true) => edges[d][axis],
        _ => f64::from(u8::from(d == axis)),
    };
    let lattice: Vec<String> = (0..9).map(|index| format!("{:?}", edge(index / 3, index % 3))).collect();
    let start = |axis: usize| if axis < D { corner[axis] } else { 0.0 };
    format!(
        r#"Lattice="{}" Origin="{:?} {:?} {:?}" pbc="T T {}""#,
        lattice.join(" "),
        start(0),
        start(1),
        start(2),
        if D == 2 { "F" } else { "T" }
    )
}

/// The value, quoted if it would not be read as one word.
fn quoted(value: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"_-+./:".contains(&byte);
    if !value.is_empty() && value.bytes().all(plain) {
        return value.into();
    }
    format!("\"{}\"", value.replace('\\', "\\\\").replace('"', "\\\""))
}
