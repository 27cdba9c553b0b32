//! [`Study`]: the parameters that are varied, as plain data.

use serde::{Deserialize, Serialize};

use crate::inflation::Boundary;
use crate::law::choice::LawChoice;
use crate::memory::{Limit, TooLarge};
use crate::relax::RelaxerChoice;
use crate::scene::reduced_pressure::reduction;
use crate::scene::{NotWritable, ProtocolChoice, Sample, Scene, SceneError, Source, finite_numbers};

/// A scene and the lists of its varied parameters.
///
/// In a file, `protocol` may stand in place of `relaxers`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Study {
    /// Common settings of all samples. It contains no samples; the lists define them.
    pub scene: Scene,
    /// Numbers of disks in the box; if empty, that of the scene.
    pub disk_counts: Vec<usize>,
    /// Pressures, reduced pressures or packing fractions.
    pub targets: Vec<Target>,
    /// Increases d_0; if empty, that of the scene \[length\].
    pub increases: Vec<f64>,
    /// Whether the inflated disk is held, one inflation for each value; if empty, as in the scene.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub centres_held: Vec<bool>,
    /// Contact laws; if empty, that of the scene.
    pub laws: Vec<LawChoice>,
    /// Relaxers after the inflation; if empty, that of the default [`ProtocolChoice`].
    pub relaxers: Vec<RelaxerChoice>,
    /// Samples of every combination.
    pub seeds: Seeds,
    /// Parts, run one after the other, each with its own lists; if empty, the lists above are the only ones.
    #[serde(rename = "part", skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<Part>,
    /// Time limit of a packing and its inflations \[s\]; if absent, unlimited. Samples beyond it are recorded as
    /// failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_limit: Option<f64>,
}

/// A part of a study; its lists replace those of the study.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Part {
    /// Numbers of disks in the box; if empty, those of the study.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub disk_counts: Vec<usize>,
    /// Pressures, reduced pressures or packing fractions; if empty, those of the study.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub targets: Vec<Target>,
    /// Increases d_0; if empty, those of the study \[length\].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub increases: Vec<f64>,
    /// Contact laws; if empty, those of the study.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub laws: Vec<LawChoice>,
    /// Relaxers; if empty, those of the study.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub relaxers: Vec<RelaxerChoice>,
    /// Samples of every combination; if absent, those of the study.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seeds: Option<Seeds>,
    /// The boundary; if absent, that of the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub boundary: Option<Boundary>,
}

/// Target of the preparation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// p \[force / length\].
    Pressure(f64),
    /// p̂ = p N^(α−1), N the number of disks in the circle by area, α the exponent of the law \[force / length\].
    ReducedPressure(f64),
    /// φ at the quench \[1\].
    PackingFraction(f64),
}

impl Target {
    /// Its name in a table, and its value \[force / length for a pressure, 1 for a packing fraction\].
    pub fn name_and_value(self) -> (&'static str, f64) {
        match self {
            Target::Pressure(value) => ("pressure", value),
            Target::ReducedPressure(value) => ("reduced_pressure", value),
            Target::PackingFraction(value) => ("packing_fraction", value),
        }
    }
}

/// One inflation of a packing.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellInflation {
    pub increase: f64,
    pub centre_held: bool,
    pub relaxer: RelaxerChoice,
}

/// Consecutive seeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Seeds {
    /// The first seed.
    pub first: u64,
    /// Number of seeds.
    pub count: usize,
}

impl Default for Study {
    /// The size and the law of the built-in scene at p = 10, one sample.
    fn default() -> Self {
        Study {
            scene: Scene { sample: Vec::new(), ..Scene::default() },
            disk_counts: Vec::new(),
            targets: vec![Target::Pressure(10.0)],
            increases: Vec::new(),
            centres_held: Vec::new(),
            laws: Vec::new(),
            relaxers: Vec::new(),
            seeds: Seeds { first: 1, count: 1 },
            parts: Vec::new(),
            time_limit: None,
        }
    }
}

