//! Profiles of a medium on an elastic foundation against the plain formulas in 512 bits, and their limits.

use jamscope::reference::antiscreened::Antiscreened;
use jamscope::reference::elastic::Elastic;
use jamscope::reference::{Annulus, RadialSolution, ReferenceError};

use crate::precise_bessel::rounded;
use crate::precise_profile::{PreciseProfile, Sign, error};
use crate::random_annuli::{cases, holds};
use crate::{CLAIMED, annulus, radii};

/// Below this the displacement loses digits to underflow: its products reach the subnormal numbers.
const VANISHED: f64 = 1e-290;

fn profiles_have_their_digits<const D: usize>(count: u32) {
    holds(&format!("antiscreened, D = {D}"), count, cases(3), |case| {
        let medium = Antiscreened::<D>::new(case.annulus, 1.0, case.wavenumber).expect("valid");
        let (inner, outer) = (case.annulus.inner_radius(), case.annulus.outer_radius());
        let precise = PreciseProfile::<D>::new(Sign::Antiscreened, inner, outer, case.wavenumber);
        let mut shares = vec![(medium.value(inner) - 1.0).abs()];
        for &radius in &case.radii {
            let point = precise.point(radius);
            let found = [medium.value(radius), medium.derivative(radius), medium.wavenumber_derivative(radius)];
            let exact = [&point.value, &point.derivative, &point.wavenumber_derivative];
            for (found, exact) in found.into_iter().zip(exact) {
                // Nothing oscillates, so every error is relative.
                let size = rounded(exact).abs();
                shares.push(if size > VANISHED {
                    error(found, exact) / size / CLAIMED
                } else {
                    error(found, exact) / VANISHED
                });
            }
        }
        shares
    });
}

#[test]
fn antiscreened_profiles_and_both_derivatives_have_their_digits_in_two_dimensions() {
    profiles_have_their_digits::<2>(250);
}

#[test]
fn antiscreened_profiles_and_both_derivatives_have_their_digits_in_three_dimensions() {
    profiles_have_their_digits::<3>(250);
}

#[test]
fn no_foundation_is_the_elastic_solution_bit_for_bit() {
    let annulus = annulus(0.5, 42.0);
    for wavenumber in [0.0, 1e-12] {
        let medium = Antiscreened::<2>::new(annulus, 0.1, wavenumber).expect("valid");
        let elastic = Elastic::<2>::new(annulus, 0.1).expect("valid");
        for radius in radii(annulus, 50) {
            assert_eq!(medium.value(radius), elastic.value(radius));
            assert_eq!(medium.derivative(radius), elastic.derivative(radius));
        }
    }
}

/// From d_0 = 0.1 at a to 0 at R, with no node, and less where the foundation is stiffer.
fn falls_monotonically(annulus: Annulus, medium: &dyn RadialSolution, response: &dyn Fn(f64) -> f64) {
    let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
    assert_eq!((medium.value(inner), medium.value(outer)), (0.1, 0.0));
    assert_eq!((response(inner), response(outer)), (0.0, 0.0));
    assert!(medium.value(outer.next_up()).is_nan() && response(inner.next_down()).is_nan());
    let mut last = 0.1;
    for radius in radii(annulus, 40) {
        let (value, slope, response) = (medium.value(radius), medium.derivative(radius), response(radius));
        assert!(value >= 0.0 && value <= last, "{value} after {last} at {radius}");
        assert!(slope <= 0.0 && response <= 0.0, "{slope} and {response} at {radius}");
        assert!((value > VANISHED) <= (slope < 0.0 && response < 0.0), "at {radius}");
        last = value;
    }
}

#[test]
fn foundation_pulls_back_everywhere() {
    // κR up to 10⁶: no pole, no overflow.
    for (inner, outer) in [(0.5, 42.0), (3.0, 4.0), (1.0, 1.001), (1e-6, 1.0)] {
        let annulus = annulus(inner, outer);
        for argument in [1e-9, 1e-3, 0.7, 1.9, 2.1, 13.0, 24.9, 300.0, 1e6] {
            let medium = Antiscreened::<2>::new(annulus, 0.1, argument / outer).expect("valid");
            let shell = Antiscreened::<3>::new(annulus, 0.1, argument / outer).expect("valid");
            falls_monotonically(annulus, &medium, &|radius| medium.wavenumber_derivative(radius));
            falls_monotonically(annulus, &shell, &|radius| shell.wavenumber_derivative(radius));
        }
    }
}

#[test]
fn foundations_that_are_none_are_named() {
    let annulus = annulus(0.5, 42.0);
    for wavenumber in [-0.1, f64::NAN, f64::INFINITY, f64::MAX] {
        let error = Antiscreened::<2>::new(annulus, 0.1, wavenumber).expect_err("bad wavenumber");
        assert!(matches!(error, ReferenceError::WavenumberNegative { .. }), "{error}");
    }
    let error = Antiscreened::<3>::new(annulus, f64::NAN, 0.1).expect_err("bad amplitude");
    assert!(matches!(error, ReferenceError::AmplitudeNotFinite { .. }), "{error}");
}
