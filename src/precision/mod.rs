//! What accuracy costs: [`measure`] relaxes one inflated packing by every relaxer at a ladder of settings and holds each end
//! against a state known to rounding.
//!
//! ```text
//! error of a run = |its state − the minimum it belongs to|      against seconds, force evaluations, factorisations
//! ```
//!
//! The minimum is known by two methods that share nothing but the forces: implicit dynamics at a tight tolerance (A) and FIRE
//! (B), both finished by Newton; how far they disagree is stated. A run may have fallen into another minimum, which is no lack
//! of precision. So each end is followed by gradient flow to the minimum it belongs to. Where that is A or B, errors are those
//! against A or B; where it is another, they are against that one, and its distance from the nearest reference is told beside.
//!
//! The relaxations are timed one after the other, each on one thread.

pub mod choices;
pub mod csv;
#[cfg(feature = "plot")]
pub mod figure;
mod files;
pub mod ladder;
pub mod minima;
#[cfg(feature = "plot")]
pub mod page;
pub mod state;
pub mod table;

use serde::{Deserialize, Serialize};

use crate::contact::damping::DampingChoice;
use crate::contact::{LawChoice, OnSite, PairLaw};
use crate::inflation::{Grown, InflationError};
use crate::packing::{Packing, PackingError};
use crate::relax::{Cost, Criterion, RelaxerChoice, Stop};
use crate::run::{RunError, packing_of};
use crate::scene::{Sample, Scene, SceneError};

pub use files::write;

use choices::{ChoiceTable, choice_tables};
use ladder::{Method, Rung, Varied, rungs};
use minima::{Disagreement, End, Minima, Minimum};
use state::Errors;

/// The ladders.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PrecisionSettings {
    /// Force limits, over the mean contact force \[1\].
    pub force_limits: Vec<f64>,
    /// Time steps of damped dynamics, over the bound on a stable one \[1\].
    pub time_steps: Vec<f64>,
    /// Tolerances of the implicit motions, over the mean overlap \[1\].
    pub tolerances: Vec<f64>,
    /// Steps allowed to the relaxers that take one or two force evaluations a step.
    pub explicit_step_limit: usize,
    /// Steps allowed to an implicit motion that finishes by its own steps.
    pub implicit_step_limit: usize,
    /// Force limit of the references, over the mean contact force \[1\].
    pub reference_limit: f64,
}

impl Default for PrecisionSettings {
    fn default() -> Self {
        PrecisionSettings {
            force_limits: vec![1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12],
            time_steps: vec![0.45, 0.225],
            tolerances: vec![0.3, 0.1, 0.03, 0.01, 0.003],
            explicit_step_limit: 50_000,
            implicit_step_limit: 2000,
            reference_limit: 1e-13,
        }
    }
}

/// Why there is nothing to compare.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PrecisionError {
    /// The scene makes no sense.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A ladder holds a number that makes no sense.
    #[error("{field} = {value}: must be a positive, finite number")]
    NotPositive {
        /// The field of the settings.
        field: &'static str,
        /// The value.
        value: f64,
    },
    /// A ladder is empty.
    #[error("{field} is empty")]
    Empty {
        /// The field of the settings.
        field: &'static str,
    },
    /// The packing of a sample, or its inflation, could not be had.
    #[error("sample \"{name}\": {source}")]
    Sample {
        /// The sample.
        name: String,
        /// Why.
        source: RunError,
    },
}

/// Steps allowed to an implicit motion of an unjammed packing, whose disks fly until they hit nothing any more.
const FLIGHT_LIMIT: usize = 100;

impl PrecisionSettings {
    /// The ladders of an unjammed packing: there every limit relative to contact forces is met at once, when these are gone.
    fn where_nothing_presses(&self) -> Self {
        PrecisionSettings {
            force_limits: vec![self.force_limits.iter().copied().fold(f64::INFINITY, f64::min)],
            time_steps: Vec::new(),
            tolerances: self.tolerances.iter().copied().take(1).collect(),
            implicit_step_limit: self.implicit_step_limit.min(FLIGHT_LIMIT),
            ..self.clone()
        }
    }

