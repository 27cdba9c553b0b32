//! Time of a particle step of FIRE, printed as one JSON line; jamscope's side of `benches/peers/lammps/compare.sh`.
//!
//! ```text
//! cargo run --release --features measurements --example fire_speed -- PACKING [--steps N] [--replicate K] [--law hertz|hooke] [--precision double|mixed]
//! ```
//!
//! The packing (extended XYZ, periodic) is tiled K × K, the smallest disk nearest to the middle of the box grows by 0.1
//! and is held, all others move. The force limit is 0, so exactly N steps are made, neighbour lists, looks at the residual
//! and bounds on the time step included.

#[path = "scenes/middle.rs"]
mod middle;
#[path = "scenes/processor.rs"]
mod processor;
#[path = "scenes/tiled.rs"]
mod tiled;

use std::error::Error;

use jamscope::io::read_packing;
use jamscope::law::{Hertzian, Hookean, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::relax::{Fire, ForceLimit, Precision, Relaxer};

use middle::inflated;
use processor::cpu_seconds;
use tiled::tiled;

/// Stiffness of linear springs: about that of the Hertzian contacts of a packing at p = 100.
const HOOKEAN_STIFFNESS: f64 = 1e4;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut path, mut law) = (None, String::from("hertz"));
    let mut precision = String::from("double");
    let (mut steps, mut replicate) = (2000usize, 1usize);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut number = || -> Result<usize, Box<dyn Error>> {
            Ok(arguments.next().ok_or_else(|| format!("{argument} needs a number"))?.parse()?)
        };
        match argument.as_str() {
            "--steps" => steps = number()?,
            "--replicate" => replicate = number()?,
            "--precision" => precision = arguments.next().ok_or("--precision needs a name")?,
            "--law" => law = arguments.next().ok_or("--law needs a name")?,
            _ => path = Some(argument),
        }
    }
    let path = path.unwrap_or_else(|| "fixtures/packings/hertz_N5548_p100.xyz".into());
    let packing = inflated(tiled(&read_packing::<2>(&path)?, replicate)?)?;
    let precision = match precision.as_str() {
        "double" => Precision::Double,
        "mixed" => Precision::Mixed,
        other => return Err(format!("--precision: double or mixed, not {other}").into()),
    };
    match law.as_str() {
        "hertz" => timed(packing, &Hertzian::default(), (steps, precision)),
        "hooke" => timed(packing, &Hookean { stiffness: HOOKEAN_STIFFNESS }, (steps, precision)),
        other => Err(format!("--law: hertz or hooke, not {other}").into()),
    }
}

fn timed(packing: Packing<2>, law: &dyn PairLaw, (steps, precision): (usize, Precision)) -> Result<(), Box<dyn Error>> {
    let disks = packing.len();
    let fire = Fire { limit: ForceLimit::Relative(0.0), step_limit: steps, precision, ..Fire::default() };
    // One thread does all the work (RAYON_NUM_THREADS=1), so its time is the time of the relaxation.
    let before = cpu_seconds();
    let outcome = fire.relax(packing, law, &mut ())?;
    let cpu_seconds = cpu_seconds().zip(before).map_or(outcome.cost.seconds, |(after, before)| after - before);
    let steps = outcome.cost.step_count;
    println!(
        "{{\"code\": \"{}\", \"case\": \"inflated\", \"law\": \"{}\", \"disks\": {disks}, \"steps\": {steps}, \"cpu_seconds\": {cpu_seconds:.6}, \
         \"ns_per_particle_step\": {:.2}, \"wall_ns_per_particle_step\": {:.2}, \"force_evaluations\": {}, \"neighbour_lists\": {}, \"largest_force\": {:e}}}",
        if precision == Precision::Mixed { "jamscope, mixed precision" } else { "jamscope" },
        if law.exponent() == 2.0 { "hooke" } else { "hertz" },
        cpu_seconds * 1e9 / (steps * disks) as f64,
        outcome.cost.seconds * 1e9 / (steps * disks) as f64,
        outcome.cost.force_evaluation_count,
        outcome.cost.build_count,
        ContactNetwork::new(&outcome.state, law)?.largest_net_force(),
    );
    Ok(())
}
