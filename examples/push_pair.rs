//! Pushes two touching disks apart, a force dipole, and prints the modes n = 0 and 2 beside those of the continuum.
//!
//! ```text
//! cargo run --release --example push_pair
//! ```

use jamscope::inflation::{Drive, inflate_with};
use jamscope::observe::multipoles::MultipoleSettings;
use jamscope::preparation::Target;
use jamscope::relax::Fire;
use jamscope::run::DriveSummary;
use jamscope::{Hertzian, Inflation, Preparation, prepare};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let preparation = Preparation { disk_count: 3000, target: Target::Pressure(1000.0), ..Preparation::default() };
    let packing = prepare(&preparation)?.packing.into_inner();
    let (law, relaxer) = (Hertzian::default(), Fire::default());
    let drive = Drive::ForceDipole { force_over_mean: 0.1 };
    let pushed = inflate_with(&Inflation { drive, ..Inflation::default() }, &packing, &law, &relaxer, 1, &mut ())?;

    let summary = DriveSummary::of(&pushed, &packing, &law, None, &MultipoleSettings::default())?.ok_or("a drive")?;
    println!("F s = {:.3} along θ_0 = {:.3}", summary.moment.unwrap_or_default(), summary.angle);
    println!("{:>3} {:>8} {:>12} {:>12}", "n", "r", "d_r", "continuum");
    for ring in &summary.modes {
        println!("{:3} {:8.2} {:12.3e} {:12.3e}", ring.mode, ring.radius, ring.radial[0], ring.exact[0]);
    }
    Ok(())
}
