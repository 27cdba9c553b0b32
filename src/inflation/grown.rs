//! [`Grown`]: a packing whose disk has grown, or to which another drive was applied, before any disk has moved.

use crate::inflation::choose_centre::choose_centre;
use crate::inflation::circle::Circle;
use crate::inflation::drive::{DiagonalStrain, Drive};
use crate::inflation::error::InflationError;
#[cfg(feature = "linear")]
use crate::inflation::region::Region;
use crate::inflation::region::Shape;
use crate::inflation::rest::{Rest, Stage};
use crate::inflation::settings::{Boundary, Inflation};
use crate::inflation::strip::Strip;
use crate::law::pair_law::PairLaw;
use crate::network::ContactNetwork;
use crate::packing::{Packing, PackingError, displacement};
use crate::relax::{Criterion, Outcome, Relaxer, Stop, Trace};
use crate::vector::{norm, scaled, sum};

/// A packing at rest before the inflation, and the same packing with the grown disk: the start of any relaxer.
///
/// If disks have sites, the law here and below is one with sites ([`OnSite`](crate::law::on_site::OnSite)).
#[derive(Debug, Clone)]
pub struct Grown<const D: usize> {
    experiment: Experiment<D>,
    /// What was done.
    pub drive: Drive,
    /// Index of the inflated disk in the packings below; in a strip, of the chosen one, through which the line runs.
    pub centre: usize,
    /// Indices of all inflated disks: the centre, or the row of a strip.
    pub grown: Vec<usize>,
    /// Radius of the centre before \[length\].
    pub inner_radius: f64,
    /// R, the radius of the rim; half the shortest side in the periodic box; H in a strip \[length\].
    pub outer_radius: f64,
    /// Number of mobile disks.
    pub mobile_count: usize,
    /// The state at rest before the inflation.
    pub before: Rest<D>,
    /// The start of the relaxation: the same disks at the same positions, one of them or a row larger; or another drive
    /// applied.
    pub packing: Packing<D>,
}

impl<const D: usize> Grown<D> {
    /// Chooses the disk, cuts the circle if the boundary is a rim, relaxes the packing and lets the disk grow.
    ///
    /// # Errors
    /// [`InflationError`].
    pub fn new(
        inflation: &Inflation,
        packing: &Packing<D>,
        law: &dyn PairLaw,
        relaxer: &impl Relaxer,
        seed: u64,
        trace: &mut dyn Trace,
    ) -> Result<Self, InflationError> {
        let drive = inflation.drive;
        inflation.check_drive()?;
        let chosen = choose_centre(packing, law, inflation.centre, seed)?;
        let inner_radius = packing.radii()[chosen];
        let experiment = Experiment::new(inflation, packing, chosen)?;
        let start = experiment.start();
        let (centre, grown) = (experiment.centre(), experiment.grown());
        if drive.is_inflation() {
            grown.iter().try_for_each(|&disk| check_increase(&start, disk, inflation.increase))?;
        }
        let before = experiment.rest((Stage::Before, DiagonalStrain::default()), start, law, relaxer, trace)?;
        let mut packing = drive.start(before.packing.get(), centre, law)?;
        for &disk in grown.iter().filter(|_| drive.is_inflation()) {
            let radius = packing.radii()[disk] + inflation.increase;
            packing = packing.with_radius(disk, radius)?;
        }
        let (outer_radius, mobile_count) = experiment.extent();
        Ok(Grown { experiment, drive, centre, grown, inner_radius, outer_radius, mobile_count, before, packing })
    }

    /// The shape of the region, for displacement fields.
    pub fn shape(&self) -> Shape {
        match &self.experiment {
            Experiment::HeldWalls(strip) => Shape::Strip { length: strip.length() },
            Experiment::HeldRim(_) | Experiment::Periodic { .. } => Shape::Round,
        }
    }

    /// The inflated disks and the region around them.
    #[cfg(feature = "linear")]
    pub(crate) fn region(&self) -> Region<'_> {
        let Grown { centre, ref grown, inner_radius, outer_radius, drive, .. } = *self;
        Region { centre, grown, inner_radius, outer_radius, shape: self.shape(), strain: drive.strain::<D>() }
    }

    /// A packing with the radii before the inflation, or with another drive taken back.
    pub(super) fn deflated(&self, packing: Packing<D>) -> Result<Packing<D>, PackingError> {
        let mut packing = self.drive.released(packing, self.before.packing.get(), self.centre);
        for &disk in &self.grown {
            packing = packing.with_radius(disk, self.before.packing.get().radii()[disk])?;
        }
        Ok(packing)
    }

    /// Relaxes disks in the geometry of this inflation. The outcome need not be at rest.
    ///
    /// # Errors
    /// Only conditions that make forces undefined.
    pub fn relax(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        relaxer: &impl Relaxer,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        self.experiment.relax(packing, law, relaxer, trace)
    }

    /// Pressure of the circle or the box from all contacts of a state \[force / length^(D−1)\].
    pub fn pressure_of(&self, network: &ContactNetwork<D>) -> f64 {
        self.experiment.pressure_of(network)
    }

    pub(super) fn rest(
        &self,
        stage: Stage,
        packing: Packing<D>,
        law: &dyn PairLaw,
        relaxer: &impl Relaxer,
        trace: &mut dyn Trace,
    ) -> Result<Rest<D>, InflationError> {
        // Taken back, the rim is where it was.
        let strain = if stage == Stage::Inflated { self.drive.strain::<D>() } else { DiagonalStrain::default() };
        self.experiment.rest((stage, strain), packing, law, relaxer, trace)
    }
}

