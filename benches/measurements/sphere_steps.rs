//! Time of a step of FIRE for spheres, beside LAMMPS (`benches/peers/lammps/spheres.py`).
//!
//! ```text
//! cargo run --release --features measurements --example sphere_steps -- PACKING.xyz COPIES STEPS
//! ```
//!
//! The packing of spheres is repeated COPIES times along each axis, and every coordinate moved by up to 0.01. One line for each law: the
//! least time of a step of one sphere over five runs of STEPS steps from there, on one thread, lists included.

use std::error::Error;
use std::time::Instant;

use jamscope::io::read_packing;
use jamscope::law::{Hertzian, Hookean, PairLaw};
use jamscope::packing::{Domain, Packing};
use jamscope::relax::{Fire, ForceLimit, Relaxer};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Half width of the random displacement \[length\].
const JITTER: f64 = 0.01;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, copies, steps] = arguments.as_slice() else {
        return Err("usage: sphere_steps PACKING COPIES STEPS".into());
    };
    let (copies, step_limit): (usize, usize) = (copies.parse()?, steps.parse()?);
    let packing = jittered(&read_packing::<3>(path)?, copies)?;
    // The stiffness of linear springs is about that of the Hertzian contacts at p = 100, as in the plane.
    measure("hertz", &packing, &Hertzian::default(), step_limit)?;
    measure("hooke", &packing, &Hookean { stiffness: 1e4 }, step_limit)
}

fn measure(name: &str, packing: &Packing<3>, law: &dyn PairLaw, step_limit: usize) -> Result<(), Box<dyn Error>> {
    let fire = Fire { limit: ForceLimit::Relative(1e-300), step_limit, ..Fire::default() };
    let (mut least, mut made) = (f64::INFINITY, 0);
    for _ in 0..5 {
        let before = Instant::now();
        let outcome = fire.relax(packing.clone(), law, &mut ())?;
        made = outcome.cost.step_count;
        least = least.min(before.elapsed().as_secs_f64() / made as f64);
    }
    println!(
        "{name}: {} spheres, {made} steps, {:.1} ns a particle step",
        packing.len(),
        1e9 * least / packing.len() as f64
    );
    Ok(())
}

/// The packing repeated along each axis, with its centres moved at random.
fn jittered(packing: &Packing<3>, copies: usize) -> Result<Packing<3>, Box<dyn Error>> {
    let lengths = packing.domain().lengths().ok_or("the packing is not periodic")?;
    let mut generator = Pcg64::seed_from_u64(1);
    let (mut positions, mut radii) = (Vec::new(), Vec::new());
    for copy in 0..copies.pow(3) {
        let along = [copy % copies, copy / copies % copies, copy / copies / copies];
        for (position, &radius) in packing.positions().iter().zip(packing.radii()) {
            positions.push(std::array::from_fn(|d| {
                position[d] + along[d] as f64 * lengths[d] + JITTER * (2.0 * generator.random::<f64>() - 1.0)
            }));
            radii.push(radius);
        }
    }
    let domain = Domain::rectangular([0.0; 3], lengths.map(|length| length * copies as f64));
    Ok(Packing::new(domain, positions, radii)?)
}
