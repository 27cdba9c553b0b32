//! A packing from a file: is it at rest, and how does it respond to an inflation?
//!
//! ```text
//! cargo run --release --example own_packing [FILE]
//! ```
//!
//! Extended XYZ with a column `radius`, LAMMPS data (`atom_style sphere`) and LAMMPS dumps are read.

use jamscope::certificate::Certificate;
use jamscope::inflation::inflate_with;
use jamscope::io::write_packing;
use jamscope::relax::Relaxer;
use jamscope::{Fire, Hertzian, Inflation, read_packing};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).unwrap_or_else(|| "fixtures/packings/hertz_N1000_p100.xyz".into());
    let packing = read_packing::<2>(&file)?;
    let (law, fire) = (Hertzian::default(), Fire::default());
    println!("{}: {} disks, {:?}", file, packing.len(), packing.domain());
    let residual = Certificate::of(&packing, &law, None)?.relative_residual;
    println!("residual as read {residual:.1e}");

    // A relaxation is an outcome; only one that converged has a packing at rest.
    let outcome = fire.relax(packing, &law, &mut ())?;
    println!("{:?} after {} steps", outcome.stop, outcome.cost.step_count);
    let packing = outcome.converged().map_err(|outcome| format!("not at rest: {:?}", outcome.stop))?.into_inner();

    let seed = 1; // seed of the inflated disk; `&mut ()` above and below: no observer
    let inflated = inflate_with(&Inflation::default(), &packing, &law, &fire, seed, &mut ())?;
    println!("Δp = {:.4}", inflated.after.pressure - inflated.before.pressure);
    let after = std::env::temp_dir().join("jamscope_after.xyz");
    write_packing(&after, inflated.after.packing.get(), &[], &[])?;
    println!("written to {}", after.display());
    Ok(())
}
