//! [`Array`]: one array of numbers in the format npy, read and written.
//!
//! ```text
//! \x93NUMPY  version  length of the header  {'descr': '<f8', 'fortran_order': False, 'shape': (N, D), }  values
//! ```
//!
//! # Source
//! NumPy documentation, `numpy.lib.format`, versions 1.0 to 3.0.

use crate::io::npz::error::ArchiveError;

/// The first bytes.
pub(super) const MAGIC: [u8; 6] = *b"\x93NUMPY";

/// The header ends at a multiple of this \[bytes\].
const ALIGNMENT: usize = 64;

/// Values of an array, in C order: the last index changes first.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values {
    Real(Vec<f64>),
    Whole(Vec<i128>),
    Flags(Vec<bool>),
    /// A single text.
    Text(String),
}

/// An array of numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Array {
    /// Its name in the archive.
    pub name: String,
    pub shape: Vec<usize>,
    pub values: Values,
    /// Whether the values were stored in single precision.
    pub is_single: bool,
}

impl Array {
    /// Reads an array.
    pub fn parse(name: &str, bytes: &[u8]) -> Result<Self, ArchiveError> {
        let damaged = |what: &str| ArchiveError::Header { array: name.into(), what: what.into() };
        let cut = || damaged("its header is cut");
        let rest = bytes.strip_prefix(&MAGIC).ok_or_else(|| damaged("it is not in the format npy"))?;
        // Version 1.0 has two bytes for the length of the header, later versions four.
        let (length, start): (usize, usize) = match rest {
            [1, _, a, b, ..] => (usize::from(u16::from_le_bytes([*a, *b])), 4),
            [2 | 3, _, a, b, c, d, ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, 6),
            _ => return Err(cut()),
        };
        let header = rest.get(start..start.saturating_add(length)).ok_or_else(cut)?;
        let header = std::str::from_utf8(header).map_err(|_| damaged("its header is not text"))?;
        let entry = |key: &str| {
            let at = header.find(&format!("'{key}'"))? + key.len() + 2;
            Some(header[at..].trim_start().strip_prefix(':')?.trim_start())
        };
        let wrong = || damaged(&format!("its header is `{}`", header.trim()));
        let dtype = entry("descr").ok_or_else(wrong)?;
        let dtype = match dtype.strip_prefix('\'') {
            Some(text) => text.split('\'').next().unwrap_or_default(),
            // Fields of a record.
            None => "record",
        };
        let is_fortran = entry("fortran_order").ok_or_else(wrong)?.starts_with("True");
        let shape = entry("shape").and_then(|text| text.strip_prefix('(')?.split(')').next()).ok_or_else(wrong)?;
        let sides = shape.split(',').map(str::trim).filter(|side| !side.is_empty());
        let shape: Vec<usize> = sides.map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
        let count = shape.iter().try_fold(1_usize, |count, &side| count.checked_mul(side)).ok_or_else(wrong)?;
        let data = &rest[start + length..];
        let mut values = values(name, dtype, data)?;
        let found = values.len();
        if found != count && !matches!(values, Values::Text(_)) {
            return Err(damaged(&format!("{found} values for shape {shape:?}")));
        }
        if is_fortran && shape.len() > 1 {
            values = values.in_c_order(&shape);
        }
        Ok(Array { name: name.into(), shape, values, is_single: dtype == "<f4" })
    }

    /// The bytes of an array.
    pub fn bytes(shape: &[usize], values: &Values) -> Vec<u8> {
        let (dtype, data): (String, Vec<u8>) = match values {
            Values::Real(values) => ("<f8".into(), values.iter().flat_map(|value| value.to_le_bytes()).collect()),
            // The integers of NumPy itself, unless a label is beyond them. The lower 8 bytes are the same.
            Values::Whole(values) => {
                let is_signed = values.iter().all(|&value| i64::try_from(value).is_ok());
                let dtype = if is_signed { "<i8" } else { "<u8" };
                (dtype.into(), values.iter().flat_map(|&value| (value as u64).to_le_bytes()).collect())
            }
            Values::Flags(values) => ("|b1".into(), values.iter().map(|&flag| u8::from(flag)).collect()),
            // Each character has four bytes. A text without characters has one, of zero.
            Values::Text(text) => {
                let mut letters: Vec<u32> = text.chars().map(u32::from).collect();
                letters.resize(letters.len().max(1), 0);
                (format!("<U{}", letters.len()), letters.into_iter().flat_map(u32::to_le_bytes).collect())
            }
        };
        let sides: String = shape.iter().map(|side| format!("{side}, ")).collect();
        // (N,) for one axis, (N, D) for two.
        let sides = if shape.len() == 1 { sides.trim_end() } else { sides.trim_end_matches(", ") };
        let mut header = format!("{{'descr': '{dtype}', 'fortran_order': False, 'shape': ({sides}), }}");
        // Magic, version and length have 10 bytes; the header ends with a line break.
        let whole = (10 + header.len() + 1).next_multiple_of(ALIGNMENT);
        header.extend(std::iter::repeat_n(' ', whole - 10 - header.len() - 1));
        header.push('\n');
        let length = u16::try_from(header.len()).expect("a name of a type and a few sides are short");
        [&MAGIC[..], &[1, 0], &length.to_le_bytes(), header.as_bytes(), &data].concat()
    }

