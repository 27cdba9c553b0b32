//! Relaxing to a residual by FIRE, by FIRE in mixed precision, by the staged relaxer and by L-BFGS, one JSON line each; jamscope's side of
//! `benches/peers/lammps/to_residual.sh`.
//!
//! ```text
//! cargo run --release --features measurements --example to_residual -- random[-SEED]|PACKING [--limit R] [--relaxer fire|mixed|staged|lbfgs] [--law hertz|hooke] [--disks N] [--write FILE]
//! ```
//!
//! `random`: 5548 bidisperse disks (or N) at random points (seed 1 unless given) of a periodic box, packing fraction 0.852, which relaxes to
//! p ≈ 40 with either law. A packing (extended XYZ, periodic): the smallest disk nearest to the middle of the box grows by 0.1 and is held, all
//! others move. With `--write` nothing is relaxed: the start goes to a file, the sides of the box in its first line after a #,
//! then a line a disk (x, y, radius, 1 if held). The limit is 10⁻⁸ of the mean contact force unless given.

#[path = "scenes/middle.rs"]
mod middle;
#[path = "scenes/processor.rs"]
mod processor;

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use jamscope::io::read_packing;
use jamscope::law::{Hertzian, Hookean, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::random_points;
use jamscope::relax::{Fire, ForceLimit, Precision, QuasiNewton, Relaxer, RelaxerChoice, Staged};

use middle::inflated;
use processor::cpu_seconds;

const DISK_COUNT: usize = 5548;
const PACKING_FRACTION: f64 = 0.852;

/// Stiffness of linear springs: about that of the Hertzian contacts of a packing at p = 100.
const HOOKEAN_STIFFNESS: f64 = 1e4;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut from, mut file, mut only, mut limit) = (String::from("random"), None, None, 1e-8);
    let (mut law, mut disks): (Box<dyn PairLaw>, _) = (Box::new(Hertzian::default()), DISK_COUNT);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--limit" => limit = value()?.parse()?,
            "--relaxer" => only = Some(value()?),
            "--disks" => disks = value()?.parse()?,
            "--law" => {
                law = match value()?.as_str() {
                    "hertz" => Box::new(Hertzian::default()),
                    "hooke" => Box::new(Hookean { stiffness: HOOKEAN_STIFFNESS }),
                    other => return Err(format!("--law: hertz or hooke, not {other}").into()),
                }
            }
            "--write" => file = Some(value()?),
            _ => from = argument,
        }
    }
    let (case, start) = if let Some(seed) = from.strip_prefix("random") {
        let seed = seed.strip_prefix('-').map_or(Ok(1), str::parse)?;
        (from.clone(), random_points::<2>(disks, &Mixture::default(), PACKING_FRACTION, seed)?)
    } else {
        let name = Path::new(&from).file_stem().and_then(|name| name.to_str()).ok_or("no name of a file")?;
        (name.to_string(), inflated(read_packing::<2>(&from)?)?)
    };
    if let Some(file) = file {
        return Ok(std::fs::write(file, table(&start)?)?);
    }
    let limit = ForceLimit::Relative(limit);
    let relaxers = [
        ("fire", RelaxerChoice::Fire(Fire { limit, ..Fire::default() })),
        ("mixed", RelaxerChoice::Fire(Fire { limit, precision: Precision::Mixed, ..Fire::default() })),
        ("staged", RelaxerChoice::Staged(Staged { limit, ..Staged::default() })),
        ("lbfgs", RelaxerChoice::QuasiNewton(QuasiNewton { limit, ..QuasiNewton::default() })),
    ];
    if let Some(unknown) = only.as_ref().filter(|only| relaxers.iter().all(|(name, _)| name != only)) {
        return Err(format!("--relaxer: fire, mixed, staged or lbfgs, not {unknown}").into());
    }
    for (name, relaxer) in relaxers {
        if only.as_ref().is_none_or(|only| only == name) {
            timed(&case, name, &relaxer, (start.clone(), &*law))?;
        }
    }
    Ok(())
}

fn timed(
    case: &str,
    name: &str,
    relaxer: &RelaxerChoice,
    (start, law): (Packing<2>, &dyn PairLaw),
) -> Result<(), Box<dyn Error>> {
    // One thread does all the work (RAYON_NUM_THREADS=1), so its time is the time of the relaxation.
    let before = cpu_seconds();
    let outcome = relaxer.relax(start, law, &mut ())?;
    let cpu_seconds = cpu_seconds().zip(before).map_or(outcome.cost.seconds, |(after, before)| after - before);
    let volume = outcome.state.domain().volume().ok_or("the packing is not periodic")?;
    println!(
        "{{\"code\": \"jamscope\", \"case\": \"{case}\", \"relaxer\": \"{name}\", \"law\": \"{}\", \"disks\": {}, \"stop\": \"{:?}\", \
         \"cpu_seconds\": {cpu_seconds:.4}, \"steps\": {}, \"force_evaluations\": {}, \"factorisations\": {}, \
         \"residual\": {:e}, \"mean_contact_force\": {:e}, \"pressure\": {:.4}}}",
        if law.exponent() == 2.0 { "hooke" } else { "hertz" },
        outcome.state.len(),
        outcome.stop,
        outcome.cost.step_count,
        outcome.cost.force_evaluation_count,
        outcome.cost.factorisation_count,
        outcome.residual.relative(),
        outcome.residual.mean_contact_force,
        ContactNetwork::new(&outcome.state, law)?.pressure(volume),
    );
    Ok(())
}

fn table(packing: &Packing<2>) -> Result<String, Box<dyn Error>> {
    let lengths = packing.domain().lengths().ok_or("the packing is not periodic")?;
    let mut text = format!("# {:?} {:?}\n", lengths[0], lengths[1]);
    for ((position, radius), &held) in packing.positions().iter().zip(packing.radii()).zip(packing.held()) {
        writeln!(text, "{:?} {:?} {:?} {}", position[0], position[1], radius, u8::from(held))?;
    }
    Ok(text)
}
