//! [`PlasticPart`]: the difference between the relaxed and the linear response, and the range of inflations without
//! one.
//!
//! ```text
//! d_plastic = d_relaxed − d_0 u        |d_plastic| = √(Σ_i d_i²)        P = (Σ_i d_i²)² / (N Σ_i d_i⁴)
//! ```
//!
//! In a packing whose contacts do not change this is of order d_0². Contacts that open, close or rearrange add the
//! plastic part.

use crate::displacement::{DisplacementField, Moved};
use crate::inflation::{Drive, Inflated};
use crate::law::pair_law::PairLaw;
use crate::linear::hessian::Prestress;
use crate::linear::{LinearError, LinearResponse};
use crate::network::ContactNetwork;
use crate::packing::displacement;
use crate::packing::{Packing, PackingError};
use crate::relax::{Cost, Relaxed, Relaxer, Stop};
use crate::vector::{Vector, difference, dot, scaled};

/// Why a linear range could not be found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlasticError {
    /// The disks themselves are invalid.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// The response is to forces or displacements, not to the growth of a disk.
    #[error("the linear response must be the response to the growth of a disk")]
    NothingGrows,
    /// A relaxation did not end at rest.
    #[error("after an inflation by {increase:e}, the relaxation stopped with {stop:?} after {step_count} steps")]
    NotAtRest {
        /// d_0 of that relaxation.
        increase: f64,
        /// Why it stopped.
        stop: Stop,
        /// Steps taken.
        step_count: usize,
    },
}

/// The linear response to the drive of an inflation, on its state before: per d_0 if disks grow, otherwise to the whole
/// load. That of a shear or a compression includes the affine displacement ε r.
///
/// # Errors
/// See [`LinearResponse::of_inflation`].
pub fn linear_response<const D: usize>(
    inflated: &Inflated<D>,
    law: &dyn PairLaw,
) -> Result<LinearResponse<D>, LinearError> {
    let (before, prestress) = (inflated.before.packing.get(), Prestress::Included);
    match inflated.drive {
        Drive::Inflation => LinearResponse::of_growth(before, &inflated.grown, law, prestress),
        Drive::PointForce { .. } | Drive::ForceDipole { .. } => {
            LinearResponse::of_forces(before, inflated.start.loads().unwrap_or_default(), law, prestress)
        }
        Drive::Displacement { .. } => {
            let moved = displacement(before, &inflated.start, inflated.centre);
            LinearResponse::of_displacements(before, &[(inflated.centre, moved)], law, prestress)
        }
        Drive::Shear { .. } | Drive::Compression { .. } => {
            let held = (0..before.len()).filter(|&disk| before.held()[disk]);
            let moved: Vec<_> = held.map(|disk| (disk, displacement(before, &inflated.start, disk))).collect();
            LinearResponse::of_displacements(before, &moved, law, prestress)
        }
    }
}

/// By what the displacements of [`linear_response`] are multiplied: d_0 if disks grow, otherwise 1.
pub(crate) fn load_factor<const D: usize>(inflated: &Inflated<D>, response: &LinearResponse<D>) -> f64 {
    match response.growing.is_empty() {
        true => 1.0,
        false => inflated.after.packing.get().radii()[inflated.centre] - inflated.inner_radius,
    }
}

/// The plastic part of a response.
#[derive(Debug, Clone, PartialEq)]
pub struct PlasticPart<const D: usize> {
    /// d_relaxed − d_0 u per disk, on the disks that count in the relaxed field and were solved for.
    pub field: DisplacementField<D>,
    /// √(Σ d_i²) over these disks \[length\].
    pub norm: f64,
    /// That norm over the norm of the relaxed response \[1\].
    pub share: f64,
    /// Participation ratio: 1 if all disks move equally, 1/N if one moves; 0 if none does \[1\].
    pub participation_ratio: f64,
}

