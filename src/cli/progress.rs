//! Progress on a terminal: one bar per sample with its stage, residual and remaining time. Silent if the output is not
//! a terminal.

use std::sync::Mutex;
use std::time::Instant;

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use jamscope::run::Progress;

/// Number of parts of a bar, which fills with the logarithm of the residual.
const PARTS: u64 = 1000;

/// One bar per sample.
pub struct Bars {
    bars: Vec<ProgressBar>,
    stages: Mutex<Vec<Stage>>,
    // Draws the bars while it exists.
    _all: MultiProgress,
}

#[derive(Clone, Copy)]
struct Stage {
    name: &'static str,
    limit: f64,
    first: f64,
    start: Instant,
    relaxation_count: usize,
}

impl Bars {
    /// Bars with these names on the standard error stream; indicatif hides them if that is not a terminal.
    pub fn new<'a>(names: impl Iterator<Item = &'a str>) -> Self {
        let all = MultiProgress::new();
        let style = ProgressStyle::with_template("{prefix:>14} {bar:30} {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        let bars: Vec<ProgressBar> = names
            .map(|name| {
                let bar = all.add(ProgressBar::new(PARTS));
                bar.set_style(style.clone());
                bar.set_prefix(name.to_string());
                bar.set_message("waiting");
                bar
            })
            .collect();
        let waits = Stage { name: "", limit: 0.0, first: f64::NAN, start: Instant::now(), relaxation_count: 0 };
        let stages = Mutex::new(vec![waits; bars.len()]);
        Bars { bars, stages, _all: all }
    }
}

impl Progress for Bars {
    fn stage(&self, sample: usize, name: &'static str, limit: f64) {
        let (Some(bar), Ok(mut stages)) = (self.bars.get(sample), self.stages.lock()) else { return };
        let before = &stages[sample];
        let relaxation_count = if before.name == name { before.relaxation_count + 1 } else { 1 };
        stages[sample] = Stage { name, limit, first: f64::NAN, start: Instant::now(), relaxation_count };
        bar.set_position(0);
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
        let part = (libm::log(stage.first / residual) / libm::log(stage.first / stage.limit)).clamp(0.0, 1.0);
        // The residual of a quench also rises; the bar shows the best value so far.
        let position = ((part * PARTS as f64) as u64).max(bar.position());
        bar.set_position(position);
        let part = position as f64 / PARTS as f64;
        // The logarithm of the residual falls at a roughly constant rate.
        let left = match part {
            part if part > 0.02 => {
                format!("about {:.0} s left", stage.start.elapsed().as_secs_f64() * (1.0 - part) / part)
            }
            _ => "time left unknown".into(),
        };
        let Stage { name, limit, relaxation_count, .. } = stage;
        bar.set_message(format!("{name} {relaxation_count}: residual {residual:.1e} to {limit:.0e}, {left}"));
    }

    fn done(&self, sample: usize, failure: Option<&str>) {
        let Some(bar) = self.bars.get(sample) else { return };
        bar.set_position(PARTS);
        bar.finish_with_message(failure.map_or_else(|| "done".to_string(), |reason| format!("failed: {reason}")));
    }
}
