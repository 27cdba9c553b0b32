//! Inflates one disk of a packing and fits the elastic and the screened solution to the response.
//!
//! ```text
//! cargo run --release --example inflate_and_fit
//! ```

use jamscope::fit::profile::{ProfileFitSettings, fit_radial_profile};
use jamscope::preparation::Target;
use jamscope::{Annulus, DisplacementField, Inflation, Preparation, RadialProfile, inflate, prepare};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let prepared = prepare(&Preparation { target: Target::Pressure(3000.0), ..Preparation::default() })?;
    let inflated = inflate(&Inflation::default(), prepared.packing.get())?;
    let field = DisplacementField::of_inflation(&inflated);
    let profile = RadialProfile::of(&field, 1.0);
    println!("Δp = {:.4}", inflated.after.pressure - inflated.before.pressure);

    println!("r [length], mean d_r [length], its standard error");
    for ring in &profile.rings {
        println!("{:6.2} {:10.5} {:9.5}", ring.radius, ring.mean, ring.standard_error);
    }

    // d_0^eff of the elastic solution, κ of the screened one, and which of them describes the profile.
    let annulus = Annulus::new(field.inner_radius, field.outer_radius)?;
    let fit = fit_radial_profile(&profile, annulus, &ProfileFitSettings::default())?;
    let elastic = fit.elastic.amplitude;
    println!("elastic:  d_0^eff = {:.4} ± {:.4}", elastic.value, elastic.standard_error);
    if let Some(screened) = fit.screened {
        println!("screened: κ = {:.4} ± {:.4}", screened.wavenumber.value, screened.wavenumber.standard_error);
    }
    println!("described by: {:?}", fit.decision);
    Ok(())
}
