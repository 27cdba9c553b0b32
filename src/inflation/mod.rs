//! One disk is inflated, the rest relaxes.
//!
//! Two geometries: a [`Circle`] with a held rim, in which the centre is held at the origin (the experiment of the study),
//! and the whole periodic box, in which nothing is held and the centre of mass stays where it is. Deflation takes the
//! inflated state, gives the disk its first radius back and relaxes again.

pub mod circle;
pub(crate) mod grown;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

pub use circle::Circle;
pub use grown::Grown;

use crate::law::on_site::OnSite;
use crate::law::pair_law::PairLaw;
use crate::network::ContactNetwork;
use crate::packing::{Packing, PackingError};
use crate::relax::{Cost, Criterion, Relaxed, Relaxer, Residual, Stop, Trace};

/// What keeps the packing in place while a disk is inflated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Boundary {
    /// A circle is cut out; disks from this radius outwards are held, and so is the centre.
    HeldRim {
        /// r_out over the shortest side of the box, at most 1/2 \[1\].
        outer_radius_over_side: f64,
    },
    /// The periodic box; nothing is held, the centre of mass stays.
    Periodic,
}

impl Default for Boundary {
    /// Source: design §4, r_out/L for 5548 disks (0.486 and 0.491 for 22184 and 88776).
    fn default() -> Self {
        Boundary::HeldRim { outer_radius_over_side: 0.480 }
    }
}

/// Which disk is inflated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Centre {
    /// A random one of the smallest disks on the backbone (of all the smallest disks where there is no backbone).
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
    /// d_0, by which the radius grows at once \[length\].
    pub increase: f64,
    /// What keeps the packing in place.
    pub boundary: Boundary,
    /// Which disk is inflated.
    pub centre: Centre,
    /// Whether the disk is deflated again afterwards.
    pub deflate: bool,
    /// Γ of an energy −Γu²/2 on every mobile disk, u its displacement from where it was in the packing given; absent, there
    /// is none \[force / length\]. The packing itself is prepared without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on_site_coupling: Option<f64>,
}

impl Inflation {
    /// A law with the sites of the inflation, if disks have any.
    pub fn law_with_sites<L: PairLaw>(&self, law: &L) -> OnSite<L> {
        OnSite { law: *law, coupling: self.on_site_coupling.unwrap_or(0.0) }
    }

    /// The same.
    ///
    /// # Errors
    /// A coupling that is not finite.
    pub(crate) fn checked_law_with_sites<L: PairLaw>(&self, law: &L) -> Result<OnSite<L>, InflationError> {
        match self.on_site_coupling {
            Some(coupling) if !coupling.is_finite() => Err(InflationError::CouplingNotFinite { coupling }),
            _ => Ok(self.law_with_sites(law)),
        }
    }
}

impl Default for Inflation {
    /// Source: design §4 (d_0 = 0.1).
    fn default() -> Self {
        Inflation {
            increase: 0.1,
            boundary: Boundary::default(),
            centre: Centre::default(),
            deflate: false,
            on_site_coupling: None,
        }
    }
}

/// Why an inflation could not be done.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InflationError {
    /// The disks themselves are at fault.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// A circle is cut from a periodic box only.
    #[error("the packing is not periodic: a circle with its held rim is cut from a periodic box")]
    NotPeriodic,
    /// r_out must leave every mobile disk one image.
    #[error("outer radius {outer_radius} is not between 0 and half the shortest side of the box, {half_side}")]
    OuterRadiusOutOfRange {
        /// The radius asked for.
        outer_radius: f64,
        /// Half the shortest side.
        half_side: f64,
    },
    /// Nothing could move.
    #[error("no disk lies within the outer radius {outer_radius}")]
    NoMobileDisk {
        /// The radius asked for.
        outer_radius: f64,
    },
    /// d_0 must be finite and leave a positive radius.
    #[error("increase is {increase}, which leaves no positive radius of a disk of radius {radius}")]
    IncreaseNotPossible {
        /// d_0 asked for.
        increase: f64,
        /// Radius of the disk.
        radius: f64,
    },
    /// The inflated disk would cover the centre of a neighbour.
    #[error(
        "increase is {increase}, larger than the neighbours allow: a disk of radius {radius} has a neighbour's centre at {nearest}, so the increase must stay below {}",
        nearest - radius
    )]
    IncreaseTooLarge {
        /// d_0 asked for.
        increase: f64,
        /// Radius of the disk.
        radius: f64,
        /// Distance of the nearest centre.
        nearest: f64,
    },
    /// Γ must be a number.
    #[error("on_site_coupling is {coupling}, not a finite number")]
    CouplingNotFinite {
        /// The value asked for.
        coupling: f64,
    },
    /// There is no disk with the label asked for.
    #[error("no disk has the label {label}")]
    NoSuchLabel {
        /// The label asked for.
        label: u64,
    },
    /// A mobile disk was pushed through the held rim: its centre is farther out than the rim and a disk.
    #[error(
        "{stage}: disk {label} was pushed through the rim: it is at {distance} from the centre, and disks from {outer_radius} on are held"
    )]
    BeyondRim {
        /// Which of the relaxations.
        stage: Stage,
        /// Label of the disk.
        label: u64,
        /// Its distance from the centre \[length\].
        distance: f64,
        /// r_out \[length\].
        outer_radius: f64,
    },
    /// A relaxation did not end at rest.
    #[error("{stage}: the relaxation stopped with {stop:?} after {step_count} steps, residual {residual:e}")]
    NotAtRest {
        /// Which of the relaxations.
        stage: Stage,
        /// Why it stopped.
        stop: Stop,
        /// Steps taken.
        step_count: usize,
        /// Relative residual reached.
        residual: f64,
    },
}

