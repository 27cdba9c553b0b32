//! The results of a measurement: a report of samples, a sample of runs.

use serde::Serialize;

use crate::precision::ladder::{Method, Varied};
use crate::precision::minima::{Disagreement, Minimum};
use crate::precision::numerical_choices::ChoiceTable;
use crate::precision::settings::PrecisionSettings;
use crate::precision::state::Errors;
use crate::relax::{Cost, Criterion, Stop};
use crate::scene::Scene;

/// The cost of accuracy, for the samples of a scene.
#[derive(Debug, Clone, Serialize)]
pub struct PrecisionReport {
    /// Version of jamscope that ran it.
    pub jamscope_version: &'static str,
    /// The scene, including all defaults.
    pub scene: Scene,
    /// The ladders.
    pub settings: PrecisionSettings,
    /// One entry per sample.
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
    /// Whether no disk is pressed. There is then no unique minimum, and errors are distances between end states.
    pub unjammed: bool,
    /// Comparison of the references.
    pub references: Disagreement,
    /// The minima in which runs ended, references first.
    pub minima: Vec<Minimum>,
    /// One entry per run.
    pub runs: Vec<Run>,
    /// The effect of other numerical choices.
    pub choices: Vec<ChoiceTable>,
}

/// One run.
#[derive(Debug, Clone, Serialize)]
pub struct Run {
    /// The relaxer.
    pub method: Method,
    /// The setting that its ladder varies.
    pub varied: Varied,
    /// Its value \[1\].
    pub value: f64,
    /// Why it stopped.
    pub stop: Stop,
    /// Relative residual reached \[1\].
    pub residual: f64,
    /// Label of its minimum.
    pub minimum: String,
    /// Distance of that minimum from the nearest reference, 0 for a reference \[length\].
    pub minimum_distance: f64,
    /// Its errors relative to that minimum.
    pub errors: Errors,
    /// Wall time, the only number that differs between two measurements of one scene \[s\].
    pub seconds: f64,
    /// Cost of the relaxation.
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
