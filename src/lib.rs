//! The mechanics of jammed packings.

pub mod io;
pub mod observe;
pub mod packing;
pub mod vector;