/// The relaxations of an inflation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Before anything is inflated (at once at rest if the packing was).
    Before,
    /// After the inflation.
    Inflated,
    /// After the deflation.
    Deflated,
}

impl std::fmt::Display for Stage {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Stage::Before => "before the inflation",
            Stage::Inflated => "after the inflation",
            Stage::Deflated => "after the deflation",
        })
    }
}

/// One state of an inflation at rest.
#[derive(Debug, Clone)]
pub struct Rest<const D: usize> {
    /// The disks.
    pub packing: Relaxed<Packing<D>>,
    /// Pressure of the circle or the box \[force / length^(D−1)\].
    pub pressure: f64,
    /// Elastic energy, with that of the sites where there are some \[energy\].
    pub energy: f64,
    /// Number of contacts, held–held ones left out.
    pub contact_count: usize,
    /// Number of mobile disks that are rattlers.
    pub rattler_count: usize,
    /// Whether each disk belongs to the backbone.
    pub backbone: Vec<bool>,
    /// Residual reached.
    pub residual: Residual,
    /// Rounding floor of the relative residual \[1\].
    pub rounding_floor: f64,
    /// Which limit was met.
    pub criterion: Criterion,
    /// What it cost.
    pub cost: Cost,
}

/// An inflation done: the states before, after, and after deflation if asked for.
#[derive(Debug, Clone)]
pub struct Inflated<const D: usize> {
    /// Index of the inflated disk in the packings below.
    pub centre: usize,
    /// Radius of the inflated disk before \[length\].
    pub inner_radius: f64,
    /// r_out, half the shortest side in the periodic variant \[length\].
    pub outer_radius: f64,
    /// Number of mobile disks.
    pub mobile_count: usize,
    /// At rest before.
    pub before: Rest<D>,
    /// At rest with the disk inflated.
    pub after: Rest<D>,
    /// At rest with the disk deflated again.
    pub deflated: Option<Rest<D>>,
}

/// Picks the disk to inflate.
///
/// # Errors
/// A label that no disk has; two disks with the same centre.
pub fn choose_centre<const D: usize, L: PairLaw>(
    packing: &Packing<D>,
    law: &L,
    centre: Centre,
    seed: u64,
) -> Result<usize, InflationError> {
    if let Centre::Label(label) = centre {
        let found = packing.labels().iter().position(|&other| other == label);
        return found.ok_or(InflationError::NoSuchLabel { label });
    }
    let smallest = packing.radii().iter().copied().fold(f64::INFINITY, f64::min);
    let small: Vec<usize> = (0..packing.len()).filter(|&disk| packing.radii()[disk] == smallest).collect();
    let backbone = ContactNetwork::new(packing, law)?.backbone;
    let rigid: Vec<usize> = small.iter().copied().filter(|&disk| backbone[disk]).collect();
    let candidates = if centre == Centre::Backbone && !rigid.is_empty() { rigid } else { small };
    let mut generator = Pcg64::seed_from_u64(seed);
    Ok(candidates[generator.random_range(0..candidates.len())])
}

/// Inflates a disk of a packing and relaxes the rest.
///
/// # Errors
/// [`InflationError`] says what cannot be done, with numbers.
pub fn inflate<const D: usize, L: PairLaw>(
    inflation: &Inflation,
    packing: &Packing<D>,
    law: &L,
    relaxer: &impl Relaxer,
    seed: u64,
    trace: &mut impl Trace,
) -> Result<Inflated<D>, InflationError> {
    let law = &inflation.checked_law_with_sites(law)?;
    let grown = Grown::new(inflation, packing, law, relaxer, seed, trace)?;
    let after = grown.rest(Stage::Inflated, grown.packing.clone(), law, relaxer, trace)?;
    let deflated = if inflation.deflate {
        let shrunk = after.packing.get().clone().with_radius(grown.centre, grown.inner_radius)?;
        Some(grown.rest(Stage::Deflated, shrunk, law, relaxer, trace)?)
    } else {
        None
    };
    let Grown { centre, inner_radius, outer_radius, mobile_count, before, .. } = grown;
    Ok(Inflated { centre, inner_radius, outer_radius, mobile_count, before, after, deflated })
}

/// How far a disk moved, to the rounding of that distance (positions are sums of two numbers).
pub(crate) fn displacement<const D: usize>(before: &Packing<D>, after: &Packing<D>, disk: usize) -> [f64; D] {
    let ((a, a_low), (b, b_low)) = (after.centre(disk), before.centre(disk));
    std::array::from_fn(|d| (a[d] - b[d]) + (a_low[d] - b_low[d]))
}
