//! [`Strip`]: a periodic packing between held walls, with a row of disks to inflate.
//!
//! ```text
//! wall    |y| ≥ H    held                     y = 0 runs through the chosen disk
//! mobile  |y| < H    periodic along x
//! row     |y| < R_i  the disks that the line y = 0 cuts; they grow, held in place or free
//! ```
//!
//! A dense row has no gaps: about one disk a diameter. If it is held, it separates the two halves of the strip, which
//! then respond independently. The wall is what lies between the images of the strip across the box.

use crate::inflation::circle::RIM_WIDTH;
use crate::inflation::error::InflationError;
use crate::inflation::region;
use crate::network::ContactNetwork;
use crate::packing::{Domain, Packing};

/// A strip of a packing between held walls.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip<const D: usize> {
    /// All disks of the box, in its order.
    pub packing: Packing<D>,
    /// Index of the chosen disk, through which the line runs.
    pub centre: usize,
    /// Indices of the disks that the line cuts, ascending.
    pub row: Vec<usize>,
    /// H, the distance of either wall from the line \[length\].
    pub wall_distance: f64,
    /// Whether a disk belongs to the walls.
    in_wall: Vec<bool>,
}

impl<const D: usize> Strip<D> {
    /// The axis along the strip.
    pub const ALONG: usize = 0;
    /// The axis across it.
    pub const ACROSS: usize = region::ACROSS;

    /// The strip around a disk of a periodic packing: its row, held if `row_held`, and walls at `wall_distance`.
    ///
    /// # Errors
    /// The packing must be periodic and in the plane. Between the images of the strip there must be four of the largest
    /// radii.
    pub fn cut(
        packing: &Packing<D>,
        centre: usize,
        wall_distance: f64,
        row_held: bool,
    ) -> Result<Self, InflationError> {
        if D != 2 {
            return Err(InflationError::StripNotInPlane);
        }
        let side = packing.domain().lengths().ok_or(InflationError::NotPeriodic)?[Self::ACROSS];
        let largest = 0.5 * (side - RIM_WIDTH * packing.largest_radius());
        if !(wall_distance > 0.0 && wall_distance < largest) {
            return Err(InflationError::WallDistanceOutOfRange { wall_distance, largest });
        }
        let distance = |disk: usize| packing.separation(disk, centre)[Self::ACROSS].abs();
        let in_wall: Vec<bool> = (0..packing.len()).map(|disk| distance(disk) >= wall_distance).collect();
        let row: Vec<usize> =
            (0..packing.len()).filter(|&disk| !in_wall[disk] && distance(disk) < packing.radii()[disk]).collect();
        let mut held = in_wall.clone();
        if row_held {
            row.iter().for_each(|&disk| held[disk] = true);
        }
        let mobile_count = in_wall.iter().filter(|&&wall| !wall).count() - row.len();
        if mobile_count == 0 {
            return Err(InflationError::NoMobileDisk { outer_radius: wall_distance });
        }
        let packing = packing.clone().without_sites().with_held(held)?;
        Ok(Strip { packing, centre, row, wall_distance, in_wall })
    }

    /// Length of the strip, the side of the box along it \[length\].
    pub fn length(&self) -> f64 {
        self.packing.domain().lengths().map_or(f64::INFINITY, |lengths| lengths[Self::ALONG])
    }

    /// Number of mobile disks, without the row.
    pub fn mobile_count(&self) -> usize {
        self.in_wall.iter().filter(|&&wall| !wall).count() - self.row.len()
    }

    /// Area between the walls \[length^D\].
    pub fn area(&self) -> f64 {
        area(self.packing.domain(), self.wall_distance)
    }

    /// Whether a disk belongs to the walls.
    pub fn is_wall(&self, disk: usize) -> bool {
        self.in_wall[disk]
    }

    /// Pressure of the strip: virial of its disks over its area. Contacts with the walls count half; those within a held
    /// row have no force \[force / length^(D−1)\].
    pub fn pressure_of(&self, network: &ContactNetwork<D>) -> f64 {
        network.cluster_pressure(self.area(), |disk| self.in_wall[disk])
    }

    /// Label and distance from the line of the outermost mobile disk, if a disk of the largest radius fits between it and
    /// the line at H.
    pub(super) fn beyond_wall(&self, packing: &Packing<D>) -> Option<(u64, f64)> {
        let largest = packing.largest_radius();
        let distance = |disk: usize| {
            let (before, after) = (self.packing.positions()[disk], packing.positions()[disk]);
            // From its own position before, since a disk that crosses the wall gets another nearest image.
            let moved = after[Self::ACROSS] - before[Self::ACROSS];
            (self.packing.separation(disk, self.centre)[Self::ACROSS] + moved).abs()
        };
        let mobile = (0..packing.len()).filter(|&disk| !self.in_wall[disk]);
        let distances = mobile.map(|disk| (packing.labels()[disk], distance(disk)));
        distances
            .filter(|&(_, distance)| distance > self.wall_distance + 2.0 * largest)
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Area of a box within `wall_distance` of a line along the strip \[length^D\].
pub(crate) fn area<const D: usize>(domain: &Domain<D>, wall_distance: f64) -> f64 {
    let side = domain.lengths().map_or(f64::INFINITY, |lengths| lengths[Strip::<D>::ACROSS]);
    2.0 * wall_distance / side * domain.volume().unwrap_or(f64::INFINITY)
}
