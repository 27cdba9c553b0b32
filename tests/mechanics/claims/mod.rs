//! What holds of a relaxer that goes downhill, whichever it is.

pub mod closed_forms;
pub mod elsewhere;
pub mod only_falls;
pub mod other_units;
