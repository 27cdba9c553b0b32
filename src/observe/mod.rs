//! One observable a file, all measured on the backbone.

pub mod angular;
pub mod angular_profile;
pub mod force_distribution;
pub mod radial_profile;

pub use angular_profile::AngularProfile;
pub use force_distribution::ForceDistribution;
pub use radial_profile::{RadialProfile, Ring};
