//! [`merge()`]: all records of a folder in the order of the plan, and the statistics of every cell.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::io::write_atomically;
use crate::processor::Vectors;
use crate::study::plan::Plan;
use crate::study::samples::CellSamples;
use crate::study::settings::{Study, StudyError};
use crate::study::statistics::CellStatistics;
use crate::study::store::{Problem, Store, TaskState};
use crate::study::store_error::StoreError;

/// The result of a merge.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Merged {
    /// The study.
    pub study: Study,
    /// Number of samples of the plan.
    pub sample_count: usize,
    /// Number of samples with a record.
    pub record_count: usize,
    /// Numbers of records by the vector instructions that computed them. With more than one entry, records come from
    /// different processors. Results of factorisations then differ in their last digits.
    pub records_by_vectors: BTreeMap<String, usize>,
    /// Files that cannot be used; their samples are missing.
    pub damaged: Vec<Problem>,
    /// Files of no sample of this study.
    pub foreign: Vec<Problem>,
    /// Statistics in the order of the plan.
    pub cells: Vec<CellStatistics>,
    /// The samples behind the statistics, cell by cell.
    #[serde(skip)]
    pub samples: Vec<CellSamples>,
    /// The files written.
    #[serde(skip)]
    pub files: Vec<PathBuf>,
}

/// Why the merge failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// The study of the folder is invalid.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The folder cannot be used.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The result cannot be written.
    #[error(transparent)]
    Write(#[from] crate::io::WriteError),
    /// The result cannot be written as JSON.
    #[error("summary.json: {0}")]
    Json(#[from] serde_json::Error),
}

/// Collects the records of the study in `folder`. Writes `records.jsonl` (one record per line), `summary.json` and
/// `summary.csv` (one row per cell and number).
///
/// Records are read one task at a time; [`CellSamples`] contains what is kept of each.
///
/// # Errors
/// A folder without a study; a folder that cannot be written.
pub fn merge(folder: &Path) -> Result<Merged, MergeError> {
    let (store, study, _lock) = Store::held(folder)?;
    let plan = Plan::of(&study)?;
    merge_in(&store, study, &plan)
}

/// Merges a locked folder.
pub(super) fn merge_in(store: &Store, study: Study, plan: &Plan) -> Result<Merged, MergeError> {
    let mut merged = Merged {
        study,
        sample_count: plan.sample_count(),
        record_count: 0,
        records_by_vectors: BTreeMap::new(),
        damaged: Vec::new(),
        foreign: store.foreign(&plan.tasks)?,
        cells: Vec::new(),
        samples: Vec::new(),
        files: Vec::new(),
    };
    let mut cells: Vec<CellSamples> = Vec::new();
    let path = store.path("records.jsonl");
    write_atomically(&path, |writer| {
        for task in &plan.tasks {
            let (records, vectors) = match store.state(task) {
                TaskState::Missing => continue,
                TaskState::Damaged(problem) => {
                    merged.damaged.push(problem);
                    continue;
                }
                TaskState::Finished(records, _, vectors) => (records, vectors),
            };
            let vectors = vectors.map_or("not recorded", Vectors::name);
            *merged.records_by_vectors.entry(vectors.into()).or_default() += records.len();
            for record in &records {
                serde_json::to_writer(&mut *writer, record)?;
                writer.write_all(b"\n")?;
                merged.record_count += 1;
                // Cells that share packings are adjacent, so the search from the end is short.
                match cells.iter_mut().rev().find(|cell| cell.has(record)) {
                    Some(cell) => cell.add(record),
                    None => {
                        let mut cell = CellSamples::new(record.cell);
                        cell.add(record);
                        cells.push(cell);
                    }
                }
            }
        }
        Ok(())
    })?;
    merged.files.push(path);
    merged.cells = cells.iter().map(CellSamples::statistics).collect();
    merged.samples = cells;
    let summary =
        serde_json::to_string_pretty(&Summary { jamscope_version: env!("CARGO_PKG_VERSION"), merged: &merged })?;
    merged.files.push(store.write_result("summary.json", &(summary + "\n"))?);
    merged.files.push(store.write_result("summary.csv", &table(&merged.cells))?);
    Ok(merged)
}

/// The content of `summary.json`.
#[derive(Serialize)]
struct Summary<'a> {
    jamscope_version: &'static str,
    #[serde(flatten)]
    merged: &'a Merged,
}

