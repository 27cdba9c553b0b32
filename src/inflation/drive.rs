//! [`Drive`]: what is done to the packing, if it is not an inflation.
//!
//! ```text
//! point force     f on the disk at the centre, F = share · ⟨F⟩, along the first axis        the disk is free
//! force dipole    ±F along a contact of that disk, apart for F > 0                          both disks are free
//! displacement    the disk at the centre moves along the first axis                        and is held there
//! pure shear      rim and disks: r → (1 + ε) r, ε_xx = γ/2, the other ε = −γ/(2(D−1))       the rim stays held
//! compression     rim and disks: r → (1 − ε) r                                             the rim stays held
//! ```
//!
//! ⟨F⟩ is the mean contact force before. The forces of a dipole act along the line between the centres before, so they
//! have no torque. The field of a shear or a compression is the non-affine displacement, d − ε r.

use serde::{Deserialize, Serialize};

use crate::inflation::error::InflationError;
use crate::law::pair_law::PairLaw;
use crate::network::ContactNetwork;
use crate::packing::{Packing, displacement};
use crate::vector::{Vector, norm, scaled};

/// What is done to the packing.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Drive {
    /// The disk grows, or in a strip the row.
    #[default]
    Inflation,
    /// A force along the first axis acts on the disk, which is free.
    PointForce {
        /// F over the mean contact force before \[1\].
        force_over_mean: f64,
    },
    /// Two opposite forces act on the disk and on one of its neighbours, along the line between their centres. The
    /// neighbour is that whose direction is nearest to the first axis.
    ForceDipole {
        /// F over the mean contact force before \[1\]; positive pushes them apart.
        force_over_mean: f64,
    },
    /// The disk is displaced along the first axis and held there.
    Displacement {
        /// By how much \[length\].
        distance: f64,
    },
    /// The rim is deformed by pure shear at constant area.
    Shear {
        /// γ = 2 ε_xx, at most 0.1 \[1\].
        strain: f64,
    },
    /// The rim is compressed in all directions.
    Compression {
        /// −ε_xx, at most 0.1; negative expands \[1\].
        strain: f64,
    },
}

/// Largest strain of the rim \[1\].
const LARGEST_STRAIN: f64 = 0.1;

/// A diagonal strain: ε along the first axis, and that along the others \[1\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DiagonalStrain {
    /// ε_xx.
    pub first: f64,
    /// ε along the other axes.
    pub others: f64,
}

impl DiagonalStrain {
    /// ε r.
    pub fn of<const D: usize>(self, position: Vector<D>) -> Vector<D> {
        std::array::from_fn(|d| if d == 0 { self.first } else { self.others } * position[d])
    }

    /// (1 + ε)⁻¹ r.
    pub fn undone<const D: usize>(self, position: Vector<D>) -> Vector<D> {
        std::array::from_fn(|d| position[d] / (1.0 + if d == 0 { self.first } else { self.others }))
    }

    /// The volume after over that before \[1\].
    pub fn volume_ratio<const D: usize>(self) -> f64 {
        (1..D).fold(1.0 + self.first, |ratio, _| ratio * (1.0 + self.others))
    }
}

impl Drive {
    /// Whether it is an inflation.
    pub fn is_inflation(&self) -> bool {
        *self == Drive::Inflation
    }

    /// Whether the disk at the centre is held, if an inflation would hold it as told.
    pub(crate) fn holds_centre(&self, inflation_holds: bool) -> bool {
        match self {
            Drive::Inflation => inflation_holds,
            Drive::Displacement { .. } => true,
            _ => false,
        }
    }

    /// The strain of the rim; zero for other drives.
    pub fn strain<const D: usize>(&self) -> DiagonalStrain {
        match *self {
            Drive::Shear { strain } => DiagonalStrain { first: 0.5 * strain, others: -0.5 * strain / (D - 1) as f64 },
            Drive::Compression { strain } => DiagonalStrain { first: -strain, others: -strain },
            _ => DiagonalStrain::default(),
        }
    }

    /// The number that says how much is done, with the name of its field; none for an inflation.
    pub(crate) fn amplitude(&self) -> Option<(&'static str, f64)> {
        match *self {
            Drive::Inflation => None,
            Drive::PointForce { force_over_mean } => Some(("point_force.force_over_mean", force_over_mean)),
            Drive::ForceDipole { force_over_mean } => Some(("force_dipole.force_over_mean", force_over_mean)),
            Drive::Displacement { distance } => Some(("displacement.distance", distance)),
            Drive::Shear { strain } => Some(("shear.strain", strain)),
            Drive::Compression { strain } => Some(("compression.strain", strain)),
        }
    }

    /// Checks the amplitude.
    pub(crate) fn check(&self) -> Result<(), InflationError> {
        let Some((field, value)) = self.amplitude() else { return Ok(()) };
        let largest = match self {
            Drive::Shear { .. } | Drive::Compression { .. } => LARGEST_STRAIN,
            _ => f64::MAX,
        };
        // False for NaN.
        if value.abs() <= largest { Ok(()) } else { Err(InflationError::DriveOutOfRange { field, value, largest }) }
    }

