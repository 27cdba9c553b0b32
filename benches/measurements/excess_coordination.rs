//! How ΔZ of the backbone grows with the pressure, and with what prefactor.
//!
//! ```text
//! cargo run --release --features measurements --example excess_coordination -- [DISK_COUNT [SEED_COUNT [scaled | quenched [fire | damped]]]]
//! ```
//!
//! Hertzian packings made from random points: `scaled` (default) to p = 1, 3, 10, 30, 100, 300, 800 by scaling the box after
//! the quench; `quenched` once, at packing fractions that give about the same pressures, as in the study, whose relaxer is
//! `damped` (from φ = 0.8861 on; FIRE is default here). Every packing has a seed of its own. Columns, means over the seeds ±
//! standard error, all over p^(1/3):
//!
//! * `backbone`: Z − 4, rattlers left out;
//! * `counted`: 2 (N_c − N_iso)/N of the backbone, N_iso = 2 (N − 1) + 1, as the constraints count in a box;
//! * `all disks`: twice the contacts over all disks, rattlers among them, less 4;
//!
//! then least squares through the single packings, the errors from their scatter: ln ΔZ = ln A + b ln p; A with b = 1/3; and
//! ΔZ = A p^(1/3) (1 + B p^(1/3)), whose A is the prefactor at p → 0.

use std::error::Error;

use jamscope::law::Hertzian;
use jamscope::network::ContactNetwork;
use jamscope::observe::ExcessCoordination;
use jamscope::packing::Mixture;
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{DampedDynamics, RelaxerChoice};

/// Pressures \[force / length\].
const PRESSURES: [f64; 7] = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 800.0];

/// Packing fractions whose quench gives about those pressures. Source: p^(2/3) ∝ φ − 0.842 through p = 78 at φ = 0.86.
const PACKING_FRACTIONS: [f64; 7] = [0.8430, 0.8441, 0.8466, 0.8515, 0.8632, 0.8861, 0.9272];

/// The first of them that damped dynamics is asked for.
const DAMPED_FROM: usize = 5;

/// Names of the three ways to count.
const COUNTED: [&str; 3] = ["backbone", "counted", "all disks"];

/// One packing: its pressure, packing fraction and the three ΔZ.
struct Point {
    pressure: f64,
    packing_fraction: f64,
    excess: [f64; 3],
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, default: usize| arguments.get(index).map_or(Ok(default), |text| text.parse());
    let (disk_count, seed_count) = (number(0, 1000)?, number(1, 8)?);
    let targets: Vec<Target> = match arguments.get(2).map(String::as_str) {
        None | Some("scaled") => PRESSURES.map(Target::Pressure).to_vec(),
        Some("quenched") => PACKING_FRACTIONS.map(Target::PackingFraction).to_vec(),
        Some(other) => return Err(format!("{other}: neither scaled nor quenched").into()),
    };
    let damped = arguments.get(3).is_some_and(|relaxer| relaxer == "damped");
    let relaxer = match arguments.get(3).map(String::as_str) {
        None | Some("fire") => RelaxerChoice::default(),
        Some("damped") => RelaxerChoice::Damped(DampedDynamics::default()),
        Some(other) => return Err(format!("{other}: neither fire nor damped").into()),
    };
    println!("{disk_count} disks, {seed_count} seeds; everything over p^(1/3)");
    println!("{:>16} {:>5} {:>24} {:>24} {:>24}", "p", "φ", COUNTED[0], COUNTED[1], COUNTED[2]);
    let mut points = Vec::new();
    // Closer to jamming damped dynamics takes minutes a packing.
    for (index, &target) in targets.iter().enumerate().skip(if damped { DAMPED_FROM } else { 0 }) {
        let mut here = Vec::new();
        for seed in 1..=seed_count {
            let seed = (1000 * index + seed) as u64;
            let preparation = Preparation {
                disk_count,
                mixture: Mixture::default(),
                target,
                tolerance: 0.01,
                seed,
                ..Preparation::default()
            };
            let prepared = prepare_with::<2>(&preparation, &Hertzian::default(), &relaxer, &mut ())?;
            let network = ContactNetwork::new(prepared.packing.get(), &Hertzian::default())?;
            // An unjammed packing, near φ = 0.843 one in a few, has no ΔZ.
            let Some(excess) = ExcessCoordination::of(&network) else { continue };
            let (pressure, packing_fraction) = (prepared.pressure, prepared.packing_fraction);
            here.push(Point { pressure, packing_fraction, excess: counted(&network, &excess, disk_count) });
        }
        let pressure = statistics(here.iter().map(|point| point.pressure));
        let [packing_fraction, _] = statistics(here.iter().map(|point| point.packing_fraction));
        print!("{:>9.3} ± {:<5.2} {packing_fraction:.4}", pressure[0], pressure[1]);
        for way in 0..COUNTED.len() {
            let [mean, error] = statistics(here.iter().map(|point| point.excess[way] / point.pressure.cbrt()));
            print!(" {mean:>14.5} ± {error:.5}");
        }
        println!();
        points.append(&mut here);
    }
    for way in 0..COUNTED.len() {
        let points: Vec<(f64, f64)> = points.iter().map(|point| (point.pressure, point.excess[way])).collect();
        println!("{}:", COUNTED[way]);
        fits(&points);
    }
    Ok(())
}

/// Three ways to count.
fn counted(network: &ContactNetwork<2>, excess: &ExcessCoordination, disk_count: usize) -> [f64; 3] {
    let contacts = excess.end_count as f64 / 2.0;
    let disks = excess.disk_count as f64;
    [
        excess.value,
        2.0 * (contacts - (2.0 * (disks - 1.0) + 1.0)) / disks,
        2.0 * network.contacts.len() as f64 / disk_count as f64 - 4.0,
    ]
}

/// Mean and standard error.
fn statistics(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let values: Vec<f64> = values.collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    [mean, (squares / (count - 1.0) / count).sqrt()]
}

fn fits(points: &[(f64, f64)]) {
    if points.iter().any(|&(_, excess)| excess <= 0.0) {
        println!("  no power of p: some are not positive");
        return;
    }
    let logarithms: Vec<(f64, f64)> = points.iter().map(|&(p, excess)| (p.ln(), excess.ln())).collect();
    let [(offset, offset_error), (slope, slope_error)] = line(&logarithms);
    println!(
        "  A p^b                     A = {:.4} ± {:.4}, b = {slope:.4} ± {slope_error:.4}",
        offset.exp(),
        offset.exp() * offset_error
    );
    let [mean, error] = statistics(points.iter().map(|&(p, excess)| excess / p.cbrt()));
    println!("  A p^(1/3)                 A = {mean:.4} ± {error:.4}");
    let corrected: Vec<(f64, f64)> = points.iter().map(|&(p, excess)| (p.cbrt(), excess / p.cbrt())).collect();
    let [(offset, offset_error), (slope, slope_error)] = line(&corrected);
    println!("  A p^(1/3) (1 + B p^(1/3)) A = {offset:.4} ± {offset_error:.4}, AB = {slope:.5} ± {slope_error:.5}");
}

/// Offset and slope of the line of least squares, each with its standard error.
fn line(points: &[(f64, f64)]) -> [(f64, f64); 2] {
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0 / count, sum.1 + point.1 / count));
    let width: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
    let slope = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum::<f64>() / width;
    let rest: f64 = points.iter().map(|point| (point.1 - y - slope * (point.0 - x)).powi(2)).sum();
    let variance = rest / (count - 2.0);
    [(y - slope * x, (variance * (1.0 / count + x * x / width)).sqrt()), (slope, (variance / width).sqrt())]
}
