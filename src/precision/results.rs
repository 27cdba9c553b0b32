//! What a measurement gives: a report of samples, a sample of runs.

use serde::Serialize;

use crate::precision::choices::ChoiceTable;
use crate::precision::ladder::{Method, Varied};
use crate::precision::minima::{Disagreement, Minimum};
use crate::precision::settings::PrecisionSettings;
use crate::precision::state::Errors;
use crate::relax::{Cost, Criterion, Stop};
use crate::scene::Scene;

/// What accuracy costs, for the samples of a scene.
#[derive(Debug, Clone, Serialize)]
pub struct PrecisionReport {
    /// Version of jamscope that made it.
    pub jamscope_version: &'static str,
    /// The scene, all defaults filled in.
    pub scene: Scene,
    /// The ladders.
    pub settings: PrecisionSettings,
    /// One entry a sample.
    pub samples: Vec<SamplePrecision>,
}

/// One sample.
#[derive(Debug, Clone, Serialize)]
pub struct SamplePrecision {
    /// Its name.
    pub name: String,
    /// Number of mobile disks.
    pub mobile_count: usize,
    /// Pressure before the inflation \[force / length\].
    pub pressure: f64,
    /// Whether nothing presses the disks: then there is no minimum of its own to be found, and errors say how far two ends lie
    /// apart.
    pub unjammed: bool,
    /// The references against each other.
    pub references: Disagreement,
    /// The minima in which runs ended, references first.
    pub minima: Vec<Minimum>,
    /// One entry a run.
    pub runs: Vec<Run>,
    /// What other numerical choices move.
    pub choices: Vec<ChoiceTable>,
}

/// One run.
#[derive(Debug, Clone, Serialize)]
pub struct Run {
    /// The relaxer.
    pub method: Method,
    /// The setting its ladder varies.
    pub varied: Varied,
    /// The value of that \[1\].
    pub value: f64,
    /// Why it stopped.
    pub stop: Stop,
    /// Relative residual reached \[1\].
    pub residual: f64,
    /// The minimum it belongs to, by its label.
    pub minimum: String,
    /// Distance of that minimum from the nearest reference, 0 for a reference \[length\].
    pub minimum_distance: f64,
    /// Its errors against that minimum.
    pub errors: Errors,
    /// Wall time, the only number in which two measurements of one scene differ \[s\].
    pub seconds: f64,
    /// What it cost.
    pub cost: Cost,
}

/// Why a run stopped, in words.
pub(super) fn stop_name(stop: Stop) -> String {
    match stop {
        Stop::Converged(Criterion::Unjammed) => "unjammed".into(),
        Stop::Converged(_) => "force limit".into(),
        Stop::StepLimit => "step limit".into(),
        Stop::RoundingFloor => "rounding".into(),
        Stop::NoDescent => "no descent".into(),
        Stop::Interrupted => "interrupted".into(),
        other => format!("{other:?}"),
    }
}
