//! The fit of the response of disks tied to sites returns the wavenumber and the amplitude put in.

use jamscope::fit::profile::{Decision, ProfileFit, ProfileFitSettings, fit_radial_profile};

use super::*;

fn fitted(profile: &RadialProfile, outer_radius: f64) -> ProfileFit {
    let annulus = Annulus::new(0.5, outer_radius).expect("an annulus");
    fit_radial_profile::<2>(profile, annulus, &ProfileFitSettings::default()).expect("a fit")
}

/// κ fitted over κ put in, less one; the amplitude fitted over B d_0/a, less one; the branch.
fn recovered(law: &dyn PairLaw, ratio: f64, reduced: f64, effective: bool) -> (f64, f64, usize) {
    let lattice = triangular(0.05);
    let circle = lattice.circle(0.5 * ratio).expect("a circle");
    let rim = lattice.effective_radius(&circle).expect("triangular");
    let wavenumber = reduced / rim;
    let coupling = lattice.coupling(law, wavenumber * wavenumber).expect("isotropic");
    let response = response(&circle, &OnSite { law: law.shared(), coupling });
    assert!(response.backward_error < 1e-14, "{:e}", response.backward_error);
    let increase = 0.1;
    let field = field(&circle, &response, increase, 0.5 * ratio);
    let fit = fitted(&RadialProfile::of(&field, 1.0), if effective { rim } else { 0.5 * ratio });
    let screened = fit.screened.expect("a solution");
    assert_eq!(fit.decision, Decision::Screened, "R/a = {ratio}, κR = {reduced}: {fit:?}");
    let amplitude = lattice.growth_amplitude(law).expect("isotropic") * increase / 0.5;
    (screened.wavenumber.value / wavenumber - 1.0, screened.amplitude.value / amplitude - 1.0, screened.branch)
}

#[test]
fn the_fit_returns_the_screening_wavenumber_put_in_below_the_first_pole_and_between_the_first_two() {
    for ratio in [100.0, 200.0] {
        // κ_1 R = 3.83, κ_2 R = 7.02.
        for (reduced, branch) in [(2.0, 0), (3.0, 0), (5.0, 1), (6.0, 1)] {
            let hertzian = recovered(&hertzian(), ratio, reduced, true);
            let hookean = recovered(&Hookean { stiffness: 1.0 }, ratio, reduced, true);
            println!("R/a = {ratio}, κR = {reduced}: {hertzian:?}, {hookean:?}");
            for (wavenumber, amplitude, found) in [hertzian, hookean] {
                assert_eq!(found, branch);
                assert!(wavenumber.abs() < 1e-3, "R/a = {ratio}, κR = {reduced}: κ off by {wavenumber:e}");
                assert!(amplitude.abs() < 2e-2, "R/a = {ratio}, κR = {reduced}: d_0 off by {amplitude:e}");
            }
        }
    }
}

#[test]
fn the_wavenumber_errs_by_second_order_with_the_effective_rim_and_by_first_with_the_nominal_one() {
    let ratios = [60.0, 85.0, 120.0, 170.0, 240.0];
    let errors = |effective: bool| -> Vec<(f64, f64)> {
        let law = hertzian();
        ratios.iter().map(|&ratio| (ratio, recovered(&law, ratio, 5.5, effective).0.abs())).collect()
    };
    let (nominal, effective) = (errors(false), errors(true));
    let (first, second) = (-slope(&nominal), -slope(&effective));
    println!("orders {first:.3} {nominal:?}, {second:.3} {effective:?}");
    assert!((first - 1.0).abs() < 0.25, "order {first}: {nominal:?}");
    assert!((second - 2.0).abs() < 0.4, "order {second}: {effective:?}");
}
