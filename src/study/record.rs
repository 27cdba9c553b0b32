//! [`Record`]: the results of a sample that a study keeps.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

#[cfg(feature = "fit")]
use crate::fit::angular::{CrossoverOutcome, SlopeOutcome};
use crate::inflation::{Boundary, InflationError};
use crate::law::choice::LawChoice;
use crate::observe::isostatic::IsostaticOutcome;
use crate::observe::multipoles::MultipoleFit;
use crate::packing::particles;
use crate::preparation::PreparationError;
use crate::relax::{RelaxerChoice, Stop};
use crate::response::{PhaseDecision, Response};
use crate::run::{RunError, SampleResult};
use crate::scene::Scene;
use crate::scene::reduced_pressure::{mobile_count, reduction};
use crate::scene::{is_plane, plane};
use crate::study::curves::curves;
use crate::study::plan::Task;
use crate::study::settings::Target;

/// The settings of samples that differ only in the seed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Dimension of space. Written if it is not 2.
    #[serde(default = "plane", skip_serializing_if = "is_plane")]
    pub dimension: usize,
    /// The contact law.
    pub law: LawChoice,
    /// Disks in the box.
    pub disk_count: usize,
    /// Target of the preparation.
    pub target: Target,
    /// d_0 \[length\].
    pub increase: f64,
    /// Relaxer after the inflation.
    pub relaxer: RelaxerChoice,
    /// The boundary.
    pub boundary: Boundary,
    /// Whether the inflated disk, or the row, is held. Written if it is free.
    #[serde(default = "held", skip_serializing_if = "is_held")]
    pub centre_held: bool,
}

fn held() -> bool {
    true
}

fn is_held(centre_held: &bool) -> bool {
    *centre_held
}

impl Cell {
    /// Whether two cells differ only in the target.
    pub fn differs_in_target_alone(&self, other: &Cell) -> bool {
        Cell { target: self.target, ..*other } == *self
    }

    /// Number of dimensions in which the response spreads: 1 in a strip.
    pub fn spreading_dimension(&self) -> usize {
        if self.boundary.is_strip() { 1 } else { self.dimension }
    }

    /// Whether its response scales with p̂: around a held disk or sphere, or in a periodic box.
    pub fn scales(&self) -> bool {
        !self.boundary.is_strip() && self.centre_held
    }

    /// Whether the published values apply: those of disks.
    pub fn is_published(&self) -> bool {
        self.dimension == 2 && self.scales()
    }

    /// What differs from a held disk, for descriptions: the shape of a strip, a free centre.
    pub fn drive_words(&self) -> String {
        let strip = match self.boundary {
            Boundary::HeldWalls { length_over_side, .. } => format!(", strip {length_over_side} times as long as wide"),
            Boundary::HeldRim { .. } | Boundary::Periodic => String::new(),
        };
        let free = match (self.centre_held, self.boundary) {
            (true, _) => "",
            (false, Boundary::HeldWalls { .. }) => ", free row",
            (false, _) => ", free centre",
        };
        strip + free
    }

    /// What its packings consist of: disks or spheres.
    pub fn particles(&self) -> &'static str {
        particles(self.dimension)
    }

    /// N, the number of disks in the circle by area (spheres in the shell by volume), or of the whole periodic box.
    pub fn mobile_count(&self) -> f64 {
        mobile_count(self.disk_count, self.boundary, self.dimension)
    }
}

/// The results of a sample that a study keeps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Its cell.
    pub cell: Cell,
    /// Its seed.
    pub seed: u64,
    /// Its outcome.
    pub outcome: RecordOutcome,
}

/// Outcome of a sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RecordOutcome {
    /// The sample was measured.
    Done {
        /// Its phase and the evidence for it.
        phase: PhaseDecision,
        /// Single numbers by name, in the units of the table of names in the book; numbers that the sample does not
        /// have are absent.
        numbers: BTreeMap<String, f64>,
        /// Curves by name, as pairs of abscissa and ordinate.
        curves: BTreeMap<String, Vec<[f64; 2]>>,
    },
    /// The sample failed.
    Failed {
        /// The type of failure.
        kind: FailureKind,
        /// The error message.
        reason: String,
    },
}

/// Type of failure of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FailureKind {
    /// The packing did not come to rest within the step limit.
    PreparationNotAtRest,
    /// No packing fraction gave the target pressure.
    PressureNotReached,
    /// The sample did not come to rest after the inflation.
    InflationNotAtRest,
    /// The time limit was reached.
    TimeLimit,
    /// Any other failure of the sample.
    Other,
}

