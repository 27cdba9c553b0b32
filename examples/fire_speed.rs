//! Time of a particle step of FIRE, printed as one JSON line; jamscope's side of `benches/peers/lammps/compare.sh`.
//!
//! ```text
//! cargo run --release --example fire_speed -- PACKING [--steps N] [--replicate K]
//! ```
//!
//! The packing (extended XYZ, periodic) is tiled K × K, the smallest disk nearest to the middle of the box grows by 0.1
//! and is held, all others move. The force limit is 0, so exactly N steps are made, neighbour lists, looks at the residual
//! and bounds on the time step included.

use std::error::Error;

use jamscope::contact::{ContactNetwork, Hertzian};
use jamscope::io::read_packing;
use jamscope::packing::{Domain, Packing};
use jamscope::relax::{Fire, ForceLimit, Relaxer};
use jamscope::vector::norm;

fn main() -> Result<(), Box<dyn Error>> {
    let mut path = None;
    let (mut steps, mut replicate) = (2000usize, 1usize);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut number = || -> Result<usize, Box<dyn Error>> {
            Ok(arguments.next().ok_or_else(|| format!("{argument} needs a number"))?.parse()?)
        };
        match argument.as_str() {
            "--steps" => steps = number()?,
            "--replicate" => replicate = number()?,
            _ => path = Some(argument),
        }
    }
    let path = path.unwrap_or_else(|| "fixtures/packings/hertz_N5548_p100.xyz".into());
    let packing = inflated(tiled(&read_packing::<2>(&path)?, replicate)?)?;
    let law = Hertzian::default();
    let disks = packing.len();
    let fire = Fire { limit: ForceLimit::Relative(0.0), step_limit: steps, ..Fire::default() };
    // One thread does all the work, so the time of the process is the time of the relaxation.
    let before = cpu_seconds();
    let outcome = fire.relax(packing, &law, &mut ())?;
    let cpu_seconds = cpu_seconds().zip(before).map_or(outcome.cost.seconds, |(after, before)| after - before);
    let steps = outcome.cost.step_count;
    println!(
        "{{\"code\": \"jamscope\", \"case\": \"inflated\", \"disks\": {disks}, \"steps\": {steps}, \"cpu_seconds\": {cpu_seconds:.6}, \
         \"ns_per_particle_step\": {:.2}, \"force_evaluations\": {}, \"neighbour_lists\": {}, \"largest_force\": {:e}}}",
        cpu_seconds * 1e9 / (steps * disks) as f64,
        outcome.cost.force_evaluation_count,
        outcome.cost.rebuild_count,
        ContactNetwork::new(&outcome.state, &law)?.largest_net_force(),
    );
    Ok(())
}

/// The packing repeated `count` times along both axes.
fn tiled(packing: &Packing<2>, count: usize) -> Result<Packing<2>, Box<dyn Error>> {
    let lengths = packing.domain().lengths().ok_or("the packing is not periodic")?;
    let mut positions = Vec::new();
    let mut radii = Vec::new();
    for row in 0..count {
        for column in 0..count {
            for (position, &radius) in packing.positions().iter().zip(packing.radii()) {
                positions.push([position[0] + column as f64 * lengths[0], position[1] + row as f64 * lengths[1]]);
                radii.push(radius);
            }
        }
    }
    let domain = Domain::Periodic { corner: [0.0; 2], lengths: lengths.map(|length| length * count as f64) };
    Ok(Packing::new(domain, positions, radii)?)
}

/// The packing with the smallest disk nearest to the middle of the box grown by 0.1 and held.
fn inflated(packing: Packing<2>) -> Result<Packing<2>, Box<dyn Error>> {
    let lengths = packing.domain().lengths().ok_or("the packing is not periodic")?;
    let smallest = packing.radii().iter().copied().fold(f64::INFINITY, f64::min);
    let from_middle = |disk: usize| {
        let position = packing.positions()[disk];
        norm([position[0] - 0.5 * lengths[0], position[1] - 0.5 * lengths[1]])
    };
    let centre = (0..packing.len())
        .filter(|&disk| packing.radii()[disk] == smallest)
        .min_by(|&a, &b| from_middle(a).total_cmp(&from_middle(b)))
        .ok_or("no disk")?;
    let held = (0..packing.len()).map(|disk| disk == centre).collect();
    Ok(packing.with_radius(centre, smallest + 0.1)?.with_held(held)?)
}

/// Processor time of this process, where the system tells it.
fn cpu_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/schedstat").ok()?;
    Some(text.split_whitespace().next()?.parse::<f64>().ok()? * 1e-9)
}
