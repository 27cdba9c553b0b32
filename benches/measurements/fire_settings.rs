//! Which settings of FIRE take the fewest force evaluations: each changed alone, and those named.
//!
//! ```text
//! cargo run --release --features measurements --example fire_settings -- [--limit 1e-8] [KEY=VALUE[,KEY=VALUE]...] ...
//! ```
//!
//! KEY is one of time_step_fraction, delay, step_growth, step_cut, mixing, mixing_decay. Starts: random points of 1000 disks at four
//! packing fractions (three seeds each), and stored packings with one disk grown by 0.1 in a circle with a held rim (four
//! centres each). The table has sums of evaluations over the starts of a column, over those of the defaults; in the last
//! column the geometric mean of the row. A run that does not end at rest is counted in brackets.

#[path = "scenes/inflated.rs"]
mod inflated;

use std::error::Error;

use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::random_points;
use jamscope::relax::{Fire, ForceLimit, Relaxer, Stop};

use inflated::inflated;

/// What is tried where nothing is named.
const ALONE: [&str; 17] = [
    "time_step_fraction=0.9",
    "time_step_fraction=1.1",
    "time_step_fraction=1.2",
    "delay=0",
    "delay=2",
    "delay=10",
    "delay=20",
    "step_growth=1.05",
    "step_growth=1.2",
    "step_cut=0.3",
    "step_cut=0.7",
    "mixing=0.05",
    "mixing=0.15",
    "mixing=0.25",
    "mixing_decay=0.98",
    "mixing_decay=0.995",
    "mixing_decay=1",
];

/// Packing fractions of random points, and stored packings.
const FRACTIONS: [f64; 4] = [0.85, 0.86, 0.9, 1.0];
const STORED: [&str; 4] = ["hertz_N1000_p1", "hertz_N1000_p10", "hertz_N1000_p100", "hertz_N1000_p800"];

fn main() -> Result<(), Box<dyn Error>> {
    let mut limit = 1e-8;
    let mut trials = Vec::new();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        if argument == "--limit" {
            limit = arguments.next().ok_or("--limit needs a number")?.parse()?;
        } else {
            trials.push(argument);
        }
    }
    if trials.is_empty() {
        trials = ALONE.map(String::from).to_vec();
    }
    let mut columns = Vec::new();
    for fraction in FRACTIONS {
        let points = (1..=3).map(|seed| random_points::<2>(1000, &Mixture::default(), fraction, seed));
        columns.push((format!("φ {fraction}"), points.collect::<Result<Vec<_>, _>>()?));
    }
    for name in STORED {
        let packing = read_packing::<2>(format!("fixtures/packings/{name}.xyz"))?;
        let starts = (1..=4).map(|seed| inflated(&packing, seed));
        columns.push((name.replace("hertz_N1000_", ""), starts.collect::<Result<Vec<_>, _>>()?));
    }
    print!("{:<28}", "");
    columns.iter().for_each(|(name, _)| print!("{name:>13}"));
    println!("{:>9}", "mean");
    let fire = Fire { limit: ForceLimit::Relative(limit), ..Fire::default() };
    let standard: Vec<(usize, usize)> =
        columns.iter().map(|(_, starts)| evaluations(&fire, starts)).collect::<Result<_, _>>()?;
    print!("{:<28}", "defaults, evaluations");
    standard.iter().for_each(|(count, failed)| print!("{:>13}", format!("{count}{}", bracketed(*failed))));
    println!();
    for trial in trials {
        let fire = changed(fire, &trial)?;
        print!("{trial:<28}");
        let mut product = 1.0;
        for ((_, starts), (before, _)) in columns.iter().zip(&standard) {
            let (count, failed) = evaluations(&fire, starts)?;
            let ratio = count as f64 / *before as f64;
            product *= ratio;
            print!("{:>13}", format!("{ratio:.3}{}", bracketed(failed)));
        }
        println!("{:>9.3}", product.powf(1.0 / columns.len() as f64));
    }
    Ok(())
}

/// Evaluations of all starts, and how many did not end at rest.
fn evaluations(fire: &Fire, starts: &[Packing<2>]) -> Result<(usize, usize), Box<dyn Error>> {
    let (mut count, mut failed) = (0, 0);
    for start in starts {
        let outcome = fire.relax(start.clone(), &Hertzian::default(), &mut ())?;
        count += outcome.cost.force_evaluation_count;
        failed += usize::from(!matches!(outcome.stop, Stop::Converged(_)));
    }
    Ok((count, failed))
}

fn bracketed(failed: usize) -> String {
    if failed == 0 { String::new() } else { format!(" ({failed})") }
}

fn changed(mut fire: Fire, settings: &str) -> Result<Fire, Box<dyn Error>> {
    for setting in settings.split(',') {
        let (key, value) = setting.split_once('=').ok_or_else(|| format!("{setting}: KEY=VALUE is wanted"))?;
        match key {
            "time_step_fraction" => fire.time_step_fraction = value.parse()?,
            "delay" => fire.delay = value.parse()?,
            "step_growth" => fire.step_growth = value.parse()?,
            "step_cut" => fire.step_cut = value.parse()?,
            "mixing" => fire.mixing = value.parse()?,
            "mixing_decay" => fire.mixing_decay = value.parse()?,
            other => return Err(format!("{other} is no setting of FIRE").into()),
        }
    }
    Ok(fire)
}
