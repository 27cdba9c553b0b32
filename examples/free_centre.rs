//! Inflates the same disk held and free, and prints the dipole and the quadrupole of both responses.
//!
//! ```text
//! cargo run --release --example free_centre
//! ```

use jamscope::inflation::inflate_with;
use jamscope::observe::multipoles::{MultipoleFit, MultipoleSettings, Multipoles};
use jamscope::preparation::Target;
use jamscope::relax::Fire;
use jamscope::{DisplacementField, Hertzian, Inflation, Preparation, prepare};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let preparation = Preparation { disk_count: 3000, target: Target::Pressure(1000.0), ..Preparation::default() };
    let packing = prepare(&preparation)?.packing.into_inner();
    println!("{:>12} {:>8} {:>12} {:>12}", "centre held", "r", "n = 1 share", "n = 2 share");
    for centre_held in [true, false] {
        let inflation = Inflation { centre_held, ..Inflation::default() };
        let inflated = inflate_with(&inflation, &packing, &Hertzian::default(), &Fire::default(), 1, &mut ())?;
        let modes = Multipoles::of(&DisplacementField::of_inflation(&inflated), &MultipoleSettings::default())?;
        for ring in modes.rings.iter().skip(5).step_by(5) {
            let MultipoleFit::Fitted { radial, .. } = &ring.fit else { continue };
            let [_, dipole, quadrupole, _] = radial.shares.unwrap_or_default();
            println!("{centre_held:>12} {:8.2} {dipole:12.4} {quadrupole:12.4}", ring.radius);
        }
    }
    Ok(())
}
