//! [`Plan`]: all packings of a study with the inflations done to each, in an order that only the study decides.

use std::collections::HashSet;

use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::scene::{Scene, Source};
use crate::study::settings::{Study, StudyError, Target};

/// One packing and what is done to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Task {
    /// Its place in the plan, from 0.
    pub index: usize,
    /// What it was asked to be prepared to.
    pub target: Target,
    /// One scene of one sample an inflation; they differ in increase and relaxer.
    pub scenes: Vec<Scene>,
}

/// All tasks of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// In the order of the merged result: seeds innermost, so that every cell stands together.
    pub tasks: Vec<Task>,
    /// Wall time allowed to a task \[s\].
    pub time_limit: Option<f64>,
}

/// One part of a plan: every `count`-th task from `index` on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 0.
    pub index: usize,
    /// How many parts there are.
    pub count: usize,
}

impl Default for Shard {
    /// All of it.
    fn default() -> Self {
        Shard { index: 0, count: 1 }
    }
}

impl Shard {
    /// Whether a task is in this part.
    pub fn has(&self, task: usize) -> bool {
        task % self.count == self.index
    }
}

impl Plan {
    /// The plan of a study.
    ///
    /// # Errors
    /// A study that makes no sense.
    pub fn of(study: &Study) -> Result<Self, StudyError> {
        study.check()?;
        let mut plan = Plan { tasks: Vec::new(), time_limit: study.time_limit };
        let mut known = HashSet::new();
        for (place, part) in study.parted().iter().enumerate() {
            let first = plan.tasks.len();
            plan.add(part);
            for task in &plan.tasks[first..] {
                if !known.insert(task.identity()) {
                    let scene = &task.scenes[0];
                    let (disk_count, seed) = (scene.disk_count, scene.sample[0].seed);
                    return Err(StudyError::PartsOverlap { part: place + 1, disk_count, target: task.target, seed });
                }
            }
        }
        Ok(plan)
    }

    fn add(&mut self, study: &Study) {
        for law in study.laws() {
            for disk_count in study.disk_counts() {
                for &target in &study.targets {
                    for place in 0..study.seeds.count {
                        let seed = study.seeds.first + place as u64;
                        let inflations = study
                            .increases()
                            .into_iter()
                            .flat_map(|increase| study.relaxers().into_iter().map(move |relaxer| (increase, relaxer)));
                        let scene = |inflation| study.scene_of(law, disk_count, target, inflation, seed);
                        let scenes = inflations.map(scene).collect();
                        self.tasks.push(Task { index: self.tasks.len(), target, scenes });
                    }
                }
            }
        }
    }

    /// Samples, one an inflation.
    pub fn sample_count(&self) -> usize {
        self.tasks.iter().map(|task| task.scenes.len()).sum()
    }
}

impl Task {
    /// What tells this task from all others, and from the same one of another version: SHA-256 of version and scenes, in hex.
    ///
    /// The place in the plan is left out: a study with more seeds has the old tasks unchanged.
    pub fn identity(&self) -> String {
        // A scene is plain data: it always has a form as JSON.
        let scenes = serde_json::to_string(&(self.target, &self.scenes)).unwrap_or_default();
        hash(&[env!("CARGO_PKG_VERSION"), &scenes])
    }

    /// What it may take on one core \[s\]: c n^(3/2) p^(−1/4) (0.6 + 0.4 k) for n disks and k inflations, c = 1.4·10⁻⁵ s.
    ///
    /// FIRE's steps grow as the square root of n and towards jamming. Measured on the recipes (the chapter on studies has the
    /// table): within a factor of three from 1387 to 22184 disks, p from 0.5 to 4000, of Hertzian and Hookean disks.
    pub fn expected_seconds(&self) -> f64 {
        let Some(first) = self.scenes.first() else { return 0.0 };
        let pressure = match first.sample.first().map(|sample| &sample.source) {
            Some(Source::Pressure(pressure)) => *pressure,
            _ => 1.0,
        };
        let size = (first.disk_count as f64).powf(1.5);
        1.4e-5 * size * pressure.powf(-0.25) * (0.6 + 0.4 * self.scenes.len() as f64)
    }

    /// The file of its records.
    pub fn file_name(&self) -> String {
        format!("{}.jsonl", &self.identity()[..24])
    }
}

/// SHA-256 of some texts, each with its length before it, in hex.
pub(super) fn hash(texts: &[&str]) -> String {
    let mut state = Sha256::new();
    for text in texts {
        state.update((text.len() as u64).to_le_bytes());
        state.update(text.as_bytes());
    }
    state.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
