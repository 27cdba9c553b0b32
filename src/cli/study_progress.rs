//! The progress bar of a study on a terminal.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use jamscope::study::{FailureKind, Record, RecordOutcome, StudyProgress, Task};

/// One bar: packings done, samples per minute, failures, remaining time.
pub struct Bar {
    bar: ProgressBar,
    counts: Mutex<Counts>,
}

#[derive(Default)]
struct Counts {
    run: usize,
    failures: BTreeMap<FailureKind, usize>,
}

impl Bar {
    pub fn new(task_count: usize) -> Self {
        let style = ProgressStyle::with_template("{bar:30} {pos}/{len} packings, {elapsed} elapsed, {eta} left{msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::new(task_count as u64).with_style(style);
        bar.enable_steady_tick(Duration::from_millis(500));
        Bar { bar, counts: Mutex::new(Counts::default()) }
    }

    /// Removes it from the terminal.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl StudyProgress for Bar {
    fn task(&self, _task: &Task, records: &[Record], seconds: Option<f64>) {
        let Ok(mut counts) = self.counts.lock() else { return };
        for record in records {
            counts.run += usize::from(seconds.is_some());
            if let RecordOutcome::Failed { kind, .. } = record.outcome {
                *counts.failures.entry(kind).or_default() += 1;
            }
        }
        if seconds.is_none() {
            // Packings that already existed do not count in the estimate of the remaining time.
            self.bar.set_length(self.bar.length().unwrap_or(1).saturating_sub(1));
        } else {
            self.bar.inc(1);
        }
        let minutes = self.bar.elapsed().as_secs_f64() / 60.0;
        let failed: Vec<String> =
            counts.failures.iter().map(|(kind, count)| format!(", {count} failed ({})", kind.name())).collect();
        self.bar.set_message(format!(", {:.1} samples per minute{}", counts.run as f64 / minutes, failed.concat()));
    }
}
