//! Pushes one disk with a force and compares the response with Kelvin's solution in a circle with a held rim.
//!
//! ```text
//! cargo run --release --example push_disk
//! ```

use jamscope::inflation::{Drive, inflate_with};
use jamscope::observe::multipoles::MultipoleSettings;
use jamscope::preparation::Target;
use jamscope::relax::Fire;
use jamscope::run::DriveSummary;
use jamscope::{Hertzian, Inflation, Preparation, prepare};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 3000 disks at p = 1000; the force is a tenth of the mean contact force, along x.
    let preparation = Preparation { disk_count: 3000, target: Target::Pressure(1000.0), ..Preparation::default() };
    let packing = prepare(&preparation)?.packing.into_inner();
    let (law, relaxer) = (Hertzian::default(), Fire::default());
    let drive = Drive::PointForce { force_over_mean: 0.1 };
    let pushed = inflate_with(&Inflation { drive, ..Inflation::default() }, &packing, &law, &relaxer, 1, &mut ())?;

    // The medium has the moduli of the packing; nothing is fitted.
    let summary = DriveSummary::of(&pushed, &packing, &law, None, &MultipoleSettings::default())?.ok_or("a drive")?;
    println!("F/μ = {:.4}, ν = {:.3}", summary.force / summary.shear_modulus, summary.poisson_ratio);
    println!("{:>8} {:>12} {:>12} {:>12}", "r", "d_r cos θ", "error", "continuum");
    for ring in &summary.modes {
        let [amplitude, error] = ring.radial;
        println!("{:8.2} {amplitude:12.3e} {error:12.1e} {:12.3e}", ring.radius, ring.exact[0]);
    }
    Ok(())
}
