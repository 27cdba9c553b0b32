//! The mechanics of jammed packings.

pub mod observe;
pub mod packing;
pub mod reference;
pub mod vector;
