//! One observable per file, all measured on the backbone.

pub mod angular;
pub mod angular_profile;
pub mod bond_changes;
pub mod contact_changes;
pub mod excess_coordination;
pub mod fluctuations;
pub mod force_distribution;
pub mod isostatic;
pub mod multipoles;
pub mod penetration_length;
pub mod pressure_change;
pub mod radial_profile;
pub mod shell;
pub mod state;

pub use angular_profile::AngularProfile;
pub use bond_changes::BondChanges;
pub use contact_changes::{ContactChanges, ContactCycle};
pub use excess_coordination::ExcessCoordination;
pub use fluctuations::Fluctuations;
pub use force_distribution::ForceDistribution;
pub use isostatic::IsostaticLength;
pub use multipoles::Multipoles;
pub use penetration_length::PenetrationLength;
pub use pressure_change::PressureChange;
pub use radial_profile::{RadialProfile, Ring};
pub use shell::ShellAnalysis;
pub use state::State;
