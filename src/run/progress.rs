//! [`Progress`]: what a run reports while it works.

use crate::relax::{Check, Trace};

/// Progress of a run; `()` ignores it.
pub trait Progress: Sync {
    /// A sample begins a relaxation of a stage, with `limit` as the target of the residual.
    fn stage(&self, sample: usize, stage: &'static str, limit: f64) {
        let _ = (sample, stage, limit);
    }
    /// The residual of the stage, from time to time.
    fn residual(&self, sample: usize, residual: f64) {
        let _ = (sample, residual);
    }
    /// Whether to end the sample as failed; called at every check of the residual.
    fn interrupted(&self, sample: usize) -> bool {
        let _ = sample;
        false
    }
    /// The sample is done, with or without failure.
    fn done(&self, sample: usize, failure: Option<&str>) {
        let _ = (sample, failure);
    }
}

impl Progress for () {}

/// Reports the residual of one sample, as the trace of its relaxations.
pub struct Watch<'a> {
    /// Where it is reported.
    pub progress: &'a dyn Progress,
    /// Number of the sample.
    pub sample: usize,
    /// Name of the stage.
    pub stage: &'static str,
    /// Limit of the relaxer \[1, or force\].
    pub limit: f64,
}

impl Trace for Watch<'_> {
    fn checked(&mut self, check: &Check) {
        if check.step_count == 0 {
            self.progress.stage(self.sample, self.stage, self.limit);
        }
        if !check.restart {
            self.progress.residual(self.sample, check.residual);
        }
    }

    fn interrupted(&mut self) -> bool {
        self.progress.interrupted(self.sample)
    }
}
