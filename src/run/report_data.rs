//! [`Report`]: all numbers of a run, with units, as plain data.

use serde::Serialize;

use crate::certificate::Certificate;
use crate::displacement::DisplacementField;
use crate::inflation::Inflated;
#[cfg(feature = "linear")]
use crate::observe::RadialProfile;
use crate::packing::Packing;
use crate::processor::Vectors;
#[cfg(feature = "linear")]
use crate::protocol::{ProtocolSensitivity, ProtocolSummary};
use crate::relax::{Cost, Criterion};
#[cfg(feature = "linear")]
use crate::response::Measurement;
use crate::response::{PhaseFrequency, Response, in_dimension};
#[cfg(feature = "linear")]
use crate::run::drive_summary::DriveSummary;
use crate::scene::Scene;
use crate::vector::{larger, norm};
use crate::verdict::RestVerdict;

/// The results of a run.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Version of jamscope that ran it.
    pub jamscope_version: &'static str,
    /// Vector instructions of the processor; the last digits of results of factorisations depend on them.
    pub vectors: Vectors,
    /// The scene, including all defaults.
    pub scene: Scene,
    /// One entry per sample, in the order of the scene.
    pub samples: Vec<SampleReport>,
    /// Summary of the samples whose protocols were compared.
    #[cfg(feature = "linear")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub protocol: Option<ProtocolSummary>,
}

/// One sample of a run.
#[derive(Debug, Clone, Serialize)]
pub struct SampleReport {
    /// Its name.
    pub name: String,
    /// Seed of its random points and of the choice of the inflated disk.
    pub seed: u64,
    /// Its result, or why there is none.
    #[serde(flatten)]
    pub result: SampleOutcome,
}

/// The result of a sample, or why there is none.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleOutcome {
    /// All stages are done.
    Done(Box<SampleResult>),
    /// A stage failed, with its error message.
    Failed(String),
}

/// The result of a sample.
#[derive(Debug, Clone, Serialize)]
pub struct SampleResult {
    /// The packing before the cut and the inflation.
    pub packing: PackingSummary,
    /// The inflation.
    pub inflation: InflationSummary,
    /// The observables.
    #[serde(flatten)]
    pub response: Response,
    /// How often similar samples of an ensemble have the phase of this one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase_frequency: Option<PhaseFrequency>,
    /// The plastic part of the response.
    #[cfg(feature = "linear")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plastic_part: Option<Measurement<PlasticSummary>>,
    /// Whether other relaxers end in the same minimum.
    #[cfg(feature = "linear")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub protocol: Option<Measurement<Box<ProtocolSensitivity>>>,
    /// Another drive than an inflation beside its exact solution.
    #[cfg(feature = "linear")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drive: Option<Measurement<DriveSummary>>,
    /// The states.
    #[serde(skip)]
    pub states: States,
}

/// The states of a sample.
#[derive(Debug, Clone)]
pub enum States {
    /// Disks in the plane.
    Plane(Box<StatesOf<2>>),
    /// Spheres in space.
    Space(Box<StatesOf<3>>),
}

/// The states of a sample in D dimensions.
#[derive(Debug, Clone)]
pub struct StatesOf<const D: usize> {
    /// The packing.
    pub prepared: Packing<D>,
    /// Its states before and after the inflation, and after the deflation.
    pub inflated: Inflated<D>,
    /// The displacement that remains after the deflation.
    pub cycle_field: Option<DisplacementField<D>>,
    /// d − d_0 u of each disk, if the plastic part was requested and there is a linear response.
    #[cfg(feature = "linear")]
    pub plastic_field: Option<DisplacementField<D>>,
}

impl States {
    /// Wraps the states of a sample in two or three dimensions.
    pub(crate) fn of<const D: usize>(states: StatesOf<D>) -> Self {
        const { assert!(D == 2 || D == 3, "a packing has two or three dimensions") };
        in_dimension(states, States::Plane, States::Space)
    }

    /// The states in the plane.
    pub fn plane(&self) -> Option<&StatesOf<2>> {
        match self {
            States::Plane(states) => Some(states),
            States::Space(_) => None,
        }
    }

    /// Radii of the packing before the inflation.
    pub fn radii(&self) -> &[f64] {
        match self {
            States::Plane(states) => states.inflated.before.packing.get().radii(),
            States::Space(states) => states.inflated.before.packing.get().radii(),
        }
    }