impl FailureKind {
    /// A description in words.
    pub fn name(self) -> &'static str {
        match self {
            FailureKind::PreparationNotAtRest => "preparation not at rest",
            FailureKind::PressureNotReached => "pressure not reached",
            FailureKind::InflationNotAtRest => "inflation not at rest",
            FailureKind::TimeLimit => "time limit",
            FailureKind::Other => "other",
        }
    }

    fn of(error: &RunError) -> Self {
        let stopped = |stop: &Stop, kind| if *stop == Stop::Interrupted { FailureKind::TimeLimit } else { kind };
        match error {
            RunError::Preparation(PreparationError::NotAtRest { stop, .. }) => {
                stopped(stop, FailureKind::PreparationNotAtRest)
            }
            RunError::Preparation(PreparationError::PressureNotReached { .. }) => FailureKind::PressureNotReached,
            RunError::Inflation(InflationError::NotAtRest { stop, .. }) => {
                stopped(stop, FailureKind::InflationNotAtRest)
            }
            _ => FailureKind::Other,
        }
    }
}

impl Record {
    /// The record of one inflation of a task.
    pub(super) fn of(task: &Task, scene: &Scene, result: Result<&SampleResult, &RunError>) -> Self {
        let sample = &scene.sample[0];
        let (disk_count, increase) = (scene.disk_count, scene.inflation.increase);
        let boundary = scene.inflation.boundary;
        let cell = Cell {
            dimension: scene.dimension,
            law: scene.law,
            disk_count,
            target: task.target,
            increase,
            relaxer: sample.relaxer,
            boundary,
            centre_held: scene.inflation.centre_held,
        };
        let outcome = match result {
            Ok(result) => RecordOutcome::Done {
                phase: result.response.phase,
                numbers: Numbers::of(scene, result).0,
                curves: curves(scene, &result.response),
            },
            Err(error) => {
                let kind = FailureKind::of(error);
                // A time limit ends a sample at a point that depends on the machine, so its message is not recorded.
                let reason = match kind {
                    FailureKind::TimeLimit => "the time limit of the study was reached".into(),
                    _ => error.to_string(),
                };
                RecordOutcome::Failed { kind, reason }
            }
        };
        Record { cell, seed: sample.seed, outcome }
    }

    /// A number of a measured sample \[unit in the table of names in the book\].
    pub fn number(&self, name: &str) -> Option<f64> {
        match &self.outcome {
            RecordOutcome::Done { numbers, .. } => numbers.get(name).copied(),
            RecordOutcome::Failed { .. } => None,
        }
    }
}

/// Numbers by name; values that are not finite are left out.
struct Numbers(BTreeMap<String, f64>);

impl Numbers {
    fn put(&mut self, name: impl Into<String>, value: f64) {
        if value.is_finite() {
            self.0.insert(name.into(), value);
        }
    }

    fn maybe(&mut self, name: impl Into<String>, value: Option<f64>) {
        if let Some(value) = value {
            self.put(name, value);
        }
    }

    fn of(scene: &Scene, result: &SampleResult) -> Self {
        let mut all = Numbers(BTreeMap::new());
        let (packing, inflation) = (&result.packing, &result.inflation);
        all.put("packing_fraction", packing.packing_fraction);
        all.put("pressure", packing.pressure);
        all.put("reduced_pressure", packing.pressure * reduction(scene));
        all.put("coordination", packing.coordination);
        all.put("rattler_count", packing.rattler_count as f64);
        all.put("mobile_count", inflation.mobile_count as f64);
        all.put("outer_radius", inflation.outer_radius);
        all.put("pressure_before", inflation.before.pressure);
        all.put("pressure_change", inflation.pressure_change);
        all.maybe("scaled_pressure_change", inflation.scaled_pressure_change);
        all.put("relative_residual_before", inflation.before.rest.relative_residual);
        all.put("relative_residual_after", inflation.after.rest.relative_residual);
        #[cfg(feature = "linear")]
        all.maybe(
            "negative_eigenvalue_count",
            inflation.after.certificate.stability.negative_eigenvalue_count().map(|count| count as f64),
        );
        let evaluations = |cost: &crate::relax::Cost| cost.force_evaluation_count as f64;
        all.put("force_evaluations_preparation", evaluations(&packing.rest.cost));
        all.put("force_evaluations_inflation", evaluations(&inflation.after.rest.cost));
        all.response(&result.response);
        #[cfg(feature = "linear")]
        if let Some(plastic) = result.plastic_part.as_ref().and_then(|it| it.measured()) {
            all.put("plastic_share", plastic.share);
            all.put("plastic_participation_ratio", plastic.participation_ratio);
            all.maybe("first_opening", plastic.first_opening);
        }
        all
    }

