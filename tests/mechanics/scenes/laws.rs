//! The laws of the model as a scene has them.

use jamscope::law::{Hertzian, Hookean, LawChoice};

/// Hertzian disks of the default stiffness.
pub fn hertzian() -> LawChoice {
    LawChoice::Hertzian(Hertzian::default())
}

/// Hookean disks of the default stiffness.
pub fn hookean() -> LawChoice {
    LawChoice::Hookean(Hookean::default())
}
