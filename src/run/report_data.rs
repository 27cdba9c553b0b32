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
use crate::response::{PhaseFrequency, Response};
use crate::scene::Scene;
use crate::verdict::RestVerdict;

/// What a run gives.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Version of jamscope that made it.
    pub jamscope_version: &'static str,
    /// Vector instructions of the processor that made it: what goes through a factorisation has other last digits with others.
    pub vectors: Vectors,
    /// The scene, all defaults filled in.
    pub scene: Scene,
    /// One entry a sample, in the order of the scene.
    pub samples: Vec<SampleReport>,
    /// What the samples whose protocols were compared say together.
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
    /// What came out, or why nothing did.
    #[serde(flatten)]
    pub result: SampleOutcome,
}

/// What came out of a sample, or why nothing did.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleOutcome {
    /// All stages done.
    Done(Box<SampleResult>),
    /// A stage failed, in its own words.
    Failed(String),
}

/// What came out of a sample.
#[derive(Debug, Clone, Serialize)]
pub struct SampleResult {
    /// The packing before anything is cut or inflated.
    pub packing: PackingSummary,
    /// The inflation.
    pub inflation: InflationSummary,
    /// All that is measured on it.
    #[serde(flatten)]
    pub response: Response,
    /// How often samples of an ensemble like this one are called what it is called.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase_frequency: Option<PhaseFrequency>,
    /// What of the response is not in the linear one.
    #[cfg(feature = "linear")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plastic_part: Option<Measurement<PlasticSummary>>,
    /// Whether other relaxers end in the same minimum.
    #[cfg(feature = "linear")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub protocol: Option<Measurement<Box<ProtocolSensitivity>>>,
    /// What the deflation leaves of it.
    #[serde(skip)]
    pub cycle_field: Option<DisplacementField<2>>,
    /// The states themselves.
    #[serde(skip)]
    pub inflated: Inflated<2>,
    /// The packing itself.
    #[serde(skip)]
    pub prepared: Packing<2>,
}

/// The plastic part in numbers: what of the response is not in the linear one.
#[cfg(feature = "linear")]
#[derive(Debug, Clone, Serialize)]
pub struct PlasticSummary {
    /// √(Σ |d − d_0 u|²) over the disks that count \[length\].
    pub norm: f64,
    /// The same over that of the response \[1\].
    pub share: f64,
    /// Participation ratio, 1 where all disks take part alike \[1\].
    pub participation_ratio: f64,
    /// Mean radial part in rings.
    pub radial_profile: RadialProfile,
    /// d_0 at which the linear response would open its first contact; absent if it opens none \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_opening: Option<f64>,
    /// Δp of the linear response \[force / length\].
    pub linear_pressure_change: f64,
    /// Negative eigenvalues of the Hessian before: 0 proves a minimum.
    pub negative_eigenvalue_count: usize,
    /// Backward error of the linear response \[1\].
    pub backward_error: f64,
}

/// A packing in numbers.
#[derive(Debug, Clone, Serialize)]
pub struct PackingSummary {
    /// Number of disks.
    pub disk_count: usize,
    /// Sides of the box \[length\].
    pub box_sides: [f64; 2],
    /// Packing fraction \[1\].
    pub packing_fraction: f64,
    /// Packing fraction at which random points were quenched; absent for a packing from a file \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quench_packing_fraction: Option<f64>,
    /// Whether a packing from a file was at rest as it was read; absent for a packing made here.
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
    /// How well it is at rest.
    pub rest: RestSummary,
    /// What is known of it.
    pub certificate: Certificate,
}

/// How well a state is at rest.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct RestSummary {
    /// Which limit was met.
    pub criterion: Criterion,
    /// Largest net force on the backbone over the mean contact force \[1\].
    pub relative_residual: f64,
    /// Largest net force on the backbone \[force\].
    pub largest_net_force: f64,
    /// What rounding alone makes of the relative residual \[1\].
    pub rounding_floor: f64,
    /// What it cost.
    pub cost: Cost,
}

/// An inflation in numbers.
#[derive(Debug, Clone, Serialize)]
pub struct InflationSummary {
    /// Label of the inflated disk.
    pub centre_label: u64,
    /// Its radius before, a \[length\].
    pub inner_radius: f64,
    /// r_out, R \[length\].
    pub outer_radius: f64,
    /// Number of mobile disks.
    pub mobile_count: usize,
    /// Before.
    pub before: StateSummary,
    /// After.
    pub after: StateSummary,
    /// After the deflation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deflated: Option<StateSummary>,
    /// Δp = p_after − p_before \[force / length\].
    pub pressure_change: f64,
    /// Δp / p^((α−2)/(α−1)) \[(force / length)^(1/(α−1))\], absent for an unjammed packing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scaled_pressure_change: Option<f64>,
}

/// One state of an inflation in numbers.
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
    /// How well it is at rest.
    pub rest: RestSummary,
    /// What is known of it.
    pub certificate: Certificate,
}
