//! [`write_npz`]: writes a packing, with columns and key-value pairs of the caller, as a NumPy archive.

use std::io::{self, Write};
use std::path::Path;

use crate::io::atomic::{WriteError, write_atomically};
use crate::io::npz::archive::Archive;
use crate::io::npz::array::{Array, Values};
use crate::io::npz::contents::is_reserved;
use crate::io::write_packing::{Column, check};
use crate::packing::{Domain, Packing};

/// Writes a packing as a NumPy archive (`.npz`), which `numpy.load` opens and [`read_packing`](crate::io::read_packing) reads to the same
/// bits.
///
/// The arrays are `positions` (N, D), `radii`, `labels`, `held` (N,), `box` and `origin` (D,) for a periodic box, `pbc` (D,), `corrections`
/// (N, D) if a centre has one, `sites` and `site_corrections` (N, D) if disks have sites, `loads` (N, D) if there are any. Then follow `columns`, of shape (N,) or
/// (N, width), and `properties` as arrays without an axis: numbers as numbers, others as texts.
///
/// # Shape
/// Every column has `packing.len() * width` values, disk by disk.
///
/// # Errors
/// [`WriteError`] with the file and the problem; nothing is written then. A column and a key have different names, and none of those of the
/// arrays. The archive has at most 4 GiB.
///
/// # Example
/// ```
/// use jamscope::io::{read_packing, write_npz};
/// let packing = read_packing::<2>("fixtures/packings/hertz_N1000_p100.xyz")?;
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("packing.npz");
/// write_npz(&path, &packing, &[], &[("law", "hertzian")])?;
/// assert_eq!(read_packing::<2>(&path)?, packing);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_npz<const D: usize>(
    path: impl AsRef<Path>,
    packing: &Packing<D>,
    columns: &[Column],
    properties: &[(&str, &str)],
) -> Result<(), WriteError> {
    let path = path.as_ref();
    check(path, packing.len(), columns, properties)?;
    let mut names: Vec<&str> = columns.iter().map(|column| column.name).collect();
    names.extend(properties.iter().map(|(key, _)| *key));
    let repeated = |at: usize| names[..at].contains(&names[at]);
    if let Some(at) = (0..names.len()).find(|&at| is_reserved(names[at]) || repeated(at)) {
        return Err(WriteError::Name { path: path.into(), name: names[at].into() });
    }
    write_atomically(path, |writer| write(writer, packing, columns, properties))
}

fn write<const D: usize>(
    writer: &mut impl Write,
    packing: &Packing<D>,
    columns: &[Column],
    properties: &[(&str, &str)],
) -> io::Result<()> {
    let mut archive = Archive::new(writer);
    let mut add = |name: &str, shape: &[usize], values: &Values| {
        archive.add(&format!("{name}.npy"), &Array::bytes(shape, values))
    };
    let count = packing.len();
    let vectors = |values: &[[f64; D]]| Values::Real(values.as_flattened().to_vec());
    let is_zero = |values: &[[f64; D]]| values.as_flattened().iter().all(|low| low.to_bits() == 0);
    add("positions", &[count, D], &vectors(packing.positions()))?;
    add("radii", &[count], &Values::Real(packing.radii().to_vec()))?;
    add("labels", &[count], &Values::Whole(packing.labels().iter().map(|&label| label.into()).collect()))?;
    add("held", &[count], &Values::Flags(packing.held().to_vec()))?;
    let is_periodic = packing.domain().lengths().is_some();
    add("pbc", &[D], &Values::Flags(vec![is_periodic; D]))?;
    if let Domain::Periodic { corner, edges } = packing.domain() {
        match packing.domain().lengths().filter(|_| !packing.domain().is_tilted()) {
            Some(lengths) => add("box", &[D], &Values::Real(lengths.to_vec()))?,
            None => add("box", &[D, D], &Values::Real(edges.as_flattened().to_vec()))?,
        }
        add("origin", &[D], &Values::Real(corner.to_vec()))?;
    }
    if !is_zero(packing.corrections()) {
        add("corrections", &[count, D], &vectors(packing.corrections()))?;
    }
    if let Some(sites) = packing.sites() {
        let (sites, low): (Vec<_>, Vec<_>) = sites.iter().copied().unzip();
        add("sites", &[count, D], &vectors(&sites))?;
        add("site_corrections", &[count, D], &vectors(&low))?;
    }
    if let Some(loads) = packing.loads() {
        add("loads", &[count, D], &vectors(loads))?;
    }
    for column in columns {
        let shape = [count, column.width];
        add(column.name, &shape[..if column.width == 1 { 1 } else { 2 }], &Values::Real(column.values.to_vec()))?;
    }
    for (key, text) in properties {
        add(key, &[], &value_of(text))?;
    }
    archive.finish()
}

/// A number if the text is what the number is written as, otherwise the text.
fn value_of(text: &str) -> Values {
    if let Some(whole) = text.parse::<i64>().ok().filter(|whole| whole.to_string() == text) {
        return Values::Whole(vec![whole.into()]);
    }
    match text.parse::<f64>().ok().filter(|number| format!("{number:?}") == text) {
        Some(number) => Values::Real(vec![number]),
        None => Values::Text(text.into()),
    }
}