/// The geometry of an inflation.
#[derive(Debug, Clone)]
enum Experiment<const D: usize> {
    HeldRim(Circle<D>),
    Periodic { packing: Packing<D>, centre: usize },
    HeldWalls(Strip<D>),
}

/// Checks that a disk can grow by `increase`.
fn check_increase<const D: usize>(packing: &Packing<D>, disk: usize, increase: f64) -> Result<(), InflationError> {
    let radius = packing.radii()[disk];
    if !(increase.is_finite() && radius + increase > 0.0) {
        return Err(InflationError::IncreaseNotPossible { increase, radius });
    }
    let others = (0..packing.len()).filter(|&other| other != disk);
    let nearest = others.map(|other| norm(packing.separation(other, disk))).fold(f64::INFINITY, f64::min);
    if radius + increase >= nearest {
        return Err(InflationError::IncreaseTooLarge { increase, radius, nearest });
    }
    Ok(())
}

impl<const D: usize> Experiment<D> {
    fn new(inflation: &Inflation, packing: &Packing<D>, chosen: usize) -> Result<Self, InflationError> {
        let lengths = packing.domain().lengths().ok_or(InflationError::NotPeriodic)?;
        let centre_held = inflation.drive.holds_centre(inflation.centre_held);
        match inflation.boundary {
            Boundary::HeldRim { outer_radius_over_side } => {
                let side = lengths.iter().copied().fold(f64::INFINITY, f64::min);
                let circle = Circle::cut(packing, chosen, outer_radius_over_side * side)?;
                Ok(Experiment::HeldRim(if centre_held { circle } else { circle.with_free_centre()? }))
            }
            Boundary::Periodic => Ok(Experiment::Periodic { packing: packing.clone(), centre: chosen }),
            Boundary::HeldWalls { distance_over_side, .. } => {
                let wall_distance = distance_over_side * lengths[Strip::<D>::ACROSS];
                Ok(Experiment::HeldWalls(Strip::cut(packing, chosen, wall_distance, centre_held)?))
            }
        }
    }

    fn start(&self) -> Packing<D> {
        match self {
            Experiment::HeldRim(circle) => circle.packing.clone(),
            // Sites of an earlier relaxation do not apply here.
            Experiment::Periodic { packing, .. } => packing.clone().without_sites(),
            Experiment::HeldWalls(strip) => strip.packing.clone(),
        }
    }

    /// The disks that grow.
    fn grown(&self) -> Vec<usize> {
        match self {
            Experiment::HeldRim(_) | Experiment::Periodic { .. } => vec![self.centre()],
            Experiment::HeldWalls(strip) => strip.row.clone(),
        }
    }

    fn centre(&self) -> usize {
        match self {
            Experiment::HeldRim(circle) => circle.centre,
            Experiment::Periodic { centre, .. } => *centre,
            Experiment::HeldWalls(strip) => strip.centre,
        }
    }

    /// R and the number of mobile disks.
    fn extent(&self) -> (f64, usize) {
        match self {
            Experiment::HeldRim(circle) => (circle.outer_radius, circle.mobile_count()),
            Experiment::HeldWalls(strip) => (strip.wall_distance, strip.mobile_count()),
            Experiment::Periodic { packing, .. } => {
                let lengths = packing.domain().lengths().unwrap_or([f64::INFINITY; D]);
                (0.5 * lengths.iter().copied().fold(f64::INFINITY, f64::min), packing.len())
            }
        }
    }

    fn relax(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        relaxer: &impl Relaxer,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        match self {
            // Contact forces add up to zero. With sites the centre of mass must stay where it was; without, its
            // displacement is removed.
            Experiment::Periodic { .. } if !law.has_sites() => {
                let mut outcome = relaxer.relax(packing.clone(), law, trace)?;
                outcome.state = with_centre_of_mass_of(&packing, outcome.state);
                Ok(outcome)
            }
            _ => relaxer.relax(packing, law, trace),
        }
    }

    fn pressure_of(&self, network: &ContactNetwork<D>) -> f64 {
        match self {
            Experiment::HeldRim(circle) => circle.pressure_of(network),
            Experiment::HeldWalls(strip) => strip.pressure_of(network),
            Experiment::Periodic { packing, .. } => {
                network.pressure(packing.domain().volume().unwrap_or(f64::INFINITY))
            }
        }
    }

    fn rest(
        &self,
        (stage, strain): (Stage, DiagonalStrain),
        packing: Packing<D>,
        law: &dyn PairLaw,
        relaxer: &impl Relaxer,
        trace: &mut dyn Trace,
    ) -> Result<Rest<D>, InflationError> {
        let outcome = self.relax(packing, law, relaxer, trace)?;
        let Outcome { stop, residual, rounding_floor, cost, .. } = outcome;
        let (Stop::Converged(criterion), Ok(packing)) = (stop, outcome.converged()) else {
            let residual = residual.relative();
            return Err(InflationError::NotAtRest { stage, stop, step_count: cost.step_count, residual });
        };
        if let Experiment::HeldRim(circle) = self
            && let Some((label, distance)) = circle.beyond_rim(packing.get(), strain)
        {
            return Err(InflationError::BeyondRim { stage, label, distance, outer_radius: circle.outer_radius });
        }
        if let Experiment::HeldWalls(strip) = self
            && let Some((label, distance)) = strip.beyond_wall(packing.get())
        {
            return Err(InflationError::BeyondRim { stage, label, distance, outer_radius: strip.wall_distance });
        }
        let network = ContactNetwork::new(packing.get(), law)?;
        Ok(Rest {
            pressure: if criterion == Criterion::Unjammed {
                0.0
            } else {
                self.pressure_of(&network) / strain.volume_ratio::<D>()
            },
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

/// Translates the second packing so that the mean displacement of its disks is zero.
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
