//! [`Scale`]: the size of a recipe, and the parts that recipes share.

use serde::Serialize;

use crate::inflation::Boundary;
use crate::scene::{Observables, ProtocolChoice, Scene};
use crate::study::settings::{Part, Seeds, Study, Target};

/// The size of a recipe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Minutes on two cores.
    Small,
    /// A night on two cores.
    Medium,
    /// The published sizes and 400 samples: for a cluster.
    Full,
}

/// Number of disks, and outer radius of the circle over the side of the box. Source: the study; below 5548 disks the
/// value for 5548.
const SIZES: [(usize, f64); 4] = [(1387, 0.480), (5548, 0.480), (22184, 0.486), (88776, 0.491)];

impl Scale {
    /// All scales.
    pub const ALL: [Scale; 3] = [Scale::Small, Scale::Medium, Scale::Full];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Scale::Small => "small",
            Scale::Medium => "medium",
            Scale::Full => "full",
        }
    }
}

/// Common settings: FIRE for the packing, then the protocol of the published study.
pub(super) fn common() -> Study {
    Study {
        scene: Scene { observables: ensemble_observables(2), sample: Vec::new(), ..Scene::default() },
        targets: Vec::new(),
        relaxers: vec![ProtocolChoice::default().relaxer()],
        ..Study::default()
    }
}

/// The observables that an ensemble needs, of disks (2) or spheres (3).
pub(super) fn ensemble_observables(dimension: usize) -> Observables {
    Observables {
        angular_profiles: None,
        bond_changes: None,
        displacement_field: None,
        #[cfg(feature = "fit")]
        elastic_modes: None,
        #[cfg(feature = "linear")]
        plastic_part: None,
        ..Observables::of_dimension(dimension)
    }
}

pub(super) fn reduced(values: &[f64]) -> Vec<Target> {
    values.iter().map(|&value| Target::ReducedPressure(value)).collect()
}

/// A part with one size and these targets.
pub(super) fn part(size: usize, targets: Vec<Target>, count: usize) -> Part {
    let (disk_count, ratio) = SIZES[size];
    Part {
        disk_counts: vec![disk_count],
        targets,
        seeds: Some(Seeds { first: 1, count }),
        boundary: Some(Boundary::HeldRim { outer_radius_over_side: ratio }),
        ..Part::default()
    }
}