impl<const D: usize> PlasticPart<D> {
    /// The plastic part of an inflation or of another drive. The linear response must be that of its state before, see
    /// [`linear_response`].
    ///
    /// # Panics
    /// If the response belongs to another packing.
    pub fn of(inflated: &Inflated<D>, response: &LinearResponse<D>) -> Self {
        let field = DisplacementField::of_inflation(inflated);
        let (factor, strain) = (load_factor(inflated, response), inflated.drive.strain::<D>());
        Self::between(field, response, |disk| {
            difference(scaled(factor, response.displacements[disk.disk]), strain.of(disk.position))
        })
    }

    /// The plastic part of the displacements after an inflation by `increase`. The linear response must be that of the state before.
    ///
    /// # Panics
    /// If the response belongs to another packing.
    pub fn of_field(field: DisplacementField<D>, increase: f64, response: &LinearResponse<D>) -> Self {
        Self::between(field, response, |disk| scaled(increase, response.displacements[disk.disk]))
    }

    fn between(
        mut field: DisplacementField<D>,
        response: &LinearResponse<D>,
        linear: impl Fn(&Moved<D>) -> Vector<D>,
    ) -> Self {
        let shape = field.shape;
        let relaxed = Squares::of(field.counted().map(|disk| disk.displacement));
        for disk in &mut field.disks {
            disk.displacement = difference(disk.displacement, linear(disk));
            disk.radial = shape.radial_part(disk.position, disk.displacement);
            disk.counted &= response.solved[disk.disk];
        }
        let plastic = Squares::of(field.counted().map(|disk| disk.displacement));
        PlasticPart {
            norm: plastic.sum.sqrt(),
            share: if relaxed.sum > 0.0 { (plastic.sum / relaxed.sum).sqrt() } else { 0.0 },
            participation_ratio: plastic.participation_ratio(),
            field,
        }
    }
}

/// Number of vectors, Σ d² and Σ d⁴. The fourth power is relative to the largest square, so it does not underflow.
struct Squares {
    count: usize,
    sum: f64,
    largest: f64,
    fourth: f64,
}

impl Squares {
    fn of<const D: usize>(vectors: impl Iterator<Item = Vector<D>>) -> Self {
        let squares: Vec<f64> = vectors.map(|vector| dot(vector, vector)).collect();
        let largest = squares.iter().copied().fold(0.0, f64::max);
        let relative = |square: f64| if largest > 0.0 { square / largest } else { 0.0 };
        Squares {
            count: squares.len(),
            sum: squares.iter().sum(),
            fourth: squares.iter().map(|&square| relative(square).powi(2)).sum(),
            largest,
        }
    }

    fn participation_ratio(&self) -> f64 {
        if self.fourth == 0.0 {
            return 0.0;
        }
        (self.sum / self.largest).powi(2) / (self.count as f64 * self.fourth)
    }
}

/// The range of inflations with a linear response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearRange {
    /// The largest d_0 tried at which |d_relaxed − d_0 u| is within the tolerance of |d_0 u| \[length\].
    pub linear_up_to: f64,
    /// The smallest d_0 tried above it \[length\]; none if the largest d_0 tried is still linear.
    pub not_linear_from: Option<f64>,
    /// The largest d_0 tried that changes no contact of the backbone \[length\].
    pub contacts_kept_up_to: f64,
    /// The smallest d_0 tried that changes one \[length\]; none if the largest changes none.
    pub contact_change_from: Option<f64>,
    /// The d_0 at which the linear response opens its first contact \[length\]; none if it opens none.
    pub first_opening: Option<f64>,
    /// Cost of the relaxations.
    pub cost: Cost,
}

/// Settings of [`linear_range`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearRangeSearch {
    /// Relative deviation from the linear response that still counts as linear \[1\].
    pub tolerance: f64,
    /// Largest d_0 tried \[length\].
    pub largest: f64,
    /// Smallest d_0 tried \[length\].
    pub smallest: f64,
    /// Number of bisections of log d_0 between the two.
    pub halving_count: usize,
}