    /// The packing right after the drive, before any disk has moved by itself. Not for an inflation.
    pub(super) fn start<const D: usize>(
        &self,
        before: &Packing<D>,
        centre: usize,
        law: &dyn PairLaw,
    ) -> Result<Packing<D>, InflationError> {
        let mut start = before.clone();
        match *self {
            Drive::Inflation => {}
            Drive::PointForce { force_over_mean } => {
                let mut loads = vec![[0.0; D]; before.len()];
                loads[centre][0] = force_over_mean * mean_force(&ContactNetwork::new(before, law)?)?;
                start = start.with_loads(loads)?;
            }
            Drive::ForceDipole { force_over_mean } => {
                let network = ContactNetwork::new(before, law)?;
                let (neighbour, towards) = neighbour(before, &network, centre)
                    .ok_or(InflationError::NoNeighbour { label: before.labels()[centre] })?;
                let mut loads = vec![[0.0; D]; before.len()];
                loads[neighbour] = scaled(force_over_mean * mean_force(&network)?, towards);
                loads[centre] = scaled(-1.0, loads[neighbour]);
                start = start.with_loads(loads)?;
            }
            Drive::Displacement { distance } => {
                let radius = before.radii()[centre];
                if distance.abs() >= radius {
                    return Err(InflationError::DisplacementTooLong { distance, radius });
                }
                start.displace(centre, std::array::from_fn(|d| if d == 0 { distance } else { 0.0 }));
            }
            Drive::Shear { .. } | Drive::Compression { .. } => {
                let strain = self.strain::<D>();
                for disk in 0..before.len() {
                    start.displace(disk, strain.of(before.separation(disk, centre)));
                }
            }
        }
        Ok(start)
    }

    /// A packing after the drive with the drive taken back: loads removed, held disks and affine displacements returned.
    pub(super) fn released<const D: usize>(
        &self,
        mut after: Packing<D>,
        before: &Packing<D>,
        centre: usize,
    ) -> Packing<D> {
        match self {
            Drive::Inflation => {}
            Drive::PointForce { .. } | Drive::ForceDipole { .. } => {
                after = after.without_loads();
                if before.sites().is_none() {
                    after = after.without_sites();
                }
            }
            Drive::Displacement { .. } => {
                let (position, correction) = before.centre(centre);
                after.place(centre, position, correction);
            }
            Drive::Shear { .. } | Drive::Compression { .. } => {
                let strain = self.strain::<D>();
                for disk in 0..before.len() {
                    let affine = strain.of(before.separation(disk, centre));
                    if before.held()[disk] {
                        let (position, correction) = before.centre(disk);
                        after.place(disk, position, correction);
                    } else {
                        after.displace(disk, scaled(-1.0, affine));
                    }
                }
            }
        }
        after
    }
}

/// The drive of an inflation or of what replaces it, as it was applied: forces, displacement, strain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Applied<const D: usize> {
    /// The force on the disk at the centre; 0 without loads \[force\].
    pub force: Vector<D>,
    /// The vector from the centre to the other disk of a dipole, before \[length\].
    pub arm: Option<Vector<D>>,
    /// The displacement of the disk at the centre, if it was displaced \[length\].
    pub displacement: Vector<D>,
}

impl<const D: usize> Applied<D> {
    /// What distinguishes the start from the state before.
    pub fn of(before: &Packing<D>, start: &Packing<D>, centre: usize) -> Self {
        let loads = start.loads().unwrap_or_default();
        let other = loads.iter().enumerate().position(|(disk, load)| disk != centre && norm(*load) > 0.0);
        let displaced = before.held()[centre];
        Applied {
            force: loads.get(centre).copied().unwrap_or([0.0; D]),
            arm: other.map(|other| before.separation(other, centre)),
            displacement: if displaced { displacement(before, start, centre) } else { [0.0; D] },
        }
    }
}

/// Mean contact force on the backbone \[force\].
///
/// # Errors
/// There is no backbone, so a force has no scale.
fn mean_force<const D: usize>(network: &ContactNetwork<D>) -> Result<f64, InflationError> {
    let (count, total) =
        network.backbone_contacts().fold((0usize, 0.0), |(count, total), contact| (count + 1, total + contact.force));
    if count == 0 { Err(InflationError::NoContactForce) } else { Ok(total / count as f64) }
}

/// The mobile neighbour of a disk on the backbone whose direction is nearest to the first axis, and that direction.
fn neighbour<const D: usize>(
    packing: &Packing<D>,
    network: &ContactNetwork<D>,
    centre: usize,
) -> Option<(usize, Vector<D>)> {
    let others = network.backbone_contacts().filter_map(|contact| {
        let (first, second) = (contact.first as usize, contact.second as usize);
        let other = match centre {
            _ if centre == first => second,
            _ if centre == second => first,
            _ => return None,
        };
        let apart = packing.separation(other, centre);
        (!packing.held()[other]).then(|| (other, scaled(1.0 / norm(apart), apart)))
    });
    others.max_by(|a, b| a.1[0].total_cmp(&b.1[0]))
}