    /// Whether every number makes sense.
    ///
    /// # Errors
    /// [`PrecisionError`] names the field and the value.
    pub fn check(&self) -> Result<(), PrecisionError> {
        let ladders =
            [("force_limits", &self.force_limits), ("time_steps", &self.time_steps), ("tolerances", &self.tolerances)];
        for (field, ladder) in ladders {
            if let Some(&value) = ladder.iter().find(|&&value| !(value.is_finite() && value > 0.0)) {
                return Err(PrecisionError::NotPositive { field, value });
            }
        }
        if self.force_limits.is_empty() {
            return Err(PrecisionError::Empty { field: "force_limits" });
        }
        let value = self.reference_limit;
        if !(value.is_finite() && value > 0.0) {
            return Err(PrecisionError::NotPositive { field: "reference_limit", value });
        }
        Ok(())
    }
}

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

/// What a measurement tells while it works; `()` hears nothing.
pub trait Progress: Sync {
    /// A sample of so many runs begins; its packing is there.
    fn sample(&self, name: &str, run_count: usize) {
        let _ = (name, run_count);
    }
    /// A piece of work of that sample begins, `done` runs of it being over.
    fn begins(&self, done: usize, what: &str) {
        let _ = (done, what);
    }
}

impl Progress for () {}

/// Measures every sample of a scene.
///
/// # Errors
/// Scene or settings that make no sense; a sample whose packing or inflation cannot be had. A run that does not converge is a
/// result.
///
/// # Cost
/// See the book.
pub fn measure(
    scene: &Scene,
    settings: &PrecisionSettings,
    progress: &impl Progress,
) -> Result<PrecisionReport, PrecisionError> {
    scene.check()?;
    settings.check()?;
    let named = |sample: &Sample, source| PrecisionError::Sample { name: sample.name.clone(), source };
    let mut samples = Vec::new();
    for (sample, packing) in scene.sample.iter().zip(packings(scene)) {
        let packing = packing.map_err(|source| named(sample, source))?;
        let measured = match scene.law {
            LawChoice::Hertzian(law) => of_sample(scene, sample, &packing, &law, settings, progress),
            LawChoice::Hookean(law) => of_sample(scene, sample, &packing, &law, settings, progress),
            LawChoice::PowerLaw(law) => of_sample(scene, sample, &packing, &law, settings, progress),
        };
        samples.push(measured.map_err(|source| named(sample, source))?);
    }
    let (scene, settings) = (scene.clone(), settings.clone());
    Ok(PrecisionReport { jamscope_version: env!("CARGO_PKG_VERSION"), scene, settings, samples })
}

/// The packings of all samples: the only part that is not timed, so they are made side by side.
fn packings(scene: &Scene) -> Vec<Result<Packing<2>, RunError>> {
    let one = |sample: &Sample| match scene.law {
        LawChoice::Hertzian(law) => packing_of(scene, sample, &law, &mut ()).map(|(packing, _)| packing),
        LawChoice::Hookean(law) => packing_of(scene, sample, &law, &mut ()).map(|(packing, _)| packing),
        LawChoice::PowerLaw(law) => packing_of(scene, sample, &law, &mut ()).map(|(packing, _)| packing),
    };
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        scene.sample.par_iter().with_max_len(1).map(one).collect()
    }
    #[cfg(not(feature = "parallel"))]
    scene.sample.iter().map(one).collect()
}

fn of_sample<L: PairLaw>(
    scene: &Scene,
    sample: &Sample,
    packing: &Packing<2>,
    law: &L,
    settings: &PrecisionSettings,
    progress: &impl Progress,
) -> Result<SamplePrecision, RunError> {
    match scene.inflation.on_site_coupling {
        None => with_law(scene, sample, packing, law, settings, progress),
        Some(coupling) if coupling.is_finite() => {
            with_law(scene, sample, packing, &OnSite { law: *law, coupling }, settings, progress)
        }
        Some(coupling) => Err(InflationError::CouplingNotFinite { coupling }.into()),
    }
}

