//! The mechanics of jammed packings.

pub mod contact;
pub mod displacement;
pub mod inflation;
pub mod observe;
pub mod packing;
pub mod preparation;
pub mod relax;
pub mod vector;
