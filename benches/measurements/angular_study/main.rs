//! The angular part of the study on real packings: S(f), G(θ), G*, θ*, f† and the shares of angular modes against p̂ = p N^(3/2).
//!
//! ```text
//! cargo run --release --features measurements --example angular_study -- --out DIR [--disks 5548] [--samples 20] [--reduced 1e6,1e7,1e8,1e9] [--seed 1]
//!     [--relaxer staged|damped] [--packing-fraction PHI]
//! ```
//!
//! Hertzian disks from random points, brought to the pressure p = p̂/N^(3/2), N = n π (R/L)² those inside the circle of R/L = 0.480
//! (0.486 and 0.491 from 10 000 and 50 000 disks on). A small disk is inflated by 0.1, then deflated. Everything relaxes by FIRE,
//! then Newton (`Staged`), to 10⁻⁸ of the mean contact force; with `--relaxer damped` by the damped dynamics of the study
//! (`ImplicitDynamics`). With `--packing-fraction` packings are quenched there, as in the study, and p̂ asked for is only their name.
//!
//! Each sample is a row of `DIR/samples.jsonl`, written when it is done, the ring r̂ = 0.5 ± 0.03 of its displacement field with it. A run
//! that was killed goes on where it was; more samples or pressures go to the same file. From the rows come the table on standard output,
//! `DIR/summary.csv`, `DIR/correlation.svg` and `DIR/spectrum.svg`.
//!
//! Samples run side by side (rayon; `RAYON_NUM_THREADS`); rows are sorted before they are used, so the results have the same bits.

mod figures;
mod sample;
mod store;
mod summary;

use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use rayon::prelude::*;

use crate::sample::{Plan, Row};
use crate::store::Store;
use crate::summary::Summary;

/// What was asked for.
struct Arguments {
    folder: PathBuf,
    disk_count: usize,
    sample_count: u64,
    reduced_pressures: Vec<f64>,
    first_seed: u64,
    damped: bool,
    packing_fraction: Option<f64>,
}

impl Arguments {
    fn read() -> Result<Self, Box<dyn Error>> {
        let (mut folder, mut disk_count, mut sample_count, mut first_seed) = (None, 5548, 20, 1);
        let mut reduced_pressures = vec![1e6, 1e7, 1e8, 1e9];
        let (mut damped, mut packing_fraction) = (false, None);
        let mut words = std::env::args().skip(1);
        while let Some(flag) = words.next() {
            let value = words.next().ok_or_else(|| format!("{flag} needs a value"))?;
            match flag.as_str() {
                "--out" => folder = Some(PathBuf::from(value)),
                "--disks" => disk_count = value.parse()?,
                "--samples" => sample_count = value.parse()?,
                "--seed" => first_seed = value.parse()?,
                "--reduced" => reduced_pressures = value.split(',').map(str::parse).collect::<Result<_, _>>()?,
                "--packing-fraction" => packing_fraction = Some(value.parse()?),
                "--relaxer" => {
                    damped = match value.as_str() {
                        "staged" => false,
                        "damped" => true,
                        _ => return Err(format!("--relaxer: staged or damped, not {value}").into()),
                    }
                }
                _ => {
                    let known = "--out, --disks, --samples, --reduced, --seed, --relaxer or --packing-fraction";
                    return Err(format!("{flag}: not {known}").into());
                }
            }
        }
        let folder = folder.ok_or("--out DIR is needed")?;
        Ok(Arguments { folder, disk_count, sample_count, reduced_pressures, first_seed, damped, packing_fraction })
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let Arguments { folder, disk_count, sample_count, reduced_pressures, first_seed, damped, packing_fraction } =
        Arguments::read()?;
    let plan = Plan::of(disk_count, damped, packing_fraction);
    let store = Store::open(&folder, &plan)?;
    let seeds = first_seed..first_seed + sample_count;
    let asked = |row: &Row| reduced_pressures.contains(&row.reduced_pressure) && seeds.contains(&row.seed);
    let done: Vec<Row> = store.rows()?.into_iter().filter(asked).collect();
    let is_done = |reduced: f64, seed: u64| done.iter().any(|row| row.reduced_pressure == reduced && row.seed == seed);
    let open: Vec<(f64, u64)> = seeds
        .clone()
        .flat_map(|seed| reduced_pressures.iter().map(move |&reduced| (reduced, seed)))
        .filter(|&(reduced, seed)| !is_done(reduced, seed))
        .collect();
    println!("jamscope {}: {} samples done, {} to do", env!("CARGO_PKG_VERSION"), done.len(), open.len());
    let start = Instant::now();
    // One at a time from the front: neighbouring samples finish together, whatever was asked for.
    open.par_iter().with_max_len(1).try_for_each(|&(reduced, seed)| store.append(&plan.sample(reduced, seed)))?;
    if !open.is_empty() {
        println!("{:.0} s for {} samples", start.elapsed().as_secs_f64(), open.len());
    }
    let mut rows: Vec<Row> = store.rows()?.into_iter().filter(asked).collect();
    rows.sort_by(|a, b| a.reduced_pressure.total_cmp(&b.reduced_pressure).then(a.seed.cmp(&b.seed)));
    let summaries: Vec<Summary> =
        rows.chunk_by(|a, b| a.reduced_pressure == b.reduced_pressure).map(Summary::of).collect::<Result<_, _>>()?;
    summary::print(&summaries);
    std::fs::write(folder.join("summary.csv"), summary::csv(&summaries))?;
    figures::correlation(&folder.join("correlation.svg"), &plan, &summaries)?;
    figures::spectrum(&folder.join("spectrum.svg"), &plan, &summaries)?;
    println!("{}", folder.display());
    Ok(())
}
