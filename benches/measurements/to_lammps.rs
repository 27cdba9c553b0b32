//! A packing in any format as LAMMPS data, and for comparisons what we compute of it:
//!
//! ```sh
//! cargo run --release --features measurements --example to_lammps -- PACKING OUT.data
//! cargo run --release --features measurements --example to_lammps -- PACKING OUT.data FORCES.xyz [JITTER] [hookean]
//! ```
//!
//! FORCES.xyz has the net force on every disk as a column, energy and pressure in its comment line. JITTER moves every coordinate by
//! a uniform random number up to that before both files are written (seed 1), so that forces are not those of a state at rest.

use jamscope::io::{Column, read_packing, write_lammps_data, write_packing};
use jamscope::law::{Hertzian, Hookean};
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let hookean = arguments.iter().any(|argument| argument == "hookean");
    arguments.retain(|argument| argument != "hookean");
    let (Some(from), Some(to)) = (arguments.first(), arguments.get(1)) else {
        return Err("to_lammps PACKING OUT.data [FORCES.xyz [JITTER]] [hookean]".into());
    };
    let jitter = arguments.get(3).map_or(Ok(0.0), |text| text.parse::<f64>())?;
    let packing = jittered(read_packing::<2>(from)?, jitter)?;
    write_lammps_data(to, &packing)?;
    println!("{} disks in {to}", packing.len());
    let Some(forces) = arguments.get(2) else { return Ok(()) };
    let network = if hookean {
        ContactNetwork::new(&packing, &Hookean::default())?
    } else {
        ContactNetwork::new(&packing, &Hertzian::default())?
    };
    let volume = packing.domain().volume().ok_or("the packing is not periodic")?;
    let values: Vec<f64> = network.forces().iter().flatten().copied().collect();
    let mean = network.mean_contact_force();
    let told = [("energy", network.energy()), ("pressure", network.pressure(volume)), ("mean_contact_force", mean)];
    let told: Vec<(&str, String)> = told.into_iter().map(|(name, value)| (name, format!("{value:?}"))).collect();
    let told: Vec<(&str, &str)> = told.iter().map(|(name, value)| (*name, value.as_str())).collect();
    write_packing(forces, &packing, &[Column { name: "force", width: 2, values: &values }], &told)?;
    println!("forces in {forces}");
    Ok(())
}

/// Every coordinate moved by up to `jitter`; nothing is left of corrections.
fn jittered(packing: Packing<2>, jitter: f64) -> Result<Packing<2>, Box<dyn std::error::Error>> {
    if jitter == 0.0 {
        return Ok(packing);
    }
    let mut draw = Pcg64::seed_from_u64(1);
    let mut moved = |x: f64| x + jitter * (2.0 * draw.random::<f64>() - 1.0);
    let positions = packing.positions().iter().map(|place| place.map(&mut moved)).collect();
    let jittered = Packing::new(*packing.domain(), positions, packing.radii().to_vec())?;
    Ok(jittered.with_labels(packing.labels().to_vec())?)
}
