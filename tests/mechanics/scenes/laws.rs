//! The laws of the model as a scene has them: relaxers and matrices are then compiled once, not once a law. The types of the laws
//! themselves are compared in `contact`, `kernels` and `stability`.

use jamscope::law::{Hertzian, Hookean, LawChoice};

/// Hertzian disks of the default stiffness.
pub fn hertzian() -> LawChoice {
    LawChoice::Hertzian(Hertzian::default())
}

/// Hookean disks of the default stiffness.
pub fn hookean() -> LawChoice {
    LawChoice::Hookean(Hookean::default())
}
