//! The mechanics of jammed packings.

pub mod contact;
pub mod displacement;
#[cfg(feature = "fit")]
pub mod fit;
pub mod inflation;
pub mod io;
pub mod observe;
pub mod packing;
pub mod preparation;
pub mod reference;
pub mod relax;
pub mod report;
pub mod run;
pub mod scene;
pub mod vector;