/// An invalid study.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A sample of the study is invalid.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// A number cannot be written to a file and read back.
    #[error(transparent)]
    NotWritable(#[from] NotWritable),
    /// The number of packings is too large.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// The scene of the study contains samples.
    #[error("scene.sample: must be absent in a study, whose samples come from its lists")]
    SamplesNamed,
    /// The statistics of a study are those of inflations.
    #[error(
        "scene.inflation.drive: a study inflates, and compares with the published transition of inflations; several packings under another drive are the samples of one scene"
    )]
    OfInflations,
    /// A list is empty.
    #[error("{list}: must not be empty")]
    Empty {
        /// The list.
        list: &'static str,
    },
    /// A number is outside its range.
    #[error("{field} = {value}: must be a positive number")]
    NotPositive {
        /// The field.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// A list contains a value twice.
    #[error("{list}: {value} occurs twice")]
    Twice {
        /// The list.
        list: &'static str,
        /// The value.
        value: String,
    },
    /// Two parts contain the same packing.
    #[error("part {part}: {disk_count} disks at {target:?} with seed {seed} are already in an earlier part")]
    PartsOverlap {
        /// The later part, from 1.
        part: usize,
        /// Number of disks of the packing.
        disk_count: usize,
        /// Its target.
        target: Target,
        /// Its seed.
        seed: u64,
    },
    /// A seed exceeds the largest integer.
    #[error("seeds: {count} seeds from {first} on go beyond the largest seed")]
    SeedsTooLarge {
        /// The first seed.
        first: u64,
        /// Number of seeds.
        count: usize,
    },
}

/// Largest number of packings: each has a file in one folder, and the whole plan is in memory.
const MOST_PACKINGS: Limit =
    Limit { largest: 1_000_000, reason: "a study has at most a million packings, with one file each" };

/// Memory of a task of the plan and of its file name \[bytes\].
const BYTES_A_PACKING: f64 = 256.0;

impl Study {
    /// Sets the number of seeds in every part; the first seed stays.
    pub fn set_seed_count(&mut self, count: usize) {
        self.seeds.count = count;
        self.parts.iter_mut().filter_map(|part| part.seeds.as_mut()).for_each(|seeds| seeds.count = count);
    }

    /// Checks the study and every sample of it.
    ///
    /// # Errors
    /// [`StudyError`] with list or field and value.
    pub fn check(&self) -> Result<(), StudyError> {
        if !self.scene.sample.is_empty() {
            return Err(StudyError::SamplesNamed);
        }
        if !self.scene.inflation.drive.is_inflation() {
            return Err(StudyError::OfInflations);
        }
        if let Some(value) = self.time_limit.filter(|value| value.is_nan() || *value <= 0.0) {
            return Err(StudyError::NotPositive { field: "time_limit", value });
        }
        let parts = self.parted();
        parts.iter().try_for_each(Study::check_lists)?;
        // The lists are not empty, so their lengths multiply to the number of packings.
        let mut others = 0;
        for part in &parts {
            let count = part.packing_count();
            if count > MOST_PACKINGS.largest as usize - others {
                return Err(part.too_many(others).into());
            }
            others += count;
        }
        // Fields that no rule above checks, such as new ones.
        Ok(finite_numbers::check(self)?)
    }

    /// Number of packings of a study without parts.
    fn packing_count(&self) -> usize {
        self.combination_count().saturating_mul(self.seeds.count)
    }

    /// Number of combinations of all lists except the seeds.
    fn combination_count(&self) -> usize {
        let lists = [self.laws.len().max(1), self.disk_counts.len().max(1), self.targets.len()];
        lists.into_iter().fold(1, usize::saturating_mul)
    }

    /// The error for a part with too many packings, given the number of the others.
    fn too_many(&self, others: usize) -> TooLarge {
        let combinations = self.combination_count();
        let largest = (MOST_PACKINGS.largest - others as u64) / combinations as u64;
        TooLarge {
            field: "seeds.count".into(),
            value: self.seeds.count,
            limit: largest,
            reason: MOST_PACKINGS.reason,
            bytes: self.seeds.count as f64 * combinations as f64 * BYTES_A_PACKING,
        }
    }

    /// The parts as studies without parts; the study itself if it has no parts.
    pub(super) fn parted(&self) -> Vec<Study> {
        if self.parts.is_empty() {
            return vec![self.clone()];
        }
        fn or<T: Clone>(own: &[T], common: &[T]) -> Vec<T> {
            if own.is_empty() { common.to_vec() } else { own.to_vec() }
        }
        let study = |part: &Part| {
            let mut scene = self.scene.clone();
            scene.inflation.boundary = part.boundary.unwrap_or(scene.inflation.boundary);
            Study {
                scene,
                disk_counts: or(&part.disk_counts, &self.disk_counts),
                targets: or(&part.targets, &self.targets),
                increases: or(&part.increases, &self.increases),
                centres_held: self.centres_held.clone(),
                laws: or(&part.laws, &self.laws),
                relaxers: or(&part.relaxers, &self.relaxers),
                seeds: part.seeds.unwrap_or(self.seeds),
                parts: Vec::new(),
                time_limit: self.time_limit,
            }
        };
        self.parts.iter().map(study).collect()
    }

