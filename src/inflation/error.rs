//! [`InflationError`]: why an inflation failed.

use crate::inflation::rest::Stage;
use crate::packing::PackingError;
use crate::relax::Stop;

/// Why an inflation failed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InflationError {
    /// The disks themselves are invalid.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// A circle can only be cut from a periodic box.
    #[error("the packing is not periodic: a circle with a held rim can be cut only from a periodic box")]
    NotPeriodic,
    /// R must be such that every mobile disk has one image.
    #[error("outer radius {outer_radius}: must be between 0 and half the shortest side of the box, {half_side}")]
    OuterRadiusOutOfRange {
        /// The outer radius given.
        outer_radius: f64,
        /// Half the shortest side.
        half_side: f64,
    },
    /// A row of disks is inflated in two dimensions.
    #[error("a strip between held walls has two dimensions")]
    StripNotInPlane,
    /// The walls of a strip must be so thick that disks on both sides of them do not meet.
    #[error(
        "wall distance {wall_distance}: must be above 0 and below {largest}, so that the wall between the images of the strip is four of the largest radii thick"
    )]
    WallDistanceOutOfRange {
        /// The distance of either wall from the line.
        wall_distance: f64,
        /// Its upper limit.
        largest: f64,
    },
    /// No disk could move.
    #[error("no disk could move within the distance {outer_radius}")]
    NoMobileDisk {
        /// The outer radius given.
        outer_radius: f64,
    },
    /// d_0 must be finite and leave a positive radius.
    #[error(
        "increase is {increase}: must be finite and above -{radius}, so that the radius of the inflated disk stays positive"
    )]
    IncreaseNotPossible {
        /// d_0.
        increase: f64,
        /// Radius of the disk.
        radius: f64,
    },
    /// The inflated disk would cover the centre of a neighbour.
    #[error(
        "increase is {increase}, which is too large: a disk of radius {radius} would cover the centre of a neighbour at distance {nearest}, so the increase must stay below {}",
        nearest - radius
    )]
    IncreaseTooLarge {
        /// d_0.
        increase: f64,
        /// Radius of the disk.
        radius: f64,
        /// Distance of the nearest centre.
        nearest: f64,
    },
    /// The amplitude of a drive is no number or too large.
    #[error("drive.{field} is {value}: must be a number of at most {largest:e} in magnitude")]
    DriveOutOfRange {
        /// The field.
        field: &'static str,
        /// The value given.
        value: f64,
        /// The largest magnitude.
        largest: f64,
    },
    /// A drive has no meaning in this geometry.
    #[error("drive.{drive} needs boundary = {{ held_rim = .. }}: {reason}")]
    DriveNeedsRim {
        /// The drive.
        drive: &'static str,
        /// Why.
        reason: &'static str,
    },
    /// A displaced disk would leave its place.
    #[error("drive.displacement.distance is {distance}: must be below {radius} in magnitude, the radius of the disk")]
    DisplacementTooLong {
        /// The distance given.
        distance: f64,
        /// Radius of the disk.
        radius: f64,
    },
    /// A force is given over the mean contact force, and there is none.
    #[error("the packing has no backbone, so there is no mean contact force for drive.point_force or force_dipole")]
    NoContactForce,
    /// A dipole needs a mobile neighbour on the backbone.
    #[error("disk {label} touches no mobile disk of the backbone, so there is no contact for a force dipole")]
    NoNeighbour {
        /// Label of the disk.
        label: u64,
    },
    /// Γ must be finite.
    #[error("on_site_coupling is {coupling}, not a finite number")]
    CouplingNotFinite {
        /// The coupling given.
        coupling: f64,
    },
    /// No disk has this label.
    #[error("no disk has the label {label}")]
    NoSuchLabel {
        /// The label given.
        label: u64,
    },
    /// A mobile disk was pushed through the held rim: a disk fits between it and R.
    #[error(
        "{stage}: disk {label} was pushed through the rim: it is at distance {distance} from the centre, and the rim is at {outer_radius}"
    )]
    BeyondRim {
        /// Stage of the relaxation.
        stage: Stage,
        /// Label of the disk.
        label: u64,
        /// Its distance from the centre \[length\].
        distance: f64,
        /// R \[length\].
        outer_radius: f64,
    },
    /// A relaxation did not end at rest.
    #[error("{stage}: the relaxation stopped with {stop:?} after {step_count} steps, residual {residual:e}")]
    NotAtRest {
        /// Stage of the relaxation.
        stage: Stage,
        /// Why it stopped.
        stop: Stop,
        /// Steps taken.
        step_count: usize,
        /// Relative residual reached.
        residual: f64,
    },
}
