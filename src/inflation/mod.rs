//! One disk is inflated, or another [`Drive`] is applied; the other disks relax.
//!
//! There are three geometries: a [`Circle`] with a held rim, in which the centre is held at the origin (the experiment of
//! the study) or free; the whole periodic box, in which nothing is held and the centre of mass does not move; and a
//! [`Strip`] between held walls, in which a row of disks is inflated. Deflation starts from the inflated state, restores
//! the radii and relaxes again.

mod choose_centre;
pub mod circle;
pub mod drive;
mod error;
pub(crate) mod grown;
pub(crate) mod region;
mod rest;
mod settings;
pub mod strip;

pub use choose_centre::choose_centre;
pub use circle::Circle;
pub use drive::{Applied, Drive};
pub use error::InflationError;
pub use grown::Grown;
pub use region::Shape;
pub use rest::{Rest, Stage};
pub use settings::{Boundary, Centre, Inflation};
pub use strip::Strip;

use crate::law::choice::LawChoice;
use crate::law::pair_law::PairLaw;
use crate::packing::Packing;
use crate::relax::{Fire, Relaxer, Trace};

/// The result of an inflation: the states before and after it, and after the deflation if there was one.
#[derive(Debug, Clone)]
pub struct Inflated<const D: usize> {
    /// Index of the inflated disk in the packings below; in a strip, of the chosen one, through which the line runs.
    pub centre: usize,
    /// Indices of all inflated disks: the centre, or the row of a strip.
    pub grown: Vec<usize>,
    /// Radius of the centre before \[length\].
    pub inner_radius: f64,
    /// R, the radius of the rim; half the shortest side in the periodic box; H, the distance of the walls from the line in
    /// a strip \[length\].
    pub outer_radius: f64,
    /// The shape of the region, for displacement fields.
    pub shape: Shape,
    /// Number of mobile disks.
    pub mobile_count: usize,
    /// What was done.
    pub drive: Drive,
    /// The state at rest before the inflation.
    pub before: Rest<D>,
    /// The start of the relaxation: the disk has grown, or another drive was applied, and no disk has moved by itself.
    pub start: Packing<D>,
    /// The state at rest with the disk inflated.
    pub after: Rest<D>,
    /// The state at rest after the deflation.
    pub deflated: Option<Rest<D>>,
}

/// Inflates a disk of a packing of Hertzian disks and relaxes the rest by FIRE; the disk is drawn with seed 1.
///
/// [`inflate_with`] takes any law, relaxer, seed and observer. Near jamming the relaxer decides where the disks end: FIRE stops at a
/// minimum near the start, the damped dynamics of the study cross barriers.
///
/// # Errors
/// [`InflationError`] says what is not possible, with numbers.
///
/// # Example
/// ```
/// use jamscope::{Inflation, Preparation, inflate, prepare};
/// let prepared = prepare(&Preparation { disk_count: 100, ..Preparation::default() })?;
/// let inflated = inflate(&Inflation::default(), prepared.packing.get())?;
/// assert!(inflated.after.energy > inflated.before.energy);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn inflate(inflation: &Inflation, packing: &Packing<2>) -> Result<Inflated<2>, InflationError> {
    inflate_with(inflation, packing, &LawChoice::default(), &Fire::default(), 1, &mut ())
}

/// Inflates a disk of a packing and relaxes the rest with this law and relaxer. `seed` draws the disk; `trace` observes the relaxations.
///
/// # Errors
/// [`InflationError`] says what is not possible, with numbers.
pub fn inflate_with<const D: usize>(
    inflation: &Inflation,
    packing: &Packing<D>,
    law: &dyn PairLaw,
    relaxer: &impl Relaxer,
    seed: u64,
    trace: &mut dyn Trace,
) -> Result<Inflated<D>, InflationError> {
    let law = &*inflation.checked_law_with_sites(law)?;
    let grown = Grown::new(inflation, packing, law, relaxer, seed, trace)?;
    let after = grown.rest(Stage::Inflated, grown.packing.clone(), law, relaxer, trace)?;
    let deflated = if inflation.deflate {
        let shrunk = grown.deflated(after.packing.get().clone())?;
        Some(grown.rest(Stage::Deflated, shrunk, law, relaxer, trace)?)
    } else {
        None
    };
    let shape = grown.shape();
    let Grown { centre, grown, inner_radius, outer_radius, mobile_count, drive, before, packing: start, .. } = grown;
    Ok(Inflated {
        centre,
        grown,
        inner_radius,
        outer_radius,
        shape,
        mobile_count,
        drive,
        before,
        start,
        after,
        deflated,
    })
}