impl Default for LinearRangeSearch {
    /// A tolerance of 1 %; d_0 between 10⁻⁸ and 0.1, located to 7 % (8 bisections of seven decades).
    fn default() -> Self {
        LinearRangeSearch { tolerance: 0.01, largest: 0.1, smallest: 1e-8, halving_count: 8 }
    }
}

/// Finds by bisection the largest inflation with a linear response, and the first that changes a contact.
///
/// Bisection assumes that a change persists for all larger d_0. Beyond its first plastic event a packing may violate
/// this.
///
/// `packing` is at rest with its centre and rim held (or with nothing held, in a periodic box), as for `response`.
///
/// # Errors
/// The response is not that to the growth of a disk; a relaxation does not end at rest.
///
/// # Cost
/// Two relaxations for the ends and up to twice `halving_count` between, each from the given packing.
pub fn linear_range<const D: usize>(
    packing: &Relaxed<Packing<D>>,
    response: &LinearResponse<D>,
    law: &dyn PairLaw,
    relaxer: &impl Relaxer,
    search: &LinearRangeSearch,
) -> Result<LinearRange, PlasticError> {
    let packing = packing.get();
    let disk_count = packing.len();
    if response.growing.is_empty() {
        return Err(PlasticError::NothingGrows);
    }
    let links = |packing: &Packing<D>| -> Result<Vec<(u32, u32)>, PlasticError> {
        let network = ContactNetwork::new(packing, law)?;
        Ok(network.backbone_contacts().map(|contact| (contact.first, contact.second)).collect())
    };
    let before = links(packing)?;
    let linear = Squares::of((0..disk_count).map(|disk| response.displacements[disk])).sum.sqrt();
    let mut cost = Cost::default();
    // Whether an inflation is linear, and whether it changes no contact.
    let mut probe = |increase: f64| -> Result<(bool, bool), PlasticError> {
        let mut grown = packing.clone();
        for &disk in &response.growing {
            grown = grown.with_radius(disk, packing.radii()[disk] + increase)?;
        }
        let outcome = relaxer.relax(grown, law, &mut ())?;
        cost = cost.plus(outcome.cost);
        let (stop, step_count) = (outcome.stop, outcome.cost.step_count);
        let after = match (stop, outcome.converged()) {
            (Stop::Converged(_), Ok(after)) => after,
            _ => return Err(PlasticError::NotAtRest { increase, stop, step_count }),
        };
        let deviations = (0..disk_count).filter(|&disk| response.solved[disk]).map(|disk| {
            difference(displacement(packing, after.get(), disk), scaled(increase, response.displacements[disk]))
        });
        let deviation = Squares::of(deviations).sum.sqrt();
        Ok((deviation <= search.tolerance * increase * linear, links(after.get())? == before))
    };
    let (low, high) = (search.smallest, search.largest);
    let ends = [probe(low)?, probe(high)?];
    let mut bisect = |which: fn((bool, bool)) -> bool| -> Result<(f64, Option<f64>), PlasticError> {
        if which(ends[1]) {
            return Ok((high, None));
        }
        if !which(ends[0]) {
            return Ok((0.0, Some(low)));
        }
        let (mut good, mut bad) = (low, high);
        for _ in 0..search.halving_count {
            let middle = (good * bad).sqrt();
            if which(probe(middle)?) { good = middle } else { bad = middle }
        }
        Ok((good, Some(bad)))
    };
    let (linear_up_to, not_linear_from) = bisect(|(linear, _)| linear)?;
    let (contacts_kept_up_to, contact_change_from) = bisect(|(_, kept)| kept)?;
    let changes = response.contact_changes(packing, law)?;
    let openings = changes.iter().filter_map(|change| change.opens_at());
    let first_opening = openings.fold(None, |first: Option<f64>, at| Some(first.map_or(at, |first| first.min(at))));
    Ok(LinearRange { linear_up_to, not_linear_from, contacts_kept_up_to, contact_change_from, first_opening, cost })
}
