//! How often the stated intervals of slope and crossover hold the truth.
//!
//! ```text
//! cargo run --release --features measurements --example angular_coverage -- [TRIALS [DISK_COUNT ...]]
//! ```
//!
//! Gaussian rings of 60, 1000 and 4000 disks, anywhere and jittered, 1000 of each unless told otherwise. Two standard errors hold
//! in 95.45 % of trials: ± 0.66 % for 1000, so that one such count in four is below 95 %, and ± 0.15 % for 20 000, of which one in 900 is.

use std::error::Error;
use std::time::Instant;

use jamscope::fit::angular::{CrossoverOutcome, CrossoverSettings, SpectrumWindowSettings, fit_crossover, fit_slope};
use jamscope::observe::angular::synthetic::{AngleLayout, SyntheticSettings, gaussian_rings};

fn main() -> Result<(), Box<dyn Error>> {
    let trials: usize = std::env::args().nth(1).map_or(Ok(1000), |text| text.parse())?;
    let sizes: Vec<usize> = std::env::args().skip(2).map(|text| text.parse()).collect::<Result<_, _>>()?;
    let sizes = if sizes.is_empty() { vec![60, 1000, 4000] } else { sizes };
    println!("disks, angles: s = 1.5 held (closed: mean ± scatter, mean standard error), ms a fit");
    for disk_count in sizes {
        for layout in [AngleLayout::Random, AngleLayout::Jittered(0.8)] {
            let settings = SyntheticSettings { disk_count, layout, seed: 1, ..SyntheticSettings::default() };
            slopes(&settings, trials)?;
            for crossover in [3.0, 20.0] {
                crossovers(&SyntheticSettings { seed: 2, ..settings }, trials, crossover)?;
            }
        }
    }
    Ok(())
}

/// Rings a batch, so that fields need not all be kept.
const BATCH: usize = 50;

fn slopes(settings: &SyntheticSettings, trials: usize) -> Result<(), Box<dyn Error>> {
    let (mut held, mut values, mut errors, mut seconds) = (0, Vec::new(), 0.0, 0.0);
    for batch in 0..trials.div_ceil(BATCH) {
        let settings = SyntheticSettings { seed: settings.seed + 1000 * batch as u64, ..*settings };
        for synthetic in gaussian_rings(&settings, BATCH.min(trials - batch * BATCH), |f| f.powf(-1.5))? {
            let start = Instant::now();
            let fit = fit_slope(&[synthetic.ring], &SpectrumWindowSettings::default())?;
            seconds += start.elapsed().as_secs_f64();
            held += usize::from(fit.exponent.holds(1.5));
            if let Some(estimate) = fit.exponent.estimate() {
                values.push(estimate.value);
                errors += estimate.standard_error;
            }
        }
    }
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let scatter = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
    println!(
        "{:>4} {:<13} slope     {held:>4}/{trials} ({}: {mean:.3} ± {scatter:.3}, {:.3}) {:.2} ms",
        settings.disk_count,
        format!("{:?}", settings.layout),
        values.len(),
        errors / count,
        1e3 * seconds / trials as f64
    );
    Ok(())
}

fn crossovers(settings: &SyntheticSettings, trials: usize, crossover: f64) -> Result<(), Box<dyn Error>> {
    let (mut held, mut outcomes, mut seconds) = (0, [0; 4], 0.0);
    for batch in 0..trials.div_ceil(BATCH) {
        let settings = SyntheticSettings { seed: settings.seed + 1000 * batch as u64, ..*settings };
        let spectrum = |f: f64| 1.0 / (1.0 + (f / crossover).powf(1.5));
        for synthetic in gaussian_rings(&settings, BATCH.min(trials - batch * BATCH), spectrum)? {
            let start = Instant::now();
            let fit = fit_crossover(&[synthetic.ring], &CrossoverSettings::default())?;
            seconds += start.elapsed().as_secs_f64();
            held += usize::from(fit.outcome.holds(crossover));
            outcomes[match fit.outcome {
                CrossoverOutcome::Found { .. } => 0,
                CrossoverOutcome::ScaleFree { .. } => 1,
                CrossoverOutcome::White { .. } => 2,
                CrossoverOutcome::Undetermined => 3,
            }] += 1;
        }
    }
    let [found, scale_free, white, undetermined] = outcomes;
    println!(
        "{:>4} {:<13} f† = {crossover:<4} {held:>4}/{trials} (found {found}, scale-free {scale_free}, white {white}, \
         undetermined {undetermined}) {:.2} ms",
        settings.disk_count,
        format!("{:?}", settings.layout),
        1e3 * seconds / trials as f64
    );
    Ok(())
}
