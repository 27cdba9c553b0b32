//! [`PlasticPart`]: what of a relaxed response is not in the linear one, and up to where there is nothing of it.
//!
//! ```text
//! d_plastic = d_relaxed − d_0 u        |d_plastic| = √(Σ_i d_i²)        P = (Σ_i d_i²)² / (N Σ_i d_i⁴)
//! ```
//!
//! A smooth packing leaves d_0² there; contacts that open, close, or rearrange leave what plasticity is.

use crate::displacement::DisplacementField;
use crate::inflation::{Inflated, displacement};
use crate::law::pair_law::PairLaw;
use crate::linear::LinearResponse;
use crate::network::ContactNetwork;
use crate::packing::{Packing, PackingError};
use crate::relax::{Cost, Relaxed, Relaxer, Stop};
use crate::vector::{Vector, difference, dot, scaled};

/// Why a linear range could not be found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlasticError {
    /// The disks themselves are at fault.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// The response is one to forces or displacements.
    #[error("the linear response is not one to the growth of a disk")]
    NothingGrows,
    /// A relaxation did not end at rest.
    #[error("inflated by {increase:e} the relaxation stopped with {stop:?} after {step_count} steps")]
    NotAtRest {
        /// d_0 of that relaxation.
        increase: f64,
        /// Why it stopped.
        stop: Stop,
        /// Steps taken.
        step_count: usize,
    },
}

/// The plastic part of a response.
#[derive(Debug, Clone, PartialEq)]
pub struct PlasticPart<const D: usize> {
    /// d_relaxed − d_0 u, disk by disk, on the disks that count in the relaxed field and were solved for.
    pub field: DisplacementField<D>,
    /// √(Σ d_i²) over those \[length\].
    pub norm: f64,
    /// The same over that of the relaxed response \[1\].
    pub share: f64,
    /// Participation ratio: 1 where all disks take part alike, 1/N where one does; 0 where none does \[1\].
    pub participation_ratio: f64,
}

impl<const D: usize> PlasticPart<D> {
    /// The plastic part of an inflation, whose linear response was made from its state before.
    ///
    /// # Panics
    /// If the response belongs to another packing.
    pub fn of(inflated: &Inflated<D>, response: &LinearResponse<D>) -> Self {
        let increase = inflated.after.packing.get().radii()[inflated.centre] - inflated.inner_radius;
        let mut field = DisplacementField::of_inflation(inflated);
        let relaxed = Squares::of(field.counted().map(|disk| disk.displacement));
        for disk in &mut field.disks {
            let linear = scaled(increase, response.displacements[disk.disk]);
            disk.displacement = difference(disk.displacement, linear);
            disk.radial = dot(disk.displacement, disk.position) / disk.distance;
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

/// Σ d², Σ d⁴ and how many, the fourth power relative to the largest square so that it does not vanish.
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

/// Up to where a packing answers an inflation linearly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearRange {
    /// The largest d_0 found at which |d_relaxed − d_0 u| stays within the tolerance of |d_0 u| \[length\].
    pub linear_up_to: f64,
    /// The smallest d_0 found beyond it \[length\]; none if the largest tried is still linear.
    pub not_linear_from: Option<f64>,
    /// The largest d_0 found that changes no contact of the backbone \[length\].
    pub contacts_kept_up_to: f64,
    /// The smallest d_0 found that changes one \[length\]; none if the largest tried changes none.
    pub contact_change_from: Option<f64>,
    /// The d_0 at which the linear response itself would open its first contact \[length\]; none if it opens none.
    pub first_opening: Option<f64>,
    /// What the relaxations cost.
    pub cost: Cost,
}

/// How [`linear_range`] searches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearRangeSearch {
    /// Deviation from the linear response that is still linear \[1\].
    pub tolerance: f64,
    /// Largest d_0 tried \[length\].
    pub largest: f64,
    /// Smallest d_0 tried \[length\].
    pub smallest: f64,
    /// Halvings of the logarithm of d_0 between the two.
    pub halving_count: usize,
}

impl Default for LinearRangeSearch {
    /// 1 %, between 10⁻⁸ and 0.1, to 7 % of d_0 (8 halvings of seven decades).
    fn default() -> Self {
        LinearRangeSearch { tolerance: 0.01, largest: 0.1, smallest: 1e-8, halving_count: 8 }
    }
}

/// The largest inflation that a packing answers linearly, and the first that changes a contact, both by bisection.
///
/// Bisection takes for granted that what changes once does not change back; a packing beyond its first plastic event may.
///
/// `packing` is at rest with its centre and rim held (or neither, in a periodic box), as `response` was made from.
///
/// # Errors
/// A response that is not one to the growth of a disk; a relaxation that does not end at rest.
///
/// # Cost
/// Two relaxations for the ends and up to twice `halving_count` between, each from the packing given.
pub fn linear_range<const D: usize, L: PairLaw>(
    packing: &Relaxed<Packing<D>>,
    response: &LinearResponse<D>,
    law: &L,
    relaxer: &impl Relaxer,
    search: &LinearRangeSearch,
) -> Result<LinearRange, PlasticError> {
    let packing = packing.get();
    let disk_count = packing.len();
    let centre = response.growing.ok_or(PlasticError::NothingGrows)?;
    let links = |packing: &Packing<D>| -> Result<Vec<(u32, u32)>, PlasticError> {
        let network = ContactNetwork::new(packing, law)?;
        Ok(network.backbone_contacts().map(|contact| (contact.first, contact.second)).collect())
    };
    let before = links(packing)?;
    let linear = Squares::of((0..disk_count).map(|disk| response.displacements[disk])).sum.sqrt();
    let mut cost = Cost::default();
    // Whether an inflation stays linear, and whether it keeps its contacts.
    let mut probe = |increase: f64| -> Result<(bool, bool), PlasticError> {
        let grown = packing.clone().with_radius(centre, packing.radii()[centre] + increase)?;
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
