//! Packings, and how their bonds are stretched around one disk after another.

use std::error::Error;
use std::fmt;
use std::ops::Range;

use jamscope::displacement::DisplacementField;
use jamscope::inflation::{Boundary, Centre, Inflation, inflate_with};
use jamscope::law::damping::{DampingChoice, ViscoelasticDamping};
use jamscope::law::{Hertzian, PairLaw};
use jamscope::linear::LinearResponse;
use jamscope::linear::Prestress;
use jamscope::observe::bond_changes::{BondChange, BondChanges, BondSet};
use jamscope::observe::fluctuations::Fluctuations;
use jamscope::observe::{ExcessCoordination, State};
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{ImplicitDynamics, Staged};
use jamscope::vector::norm;
use rayon::prelude::*;

/// How a disk grows.
#[derive(Clone, Copy)]
pub enum Growth {
    /// By an infinitesimal amount, contact forces counted or left out (springs at rest).
    Linear(Prestress),
    /// By this much \[length\], and everything comes to rest.
    Relaxed { increase: f64, damped: bool },
}

impl fmt::Display for Growth {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Growth::Linear(Prestress::Included) => write!(formatter, "linear response"),
            Growth::Linear(Prestress::LeftOut) => write!(formatter, "linear response of springs at rest"),
            Growth::Relaxed { increase, damped } => {
                write!(
                    formatter,
                    "d_0 = {increase}, {}",
                    if *damped { "viscoelastic damping of rate 500" } else { "FIRE and Newton" }
                )
            }
        }
    }
}

/// γ of damped dynamics. Source: the published study.
const RATE: f64 = 500.0;

/// Logarithmic width of a ring.
const RING: f64 = 0.08;

/// Radius from which on rings count \[length\]: nearer are the contacts of the disk that grows, which it pushes itself.
const FROM: f64 = 1.5;

/// Around one disk: in each ring h of d_∥ r², of k d_∥ r² over the mean k, and of d_r r over d_0, by the number of the ring; all are
/// level in an elastic medium.
pub struct Sample {
    /// ΔZ and L/2, means over packings.
    pub excess: f64,
    pub outer_radius: f64,
    pub stretching: Vec<Option<f64>>,
    pub force: Vec<Option<f64>>,
    pub radial: Vec<Option<f64>>,
}

/// The radius in the middle of a ring \[length\].
pub fn radius_of(ring: usize) -> f64 {
    FROM * (RING * (ring as f64 + 0.5)).exp()
}

/// Prepared by FIRE, then Newton.
pub fn prepared(disk_count: usize, seeds: Range<u64>, pressure: f64) -> Result<Vec<Packing<2>>, Box<dyn Error>> {
    let one = |seed: u64| {
        let (mixture, target) = (Mixture::default(), Target::Pressure(pressure));
        let preparation = Preparation { disk_count, mixture, target, tolerance: 0.01, seed, ..Preparation::default() };
        let prepared = prepare_with::<2>(&preparation, &Hertzian::default(), &Staged::default(), &mut ());
        prepared.map(|prepared| prepared.packing.into_inner()).map_err(|error| error.to_string())
    };
    Ok(seeds.into_par_iter().map(one).collect::<Result<_, String>>()?)
}

/// Small disks of the backbone, spread over the packing.
pub fn centres(state: &State<'_, 2>, count: usize) -> Vec<usize> {
    let (radii, backbone) = (state.packing.radii(), &state.network.backbone);
    let smallest = radii.iter().copied().fold(f64::INFINITY, f64::min);
    let small: Vec<usize> = (0..radii.len()).filter(|&disk| radii[disk] == smallest && backbone[disk]).collect();
    small.iter().copied().step_by((small.len() / count).max(1)).take(count).collect()
}

/// h in rings of equal logarithmic width, of (distance, value) pairs.
pub fn in_rings(pairs: impl Iterator<Item = (f64, f64)>, outer_radius: f64) -> Vec<Option<f64>> {
    let logarithm = |radius: f64| (radius / FROM).ln();
    let pairs = pairs.filter(|&(radius, _)| radius >= FROM).map(|(radius, value)| (logarithm(radius), value));
    let mut rings = vec![None; (logarithm(outer_radius) / RING) as usize];
    for ring in Fluctuations::of(pairs, logarithm(outer_radius), RING).rings {
        let number = (ring.radius / RING) as usize;
        if ring.count > 3 && number < rings.len() {
            rings[number] = Some(ring.fluctuation);
        }
    }
    rings
}