    fn response(&mut self, response: &Response) {
        #[cfg(feature = "fit")]
        self.fits(response);
        if let Some(lengths) = response.penetration_lengths.as_ref().and_then(|it| it.measured()) {
            for length in lengths {
                self.maybe(format!("penetration_length_at_{}", length.threshold), length.penetration.radius());
            }
        }
        if let Some(ring) = response.angular_correlation.as_ref().and_then(|it| it.measured()) {
            self.put("anticorrelation", ring.correlation.anticorrelation);
            self.put("ring_disk_count", ring.spectrum.disk_count as f64);
            for crossing in &ring.correlation.crossings {
                self.maybe(format!("correlation_angle_at_{}", crossing.threshold), crossing.outcome.angle());
            }
        }
        if let Some(shell) = response.shell_correlation.as_ref().and_then(|it| it.measured()) {
            let of = &shell.analysis;
            self.maybe("anticorrelation", of.correlation.anticorrelation.map(|it| it.value));
            self.put("ring_disk_count", of.disk_count as f64);
            for crossing in &of.correlation.crossings {
                self.maybe(format!("correlation_angle_at_{}", crossing.threshold), crossing.outcome.angle());
            }
        }
        if let Some(multipoles) = response.multipoles.as_ref().and_then(|it| it.measured()) {
            // The ring nearest to half of the outer radius.
            let half = 0.5 * response.detail.radii()[1];
            let fitted = multipoles.rings.iter().filter_map(|ring| match &ring.fit {
                MultipoleFit::Fitted { radial, .. } => Some((ring.radius, radial.shares?)),
                _ => None,
            });
            let nearest = fitted.min_by(|a, b| (a.0 - half).abs().total_cmp(&(b.0 - half).abs()));
            if let Some((_, shares)) = nearest {
                for (name, share) in ["isotropic", "dipole", "quadrupole", "rest"].into_iter().zip(shares) {
                    self.put(format!("share_{name}"), share);
                }
            }
        }
        if let Some(contacts) = &response.contact_changes {
            self.put("contacts_kept", contacts.inflation.kept_count as f64);
            self.put("contacts_made", contacts.inflation.made_count as f64);
            self.put("contacts_broken", contacts.inflation.broken_count as f64);
            self.maybe("contacts_returned_share", contacts.deflation.and_then(|cycle| cycle.returned_share));
        }
        if let Some(isostatic) = response.isostatic_length.as_ref().and_then(|it| it.measured()) {
            self.maybe("excess_coordination", isostatic.excess);
            if let IsostaticOutcome::Reached { length, product, .. } = isostatic.outcome {
                self.put("isostatic_length", length);
                self.put("isostatic_product", product);
            }
        }
    }

    #[cfg(feature = "fit")]
    fn fits(&mut self, response: &Response) {
        use crate::fit::profile::Decision;

        if let Some(fit) = response.profile_fit.as_ref().and_then(|it| it.measured()) {
            self.put("elastic_amplitude", fit.elastic.amplitude.value);
            self.put("elastic_share_described", fit.elastic.share_described);
            self.maybe("wavenumber_bound", fit.elastic.wavenumber_bound);
            self.maybe("screened_share_described", fit.screened.map(|screened| screened.share_described));
            self.maybe("chance_of_elastic", fit.screened.map(|screened| screened.chance_of_elastic));
            // κ of the best fit; 0 if no κ above 0 fits better.
            self.put("wavenumber", fit.screened.map_or(0.0, |screened| screened.wavenumber.value));
            self.maybe("wavenumber_error", fit.screened.map(|screened| screened.wavenumber.standard_error));
            self.maybe("screened_amplitude", fit.screened.map(|screened| screened.amplitude.value));
            self.put("decided_screened", f64::from(u8::from(fit.decision == Decision::Screened)));
            self.put("decided_elastic", f64::from(u8::from(fit.decision == Decision::Elastic)));
        }
        let ring = response.angular_correlation.as_ref().and_then(|it| it.measured());
        let shell = response.shell_correlation.as_ref().and_then(|it| it.measured());
        let slope = ring.and_then(|ring| ring.slope.as_ref()).or(shell.and_then(|shell| shell.slope.as_ref()));
        let crossover = ring.and_then(|ring| ring.crossover.as_ref());
        let crossover = crossover.or(shell.and_then(|shell| shell.crossover.as_ref()));
        if let Some(slope) = slope.and_then(|it| it.measured())
            && slope.outcome != SlopeOutcome::Undetermined
        {
            self.put("spectrum_slope", slope.exponent.best);
        }
        if let Some(crossover) = crossover.and_then(|it| it.measured()) {
            match crossover.outcome {
                CrossoverOutcome::Found { crossover, angle } => {
                    self.put("crossover", crossover.best);
                    self.put("crossover_angle", angle.best);
                    self.put("spectrum_is_scale_free", 0.0);
                }
                CrossoverOutcome::ScaleFree { .. } => self.put("spectrum_is_scale_free", 1.0),
                CrossoverOutcome::White { .. } => self.put("spectrum_is_scale_free", 0.0),
                CrossoverOutcome::Undetermined => {}
            }
        }
        if let Some(modes) = response.elastic_modes.as_ref().and_then(|it| it.measured()) {
            for mode in &modes.modes {
                self.maybe(format!("elastic_share_of_mode_{}", mode.mode), mode.share_described);
            }
        }
    }
}