fn with_law<L: PairLaw>(
    scene: &Scene,
    sample: &Sample,
    packing: &Packing<2>,
    law: &L,
    settings: &PrecisionSettings,
    progress: &impl Progress,
) -> Result<SamplePrecision, RunError> {
    let damping = damping_of(&sample.relaxer);
    let grown = Grown::new(&scene.inflation, packing, law, &sample.relaxer, sample.seed, &mut ())?;
    let rungs = if grown.before.criterion == Criterion::Unjammed {
        rungs(&settings.where_nothing_presses(), damping)
    } else {
        rungs(settings, damping)
    };
    progress.sample(&sample.name, rungs.len());
    progress.begins(0, "references");
    let mut minima = Minima::new(&grown, law, &scene.observables, damping, settings.reference_limit)?;
    let mut runs: Vec<Run> = Vec::new();
    for (done, rung) in rungs.iter().enumerate() {
        let what = format!("{}, {} {:e}", rung.method.name(), rung.varied.name(), rung.value);
        progress.begins(done, &what);
        let run = match runs.last().filter(|last| would_end_alike(last, rung)) {
            Some(last) => Run { value: rung.value, ..last.clone() },
            None => run_of(rung, &what, &grown, law, scene, &mut minima)?,
        };
        runs.push(run);
    }
    progress.begins(rungs.len(), "other choices");
    let choices = choice_tables(minima.first(), &grown, law, damping, &scene.observables)?;
    Ok(SamplePrecision {
        name: sample.name.clone(),
        mobile_count: grown.mobile_count,
        pressure: grown.before.pressure,
        unjammed: minima.first().is_unjammed(),
        references: minima.disagreement,
        minima: minima.known,
        runs,
        choices,
    })
}

/// Why a run stopped, in words.
fn stop_name(stop: Stop) -> String {
    match stop {
        Stop::Converged(Criterion::Unjammed) => "unjammed".into(),
        Stop::Converged(_) => "force limit".into(),
        Stop::StepLimit => "step limit".into(),
        Stop::RoundingFloor => "rounding".into(),
        Stop::NoDescent => "no descent".into(),
        other => format!("{other:?}"),
    }
}

/// The damping of the sample's own dynamics, the default where it is not relaxed by one.
fn damping_of(relaxer: &RelaxerChoice) -> DampingChoice {
    match relaxer {
        RelaxerChoice::Damped(dynamics) => dynamics.damping,
        RelaxerChoice::Implicit(dynamics) => dynamics.damping,
        _ => DampingChoice::default(),
    }
}

/// Whether a run needs not be made: one that used up its steps does so at a tighter limit too, on the same way.
fn would_end_alike(last: &Run, rung: &Rung) -> bool {
    last.stop == Stop::StepLimit
        && (last.method, last.varied) == (rung.method, rung.varied)
        && rung.varied == Varied::ForceLimit
        && rung.value < last.value
}

fn run_of<L: PairLaw>(
    rung: &Rung,
    what: &str,
    grown: &Grown<2>,
    law: &L,
    scene: &Scene,
    minima: &mut Minima<'_, L>,
) -> Result<Run, PackingError> {
    let outcome = grown.relax(grown.packing.clone(), law, &rung.relaxer, &mut ())?;
    let cost = outcome.cost;
    let end = End::new(outcome, grown, law, &scene.observables)?;
    let minimum = minima.of(&end.state, what)?;
    Ok(Run {
        method: rung.method,
        varied: rung.varied,
        value: rung.value,
        stop: end.stop,
        residual: end.residual,
        minimum: minima.known[minimum].label.clone(),
        minimum_distance: minima.known[minimum].distance,
        errors: minima.errors(&end.state, minimum),
        seconds: cost.seconds,
        cost,
    })
}
