//! Fits in a strip, D = 1: the elastic line and the screened sine, whose poles are nπ/(R − a).

use std::f64::consts::PI;

use super::*;

/// R of the strip; the row has a = 0.5, rings one diameter wide.
const RIM: f64 = 42.0;

fn strip() -> Annulus {
    Annulus::new(0.5, RIM).expect("an interval")
}

/// The rows of an exact displacement, written out here: no code of the library but its phases, d_0 sin κ(R−r)/sin κ(R−a).
fn profile(displacement: impl Fn(f64) -> f64) -> RadialProfile {
    let rings = (1..41).map(|index| {
        let radius = f64::from(index) + 0.5;
        Ring { radius, disk_count: 50, mean: displacement(radius), spread: 0.0, standard_error: 0.0 }
    });
    RadialProfile { rings: rings.collect() }
}

fn sine(amplitude: f64, wavenumber: f64) -> impl Fn(f64) -> f64 {
    move |radius| amplitude * (wavenumber * (RIM - radius)).sin() / (wavenumber * (RIM - 0.5)).sin()
}

fn fit(profile: &RadialProfile) -> ProfileFit {
    fit_radial_profile::<1>(profile, strip(), &ProfileFitSettings::default()).expect("a profile that can be fitted")
}

#[test]
fn exact_profiles_of_a_strip_are_recovered_in_every_branch() {
    let largest = fit(&profile(sine(0.05, 0.1))).largest_wavenumber;
    let mut worst = [0.0; 2];
    for step in 1..60 {
        let wavenumber = 0.98 * largest * f64::from(step) / 60.0;
        let found = fit(&profile(sine(0.05, wavenumber)));
        let solution = found.screened.expect("screened");
        let off = [solution.wavenumber.value / wavenumber - 1.0, solution.amplitude.value / 0.05 - 1.0].map(f64::abs);
        worst = [larger(worst[0], off[0]), larger(worst[1], off[1])];
        // As in the plane: Brent to 1.5·10⁻⁸, squared by one step; rounding times the condition κ_n/(κ − κ_n).
        assert!(off[0] < 1e-10 && off[1] < 1e-8, "{wavenumber}: {solution:?}");
        assert!(solution.wavenumber.standard_error < 1e-10 * wavenumber);
        assert_eq!(found.decision, Decision::Screened);
        assert_eq!(solution.branch, (wavenumber * (RIM - 0.5) / PI).floor() as usize);
    }
    println!("largest relative errors of κ and d_0: {worst:?}");
}

#[test]
fn an_evenly_stretched_strip_is_elastic() {
    let found = fit(&profile(|radius| 0.05 * (RIM - radius) / (RIM - 0.5)));
    assert_eq!(found.decision, Decision::Elastic);
    // Four roundings of the profile, and as many of the fit.
    assert!((found.elastic.amplitude.value / 0.05 - 1.0).abs() < 1e-15, "{found:?}");
    assert!(found.elastic.share_described > 1.0 - 1e-15);
    // χ²/χ²_0 = 10⁻³² allows a (κR)⁴/36 of that size, times the number of rings.
    assert!(found.elastic.wavenumber_bound.expect("a bound") * RIM < 1e-6, "{found:?}");
}

#[test]
fn the_first_pole_of_a_strip_is_fitted_with_a_vanishing_amplitude() {
    let first = PI / (RIM - 0.5);
    let found = fit(&profile(|radius| 0.01 * (first * (RIM - radius)).sin()));
    let screened = found.screened.expect("screened");
    assert_eq!(found.decision, Decision::Screened);
    // κ to 10⁻¹⁰ as above; sin κ(R−a) is then below π·10⁻¹⁰, of a largest displacement of 0.01.
    assert!((screened.wavenumber.value / first - 1.0).abs() < 1e-10, "{screened:?}");
    assert!(screened.amplitude.value.abs() < 4e-12, "{screened:?}");
}
