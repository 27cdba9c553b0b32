//! How far the residual can fall: FIRE with no limit at all, until it fluctuates at the rounding floor.
//!
//! ```text
//! cargo run --release --features measurements --example rounding_floor -- [DISKS] [PRESSURE] ...      (5548 disks at p = 1, 100, 1000)
//! ```
//!
//! Beside the floor reached stand the library's own estimate and what positions kept as one number a coordinate would
//! allow, about 5 F' ulp(L) / ⟨F⟩ with the mean stiffness F' and the mean contact force ⟨F⟩. The last column is the
//! largest memory the process ever held, over the number of disks.

use std::error::Error;

use jamscope::law::{Hertzian, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::Mixture;
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{Fire, ForceLimit, Relaxer};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let disk_count: usize = arguments.next().map_or(Ok(5548), |text| text.parse())?;
    let mut pressures = arguments.map(|text| text.parse()).collect::<Result<Vec<f64>, _>>()?;
    if pressures.is_empty() {
        pressures = vec![1.0, 100.0, 1000.0];
    }
    let law = Hertzian::default();
    println!(
        "{:>7} {:>8} {:>12} {:>12} {:>20} {:>8} {:>12} {:>12} {:>11}",
        "disks", "p", "residual", "estimate", "one number a coord.", "ratio", "evaluations", "stop", "bytes/disk"
    );
    for pressure in pressures {
        let preparation = Preparation {
            disk_count,
            mixture: Mixture::default(),
            target: Target::Pressure(pressure),
            tolerance: 0.1,
            seed: 1,
            ..Preparation::default()
        };
        let coarse = Fire { limit: ForceLimit::Relative(1e-6), ..Fire::default() };
        let prepared = prepare_with::<2>(&preparation, &law, &coarse, &mut ())?;
        let endless = Fire { limit: ForceLimit::Relative(0.0), ..Fire::default() };
        let outcome = endless.relax(prepared.packing.into_inner(), &law, &mut ())?;
        let network = ContactNetwork::new(&outcome.state, &law)?;
        let side = outcome.state.domain().lengths().ok_or("periodic")?[0];
        let stiffness: Vec<f64> =
            network.backbone_contacts().map(|contact| law.stiffness(contact.force, contact.overlap)).collect();
        let mean_stiffness = stiffness.iter().sum::<f64>() / stiffness.len() as f64;
        let ulp = side.next_up() - side;
        let plain = 5.0 * mean_stiffness * ulp / network.mean_contact_force();
        println!(
            "{disk_count:>7} {:>8.2} {:>12.1e} {:>12.1e} {plain:>20.1e} {:>8.0} {:>12} {:>12} {:>11}",
            prepared.pressure,
            outcome.residual.relative(),
            outcome.rounding_floor,
            plain / outcome.residual.relative(),
            outcome.cost.force_evaluation_count,
            format!("{:?}", outcome.stop),
            largest_memory().map_or_else(|| "unknown".into(), |bytes| (bytes / disk_count as u64).to_string()),
        );
    }
    Ok(())
}

/// Largest resident memory of this process \[bytes\], where the system tells it.
fn largest_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(1024 * line.split_whitespace().nth(1)?.parse::<u64>().ok()?)
}
