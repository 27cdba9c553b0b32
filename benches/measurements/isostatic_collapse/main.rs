//! Whether h_∥(r) around a disk that grows is one function of r ΔZ at all pressures, with ℓ_iso ΔZ = C; and that h_r(r) is not.
//!
//! ```text
//! cargo run --release --features measurements --example isostatic_collapse -- [OPTION …] [DISK_COUNT [PACKING_COUNT [CENTRE_COUNT [PRESSURE …]]]]
//! ```
//!
//! Without more: 22184 Hertzian disks, 8 packings, 50 centres each, p = 30, 100, 300, 1000. The packing is periodic and the disk free, so
//! that far away h_∥ falls as 1/r². Printed for every pressure: ΔZ, the plateau of h_∥ r² over d_0 and C at some shares of it, with errors from a
//! bootstrap over packings; means over centres are those of h² and geometric ones. The same for changes of force, h_F r², and for h_r r, and for ℓ √ΔZ with
//! the plateau at the same r √ΔZ. Then the power of ΔZ that the length follows.
//!
//! - `seeds FIRST`: packings from this seed on, in place of 1.
//! - `unstressed`: the linear response of springs at rest, contact forces left out.
//! - `relaxed D_0`, `damped D_0`: the disk grows by D_0 and the packing relaxes, by FIRE and Newton or by damped dynamics, viscoelastic of rate 500; else the linear response.
//! - `figures DIR`: h_∥ r² over its plateau against r ΔZ and against r √ΔZ, geometric means, into two SVG files.
//! - `held`: a circle with a held rim, its centre held or free; beside what is measured, what a point force makes of the difference.

mod curve;
mod held;
mod sample;

use std::error::Error;
use std::path::PathBuf;

use jamscope::law::Hertzian;
use jamscope::linear::Prestress;
use jamscope::linear::{ElasticModuli, LinearError};
use jamscope::observe::IsostaticLength;
use jamscope::observe::isostatic::Scale;
use jamscope::report::figures::isostatic::isostatic_figure;

use curve::{Average, Field, Lengths, Reading, SHARES, powers, scaled};
use held::print_held;
use sample::{Growth, Sample, prepared};

/// Pressures, unless others are given \[force / length\].
const PRESSURES: [f64; 4] = [30.0, 100.0, 300.0, 1000.0];

/// What is printed.
const LOOKED_AT: [Reading; 8] = [
    reading(Field::Stretching, Average::Squares, Scale::Excess),
    reading(Field::Stretching, Average::Logarithms, Scale::Excess),
    reading(Field::Stretching, Average::Logarithms, Scale::RootExcess),
    reading(Field::Force, Average::Squares, Scale::Excess),
    reading(Field::Force, Average::Logarithms, Scale::Excess),
    reading(Field::Force, Average::Logarithms, Scale::RootExcess),
    reading(Field::Radial, Average::Squares, Scale::Excess),
    reading(Field::Radial, Average::Logarithms, Scale::Excess),
];

const fn reading(field: Field, average: Average, scale: Scale) -> Reading {
    Reading { field, average, scale }
}

/// What is asked for.
struct Arguments {
    growth: Growth,
    held: bool,
    figures: Option<PathBuf>,
    first_seed: u64,
    disk_count: usize,
    packing_count: u64,
    centre_count: usize,
    pressures: Vec<f64>,
}

impl Arguments {
    fn read() -> Result<Self, Box<dyn Error>> {
        let mut words = std::env::args().skip(1).peekable();
        let (mut growth, mut held, mut figures) = (Growth::Linear(Prestress::Included), false, None);
        let mut first_seed = 1;
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
                "seeds" => first_seed = words.next().ok_or("seeds needs the first one")?.parse()?,
                "unstressed" => growth = Growth::Linear(Prestress::LeftOut),
                "figures" => figures = Some(words.next().ok_or("figures needs a folder")?.into()),
                "relaxed" => growth = Growth::Relaxed { increase: increase()?, damped: false },
                "damped" => growth = Growth::Relaxed { increase: increase()?, damped: true },
                _ => {
                    return Err(
                        format!("{option:?} is none of seeds, unstressed, relaxed, damped, figures, held").into()
                    );
                }
            }
        }
        let numbers: Vec<f64> = words.map(|word| word.parse()).collect::<Result<_, _>>()?;
        let number = |index: usize, default: f64| numbers.get(index).copied().unwrap_or(default);
        if numbers.iter().any(|&value| value.is_nan() || value <= 0.0) {
            return Err("numbers of disks, packings and centres, and pressures, are positive".into());
        }
        let packing_count = number(1, 8.0) as u64;
        if !held && packing_count < 2 {
            return Err("errors come from how packings differ: at least two of them".into());
        }
        let pressures = if numbers.len() > 3 { numbers[3..].to_vec() } else { PRESSURES.to_vec() };
        Ok(Arguments {
            growth,
            held,
            figures,
            first_seed,
            disk_count: number(0, 22184.0) as usize,
            packing_count,
            centre_count: number(2, 50.0) as usize,
            pressures,
        })
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let Arguments { growth, held, figures, first_seed, disk_count, packing_count, centre_count, pressures } =
        Arguments::read()?;
    // Before minutes of work, not after them.
    figures.as_deref().map_or(Ok(()), std::fs::create_dir_all)?;
    println!("{disk_count} disks, {packing_count} packings, {centre_count} centres each, {growth}");
    let mut curves = Vec::new();
    let mut lengths: [Vec<(f64, Lengths)>; LOOKED_AT.len()] = Default::default();
    for &pressure in &pressures {
        let packings = prepared(disk_count, first_seed..first_seed + packing_count, pressure)?;
        if held {
            print_held(pressure, &packings, centre_count)?;
            continue;
        }
        let samples = Sample::of_all(&packings, centre_count, growth)?;
        let (excess, radius) = (samples[0][0].excess, samples[0][0].outer_radius);
        let (bulk, shear) = moduli(&packings)?;
        println!(
            "p = {pressure}: ΔZ = {excess:.4}, L/2 = {radius:.1}, K = {bulk:.0}, G = {shear:.0}, {} centres; C at shares {SHARES:?}",
            samples.iter().map(Vec::len).sum::<usize>()
        );
        for (looked_at, all) in LOOKED_AT.into_iter().zip(&mut lengths) {
            let found = Lengths::of(&samples, looked_at)?;
            println!("  {looked_at}: {found}");
            all.push((excess, found));
        }
        curves.push(samples);
    }
    for (looked_at, lengths) in LOOKED_AT.iter().zip(&lengths) {
        print!("the power of ΔZ that ℓ follows, {looked_at}:");
        for power in powers(lengths) {
            match power {
                Some((power, error)) => print!(" {power:.2} ± {error:.2}"),
                None => print!(" none"),
            }
        }
        println!();
    }
    if let Some(folder) = figures {
        for (scale, name) in [(Scale::Excess, "collapse"), (Scale::RootExcess, "collapse_root")] {
            let all = pressures.iter().zip(&curves);
            let all = all.map(|(pressure, samples)| Ok((format!("p = {pressure}"), scaled(samples, scale)?)));
            let all = all.collect::<Result<Vec<_>, Box<dyn Error>>>()?;
            let curves: Vec<(&str, &IsostaticLength)> =
                all.iter().filter_map(|(name, length)| Some((name.as_str(), length.as_ref()?))).collect();
            let figure = isostatic_figure(&format!("{disk_count} disks, free centre"), &curves)?;
            std::fs::write(folder.join(format!("{name}_{disk_count}.svg")), figure.to_svg())?;
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
