//! [`DisplacementField`]: the displacement of every disk, in radial and transverse parts, on the backbone.
//!
//! ```text
//! d_i = r_i(after) − r_i(before)      d_r = d·r̂      d_θ = d·θ̂ (D = 2)      r̂ from the centre of the inflated disk
//! ```
//!
//! The field comes from two [`Relaxed`](crate::relax::Relaxed) packings, so a state that is not at rest cannot reach a
//! figure. It may also come from a linear response, which records whether its packing is at a minimum. Rattlers before
//! or after are left out of every observable. An unjammed packing has no backbone: all its disks are rattlers and all
//! count.

use std::any::Any;
use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::inflation::drive::DiagonalStrain;
use crate::inflation::region::Region;
use crate::inflation::{Inflated, Rest};
#[cfg(feature = "linear")]
use crate::linear::LinearResponse;
use crate::packing::{Packing, displacement};
use crate::relax::Criterion;
#[cfg(feature = "linear")]
use crate::vector::scaled;
use crate::vector::{Vector, difference, norm};

pub use crate::inflation::region::Shape;

/// One disk of a displacement field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moved<const D: usize> {
    /// Index of the disk in the packings the field was made from.
    pub disk: usize,
    /// Position before, relative to the centre of the inflated disk \[length\].
    pub position: Vector<D>,
    /// Distance before to that centre, or to the line of a strip \[length\].
    pub distance: f64,
    /// Displacement; of a shear or a compression its non-affine part \[length\].
    pub displacement: Vector<D>,
    /// Radial part d_r \[length\].
    pub radial: f64,
    /// Whether observables include the disk: it is on the backbone before and after, or the packing is unjammed.
    pub counted: bool,
}

impl Moved<2> {
    /// Angle θ of the position, in (−π, π] \[rad\].
    pub fn angle(&self) -> f64 {
        libm::atan2(self.position[1], self.position[0])
    }

    /// Transverse part d_θ, positive anticlockwise \[length\].
    pub fn transverse(&self) -> f64 {
        (self.position[0] * self.displacement[1] - self.position[1] * self.displacement[0]) / self.distance
    }
}

/// The displacements of the mobile disks, without the inflated disks.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplacementField<const D: usize> {
    /// Mobile disks in the order of the packing.
    pub disks: Vec<Moved<D>>,
    /// Radius of the inflated disk before, a \[length\].
    pub inner_radius: f64,
    /// R, the radius of the rim; H, the distance of the walls, in a strip \[length\].
    pub outer_radius: f64,
    /// The shape of the region.
    pub shape: Shape,
    /// Which disks count.
    pub measured_on: MeasuredOn,
}

/// Which disks the observables of a field include.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MeasuredOn {
    /// Disks on the backbone before and after.
    Backbone,
    /// All mobile disks: the packing was unjammed before or after.
    AllDisks,
}

impl<const D: usize> DisplacementField<D> {
    /// The response to an inflation.
    pub fn of_inflation(inflated: &Inflated<D>) -> Self {
        Self::between(inflated, &inflated.before, &inflated.after, inflated.drive.strain::<D>())
    }

    /// The displacement that remains after the deflation; none without a deflation.
    pub fn of_cycle(inflated: &Inflated<D>) -> Option<Self> {
        let deflated = inflated.deflated.as_ref()?;
        Some(Self::between(inflated, &inflated.before, deflated, DiagonalStrain::default()))
    }

