//! Positions and forces of a moving packing: [`Assembly`], and the loop over contacts in double and single precision.

pub mod advance;
pub mod assembly;
pub(crate) mod block_arithmetic;
pub mod damped;
pub mod elastic;
pub(crate) mod layout;
pub mod single_precision;
pub mod stiffness_bound;
pub mod totals;

pub use assembly::Assembly;
