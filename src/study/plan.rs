//! [`Plan`]: all packings of a study with their inflations, in an order determined by the study alone.

use std::collections::HashSet;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use crate::inflation::Boundary;
use crate::law::choice::LawChoice;
use crate::memory::{Memory, TooLarge};
use crate::scene::Scene;
use crate::scene::reduced_pressure::{exponent_of_size, mobile_count};
use crate::study::settings::{Study, StudyError, Target};

/// One packing and its inflations.
#[derive(Debug, Clone, PartialEq)]
pub struct Task {
    /// Its index in the plan, from 0.
    pub index: usize,
    /// Target of the preparation.
    pub target: Target,
    /// The contact law.
    pub law: LawChoice,
    /// Disks in the box.
    pub disk_count: usize,
    /// The seed.
    pub seed: u64,
    /// The other settings, shared by all tasks of a part: one scene per task would take 4 kB.
    study: Arc<Study>,
}

/// All tasks of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// In the order of the merged result: seeds innermost, so that samples of a cell are adjacent.
    pub tasks: Vec<Task>,
    /// Wall time limit of a task \[s\].
    pub time_limit: Option<f64>,
}

/// One part of a plan: every `count`-th task from `index` on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Index of the part, from 0.
    pub index: usize,
    /// Number of parts.
    pub count: usize,
}

impl Default for Shard {
    /// The whole plan.
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
    /// An invalid study.
    pub fn of(study: &Study) -> Result<Self, StudyError> {
        study.check()?;
        let mut plan = Plan { tasks: Vec::new(), time_limit: study.time_limit };
        let mut known = HashSet::new();
        // The lists of one part have no duplicates, so its packings differ; packings of several parts are compared.
        let several = study.parts.len() > 1;
        for (place, part) in study.parted().into_iter().enumerate() {
            let first = plan.tasks.len();
            plan.add(&Arc::new(part));
            for task in plan.tasks[first..].iter().filter(|_| several) {
                if !known.insert(task.identity()) {
                    let Task { disk_count, target, seed, .. } = *task;
                    return Err(StudyError::PartsOverlap { part: place + 1, disk_count, target, seed });
                }
            }
        }
        Ok(plan)
    }

    fn add(&mut self, study: &Arc<Study>) {
        for law in study.laws() {
            for disk_count in study.disk_counts() {
                for &target in &study.targets {
                    for place in 0..study.seeds.count {
                        let seed = study.seeds.first + place as u64;
                        let index = self.tasks.len();
                        self.tasks.push(Task { index, target, law, disk_count, seed, study: Arc::clone(study) });
                    }
                }
            }
        }
    }

    /// Checks whether the packings of the plan fit into memory if `at_once` of them are relaxed in parallel.
    ///
    /// # Errors
    /// [`TooLarge`] with `disk_count`, the largest possible value and the memory needed.
    pub fn check_memory(&self, memory: Memory, at_once: usize) -> Result<(), TooLarge> {
        let alike = |a: &Task, b: &Task| a.disk_count == b.disk_count && Arc::ptr_eq(&a.study, &b.study);
        for tasks in self.tasks.chunk_by(alike) {
            // Scenes of a task run one after the other; tasks run in parallel.
            let at_once = at_once.min(tasks.len());
            for mut scene in tasks[0].scenes() {
                scene.sample = vec![scene.sample[0].clone(); at_once];
                scene.check_memory(memory, at_once)?;
            }
        }
        Ok(())
    }

    /// Number of samples, one per inflation.
    pub fn sample_count(&self) -> usize {
        self.tasks.iter().map(Task::scene_count).sum()
    }
}

impl Task {
    /// One scene with one sample per inflation; they differ in increase, relaxer and whether the centre is held.
    pub fn scenes(&self) -> Vec<Scene> {
        let scene = |drive| self.study.scene_of(self.law, self.disk_count, self.target, drive, self.seed);
        self.study.inflations(self.target).into_iter().map(scene).collect()
    }

    /// Number of scenes.
    pub fn scene_count(&self) -> usize {
        self.study.inflations(self.target).len()
    }

    /// Dimension of space.
    pub fn dimension(&self) -> usize {
        self.study.scene.dimension
    }

    /// The boundary.
    pub fn boundary(&self) -> Boundary {
        self.study.scene.inflation.boundary
    }

    /// Unique identifier of this task and version: SHA-256 of version and scenes, in hexadecimal.
    ///
    /// It does not contain the index in the plan, so adding seeds to a study does not change its existing tasks.
    pub fn identity(&self) -> String {
        // A scene is plain data and can always be written as JSON.
        let scenes = serde_json::to_string(&(self.target, self.scenes())).unwrap_or_default();
        hash(&[env!("CARGO_PKG_VERSION"), &scenes])
    }

    /// Estimated time on one core \[s\]: c n^(3/2) p^(−1/4) (0.6 + 0.4 k) for n disks and k inflations, c = 1.4·10⁻⁵ s.
    ///
    /// The number of FIRE steps grows as the square root of n and towards jamming. The estimate is rough and for jammed
    /// packings; unjammed ones, with p = 1 here, take a tenth and less.
    pub fn expected_seconds(&self) -> f64 {
        let mobile = mobile_count(self.disk_count, self.boundary(), self.study.scene.dimension);
        let pressure = match self.target {
            Target::Pressure(pressure) => pressure,
            Target::ReducedPressure(reduced) => {
                reduced / libm::pow(mobile, exponent_of_size(&self.law, self.study.scene.dimension))
            }
            Target::PackingFraction(_) => 1.0,
        };
        let size = libm::pow(self.disk_count as f64, 1.5);
        1.4e-5 * size * libm::pow(pressure, -0.25) * (0.6 + 0.4 * self.scene_count() as f64)
    }

    /// File name of its records.
    pub fn file_name(&self) -> String {
        format!("{}.jsonl", &self.identity()[..24])
    }
}

/// SHA-256 of several texts, each preceded by its length, in hexadecimal.
pub(super) fn hash(texts: &[&str]) -> String {
    let mut state = Sha256::new();
    for text in texts {
        state.update((text.len() as u64).to_le_bytes());
        state.update(text.as_bytes());
    }
    state.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