/// One row per cell and number; names of relaxers contain commas, so they are quoted.
fn table(cells: &[CellStatistics]) -> String {
    let mut text = String::from(
        "cell,disk_count,target,target_value,increase,relaxer,law,number,count,mean,standard_error,lower_quartile,median,\
         upper_quartile,mean_low,mean_high,median_low,median_high\n",
    );
    let or_empty = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    for (index, statistics) in cells.iter().enumerate() {
        let cell = &statistics.cell;
        let (target, value) = cell.target.name_and_value();
        for (name, number) in &statistics.numbers {
            let [lower, median, upper] = number.quartiles;
            let [mean, middle] = [number.mean_interval, number.median_interval];
            let _ = writeln!(
                text,
                "{index},{},{target},{value},{},\"{}\",\"{}\",{name},{},{},{},{lower},{median},{upper},{},{},{},{}",
                cell.disk_count,
                cell.increase,
                cell.relaxer.name(),
                cell.law.name(),
                number.count,
                number.mean,
                or_empty(number.standard_error),
                or_empty(mean.map(|it| it[0])),
                or_empty(mean.map(|it| it[1])),
                or_empty(middle.map(|it| it[0])),
                or_empty(middle.map(|it| it[1])),
            );
        }
    }
    text
}

impl Merged {
    /// A warning if records were computed with different vector instructions.
    pub fn mixed_vectors(&self) -> Option<String> {
        if self.records_by_vectors.len() < 2 {
            return None;
        }
        let each: Vec<String> =
            self.records_by_vectors.iter().map(|(name, count)| format!("{name}: {count}")).collect();
        Some(format!(
            "records computed with different vector instructions ({}): numbers that went through a factorisation differ in their \
             last digits between them",
            each.join(", ")
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::PhaseDecision;
    use crate::study::plan::Task;
    use crate::study::record::{Cell, Record, RecordOutcome};
    use crate::study::settings::{Seeds, Target};

    /// A record of the size for 5548 disks: 45 numbers, 16 curves.
    fn record(task: &Task) -> Record {
        let scene = &task.scenes()[0];
        let sample = &scene.sample[0];
        let cell = Cell {
            dimension: scene.dimension,
            law: scene.law,
            disk_count: scene.disk_count,
            target: task.target,
            increase: scene.inflation.increase,
            relaxer: sample.relaxer,
            boundary: scene.inflation.boundary,
            centre_held: scene.inflation.centre_held,
        };
        let value = |place: usize| libm::sin((sample.seed as usize + 100 * place) as f64);
        let curve = |count: usize| (0..count).map(|place| [place as f64 + 0.5, value(place)]).collect::<Vec<_>>();
        let numbers = (0..45).map(|place| (format!("number_{place}"), value(place))).collect();
        let mut curves = BTreeMap::from([
            ("radial_profile".to_string(), curve(41)),
            ("angular_correlation".to_string(), curve(91)),
            ("stretching_fluctuation".to_string(), curve(41)),
            ("radial_fluctuation".to_string(), curve(41)),
            ("isostatic_fluctuation".to_string(), curve(41)),
            ("power_spectrum".to_string(), curve(30)),
        ]);
        for tenth in 1..10 {
            curves.insert(format!("power_spectrum_at_0.{tenth}"), curve(4 * tenth));
        }
        let outcome = RecordOutcome::Done { phase: PhaseDecision::default(), numbers, curves };
        Record { cell, seed: sample.seed, outcome }
    }

    /// Peak memory of this process so far \[bytes\], if the system reports it.
    fn peak() -> Option<f64> {
        let status = std::fs::read_to_string("/proc/self/status").ok()?;
        let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
        Some(1024.0 * line.split_whitespace().nth(1)?.parse::<f64>().ok()?)
    }

    #[test]
    #[ignore = "writes 10⁵ files of 20 kB; run as the chapter on studies says"]
    fn a_hundred_thousand_samples_are_merged_in_little_memory() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let targets = (1..=250).map(|place| Target::ReducedPressure(1e6 * f64::from(place))).collect();
        let study = Study { targets, seeds: Seeds { first: 1, count: 400 }, ..Study::default() };
        let plan = Plan::of(&study).expect("it makes sense");
        let (store, lock) = Store::open(folder.path(), &study, false).expect("an empty folder");
        for task in &plan.tasks {
            store.write(task, &[record(task)], 1.0).expect("written");
        }
        drop((plan, lock));
        let before = peak();
        let start = std::time::Instant::now();
        let merged = merge(folder.path()).expect("a study is there");
        assert_eq!((merged.record_count, merged.cells.len()), (100_000, 250));
        if let (Some(before), Some(after)) = (before, peak()) {
            let seconds = start.elapsed().as_secs_f64();
            println!("peak {:.0} MB before, {:.0} MB after the merge of {seconds:.0} s", before / 1e6, after / 1e6);
            // 116 numbers per sample are 93 MB, twice that while vectors grow, and 10⁵ file names.
            assert!(after < 4e8, "{after} bytes");
        }
    }
}
