//! Whether packings prepared by different relaxers are one ensemble: distributions at a pressure, compared with those of FIRE in double precision.
//!
//! ```text
//! cargo run --release --features measurements --example preparation_ensembles -- [--disks N] [--pressure P] [--seeds [FIRST,]COUNT] [--relaxers N]
//! ```
//!
//! Prepares packings from seeds 1, 2, ... by FIRE, FIRE in mixed precision, the staged relaxer (FIRE, then Newton) and L-BFGS (or the first N of
//! these), one on each core. The first table has mean and standard error of the packing fraction φ, of the coordination Z of the backbone and of the rattlers' share,
//! and force evaluations, factorisations and seconds a packing. The second one compares each with FIRE in double precision: mean difference over the
//! seeds with its standard error; two-sample Kolmogorov–Smirnov distance D and its p-value.
//!
//! # Source
//! Distribution of D: Kolmogorov's series, with the correction of Stephens (1970), J. R. Stat. Soc. B 32, 115, to finite samples.

use std::error::Error;

use jamscope::law::Hertzian;
use jamscope::network::ContactNetwork;
use jamscope::packing::Mixture;
use jamscope::preparation::{Preparation, PreparationError, Target, prepare_with};
use jamscope::relax::{Cost, Fire, Precision, QuasiNewton, RelaxerChoice, Staged};
use jamscope::vector::larger;
use rayon::prelude::*;

/// Relative tolerance on the pressure: the default of a preparation.
const TOLERANCE: f64 = 0.01;

/// Names of the quantities compared.
const QUANTITIES: [&str; 3] = ["φ", "Z", "rattlers"];

/// φ, Z, share of rattlers, and what they cost.
type Sample = ([f64; 3], Cost);

fn main() -> Result<(), Box<dyn Error>> {
    let (mut disks, mut pressure, mut seeds, mut kinds) = (1387usize, 10.0, 1..=200u64, 4);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("{argument} needs a value"))?;
        match argument.as_str() {
            "--disks" => disks = value.parse()?,
            "--pressure" => pressure = value.parse()?,
            "--seeds" => {
                let (first, count) = value.split_once(',').unwrap_or(("1", &value));
                let (first, count): (u64, u64) = (first.parse()?, count.parse()?);
                seeds = first..=first + count - 1;
            }
            "--relaxers" => kinds = value.parse()?,
            _ => return Err(format!("unknown argument {argument}").into()),
        }
    }
    let relaxers = [
        ("FIRE", RelaxerChoice::Fire(Fire::default())),
        ("FIRE, mixed precision", RelaxerChoice::Fire(Fire { precision: Precision::Mixed, ..Fire::default() })),
        ("staged", RelaxerChoice::Staged(Staged::default())),
        ("L-BFGS", RelaxerChoice::QuasiNewton(QuasiNewton::default())),
    ];
    println!("{disks} disks, p = {pressure}, seeds {} to {}\n", seeds.start(), seeds.end());
    println!("| relaxer | packings | φ | Z | rattlers | evaluations | factorisations | seconds |");
    println!("|---|---|---|---|---|---|---|---|");
    let mut ensembles = Vec::new();
    for (name, relaxer) in relaxers.into_iter().take(kinds) {
        let made: Vec<Result<Sample, PreparationError>> =
            seeds.clone().into_par_iter().map(|seed| sample(disks, pressure, seed, &relaxer)).collect();
        for failure in made.iter().filter_map(|sample| sample.as_ref().err()) {
            eprintln!("{name}: {failure}");
        }
        let samples: Vec<Option<Sample>> = made.into_iter().map(Result::ok).collect();
        let costs: Vec<Cost> = samples.iter().flatten().map(|sample| sample.1).collect();
        let per_packing = |value: &dyn Fn(&Cost) -> f64| mean(&costs.iter().map(value).collect::<Vec<_>>()).0;
        let [phi, z, rattlers] = [0, 1, 2].map(|quantity| mean(&column(&samples, quantity)));
        println!(
            "| {name} | {} | {:.6} ± {:.6} | {:.4} ± {:.4} | {:.4} ± {:.4} | {:.0} | {:.1} | {:.2} |",
            costs.len(),
            phi.0,
            phi.1,
            z.0,
            z.1,
            rattlers.0,
            rattlers.1,
            per_packing(&|cost| cost.force_evaluation_count as f64),
            per_packing(&|cost| cost.factorisation_count as f64),
            per_packing(&|cost| cost.seconds),
        );
        ensembles.push((name, samples));
    }
    println!("\n| relaxer | quantity | difference from FIRE | D | p-value |");
    println!("|---|---|---|---|---|");
    let (_, reference) = &ensembles[0];
    for (name, samples) in &ensembles[1..] {
        for (quantity, label) in QUANTITIES.iter().enumerate() {
            let both = samples.iter().zip(reference).filter_map(|(one, two)| Some((one.as_ref()?, two.as_ref()?)));
            let differences: Vec<f64> = both.map(|(one, two)| one.0[quantity] - two.0[quantity]).collect();
            let (difference, error) = mean(&differences);
            let (one, two) = (column(samples, quantity), column(reference, quantity));
            if one.len().min(two.len()) < 2 {
                println!("| {name} | {label} | cannot tell: {} and {} packings | | |", one.len(), two.len());
                continue;
            }
            let distance = largest_distance(&one, &two);
            let p_value = p_value(distance, (one.len(), two.len()));
            println!("| {name} | {label} | {difference:+.1e} ± {error:.1e} | {distance:.3} | {p_value:.2} |");
        }
    }
    Ok(())
}

fn sample(disk_count: usize, pressure: f64, seed: u64, relaxer: &RelaxerChoice) -> Result<Sample, PreparationError> {
    let (mixture, target, law) = (Mixture::default(), Target::Pressure(pressure), Hertzian::default());
    let preparation = Preparation { disk_count, mixture, target, tolerance: TOLERANCE, seed, ..Preparation::default() };
    let prepared = prepare_with::<2>(&preparation, &law, relaxer, &mut ())?;
    let network = ContactNetwork::new(prepared.packing.get(), &law)?;
    let rattlers = network.rattlers().count() as f64 / disk_count as f64;
    Ok(([prepared.packing_fraction, network.coordination(), rattlers], prepared.cost))
}

/// One quantity of all packings.
fn column(samples: &[Option<Sample>], quantity: usize) -> Vec<f64> {
    samples.iter().flatten().map(|sample| sample.0[quantity]).collect()
}

/// Mean and its standard error.
fn mean(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let spread: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (spread / (count - 1.0) / count).sqrt())
}

/// Largest distance between the distribution functions of two samples, D.
fn largest_distance(one: &[f64], two: &[f64]) -> f64 {
    let share =
        |sample: &[f64], value: f64| sample.iter().filter(|&&x| x <= value).count() as f64 / sample.len() as f64;
    one.iter().chain(two).map(|&value| (share(one, value) - share(two, value)).abs()).fold(0.0, larger)
}

/// Probability of a distance D or more of samples of one distribution. Equal values make it too large.
fn p_value(distance: f64, (one, two): (usize, usize)) -> f64 {
    let root = ((one * two) as f64 / (one + two) as f64).sqrt();
    let x = (root + 0.12 + 0.11 / root) * distance;
    if x < 0.2 {
        return 1.0; // 1 − 10⁻¹² there, where the series converges slowly
    }
    let term = |k: i32| (-2.0 * (f64::from(k) * x).powi(2)).exp() * if k % 2 == 1 { 2.0 } else { -2.0 };
    (1..=20).map(term).sum::<f64>().clamp(0.0, 1.0)
}
