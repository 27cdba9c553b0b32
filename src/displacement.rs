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

use serde::{Deserialize, Serialize};

use crate::inflation::{Inflated, Rest, displacement};
#[cfg(feature = "linear")]
use crate::linear::LinearResponse;
use crate::packing::Packing;
use crate::relax::Criterion;
use crate::vector::{Vector, dot, norm, scaled};

/// One disk of a displacement field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moved<const D: usize> {
    /// Index of the disk in the packings the field was made from.
    pub disk: usize,
    /// Position before, relative to the centre of the inflated disk \[length\].
    pub position: Vector<D>,
    /// Distance before to that centre \[length\].
    pub distance: f64,
    /// Displacement \[length\].
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

/// The displacements of the mobile disks, without the inflated disk.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplacementField<const D: usize> {
    /// Mobile disks in the order of the packing.
    pub disks: Vec<Moved<D>>,
    /// Radius of the inflated disk before, a \[length\].
    pub inner_radius: f64,
    /// R, the radius of the rim \[length\].
    pub outer_radius: f64,
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
        Self::between(inflated, &inflated.before, &inflated.after)
    }

    /// The displacement that remains after the deflation; none without a deflation.
    pub fn of_cycle(inflated: &Inflated<D>) -> Option<Self> {
        inflated.deflated.as_ref().map(|deflated| Self::between(inflated, &inflated.before, deflated))
    }

    /// The linear response to an inflation by `increase`. The disks that were solved for count.
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
        let centre = response.growing.expect("a field has a disk that grows in its middle");
        let displacement = |disk: usize| scaled(increase, response.displacements[disk]);
        let disks = moved(packing, centre, &response.solved, displacement);
        let inner_radius = packing.radii()[centre];
        DisplacementField { disks, inner_radius, outer_radius, measured_on: MeasuredOn::Backbone }
    }

    fn between(inflated: &Inflated<D>, before: &Rest<D>, after: &Rest<D>) -> Self {
        let unjammed = [before, after].iter().any(|rest| rest.criterion == Criterion::Unjammed);
        let states = [(before.packing.get(), before.backbone.as_slice()), (after.packing.get(), &after.backbone)];
        Self::of_states(states, unjammed, inflated.centre, inflated.inner_radius, inflated.outer_radius)
    }

    /// The field from two states with their backbones. The caller ensures that both are at rest, or states that they
    /// are not.
    pub(crate) fn of_states(
        [(first, first_backbone), (second, second_backbone)]: [(&Packing<D>, &[bool]); 2],
        unjammed: bool,
        centre: usize,
        inner_radius: f64,
        outer_radius: f64,
    ) -> Self {
        let measured_on = if unjammed { MeasuredOn::AllDisks } else { MeasuredOn::Backbone };
        let counted: Vec<bool> =
            first_backbone.iter().zip(second_backbone).map(|(&a, &b)| unjammed || (a && b)).collect();
        let disks = moved(first, centre, &counted, |disk| displacement(first, second, disk));
        DisplacementField { disks, inner_radius, outer_radius, measured_on }
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

fn moved<const D: usize>(
    before: &Packing<D>,
    centre: usize,
    counted: &[bool],
    displacement: impl Fn(usize) -> Vector<D>,
) -> Vec<Moved<D>> {
    (0..before.len())
        .filter(|&disk| disk != centre && !before.held()[disk])
        .map(|disk| {
            let position = before.separation(disk, centre);
            let distance = norm(position);
            let displacement = displacement(disk);
            let radial = dot(displacement, scaled(1.0 / distance, position));
            Moved { disk, position, distance, displacement, radial, counted: counted[disk] }
        })
        .collect()
}
