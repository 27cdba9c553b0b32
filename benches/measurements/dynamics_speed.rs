//! Implicit damped dynamics from an inflated start to a residual, as one JSON line; jamscope's side of
//! `benches/peers/lammps/dynamics.sh`.
//!
//! ```text
//! cargo run --release --features measurements --example dynamics_speed -- PACKING [--limit R] [--start FILE] [--motion]
//! ```
//!
//! The smallest backbone disk of seed 1 becomes the middle of a circle with a held rim, grows by 0.1 and is held; constant
//! damping, γ = 500. The motion is [`ImplicitDynamics`] with its defaults to the residual R, 10⁻⁵ unless given. With `--start`
//! nothing moves: the start is written to a file, a line a disk (x, y, radius, 1 if held), with its residual in the JSON line.
//! With `--motion` no Newton finishes the motion, and the line has the times between which the residual fell to R.

#[path = "scenes/processor.rs"]
mod processor;

use std::error::Error;
use std::fmt::Write;

use jamscope::inflation::{Centre, Circle, choose_centre};
use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::relax::implicit::Finish;
use jamscope::relax::{Check, DampedDynamics, ForceLimit, ImplicitDynamics, Relaxer};

use processor::cpu_seconds;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut path, mut file, mut limit, mut motion) = (None, None, 1e-5, false);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--limit" => limit = value()?.parse()?,
            "--start" => file = Some(value()?),
            "--motion" => motion = true,
            _ => path = Some(argument),
        }
    }
    let path = path.unwrap_or_else(|| "fixtures/packings/hertz_N5548_p100.xyz".into());
    let law = Hertzian::default();
    let (start, mobile) = inflated(&read_packing::<2>(&path)?)?;
    if let Some(file) = file {
        std::fs::write(file, table(&start)?)?;
        // No step: the residual of the start.
        let check = DampedDynamics { step_limit: 0, ..DampedDynamics::default() }.relax(start, &law, &mut ())?;
        println!("{{\"code\": \"jamscope\", \"mobile\": {mobile}, \"residual\": {:e}}}", check.residual.relative());
        return Ok(());
    }
    let mut dynamics = ImplicitDynamics { limit: ForceLimit::Relative(limit), ..ImplicitDynamics::default() };
    if motion {
        dynamics.finish = Finish::Motion;
    }
    let mut last_step = 0.0;
    let mut trace = |check: &Check| {
        if check.residual > limit {
            last_step = check.time_step;
        }
    };
    // One thread does all the work, so the time of the process is the time of the motion.
    let before = cpu_seconds();
    let outcome = dynamics.relax(start, &law, &mut trace)?;
    let cpu_seconds = cpu_seconds().zip(before).map_or(outcome.cost.seconds, |(after, before)| after - before);
    let (cost, residual) = (outcome.cost, outcome.residual.relative());
    let times = if motion {
        // The last step may have been shortened, so the residual fell to the limit after this.
        format!(", \"after_time\": {:.6}, \"by_time\": {:.6}", cost.simulated_time - last_step, cost.simulated_time)
    } else {
        String::new()
    };
    let network = ContactNetwork::new(&outcome.state, &law)?;
    println!(
        "{{\"code\": \"jamscope\", \"mobile\": {mobile}, \"stop\": \"{:?}\", \"steps\": {}, \"factorisations\": {}, \
         \"cpu_seconds\": {cpu_seconds:.4}, \"residual\": {residual:e}, \"energy\": {:e}{times}}}",
        outcome.stop,
        cost.step_count,
        cost.factorisation_count,
        network.energy(),
    );
    Ok(())
}

/// The packing cut to a circle around a small disk of its backbone, which has grown by 0.1; how many disks can move.
fn inflated(packing: &Packing<2>) -> Result<(Packing<2>, usize), Box<dyn Error>> {
    let chosen = choose_centre(packing, &Hertzian::default(), Centre::Backbone, 1)?;
    let side = packing.domain().lengths().ok_or("the packing is not periodic")?[0];
    let circle = Circle::cut(packing, chosen, 0.486 * side)?;
    let (mobile, radius) = (circle.mobile_count(), circle.packing.radii()[circle.centre]);
    Ok((circle.packing.with_radius(circle.centre, radius + 0.1)?, mobile))
}

fn table(packing: &Packing<2>) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    for ((position, radius), &held) in packing.positions().iter().zip(packing.radii()).zip(packing.held()) {
        writeln!(text, "{:?} {:?} {:?} {}", position[0], position[1], radius, u8::from(held))?;
    }
    Ok(text)
}