impl Sample {
    fn new(
        before: &Packing<2>,
        (excess, outer_radius): (f64, f64),
        bonds: &BondChanges<2>,
        field: &DisplacementField<2>,
        increase: f64,
    ) -> Self {
        let stretching =
            bonds.bonds.iter().map(|bond| (bond.distance, bond.parallel * bond.distance.powi(2) / increase));
        let law = Hertzian::default();
        let stiffness = |bond: &BondChange<2>| {
            let [first, second] = [bond.first, bond.second].map(|disk| before.radii()[disk as usize]);
            let overlap = first + second - norm(bond.separation);
            law.stiffness(law.force(law.coefficient(first, second), overlap), overlap)
        };
        let mean_stiffness = bonds.bonds.iter().map(stiffness).sum::<f64>() / bonds.bonds.len() as f64;
        let force = bonds.bonds.iter().map(|bond| {
            let share = stiffness(bond) / mean_stiffness;
            (bond.distance, share * bond.parallel * bond.distance.powi(2) / increase)
        });
        let radial = field.counted().map(|disk| (disk.distance, disk.radial * disk.distance / increase));
        Sample {
            excess,
            outer_radius,
            stretching: in_rings(stretching, outer_radius),
            force: in_rings(force, outer_radius),
            radial: in_rings(radial, outer_radius),
        }
    }

    /// Around so many disks of every packing, packing by packing.
    pub fn of_all(packings: &[Packing<2>], count: usize, growth: Growth) -> Result<Vec<Vec<Sample>>, Box<dyn Error>> {
        let law = Hertzian::default();
        let states = packings.iter().map(|packing| State::new(packing, &law)).collect::<Result<Vec<_>, _>>()?;
        let of = |state: &State<'_, 2>| ExcessCoordination::of(&state.network).map_or(f64::NAN, |excess| excess.value);
        let half_side = |packing: &Packing<2>| packing.domain().lengths().map_or(f64::NAN, |sides| 0.5 * sides[0]);
        let mean = |sum: f64| sum / packings.len() as f64;
        let shape = (mean(states.iter().map(of).sum()), mean(packings.iter().map(half_side).sum()));
        let around = |state: &State<'_, 2>| -> Result<Vec<Sample>, String> {
            match growth {
                Growth::Linear(prestress) => linear(state, shape, count, prestress),
                Growth::Relaxed { increase, damped } => relaxed(state, shape, count, (increase, damped)),
            }
        };
        Ok(states.par_iter().map(around).collect::<Result<Vec<_>, _>>()?)
    }
}

fn linear(state: &State<'_, 2>, shape: (f64, f64), count: usize, prestress: Prestress) -> Result<Vec<Sample>, String> {
    let mut samples = Vec::new();
    let (packing, centres) = (state.packing, centres(state, count));
    LinearResponse::of_inflations(packing, &centres, &Hertzian::default(), prestress, |response| {
        let bonds = BondChanges::of_linear_response(state, &response, 1.0);
        let field = DisplacementField::of_linear_response(&response, packing, 1.0, shape.1);
        samples.push(Sample::new(packing, shape, &bonds, &field, 1.0));
    })
    .map_err(|error| error.to_string())?;
    Ok(samples)
}

fn relaxed(
    state: &State<'_, 2>,
    shape: (f64, f64),
    count: usize,
    (increase, damped): (f64, bool),
) -> Result<Vec<Sample>, String> {
    let law = Hertzian::default();
    let one = |&centre: &usize| -> Result<Sample, String> {
        let centre = Centre::Label(state.packing.labels()[centre]);
        let inflation = Inflation { increase, boundary: Boundary::Periodic, centre, ..Inflation::default() };
        let inflated = if damped {
            let damping = DampingChoice::Viscoelastic(ViscoelasticDamping { rate: RATE });
            let dynamics = ImplicitDynamics { damping, ..ImplicitDynamics::default() };
            inflate_with(&inflation, state.packing, &law, &dynamics, 1, &mut ())
        } else {
            inflate_with(&inflation, state.packing, &law, &Staged::default(), 1, &mut ())
        };
        let inflated = inflated.map_err(|error| error.to_string())?;
        let bonds = BondChanges::of_inflation(&inflated, &law, BondSet::Kept).map_err(|error| error.to_string())?;
        Ok(Sample::new(state.packing, shape, &bonds, &DisplacementField::of_inflation(&inflated), increase))
    };
    centres(state, count).par_iter().map(one).collect()
}
