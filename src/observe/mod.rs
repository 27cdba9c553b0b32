//! One observable a file, all measured on the backbone.

pub mod angular_profile;
pub mod radial_profile;

pub use angular_profile::AngularProfile;
pub use radial_profile::{RadialProfile, Ring};
