//! The mechanics of jammed packings.

#[cfg(feature = "fit")]
pub mod fit;
pub mod observe;
pub mod packing;
pub mod reference;
pub mod vector;
