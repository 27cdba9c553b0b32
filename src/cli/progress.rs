//! Progress on a terminal: one bar a sample, its stage, residual and time left. Silent when the output is not a terminal.

use std::sync::Mutex;

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use jamscope::run::Progress;

/// Parts of a bar; it fills with the logarithm of the residual.
const PARTS: u64 = 1000;

/// One bar a sample.
pub struct Bars {
    bars: Vec<ProgressBar>,
    stages: Mutex<Vec<Stage>>,
    // Draws the bars as long as it lives.
    _all: MultiProgress,
}

#[derive(Clone, Copy)]
struct Stage {
    limit: f64,
    first: f64,
}

impl Bars {
    /// Bars with these names on the standard error stream; indicatif hides them where that is no terminal.
    pub fn new<'a>(names: impl Iterator<Item = &'a str>) -> Self {
        let all = MultiProgress::new();
        let style = ProgressStyle::with_template("{prefix:>14} {bar:30} {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        let bars: Vec<ProgressBar> = names
            .map(|name| {
                let bar = all.add(ProgressBar::new(PARTS));
                bar.set_style(style.clone());
                bar.set_prefix(name.to_string());
                bar.set_message("waits");
                bar
            })
            .collect();
        let stages = Mutex::new(vec![Stage { limit: 0.0, first: f64::NAN }; bars.len()]);
        Bars { bars, stages, _all: all }
    }
}

impl Progress for Bars {
    fn stage(&self, sample: usize, stage: &str, limit: f64) {
        let Some(bar) = self.bars.get(sample) else { return };
        if let Ok(mut stages) = self.stages.lock() {
            stages[sample] = Stage { limit, first: f64::NAN };
        }
        bar.reset();
        bar.set_message(format!("{stage} "));
    }

    fn residual(&self, sample: usize, residual: f64) {
        let (Some(bar), Ok(mut stages)) = (self.bars.get(sample), self.stages.lock()) else { return };
        let stage = &mut stages[sample];
        if !(residual > 0.0 && residual.is_finite()) {
            return;
        }
        if stage.first.is_nan() {
            stage.first = residual.max(1.0);
        }
        let part = (stage.first / residual).ln() / (stage.first / stage.limit).ln();
        let position = (part * PARTS as f64).clamp(0.0, PARTS as f64) as u64;
        // A quench climbs in between; the bar shows how far it ever came.
        bar.set_position(position.max(bar.position()));
        let stage_name = bar.message().split_whitespace().next().unwrap_or_default().to_string();
        let left = bar.eta().as_secs();
        bar.set_message(format!(
            "{stage_name}  residual {residual:.1e}, limit {:.0e}, about {left} s left",
            stage.limit
        ));
    }

    fn done(&self, sample: usize, failure: Option<&str>) {
        let Some(bar) = self.bars.get(sample) else { return };
        bar.set_position(PARTS);
        bar.finish_with_message(failure.map_or_else(|| "done".to_string(), |reason| format!("failed: {reason}")));
    }
}
