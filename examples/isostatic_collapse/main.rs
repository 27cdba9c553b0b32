//! Whether h_∥(r) around a disk that grows is one function of r ΔZ at all pressures, with ℓ_iso ΔZ = C; and that h_r(r) is not.
//!
//! ```text
//! cargo run --release --features measurements --example isostatic_collapse -- [OPTION …] [DISK_COUNT [PACKING_COUNT [CENTRE_COUNT [PRESSURE …]]]]
//! ```
//!
//! Without more: 22184 Hertzian disks, 2 packings, 150 centres each, p = 10, 30, 100, 300, 1000. The packing is periodic and the disk free, so
//! that far away h_∥ falls as 1/r². Printed for every pressure: ΔZ, the plateau of h_∥ r² over d_0 and C at some shares of it, with errors from a
//! bootstrap over centres; means over centres are those of h² and geometric ones. Then how far the pressures lie apart.
//!
//! - `relaxed D_0`, `damped D_0`: the disk grows by D_0 and the packing relaxes, by FIRE and Newton or by damped dynamics; else the linear response.
//! - `held`: a circle with a held rim, its centre held or free; beside what is measured, what a point force makes of the difference.

mod curve;
mod held;
mod sample;

use std::error::Error;

use jamscope::contact::{Hertzian, Prestress};
use jamscope::linear::{ElasticModuli, LinearError};

use curve::{Average, Field, Lengths, SHARES, spread};
use held::print_held;
use sample::{Growth, Sample, prepared};

/// Pressures, unless others are given \[force / length\].
const PRESSURES: [f64; 5] = [10.0, 30.0, 100.0, 300.0, 1000.0];

/// What is printed.
const LOOKED_AT: [(Field, Average); 4] = [
    (Field::Stretching, Average::Squares),
    (Field::Stretching, Average::Logarithms),
    (Field::Radial, Average::Squares),
    (Field::Radial, Average::Logarithms),
];

/// What is asked for.
struct Arguments {
    growth: Growth,
    held: bool,
    disk_count: usize,
    packing_count: u64,
    centre_count: usize,
    pressures: Vec<f64>,
}

impl Arguments {
    fn read() -> Result<Self, Box<dyn Error>> {
        let mut words = std::env::args().skip(1).peekable();
        let (mut growth, mut held) = (Growth::Linear, false);
        while let Some(option) = words.next_if(|word| word.parse::<f64>().is_err()) {
            let mut increase = || {
                words
                    .next()
                    .ok_or_else(|| format!("{option} needs d_0"))?
                    .parse::<f64>()
                    .map_err(|error| error.to_string())
            };
            match option.as_str() {
                "held" => held = true,
                "relaxed" => growth = Growth::Relaxed { increase: increase()?, damped: false },
                "damped" => growth = Growth::Relaxed { increase: increase()?, damped: true },
                _ => return Err(format!("{option:?} is none of relaxed, damped, held").into()),
            }
        }
        let numbers: Vec<f64> = words.map(|word| word.parse()).collect::<Result<_, _>>()?;
        let number = |index: usize, default: f64| numbers.get(index).copied().unwrap_or(default);
        let pressures = if numbers.len() > 3 { numbers[3..].to_vec() } else { PRESSURES.to_vec() };
        Ok(Arguments {
            growth,
            held,
            disk_count: number(0, 22184.0) as usize,
            packing_count: number(1, 2.0) as u64,
            centre_count: number(2, 150.0) as usize,
            pressures,
        })
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let Arguments { growth, held, disk_count, packing_count, centre_count, pressures } = Arguments::read()?;
    println!("{disk_count} disks, {packing_count} packings, {centre_count} centres each, {growth}");
    let mut curves = Vec::new();
    for &pressure in &pressures {
        let packings = prepared(disk_count, packing_count, pressure)?;
        if held {
            print_held(pressure, &packings, centre_count)?;
            continue;
        }
        let samples = Sample::of_all(&packings, centre_count, growth)?;
        let (excess, radius) = (samples[0].excess, samples[0].outer_radius);
        let (bulk, shear) = moduli(&packings)?;
        println!(
            "p = {pressure}: ΔZ = {excess:.4}, L/2 = {radius:.1}, K = {bulk:.0}, G = {shear:.0}, {} centres; C at shares {SHARES:?}",
            samples.len()
        );
        for (field, average) in LOOKED_AT {
            println!("  {field:<6}, {average:<16}: {}", Lengths::of(&samples, field, average)?);
        }
        curves.push(samples);
    }
    if curves.len() > 1 {
        for (field, average) in LOOKED_AT {
            let apart = spread(&curves, field, average);
            println!("pressures apart in ln of {field} over its plateau, {average}: {apart:.3}");
        }
    }
    Ok(())
}

/// K and G, means over packings.
fn moduli(packings: &[jamscope::packing::Packing<2>]) -> Result<(f64, f64), LinearError> {
    let (mut bulk, mut shear) = (0.0, 0.0);
    for packing in packings {
        let moduli = ElasticModuli::of(packing, &Hertzian::default(), Prestress::Included)?.relaxed;
        bulk += moduli.bulk() / packings.len() as f64;
        shear += moduli.shear().mean / packings.len() as f64;
    }
    Ok((bulk, shear))
}
