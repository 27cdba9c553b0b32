//! One disk is inflated, the rest relaxes.
//!
//! Two geometries: a [`Circle`] with a held rim, in which the centre is held at the origin (the experiment of the study),
//! and the whole periodic box, in which nothing is held and the centre of mass stays where it is. Deflation takes the
//! inflated state, gives the disk its first radius back and relaxes again.

pub mod circle;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

pub use circle::Circle;

use crate::contact::{ContactNetwork, OnSite, PairLaw};
use crate::packing::{Packing, PackingError};
use crate::relax::{Cost, Criterion, Outcome, Relaxed, Relaxer, Residual, Stop, Trace};
use crate::vector::{norm, scaled, sum};

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
    match inflation.on_site_coupling {
        None => inflate_with(inflation, packing, law, relaxer, seed, trace),
        Some(coupling) if coupling.is_finite() => {
            inflate_with(inflation, packing, &OnSite { law: *law, coupling }, relaxer, seed, trace)
        }
        Some(coupling) => Err(InflationError::CouplingNotFinite { coupling }),
    }
}

fn inflate_with<const D: usize, L: PairLaw>(
    inflation: &Inflation,
    packing: &Packing<D>,
    law: &L,
    relaxer: &impl Relaxer,
    seed: u64,
    trace: &mut impl Trace,
) -> Result<Inflated<D>, InflationError> {
    let chosen = choose_centre(packing, law, inflation.centre, seed)?;
    let inner_radius = packing.radii()[chosen];
    let increase = inflation.increase;
    if !(increase.is_finite() && inner_radius + increase > 0.0) {
        return Err(InflationError::IncreaseNotPossible { increase, radius: inner_radius });
    }
    let nearest = (0..packing.len())
        .filter(|&disk| disk != chosen)
        .map(|disk| norm(packing.separation(disk, chosen)))
        .fold(f64::INFINITY, f64::min);
    if inner_radius + increase >= nearest {
        return Err(InflationError::IncreaseTooLarge { increase, radius: inner_radius, nearest });
    }
    let experiment = Experiment::new(inflation.boundary, packing, chosen)?;
    let start = experiment.start();
    let centre = experiment.centre();
    let before = experiment.rest(Stage::Before, start, law, relaxer, trace)?;
    let grown = before.packing.get().clone().with_radius(centre, inner_radius + increase)?;
    let after = experiment.rest(Stage::Inflated, grown, law, relaxer, trace)?;
    let deflated = if inflation.deflate {
        let shrunk = after.packing.get().clone().with_radius(centre, inner_radius)?;
        Some(experiment.rest(Stage::Deflated, shrunk, law, relaxer, trace)?)
    } else {
        None
    };
    let (outer_radius, mobile_count) = experiment.extent();
    Ok(Inflated { centre, inner_radius, outer_radius, mobile_count, before, after, deflated })
}

/// The geometry of an inflation.
enum Experiment<const D: usize> {
    HeldRim(Circle<D>),
    Periodic { packing: Packing<D>, centre: usize },
}

impl<const D: usize> Experiment<D> {
    fn new(boundary: Boundary, packing: &Packing<D>, chosen: usize) -> Result<Self, InflationError> {
        let lengths = packing.domain().lengths().ok_or(InflationError::NotPeriodic)?;
        match boundary {
            Boundary::HeldRim { outer_radius_over_side } => {
                let side = lengths.iter().copied().fold(f64::INFINITY, f64::min);
                Ok(Experiment::HeldRim(Circle::cut(packing, chosen, outer_radius_over_side * side)?))
            }
            Boundary::Periodic => Ok(Experiment::Periodic { packing: packing.clone(), centre: chosen }),
        }
    }

    fn start(&self) -> Packing<D> {
        match self {
            Experiment::HeldRim(circle) => circle.packing.clone(),
            // Sites of an earlier relaxation are not those of this one.
            Experiment::Periodic { packing, .. } => packing.clone().without_sites(),
        }
    }

    fn centre(&self) -> usize {
        match self {
            Experiment::HeldRim(circle) => circle.centre,
            Experiment::Periodic { centre, .. } => *centre,
        }
    }

    /// r_out and the number of mobile disks.
    fn extent(&self) -> (f64, usize) {
        match self {
            Experiment::HeldRim(circle) => (circle.outer_radius, circle.mobile_count()),
            Experiment::Periodic { packing, .. } => {
                let lengths = packing.domain().lengths().unwrap_or([f64::INFINITY; D]);
                (0.5 * lengths.iter().copied().fold(f64::INFINITY, f64::min), packing.len())
            }
        }
    }

    fn rest<L: PairLaw>(
        &self,
        stage: Stage,
        packing: Packing<D>,
        law: &L,
        relaxer: &impl Relaxer,
        trace: &mut impl Trace,
    ) -> Result<Rest<D>, InflationError> {
        let mut outcome = relaxer.relax(packing.clone(), law, trace)?;
        // Contact forces add up to nothing, so sites are at rest only where the centre of mass has not moved: nothing to undo.
        if let (Experiment::Periodic { .. }, false) = (self, L::ON_SITE) {
            outcome.state = with_centre_of_mass_of(&packing, outcome.state);
        }
        let Outcome { stop, residual, rounding_floor, cost, .. } = outcome;
        let (Stop::Converged(criterion), Ok(packing)) = (stop, outcome.converged()) else {
            let residual = residual.relative();
            return Err(InflationError::NotAtRest { stage, stop, step_count: cost.step_count, residual });
        };
        let network = ContactNetwork::new(packing.get(), law)?;
        let pressure = match (self, criterion) {
            (_, Criterion::Unjammed) => 0.0,
            (Experiment::HeldRim(circle), _) => circle.pressure_of(&network),
            (Experiment::Periodic { packing, .. }, _) => {
                network.pressure(packing.domain().volume().unwrap_or(f64::INFINITY))
            }
        };
        Ok(Rest {
            pressure,
            energy: network.energy() + network.on_site_energy(),
            contact_count: network.contacts.len(),
            rattler_count: network.rattlers().count(),
            packing,
            backbone: network.backbone,
            residual,
            rounding_floor,
            criterion,
            cost,
        })
    }
}

/// The second packing moved as a whole so that its disks have moved by nothing on average.
pub(crate) fn with_centre_of_mass_of<const D: usize>(before: &Packing<D>, mut after: Packing<D>) -> Packing<D> {
    let mut mean = [0.0; D];
    for disk in 0..before.len() {
        mean = sum(mean, displacement(before, &after, disk));
    }
    let shift = scaled(-1.0 / before.len() as f64, mean);
    for disk in 0..before.len() {
        after.displace(disk, shift);
    }
    after
}

/// How far a disk moved, to the rounding of that distance (positions are sums of two numbers).
pub(crate) fn displacement<const D: usize>(before: &Packing<D>, after: &Packing<D>, disk: usize) -> [f64; D] {
    let ((a, a_low), (b, b_low)) = (after.centre(disk), before.centre(disk));
    std::array::from_fn(|d| (a[d] - b[d]) + (a_low[d] - b_low[d]))
}
