//! [`Arrays`]: the arrays of an archive, found by their meaning.

use crate::io::npz::archive;
use crate::io::npz::array::{Array, MAGIC, Values};
use crate::io::npz::error::ArchiveError;

/// A meaning of an array, and the names that other programs give it.
pub(super) struct Meaning {
    pub what: &'static str,
    pub names: &'static [&'static str],
}

pub(super) const CENTRES: Meaning =
    Meaning { what: "centres", names: &["positions", "position", "R", "points", "pos", "x", "coordinates"] };
pub(super) const RADII: Meaning = Meaning { what: "radii", names: &["radii", "radius", "rad"] };
pub(super) const DIAMETERS: Meaning = Meaning { what: "diameters", names: &["diameters", "diameter", "sigma"] };
pub(super) const BOX: Meaning = Meaning { what: "sides of the box", names: &["box", "BoxMatrix", "cell_lengths", "L"] };
pub(super) const ORIGIN: Meaning = Meaning { what: "the corner of the box", names: &["origin"] };
pub(super) const PERIODIC: Meaning = Meaning { what: "periodic directions", names: &["pbc", "periodic"] };
pub(super) const LABELS: Meaning = Meaning { what: "labels", names: &["labels", "label", "ids", "id"] };
pub(super) const HELD: Meaning = Meaning { what: "held disks", names: &["held"] };
pub(super) const CORRECTIONS: Meaning = Meaning { what: "corrections", names: &["corrections"] };
pub(super) const SITES: Meaning = Meaning { what: "sites", names: &["sites"] };
pub(super) const SITE_CORRECTIONS: Meaning = Meaning { what: "corrections of sites", names: &["site_corrections"] };
pub(super) const LOADS: Meaning = Meaning { what: "loads", names: &["loads"] };
pub(super) const DIMENSION: Meaning = Meaning { what: "the dimension", names: &["dimension"] };

/// All meanings: their names are no key-value pairs.
const MEANINGS: [&Meaning; 13] = [
    &CENTRES,
    &RADII,
    &DIAMETERS,
    &BOX,
    &ORIGIN,
    &PERIODIC,
    &LABELS,
    &HELD,
    &CORRECTIONS,
    &SITES,
    &SITE_CORRECTIONS,
    &LOADS,
    &DIMENSION,
];

/// Whether an array of this name describes the packing itself.
pub(crate) fn is_reserved(name: &str) -> bool {
    MEANINGS.iter().any(|meaning| meaning.names.contains(&name))
}

/// The arrays of an archive, in its order, as bytes.
pub(super) struct Arrays {
    all: Vec<(String, Vec<u8>)>,
}

impl Arrays {
    pub fn new(bytes: &[u8]) -> Result<Self, ArchiveError> {
        if bytes.starts_with(&MAGIC) {
            return Err(ArchiveError::SingleArray);
        }
        let mut all = archive::members(bytes)?;
        all.iter_mut().for_each(|(name, _)| name.truncate(name.strip_suffix(".npy").unwrap_or(name).len()));
        Ok(Arrays { all })
    }

    /// The array with this meaning; two are refused.
    pub fn find(&self, meaning: &Meaning) -> Result<Option<Array>, ArchiveError> {
        let mut found = self.all.iter().filter(|(name, _)| meaning.names.contains(&name.as_str()));
        let Some((name, bytes)) = found.next() else { return Ok(None) };
        if let Some((second, _)) = found.next() {
            return Err(ArchiveError::Two { what: meaning.what, first: name.clone(), second: second.clone() });
        }
        Array::parse(name, bytes).map(Some)
    }

    /// Like [`Arrays::find`], for an array that must be there.
    pub fn need(&self, meaning: &Meaning) -> Result<Array, ArchiveError> {
        self.find(meaning)?.ok_or_else(|| self.missing(meaning.what, &[meaning]))
    }

    /// The error of a missing array.
    pub fn missing(&self, what: &'static str, meanings: &[&Meaning]) -> ArchiveError {
        let names: Vec<&str> = meanings.iter().flat_map(|meaning| meaning.names).copied().collect();
        let found: Vec<&str> = self.all.iter().map(|(name, _)| name.as_str()).collect();
        ArchiveError::Missing { what, names: names.join(", "), found: found.join(", ") }
    }

    /// Arrays without an axis that do not describe the packing, as text. Arrays that are not read are left out.
    pub fn properties(&self) -> Vec<(String, String)> {
        let others = self.all.iter().filter(|(name, _)| !is_reserved(name));
        let arrays = others.filter_map(|(name, bytes)| Array::parse(name, bytes).ok());
        let single = arrays.filter(|array| array.shape.is_empty());
        single.map(|array| (array.name.clone(), array.text(0))).collect()
    }
}

impl Array {
    /// The error of its shape.
    pub fn wrong_shape(&self, expected: String) -> ArchiveError {
        ArchiveError::Shape { array: self.name.clone(), shape: self.shape.clone(), expected }
    }

    /// The error of a value.
    pub fn wrong_value(&self, at: usize, expected: impl Into<String>) -> ArchiveError {
        let (array, value) = (self.name.clone(), self.text(at));
        ArchiveError::Value { array, place: self.place(at), value, expected: expected.into() }
    }

    /// A value as a finite number.
    pub fn finite(&self, at: usize) -> Result<f64, ArchiveError> {
        let number = self.number(at).filter(|number| number.is_finite());
        number.ok_or_else(|| self.wrong_value(at, "a finite number"))
    }

    /// One frame: the array without its first axis.
    pub fn frame(self, frame: usize) -> Array {
        fn part<T: Copy>(values: &[T], frame: usize, count: usize) -> Vec<T> {
            values[frame * count..(frame + 1) * count].to_vec()
        }
        let shape = self.shape[1..].to_vec();
        let count = shape.iter().product();
        let values = match self.values {
            Values::Real(values) => Values::Real(part(&values, frame, count)),
            Values::Whole(values) => Values::Whole(part(&values, frame, count)),
            Values::Flags(values) => Values::Flags(part(&values, frame, count)),
            Values::Text(text) => Values::Text(text),
        };
        Array { name: self.name, shape, values, is_single: self.is_single }
    }
}
