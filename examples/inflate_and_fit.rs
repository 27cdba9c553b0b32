//! Inflates one disk of a packing and fits the elastic and the screened solution to the response.
//!
//! ```text
//! cargo run --release --example inflate_and_fit
//! ```
//!
//! `prepare` and `inflate` relax by FIRE. The default of the program is the damped dynamics of the study: near jamming
//! another minimum, and another phase.

use jamscope::fit::profile::{ProfileFitSettings, fit_radial_profile};
use jamscope::preparation::Target;
use jamscope::{Annulus, DisplacementField, Inflation, Preparation, RadialProfile, inflate, prepare};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 1000 disks at p = 3000 [force / length]; seed 1 of the random points, and of the inflated disk.
    let prepared = prepare(&Preparation { target: Target::Pressure(3000.0), ..Preparation::default() })?;
    let inflated = inflate(&Inflation::default(), prepared.packing.get())?;
    let field = DisplacementField::of_inflation(&inflated);
    let profile = RadialProfile::of(&field, 1.0); // width of a ring [length]
    println!("Δp = {:.4}", inflated.after.pressure - inflated.before.pressure);

    println!("r [length], mean d_r [length], its standard error");
    for ring in &profile.rings {
        println!("{:6.2} {:10.5} {:9.5}", ring.radius, ring.mean, ring.standard_error);
    }

    // d_0^eff [length] of both solutions, κ [1 / length] of the screened one, and which of them describes the profile.
    let annulus = Annulus::new(field.inner_radius, field.outer_radius)?;
    let fit = fit_radial_profile::<2>(&profile, annulus, &ProfileFitSettings::default())?;
    let elastic = fit.elastic.amplitude;
    println!("elastic:  d_0^eff = {:.4} ± {:.4}", elastic.value, elastic.standard_error);
    if let Some(screened) = fit.screened {
        let (amplitude, wavenumber) = (screened.amplitude, screened.wavenumber);
        println!("screened: d_0^eff = {:.4} ± {:.4}", amplitude.value, amplitude.standard_error);
        println!("          κ = {:.4} ± {:.4}", wavenumber.value, wavenumber.standard_error);
    }
    println!("described by: {:?}", fit.decision);
    Ok(())
}
