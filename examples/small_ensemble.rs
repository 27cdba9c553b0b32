//! The change of pressure over an ensemble: mean, standard error, and how many samples it falls in.
//!
//! ```text
//! cargo run --release --example small_ensemble [COUNT]
//! ```
//!
//! `prepare` and `inflate` relax by FIRE. The default of the program is the damped dynamics of the study: near jamming
//! another minimum, and another phase.
//!
//! A study (`jamscope study`) does this for lists of sizes, pressures, laws and relaxers, and goes on where it was interrupted.

use jamscope::preparation::Target;
use jamscope::{Inflation, Preparation, inflate, prepare};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let count: u64 = std::env::args().nth(1).map_or(Ok(10), |text| text.parse())?;
    if count < 2 {
        return Err("COUNT must be at least 2: one sample has no standard error".into());
    }
    let target = Target::Pressure(10.0); // [force / length]
    let mut changes = Vec::new();
    for seed in 1..=count {
        // `seed` draws the random points; `inflate` draws the inflated disk with seed 1.
        let prepared = prepare(&Preparation { disk_count: 500, target, seed, ..Preparation::default() })?;
        let inflated = inflate(&Inflation::default(), prepared.packing.get())?;
        let change = inflated.after.pressure - inflated.before.pressure;
        println!("seed {seed:3}: p = {:.3}, Δp = {change:8.4}", prepared.pressure);
        changes.push(change);
    }
    let n = changes.len() as f64;
    let mean = changes.iter().sum::<f64>() / n;
    let variance = changes.iter().map(|change| (change - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let falling = changes.iter().filter(|&&change| change < 0.0).count();
    println!(
        "Δp = {mean:.4} ± {:.4} (standard error of {count} samples); it falls in {falling}",
        (variance / n).sqrt()
    );
    Ok(())
}