    /// The linear response to an inflation of one disk by `increase`. The disks that were solved for count.
    ///
    /// `packing` is the one of the response. `outer_radius` is the R of its circle or box.
    ///
    /// # Panics
    /// If the packing has another number of disks, or the response is not that to the growth of a disk.
    #[cfg(feature = "linear")]
    pub fn of_linear_response(
        response: &LinearResponse<D>,
        packing: &Packing<D>,
        increase: f64,
        outer_radius: f64,
    ) -> Self {
        assert_eq!(packing.len(), response.displacements.len(), "a response belongs to the packing it was made from");
        let &[centre] = response.growing.as_slice() else { panic!("a field has one disk that grows in its middle") };
        let displacement = |disk: usize| scaled(increase, response.displacements[disk]);
        let (inner_radius, shape) = (packing.radii()[centre], Shape::Round);
        let strain = DiagonalStrain::default();
        let region = Region { centre, grown: &[centre], inner_radius, outer_radius, shape, strain };
        let disks = moved(packing, region, &response.solved, displacement);
        DisplacementField { disks, inner_radius, outer_radius, shape, measured_on: MeasuredOn::Backbone }
    }

    fn between(inflated: &Inflated<D>, before: &Rest<D>, after: &Rest<D>, strain: DiagonalStrain) -> Self {
        let unjammed = [before, after].iter().any(|rest| rest.criterion == Criterion::Unjammed);
        let states = [(before.packing.get(), before.backbone.as_slice()), (after.packing.get(), &after.backbone)];
        let Inflated { centre, ref grown, inner_radius, outer_radius, shape, .. } = *inflated;
        Self::of_states(states, unjammed, Region { centre, grown, inner_radius, outer_radius, shape, strain })
    }

    /// The field from two states with their backbones. The caller ensures that both are at rest, or states that they
    /// are not.
    pub(crate) fn of_states(
        [(first, first_backbone), (second, second_backbone)]: [(&Packing<D>, &[bool]); 2],
        unjammed: bool,
        region: Region<'_>,
    ) -> Self {
        let measured_on = if unjammed { MeasuredOn::AllDisks } else { MeasuredOn::Backbone };
        let counted: Vec<bool> =
            first_backbone.iter().zip(second_backbone).map(|(&a, &b)| unjammed || (a && b)).collect();
        let disks = moved(first, region, &counted, |disk| displacement(first, second, disk));
        let Region { inner_radius, outer_radius, shape, .. } = region;
        DisplacementField { disks, inner_radius, outer_radius, shape, measured_on }
    }

    /// Number of dimensions in which the field spreads: D in a circle, 1 in a strip. The exact solutions are those of
    /// that number.
    pub fn spreading_dimension(&self) -> usize {
        match self.shape {
            Shape::Round => D,
            Shape::Strip { .. } => 1,
        }
    }

    /// The field as one of the plane, if it is.
    pub(crate) fn in_plane(&self) -> Option<&DisplacementField<2>> {
        (self as &dyn Any).downcast_ref()
    }

    /// The field as one of spheres, if it is.
    pub(crate) fn in_space(&self) -> Option<&DisplacementField<3>> {
        (self as &dyn Any).downcast_ref()
    }

    /// The disks that observables include.
    pub fn counted(&self) -> impl Iterator<Item = &Moved<D>> + '_ {
        self.disks.iter().filter(|disk| disk.counted)
    }
}

impl DisplacementField<2> {
    /// The place of a disk along a ring, as an angle in (−π, π]: θ of its position, or 2πx/L along a strip of length L
    /// \[rad\].
    pub fn angle(&self, disk: &Moved<2>) -> f64 {
        match self.shape {
            Shape::Round => disk.angle(),
            Shape::Strip { length } => 2.0 * PI * disk.position[0] / length,
        }
    }
}

fn moved<const D: usize>(
    before: &Packing<D>,
    region: Region<'_>,
    counted: &[bool],
    displacement: impl Fn(usize) -> Vector<D>,
) -> Vec<Moved<D>> {
    let mut apart = vec![false; before.len()];
    region.grown.iter().for_each(|&disk| apart[disk] = true);
    (0..before.len())
        .filter(|&disk| !apart[disk] && !before.held()[disk])
        .map(|disk| {
            let position = before.separation(disk, region.centre);
            let displacement = difference(displacement(disk), region.strain.of(position));
            let distance = norm(region.shape.offset(position));
            let radial = region.shape.radial_part(position, displacement);
            Moved { disk, position, distance, displacement, radial, counted: counted[disk] }
        })
        .collect()
}
