//! Inflates one sphere of a packing in three dimensions, fits the response and prints its spectrum on a shell.
//!
//! ```text
//! cargo run --release --example inflate_sphere
//! ```

use jamscope::fit::profile::{ProfileFitSettings, fit_radial_profile};
use jamscope::inflation::inflate_with;
use jamscope::observe::shell::{SHELL_HALF_WIDTH, SHELL_RADIUS, ShellAnalysis, ShellSettings};
use jamscope::preparation::{Target, prepare_with};
use jamscope::relax::Fire;
use jamscope::{Annulus, DisplacementField, Hertzian, Inflation, Preparation, RadialProfile};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 4000 spheres at p = 1000 [force / length²], seed 1 of the random points, and of the inflated sphere.
    let (law, relaxer) = (Hertzian::default(), Fire::default());
    let preparation = Preparation { disk_count: 4000, target: Target::Pressure(1000.0), ..Preparation::default() };
    let prepared = prepare_with::<3>(&preparation, &law, &relaxer, &mut ())?;
    println!("packing fraction {:.4}, p = {:.1}", prepared.packing_fraction, prepared.pressure);

    let inflated = inflate_with(&Inflation::default(), prepared.packing.get(), &law, &relaxer, 1, &mut ())?;
    let field = DisplacementField::of_inflation(&inflated);
    let profile = RadialProfile::of(&field, 0.5); // width of a shell of the profile [length]
    let annulus = Annulus::new(field.inner_radius, field.outer_radius)?;
    let fit = fit_radial_profile::<3>(&profile, annulus, &ProfileFitSettings::default())?;
    let elastic = fit.elastic.amplitude;
    println!("described by {:?}: d_0^eff = {:.3} ± {:.3}", fit.decision, elastic.value, elastic.standard_error);

    let shell = ShellAnalysis::of(&field, SHELL_RADIUS, SHELL_HALF_WIDTH, &ShellSettings::default())?;
    println!("{} spheres at r = R/2; degree ℓ, S(ℓ)", shell.disk_count);
    for (degree, power) in shell.spectrum.normalised().unwrap_or_default().iter().enumerate().skip(1) {
        println!("{degree:3} {power:8.3}");
    }
    Ok(())
}
