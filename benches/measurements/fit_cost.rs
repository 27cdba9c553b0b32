//! Fits of the screening wavenumber to noisy profiles with a known one: how far off, and how long. The side of jamscope of
//! `benches/peers/scipy/compare.sh`.
//!
//! ```text
//! cargo run --release --features measurements --example fit_cost -- [--write FOLDER]
//! ```
//!
//! Rings one diameter wide of a screened profile, a = 0.5, R = 42, d_0 = 0.1, with Gaussian errors of 2 % of the displacement at a
//! radius of one, falling as the square root of the number of disks; ten profiles each for several κR. With `--write` each
//! profile is written as CSV: r, d_r, standard error.

use std::error::Error;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use jamscope::fit::profile::{ProfileFitSettings, fit_radial_profile};
use jamscope::observe::radial_profile::{RadialProfile, Ring};
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const INNER_RADIUS: f64 = 0.5;
const OUTER_RADIUS: f64 = 42.0;
const INCREASE: f64 = 0.1;
const NOISE: f64 = 2e-3;
const PROFILES: u64 = 10;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = match (arguments.next().as_deref(), arguments.next()) {
        (None, _) => None,
        (Some("--write"), Some(folder)) => Some(PathBuf::from(folder)),
        _ => return Err("usage: fit_cost [--write FOLDER]".into()),
    };
    let annulus = Annulus::new(INNER_RADIUS, OUTER_RADIUS)?;
    println!("| κR | fit | κ within 5 errors of the truth | ms a fit |\n|---|---|---|---|");
    for argument in [2.0, 5.0, 9.0, 14.0] {
        let wavenumber = argument / OUTER_RADIUS;
        let solution = Screened::<2>::new(annulus, INCREASE, wavenumber)?;
        let (mut right, mut seconds) = (0, 0.0);
        for seed in 0..PROFILES {
            let profile = noisy(&solution, seed);
            if let Some(folder) = &folder {
                let mut text = String::new();
                for ring in &profile.rings {
                    writeln!(text, "{},{},{}", ring.radius, ring.mean, ring.standard_error)?;
                }
                std::fs::write(folder.join(format!("{argument}_{seed}.csv")), text)?;
            }
            let begin = Instant::now();
            let fit = fit_radial_profile::<2>(&profile, annulus, &ProfileFitSettings::default())?;
            seconds += begin.elapsed().as_secs_f64();
            let close = |fit: &jamscope::fit::profile::ScreenedFit| {
                (fit.wavenumber.value - wavenumber).abs() <= 5.0 * fit.wavenumber.standard_error
            };
            right += usize::from(fit.screened.as_ref().is_some_and(close));
        }
        println!("| {argument} | jamscope | {right} of {PROFILES} | {:.2} |", 1e3 * seconds / PROFILES as f64);
    }
    Ok(())
}

fn noisy(solution: &Screened<2>, seed: u64) -> RadialProfile {
    let mut random = Pcg64::seed_from_u64(seed);
    let ring = |index: usize| {
        let radius = 1.0 + index as f64;
        let disk_count = (5.0 * radius) as usize;
        let standard_error = NOISE / radius.sqrt();
        // Box and Muller.
        let (u, v): (f64, f64) = (1.0 - random.random::<f64>(), random.random());
        let normal = (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos();
        let spread = standard_error * (disk_count as f64).sqrt();
        Ring { radius, disk_count, mean: solution.value(radius) + standard_error * normal, spread, standard_error }
    };
    RadialProfile { rings: (0..41).map(ring).collect() }
}
