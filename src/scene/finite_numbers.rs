//! [`check()`]: whether all settings can be written to a file and read back.
//!
//! NaN and infinity cannot be written as JSON: they would become `null`, and the file could not be read. The check
//! serialises the settings without output and checks every number, so fields added later are included.

use serde::Serialize;
use serde::ser::{self, Serializer};

/// A setting cannot be written and read back.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NotWritable {
    /// NaN or infinity.
    #[error("{field} = {value}: must be a finite number")]
    NotFinite {
        /// The field, including its tables and its index in lists.
        field: String,
        /// Its value.
        value: f64,
    },
    /// A value cannot be written as text, such as a path that is not Unicode.
    #[error("{field}: {reason}")]
    NoForm {
        /// The field.
        field: String,
        /// The problem.
        reason: String,
    },
}

impl ser::Error for NotWritable {
    fn custom<T: std::fmt::Display>(reason: T) -> Self {
        NotWritable::NoForm { field: String::new(), reason: reason.to_string() }
    }
}

/// Checks every number of a value.
///
/// # Errors
/// [`NotWritable`] with the first field that cannot be written, and its value.
///
/// # Example
/// ```
/// use jamscope::scene::{Scene, finite_numbers};
/// let mut scene = Scene::default();
/// assert_eq!(finite_numbers::check(&scene), Ok(()));
/// scene.mixture.components[1].share = f64::INFINITY;
/// let message = finite_numbers::check(&scene).expect_err("a share without end").to_string();
/// assert_eq!(message, "mixture[1].share = inf: must be a finite number");
/// ```
pub fn check<T: Serialize + ?Sized>(value: &T) -> Result<(), NotWritable> {
    check_at("", value)
}

/// Like [`check()`], for a value that is itself the field `name`.
pub(crate) fn check_at<T: Serialize + ?Sized>(name: &str, value: &T) -> Result<(), NotWritable> {
    Checker { path: String::new() }.check_value(name.into(), value)
}

/// The current position in the value.
struct Checker {
    path: String,
}

impl Checker {
    fn number(self, value: f64) -> Result<(), NotWritable> {
        if value.is_finite() { Ok(()) } else { Err(NotWritable::NotFinite { field: self.path, value }) }
    }

    /// Checks a field below this position.
    fn field<T: Serialize + ?Sized>(&self, name: &str, value: &T) -> Result<(), NotWritable> {
        self.check_value(self.below(name), value)
    }

    /// The path of a field or variant below this position.
    fn below(&self, name: &str) -> String {
        if self.path.is_empty() { name.to_string() } else { format!("{}.{name}", self.path) }
    }

    /// Checks an element of a list at this position.
    fn element<T: Serialize + ?Sized>(&self, index: usize, value: &T) -> Result<(), NotWritable> {
        self.check_value(format!("{}[{index}]", self.path), value)
    }

    fn check_value<T: Serialize + ?Sized>(&self, path: String, value: &T) -> Result<(), NotWritable> {
        value.serialize(Checker { path: path.clone() }).map_err(|error| match error {
            // The error does not contain the path yet.
            NotWritable::NoForm { field, reason } if field.is_empty() => NotWritable::NoForm { field: path, reason },
            error => error,
        })
    }

    fn list(self) -> List {
        List { at: self, index: 0 }
    }
}

/// A list, a tuple or a map.
struct List {
    at: Checker,
    index: usize,
}

impl List {
    fn next<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NotWritable> {
        self.index += 1;
        self.at.element(self.index - 1, value)
    }
}

impl Serializer for Checker {
    type Ok = ();
    type Error = NotWritable;
    type SerializeSeq = List;
    type SerializeTuple = List;
    type SerializeTupleStruct = List;
    type SerializeTupleVariant = List;
    type SerializeMap = List;
    type SerializeStruct = Checker;
    type SerializeStructVariant = Checker;

    fn serialize_f32(self, value: f32) -> Result<(), NotWritable> {
        self.number(f64::from(value))
    }
    fn serialize_f64(self, value: f64) -> Result<(), NotWritable> {
        self.number(value)
    }

    fn serialize_bool(self, _: bool) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_i8(self, _: i8) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_i16(self, _: i16) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_i32(self, _: i32) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_i64(self, _: i64) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_u8(self, _: u8) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_u16(self, _: u16) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_u32(self, _: u32) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_u64(self, _: u64) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_char(self, _: char) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_str(self, _: &str) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_bytes(self, _: &[u8]) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_none(self) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_unit(self) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_unit_struct(self, _: &'static str) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_unit_variant(self, _: &'static str, _: u32, _: &'static str) -> Result<(), NotWritable> {
        Ok(())
    }
    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<(), NotWritable> {
        value.serialize(self)
    }
    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Result<(), NotWritable> {
        value.serialize(self)
    }
    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        value: &T,
    ) -> Result<(), NotWritable> {
        self.field(variant, value)
    }
    fn serialize_seq(self, _: Option<usize>) -> Result<List, NotWritable> {
        Ok(self.list())
    }
    fn serialize_tuple(self, _: usize) -> Result<List, NotWritable> {
        Ok(self.list())
    }
    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<List, NotWritable> {
        Ok(self.list())
    }
    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        _: usize,
    ) -> Result<List, NotWritable> {
        Ok(Checker { path: self.below(variant) }.list())
    }
    fn serialize_map(self, _: Option<usize>) -> Result<List, NotWritable> {
        Ok(self.list())
    }
    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Checker, NotWritable> {
        Ok(self)
    }
    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        _: usize,
    ) -> Result<Checker, NotWritable> {
        Ok(Checker { path: self.below(variant) })
    }
}

impl ser::SerializeSeq for List {
    type Ok = ();
    type Error = NotWritable;
    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NotWritable> {
        self.next(value)
    }
    fn end(self) -> Result<(), NotWritable> {
        Ok(())
    }
}

impl ser::SerializeTuple for List {
    type Ok = ();
    type Error = NotWritable;
    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NotWritable> {
        self.next(value)
    }
    fn end(self) -> Result<(), NotWritable> {
        Ok(())
    }
}

impl ser::SerializeTupleStruct for List {
    type Ok = ();
    type Error = NotWritable;
    fn serialize_field<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NotWritable> {
        self.next(value)
    }
    fn end(self) -> Result<(), NotWritable> {
        Ok(())
    }
}

impl ser::SerializeTupleVariant for List {
    type Ok = ();
    type Error = NotWritable;
    fn serialize_field<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NotWritable> {
        self.next(value)
    }
    fn end(self) -> Result<(), NotWritable> {
        Ok(())
    }
}

/// Keys and values count as elements of a list.
impl ser::SerializeMap for List {
    type Ok = ();
    type Error = NotWritable;
    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Result<(), NotWritable> {
        self.next(key)
    }
    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NotWritable> {
        self.next(value)
    }
    fn end(self) -> Result<(), NotWritable> {
        Ok(())
    }
}

impl ser::SerializeStruct for Checker {
    type Ok = ();
    type Error = NotWritable;
    fn serialize_field<T: Serialize + ?Sized>(&mut self, name: &'static str, value: &T) -> Result<(), NotWritable> {
        self.field(name, value)
    }
    fn end(self) -> Result<(), NotWritable> {
        Ok(())
    }
}

impl ser::SerializeStructVariant for Checker {
    type Ok = ();
    type Error = NotWritable;
    fn serialize_field<T: Serialize + ?Sized>(&mut self, name: &'static str, value: &T) -> Result<(), NotWritable> {
        self.field(name, value)
    }
    fn end(self) -> Result<(), NotWritable> {
        Ok(())
    }
}