    /// A value as text, for messages and for key-value pairs.
    pub fn text(&self, at: usize) -> String {
        let text = match &self.values {
            Values::Real(values) => values.get(at).map(|value| format!("{value:?}")),
            Values::Whole(values) => values.get(at).map(i128::to_string),
            Values::Flags(values) => values.get(at).map(|&flag| if flag { "True" } else { "False" }.into()),
            Values::Text(text) => Some(text.clone()),
        };
        text.unwrap_or_else(|| "empty".into())
    }

    /// A value as a number; none for a text, and beyond the last value.
    pub fn number(&self, at: usize) -> Option<f64> {
        match &self.values {
            Values::Real(values) => values.get(at).copied(),
            Values::Whole(values) => values.get(at).map(|&value| value as f64),
            Values::Flags(values) => values.get(at).map(|&flag| f64::from(u8::from(flag))),
            Values::Text(_) => None,
        }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// The indices of the value at this place.
    pub fn place(&self, mut at: usize) -> Vec<usize> {
        let mut place = Vec::new();
        for side in self.shape.iter().rev() {
            place.push(at % side.max(&1));
            at /= side.max(&1);
        }
        place.reverse();
        place
    }
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Values::Real(values) => values.len(),
            Values::Whole(values) => values.len(),
            Values::Flags(values) => values.len(),
            Values::Text(_) => 1,
        }
    }

    /// Values in Fortran order, where the first index changes first, in C order.
    fn in_c_order(self, shape: &[usize]) -> Self {
        match self {
            Values::Real(values) => Values::Real(transposed(&values, shape)),
            Values::Whole(values) => Values::Whole(transposed(&values, shape)),
            Values::Flags(values) => Values::Flags(transposed(&values, shape)),
            Values::Text(text) => Values::Text(text),
        }
    }
}

fn transposed<T: Copy>(values: &[T], shape: &[usize]) -> Vec<T> {
    let of_place = |at: usize| {
        let (mut left, mut index) = (at, 0);
        // The stride of an axis in Fortran order is the product of the sides before it.
        let mut stride = values.len();
        for side in shape.iter().rev() {
            stride /= side;
            index += left % side * stride;
            left /= side;
        }
        values[index]
    };
    (0..values.len()).map(of_place).collect()
}

/// The values of an array of this type.
fn values(name: &str, dtype: &str, data: &[u8]) -> Result<Values, ArchiveError> {
    // None if the last value is cut.
    fn each<const N: usize, T>(data: &[u8], value: impl Fn([u8; N]) -> T) -> Option<Vec<T>> {
        let (chunks, rest) = data.as_chunks::<N>();
        rest.is_empty().then(|| chunks.iter().map(|&bytes| value(bytes)).collect())
    }
    let values = match dtype {
        "<f8" => each(data, f64::from_le_bytes).map(Values::Real),
        "<f4" => each(data, |bytes| f64::from(f32::from_le_bytes(bytes))).map(Values::Real),
        "|i1" => each(data, |bytes| i8::from_le_bytes(bytes).into()).map(Values::Whole),
        "<i2" => each(data, |bytes| i16::from_le_bytes(bytes).into()).map(Values::Whole),
        "<i4" => each(data, |bytes| i32::from_le_bytes(bytes).into()).map(Values::Whole),
        "<i8" => each(data, |bytes| i64::from_le_bytes(bytes).into()).map(Values::Whole),
        "|u1" => each(data, |bytes| u8::from_le_bytes(bytes).into()).map(Values::Whole),
        "<u2" => each(data, |bytes| u16::from_le_bytes(bytes).into()).map(Values::Whole),
        "<u4" => each(data, |bytes| u32::from_le_bytes(bytes).into()).map(Values::Whole),
        "<u8" => each(data, |bytes| u64::from_le_bytes(bytes).into()).map(Values::Whole),
        "|b1" => each(data, |[byte]| byte != 0).map(Values::Flags),
        text if text.starts_with("<U") => {
            let text =
                |letters: Vec<u32>| letters.into_iter().take_while(|&it| it != 0).filter_map(char::from_u32).collect();
            each(data, u32::from_le_bytes).map(|letters| Values::Text(text(letters)))
        }
        _ if dtype.starts_with("|O") => return Err(ArchiveError::Objects { array: name.into() }),
        _ => return Err(ArchiveError::Type { array: name.into(), dtype: dtype.into() }),
    };
    values.ok_or_else(|| ArchiveError::Header { array: name.into(), what: "its last value is cut".into() })
}
