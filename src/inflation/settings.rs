//! [`Inflation`]: which disk is inflated, by how much, and what keeps the packing in place.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::inflation::drive::Drive;
use crate::inflation::error::InflationError;
use crate::law::on_site::OnSite;
use crate::law::pair_law::PairLaw;

/// What keeps the packing in place while a disk is inflated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Boundary {
    /// A circle is cut out. Disks outside this radius and the centre are held.
    HeldRim {
        /// R over the shortest side of the box, at most 1/2 \[1\].
        outer_radius_over_side: f64,
    },
    /// The periodic box. Nothing is held; the centre of mass does not move.
    Periodic,
    /// A strip along the first axis, periodic along it; in two dimensions. Instead of one disk, the row of disks that a
    /// line along the strip through the chosen disk cuts is inflated. Disks farther than H from the line are held.
    HeldWalls {
        /// H, the distance of either wall from the line, over the side of the box across the strip; below 1/2 \[1\].
        distance_over_side: f64,
        /// Sides of a box that is prepared for it: along the strip over across \[1\].
        length_over_side: f64,
    },
}

impl Boundary {
    /// Sides of a prepared box: that along the first axis over the others \[1\].
    pub fn side_ratio(self) -> f64 {
        match self {
            Boundary::HeldRim { .. } | Boundary::Periodic => 1.0,
            Boundary::HeldWalls { length_over_side, .. } => length_over_side,
        }
    }

    /// Whether a row of disks is inflated between walls.
    pub fn is_strip(self) -> bool {
        matches!(self, Boundary::HeldWalls { .. })
    }
}

impl Default for Boundary {
    /// Source: the study, R/L for 5548 disks (0.486 and 0.491 for 22184 and 88776).
    fn default() -> Self {
        Boundary::HeldRim { outer_radius_over_side: 0.480 }
    }
}

/// Which disk is inflated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Centre {
    /// A random one of the smallest disks on the backbone; of all the smallest disks if there is no backbone.
    #[default]
    Backbone,
    /// A random one of the smallest disks, rattler or not.
    AnySmall,
    /// The disk with this label.
    Label(u64),
}

/// The inflation of one disk.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Inflation {
    /// d_0, the increase of the radius in one step \[length\].
    pub increase: f64,
    /// What keeps the packing in place.
    pub boundary: Boundary,
    /// Which disk is inflated.
    pub centre: Centre,
    /// Whether the inflated disk, or the row, is held in a circle or a strip; true by default. A held disk passes the net
    /// force of its neighbours on to the rim: a dipole in the response. In a periodic box nothing is held.
    #[serde(skip_serializing_if = "is_true")]
    pub centre_held: bool,
    /// Whether the disk is deflated again afterwards, or another drive taken back.
    pub deflate: bool,
    /// What is done to the packing; by default the disk grows by `increase`.
    #[serde(skip_serializing_if = "Drive::is_inflation")]
    pub drive: Drive,
    /// Γ of an energy −Γu²/2 of every mobile disk, u its displacement from its position in the packing given
    /// \[force / length\]. The packing itself is prepared without it. Absent: no such energy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on_site_coupling: Option<f64>,
}

/// Whether a setting has its default, true.
fn is_true(setting: &bool) -> bool {
    *setting
}

impl Inflation {
    /// Checks the drive: its amplitude, and that it has a meaning between these boundaries.
    pub(crate) fn check_drive(&self) -> Result<(), InflationError> {
        self.drive.check()?;
        needs_rim(&self.drive, self.boundary)
    }

    /// The law with the sites of the inflation, if disks have any.
    pub fn law_with_sites(&self, law: &dyn PairLaw) -> Arc<dyn PairLaw> {
        match self.on_site_coupling {
            Some(coupling) => Arc::new(OnSite { law: law.shared(), coupling }),
            None => law.shared(),
        }
    }

    /// Like [`Inflation::law_with_sites`], but checks the coupling.
    ///
    /// # Errors
    /// A coupling that is not finite.
    pub(crate) fn checked_law_with_sites(&self, law: &dyn PairLaw) -> Result<Arc<dyn PairLaw>, InflationError> {
        match self.on_site_coupling {
            Some(coupling) if !coupling.is_finite() => Err(InflationError::CouplingNotFinite { coupling }),
            _ => Ok(self.law_with_sites(law)),
        }
    }
}

/// Checks that a drive has a meaning between these boundaries.
fn needs_rim(drive: &Drive, boundary: Boundary) -> Result<(), InflationError> {
    let drive = match (drive, boundary) {
        (Drive::Inflation, _) | (_, Boundary::HeldRim { .. }) => return Ok(()),
        (Drive::ForceDipole { .. }, Boundary::Periodic) => return Ok(()),
        (Drive::PointForce { .. }, _) => "point_force",
        (Drive::ForceDipole { .. }, _) => "force_dipole",
        (Drive::Displacement { .. }, _) => "displacement",
        (Drive::Shear { .. }, _) => "shear",
        (Drive::Compression { .. }, _) => "compression",
    };
    let reason = match boundary {
        Boundary::Periodic => "in a periodic box nothing holds the packing, and the command strain deforms the box",
        _ => "in a strip a row of disks grows",
    };
    Err(InflationError::DriveNeedsRim { drive, reason })
}

impl Default for Inflation {
    /// Source: the study (d_0 = 0.1).
    fn default() -> Self {
        Inflation {
            increase: 0.1,
            boundary: Boundary::default(),
            centre: Centre::default(),
            centre_held: true,
            deflate: false,
            drive: Drive::default(),
            on_site_coupling: None,
        }
    }
}
