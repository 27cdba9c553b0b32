//! Inflates a row of disks in a strip between held walls, fits the response and prints its spectrum along the row.
//!
//! ```text
//! cargo run --release --example inflate_row
//! ```

use std::f64::consts::PI;

use jamscope::fit::profile::{ProfileFitSettings, fit_radial_profile};
use jamscope::inflation::{Boundary, inflate_with};
use jamscope::observe::angular::{PowerSpectrum, RingSample, RingSettings, SpectrumSettings};
use jamscope::preparation::{Target, prepare_with};
use jamscope::relax::Fire;
use jamscope::{Annulus, DisplacementField, Hertzian, Inflation, Preparation, RadialProfile};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 4800 disks at p = 100 in a box four times as long as wide; the walls are 0.45 of its width from the line.
    let (law, relaxer) = (Hertzian::default(), Fire::default());
    let boundary = Boundary::HeldWalls { distance_over_side: 0.45, length_over_side: 4.0 };
    let side_ratio = boundary.side_ratio();
    let target = Target::Pressure(100.0);
    let preparation = Preparation { disk_count: 4800, target, side_ratio, ..Preparation::default() };
    let prepared = prepare_with::<2>(&preparation, &law, &relaxer, &mut ())?;

    let inflation = Inflation { increase: 0.02, boundary, ..Inflation::default() };
    let inflated = inflate_with(&inflation, prepared.packing.get(), &law, &relaxer, 1, &mut ())?;
    let field = DisplacementField::of_inflation(&inflated);
    let profile = RadialProfile::of(&field, 1.0); // width of a row of the profile [length]
    let interval = Annulus::new(field.inner_radius, field.outer_radius)?;
    let fit = fit_radial_profile::<1>(&profile, interval, &ProfileFitSettings::default())?;
    println!("{} disks grow; described by {:?}", inflated.grown.len(), fit.decision);
    println!("d_0^eff = {:.4} ± {:.4}", fit.elastic.amplitude.value, fit.elastic.amplitude.standard_error);

    let row = RingSample::of_field(&field, &RingSettings::default())?;
    let spectrum = PowerSpectrum::of(&row, &SpectrumSettings::default())?;
    let length = prepared.packing.get().domain().lengths().ok_or("a box has sides")?[0];
    println!("{} disks at half the distance to the wall; q, S(q)/S(2π/L)", row.disk_count());
    for (frequency, power) in spectrum.normalised().unwrap_or_default().into_iter().enumerate().skip(1).take(12) {
        println!("{:8.4} {power:8.3}", 2.0 * PI * frequency as f64 / length);
    }
    Ok(())
}
