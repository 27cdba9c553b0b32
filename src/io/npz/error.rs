//! [`ArchiveError`]: why a NumPy archive was not read as a packing.

/// Why a NumPy archive was not read as a packing. Indices of values start at 0, as in Python.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArchiveError {
    /// The archive is damaged.
    #[error("the archive is damaged or cut: {what}")]
    Damaged {
        /// What is damaged.
        what: &'static str,
    },
    /// The archive is above 4 GiB.
    #[error(
        "the archive has more than 4 GiB or 65534 arrays (zip64), which is not read; save positions, radii and box alone"
    )]
    Zip64,
    /// A member is encrypted.
    #[error("{name} in the archive is encrypted")]
    Encrypted {
        /// The member.
        name: String,
    },
    /// A member has an unknown compression.
    #[error("{name} in the archive has compression method {method}; save it by numpy.savez or numpy.savez_compressed")]
    Method {
        /// The member.
        name: String,
        /// The method.
        method: usize,
    },
    /// A single array.
    #[error(
        "a single NumPy array has no radii and no box; save them together: numpy.savez(\"packing.npz\", positions=..., radii=..., box=...)"
    )]
    SingleArray,
    /// An array does not have the form of NumPy.
    #[error("array {array} is damaged: {what}")]
    Header {
        /// The array.
        array: String,
        /// What is damaged.
        what: String,
    },
    /// An array of Python objects.
    #[error(
        "array {array} contains Python objects (dtype object, pickled), which are not read; save numbers: {array}=numpy.asarray({array}, dtype=float)"
    )]
    Objects {
        /// The array.
        array: String,
    },
    /// An array has values that are not read.
    #[error(
        "array {array} has dtype {dtype}; read are little-endian floats (f4, f8), integers (i1 to i8, u1 to u8) and booleans"
    )]
    Type {
        /// The array.
        array: String,
        /// Its type in the notation of NumPy.
        dtype: String,
    },
    /// An array is missing.
    #[error("no array of {what} (known names: {names}); found: {found}")]
    Missing {
        /// Its meaning.
        what: &'static str,
        /// The names that are known.
        names: String,
        /// The names of the arrays in the archive.
        found: String,
    },
    /// Two arrays have one meaning.
    #[error("arrays {first} and {second} both mean {what}; leave out one of them")]
    Two {
        /// Their meaning.
        what: &'static str,
        /// The first.
        first: String,
        /// The second.
        second: String,
    },
    /// An array has another shape.
    #[error("array {array} has shape {shape:?}, expected {expected}")]
    Shape {
        /// The array.
        array: String,
        /// Its shape.
        shape: Vec<usize>,
        /// The shape expected.
        expected: String,
    },
    /// A value is invalid.
    #[error("array {array}{place:?} is {value}, expected {expected}")]
    Value {
        /// The array.
        array: String,
        /// The indices of the value.
        place: Vec<usize>,
        /// The value.
        value: String,
        /// A valid value.
        expected: String,
    },
    /// The packing has another dimension.
    #[error("array {array} is {value}: this is not a packing in {dimension} dimensions (give --dimension {})", 5 - .dimension)]
    Dimension {
        /// The array that shows it.
        array: String,
        /// Its value.
        value: String,
        /// The dimension requested.
        dimension: usize,
    },
    /// A label occurs twice.
    #[error("array {array}: label {label} occurs more than once among the mobile disks")]
    Repeated {
        /// The array.
        array: String,
        /// The label.
        label: u64,
    },
}