    /// The largest displacement of a disk that counts, from before the inflation to after the deflation \[length\].
    pub fn largest_cycle_displacement(&self) -> Option<f64> {
        fn largest<const D: usize>(field: &DisplacementField<D>) -> f64 {
            field.counted().map(|disk| norm(disk.displacement)).fold(0.0, larger)
        }
        match self {
            States::Plane(states) => states.cycle_field.as_ref().map(largest),
            States::Space(states) => states.cycle_field.as_ref().map(largest),
        }
    }
}

/// Summary of the plastic part: the difference between the response and the linear one.
#[cfg(feature = "linear")]
#[derive(Debug, Clone, Serialize)]
pub struct PlasticSummary {
    /// √(Σ |d − d_0 u|²) over the disks that count \[length\].
    pub norm: f64,
    /// That norm over the norm of the response \[1\].
    pub share: f64,
    /// Participation ratio, 1 if all disks move equally \[1\].
    pub participation_ratio: f64,
    /// Mean radial part in rings.
    pub radial_profile: RadialProfile,
    /// d_0 at which the linear response opens its first contact; absent if it opens none \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_opening: Option<f64>,
    /// Δp of the linear response \[force / length\].
    pub linear_pressure_change: f64,
    /// Negative eigenvalues of the Hessian before; 0 shows a minimum.
    pub negative_eigenvalue_count: usize,
    /// Backward error of the linear response \[1\].
    pub backward_error: f64,
}

/// Summary of a packing.
#[derive(Debug, Clone, Serialize)]
pub struct PackingSummary {
    /// Number of disks.
    pub disk_count: usize,
    /// Sides of the box \[length\].
    pub box_sides: Vec<f64>,
    /// Packing fraction \[1\].
    pub packing_fraction: f64,
    /// Packing fraction at which random points were quenched; absent for a packing from a file \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quench_packing_fraction: Option<f64>,
    /// Verdict on a packing from a file as it was read; absent for a packing prepared here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub as_read: Option<RestVerdict>,
    /// Pressure \[force / length\].
    pub pressure: f64,
    /// Elastic energy \[energy\].
    pub energy: f64,
    /// Number of contacts.
    pub contact_count: usize,
    /// Number of rattlers.
    pub rattler_count: usize,
    /// Coordination of the backbone, Z \[1\].
    pub coordination: f64,
    /// Number of relaxations.
    pub relaxation_count: usize,
    /// Quality of its equilibrium.
    pub rest: RestSummary,
    /// Its certificate.
    pub certificate: Certificate,
}

/// Quality of the equilibrium of a state.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct RestSummary {
    /// Which limit was met.
    pub criterion: Criterion,
    /// Largest net force on the backbone over the mean contact force \[1\].
    pub relative_residual: f64,
    /// Largest net force on the backbone \[force\].
    pub largest_net_force: f64,
    /// Part of the relative residual that rounding alone causes \[1\].
    pub rounding_floor: f64,
    /// Cost of the relaxation.
    pub cost: Cost,
}

/// Summary of an inflation.
#[derive(Debug, Clone, Serialize)]
pub struct InflationSummary {
    /// Label of the inflated disk.
    pub centre_label: u64,
    /// Its radius before, a \[length\].
    pub inner_radius: f64,
    /// R, the radius of the rim \[length\].
    pub outer_radius: f64,
    /// Number of mobile disks.
    pub mobile_count: usize,
    /// State before.
    pub before: StateSummary,
    /// State after.
    pub after: StateSummary,
    /// State after the deflation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deflated: Option<StateSummary>,
    /// Δp = p_after − p_before \[force / length\].
    pub pressure_change: f64,
    /// Δp / p^((α−2)/(α−1)) \[(force / length)^(1/(α−1))\], absent for an unjammed packing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scaled_pressure_change: Option<f64>,
}

/// Summary of one state of an inflation.
#[derive(Debug, Clone, Serialize)]
pub struct StateSummary {
    /// Pressure of the circle or the box \[force / length\].
    pub pressure: f64,
    /// Elastic energy \[energy\].
    pub energy: f64,
    /// Number of contacts.
    pub contact_count: usize,
    /// Number of rattlers.
    pub rattler_count: usize,
    /// Quality of its equilibrium.
    pub rest: RestSummary,
    /// Its certificate.
    pub certificate: Certificate,
}
