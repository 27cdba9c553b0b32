//! The circle cut out of a periodic packing: mobile disks inside, a held rim around, the disk to inflate in the middle.
//!
//! The centre of the chosen disk becomes the origin of the open plane. Disks nearer than R are mobile. All images
//! of disks at R or beyond are held, as far as a mobile disk can reach. Images are needed if R plus the
//! contact range exceeds half a side of the box: without them the rim would have holes. So a label can occur twice in
//! the rim.

use crate::inflation::drive::DiagonalStrain;
use crate::inflation::error::InflationError;
use crate::network::ContactNetwork;
use crate::packing::{Domain, Packing, PackingError, ball_volume};
use crate::vector::{Vector, extended_sum, norm};

/// A circular (D = 2) or spherical (D = 3) piece of a packing with a held rim.
#[derive(Debug, Clone, PartialEq)]
pub struct Circle<const D: usize> {
    /// Mobile disks in the order of the source, then the centre, then the rim; labels are those of the source.
    pub packing: Packing<D>,
    /// Index of the centre, equal to the number of mobile disks.
    pub centre: usize,
    /// Radius R within which disks are mobile \[length\].
    pub outer_radius: f64,
}

/// Width of the held rim over the largest radius: a mobile disk at R touches held ones up to 2 away, and may be
/// pushed outwards by up to another 2.
pub(crate) const RIM_WIDTH: f64 = 4.0;

impl<const D: usize> Circle<D> {
    /// Cuts the circle of this radius around a disk of a periodic packing.
    ///
    /// # Errors
    /// The packing must be periodic. `outer_radius` must be at most half a side, so that each mobile disk has one
    /// image.
    pub fn cut(packing: &Packing<D>, centre: usize, outer_radius: f64) -> Result<Self, InflationError> {
        let edges = packing.domain().edges().ok_or(InflationError::NotPeriodic)?;
        let half = 0.5 * (0..D).map(|d| edges[d][d]).fold(f64::INFINITY, f64::min);
        if !(outer_radius > 0.0 && outer_radius <= half) {
            return Err(InflationError::OuterRadiusOutOfRange { outer_radius, half_side: half });
        }
        let reach = outer_radius + RIM_WIDTH * packing.largest_radius();
        let mut mobile = Vec::new();
        let mut rim = Vec::new();
        let mut images = Vec::new();
        for disk in (0..packing.len()).filter(|&disk| disk != centre) {
            let (high, low) = packing.domain().separation_extended(packing.centre(disk), packing.centre(centre));
            images.clear();
            let image = Image { centre: std::array::from_fn(|d| (high[d], low[d])), is_nearest: true };
            add_images(D, image, &edges, reach, &mut images);
            for &image in &images {
                let (position, distance) = (image.position(), norm(image.position().0));
                if image.is_nearest && distance < outer_radius {
                    mobile.push((disk, position));
                } else if distance >= outer_radius && distance < reach {
                    rim.push((disk, position));
                }
            }
        }
        // The images of the centre lie outside R if R is below half a side; they may belong to the rim.
        images.clear();
        add_images(D, Image { centre: [(0.0, 0.0); D], is_nearest: true }, &edges, reach, &mut images);
        for image in images.iter().filter(|image| !image.is_nearest) {
            if norm(image.position().0) < reach {
                rim.push((centre, image.position()));
            }
        }
        let middle = mobile.len();
        if middle == 0 {
            return Err(InflationError::NoMobileDisk { outer_radius });
        }
        let all: Vec<_> = mobile.into_iter().chain([(centre, ([0.0; D], [0.0; D]))]).chain(rim).collect();
        let positions = all.iter().map(|(_, position)| position.0).collect();
        let radii = all.iter().map(|&(disk, _)| packing.radii()[disk]).collect();
        let cut = Packing::new(Domain::Open, positions, radii)?
            .with_corrections(all.iter().map(|(_, position)| position.1).collect())?
            .with_labels(all.iter().map(|&(disk, _)| packing.labels()[disk]).collect())?
            .with_held((0..all.len()).map(|index| index >= middle).collect())?;
        Ok(Circle { packing: cut, centre: middle, outer_radius })
    }

    /// The same circle with a centre that moves with its neighbours.
    ///
    /// # Errors
    /// None for a circle that was [cut](Circle::cut).
    pub fn with_free_centre(mut self) -> Result<Self, PackingError> {
        let held = (0..self.packing.len()).map(|disk| disk > self.centre).collect();
        self.packing = self.packing.with_held(held)?;
        Ok(self)
    }

    /// Number of mobile disks, without the centre.
    pub fn mobile_count(&self) -> usize {
        self.centre
    }

    /// Label and distance from the centre of the outermost mobile disk, if it has left the circle through the rim. It
    /// has if a disk of the largest radius fits between it and R. `strain` is that of the rim, which distances are
    /// without.
    pub(super) fn beyond_rim(&self, packing: &Packing<D>, strain: DiagonalStrain) -> Option<(u64, f64)> {
        let largest = packing.largest_radius();
        let mobile =
            (0..=self.centre).map(|disk| (packing.labels()[disk], norm(strain.undone(packing.positions()[disk]))));
        mobile.filter(|&(_, distance)| distance > self.outer_radius + 2.0 * largest).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Pressure of the circle: virial of its disks over π R². Contacts with the rim count half \[force /
    /// length^(D−1)\].
    pub fn pressure_of(&self, network: &ContactNetwork<D>) -> f64 {
        network.cluster_pressure(ball_volume::<D>(self.outer_radius), |disk| disk > self.centre)
    }
}

/// An image of a disk relative to the centre.
#[derive(Clone, Copy)]
struct Image<const D: usize> {
    /// Its centre, an unevaluated sum per axis.
    centre: [(f64, f64); D],
    is_nearest: bool,
}

impl<const D: usize> Image<D> {
    /// Position and correction.
    fn position(&self) -> (Vector<D>, Vector<D>) {
        (self.centre.map(|it| it.0), self.centre.map(|it| it.1))
    }
}

/// Adds the images of a disk with no coordinate beyond `reach`, shifted along the edges before `axis`.
fn add_images<const D: usize>(
    axis: usize,
    image: Image<D>,
    edges: &[Vector<D>; D],
    reach: f64,
    images: &mut Vec<Image<D>>,
) {
    let Some(axis) = axis.checked_sub(1) else {
        images.push(image);
        return;
    };
    let (at, edge) = (image.centre[axis].0, edges[axis]);
    let (first, last) = (((-reach - at) / edge[axis]).ceil(), ((reach - at) / edge[axis]).floor());
    for boxes in first as i64..=last as i64 {
        let mut shifted = Image { is_nearest: image.is_nearest && boxes == 0, ..image };
        for along in 0..=axis {
            shifted.centre[along] = extended_sum(shifted.centre[along], boxes as f64 * edge[along]);
        }
        add_images(axis, shifted, edges, reach, images);
    }
}