    fn check_lists(&self) -> Result<(), StudyError> {
        for (list, empty) in [("targets", self.targets.is_empty()), ("seeds.count", self.seeds.count == 0)] {
            if empty {
                return Err(StudyError::Empty { list });
            }
        }
        let Seeds { first, count } = self.seeds;
        if first.checked_add(count as u64).is_none() {
            return Err(StudyError::SeedsTooLarge { first, count });
        }
        for target in &self.targets {
            if let Target::ReducedPressure(value) = *target
                && !(value > 0.0 && value.is_finite())
            {
                return Err(StudyError::NotPositive { field: "targets.reduced_pressure", value });
            }
        }
        twice("disk_counts", &self.disk_counts, usize::to_string)?;
        twice("targets", &self.targets, |target| format!("{target:?}"))?;
        twice("increases", &self.increases, f64::to_string)?;
        twice("centres_held", &self.centres_held, bool::to_string)?;
        twice("laws", &self.laws, |law| law.name().to_string())?;
        twice("relaxers", &self.relaxers, RelaxerChoice::description)?;
        // One scene for every combination except the seeds.
        for law in self.laws() {
            for disk_count in self.disk_counts() {
                for target in &self.targets {
                    for drive in self.inflations(*target) {
                        self.scene_of(law, disk_count, *target, drive, first).check()?;
                    }
                }
            }
        }
        Ok(())
    }

    /// The laws; that of the scene if the list is empty.
    pub(super) fn laws(&self) -> Vec<LawChoice> {
        if self.laws.is_empty() { vec![self.scene.law] } else { self.laws.clone() }
    }

    /// The sizes.
    pub(super) fn disk_counts(&self) -> Vec<usize> {
        if self.disk_counts.is_empty() { vec![self.scene.disk_count] } else { self.disk_counts.clone() }
    }

    /// The inflations.
    fn increases(&self) -> Vec<f64> {
        if self.increases.is_empty() { vec![self.scene.inflation.increase] } else { self.increases.clone() }
    }

    /// The inflations of a packing: every increase, centre held or free, and relaxer.
    pub(super) fn inflations(&self, target: Target) -> Vec<CellInflation> {
        let held = if self.centres_held.is_empty() {
            vec![self.scene.inflation.centre_held]
        } else {
            self.centres_held.clone()
        };
        let relaxers = self.relaxers(target);
        let mut inflations = Vec::new();
        for increase in self.increases() {
            for &centre_held in &held {
                inflations.extend(relaxers.iter().map(|&relaxer| CellInflation { increase, centre_held, relaxer }));
            }
        }
        inflations
    }

    /// The relaxers of a target.
    fn relaxers(&self, target: Target) -> Vec<RelaxerChoice> {
        if !self.relaxers.is_empty() {
            return self.relaxers.clone();
        }
        let protocol = ProtocolChoice::default();
        match target {
            Target::PackingFraction(fraction) => {
                vec![protocol.relaxer_in(self.scene.dimension, &Source::PackingFraction(fraction))]
            }
            Target::Pressure(_) | Target::ReducedPressure(_) => vec![protocol.relaxer()],
        }
    }

    /// The scene of one sample.
    pub(super) fn scene_of(
        &self,
        law: LawChoice,
        disk_count: usize,
        target: Target,
        CellInflation { increase, centre_held, relaxer }: CellInflation,
        seed: u64,
    ) -> Scene {
        let mut scene = Scene { law, disk_count, ..self.scene.clone() };
        scene.inflation.increase = increase;
        scene.inflation.centre_held = centre_held;
        let source = match target {
            Target::Pressure(pressure) => Source::Pressure(pressure),
            Target::ReducedPressure(reduced) => Source::Pressure(reduced / reduction(&scene)),
            Target::PackingFraction(fraction) => Source::PackingFraction(fraction),
        };
        scene.sample = vec![Sample { name: "sample".into(), seed, source, relaxer }];
        scene
    }
}

fn twice<T: PartialEq>(list: &'static str, values: &[T], words: impl Fn(&T) -> String) -> Result<(), StudyError> {
    let repeated = (1..values.len()).find(|&place| values[..place].contains(&values[place]));
    match repeated {
        Some(place) => Err(StudyError::Twice { list, value: words(&values[place]) }),
        None => Ok(()),
    }
}
