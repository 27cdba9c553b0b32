//! One observable a file, all measured on the backbone.

pub mod radial_profile;
