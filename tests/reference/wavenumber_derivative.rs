//! Screened profiles, their derivatives in r and in κ, against the plain formulas in 512 bits, over the whole range claimed.

use jamscope::reference::rim::RimSolution;
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};

use crate::precise_bessel::rounded;
use crate::precise_profile::{Point, PreciseProfile, Sign, error};
use crate::random_annuli::{Case, cases, condition, holds, rim_scales};
use crate::{CLAIMED, annulus, radii};

/// What an error of ∂d/∂κ is measured in.
///
/// For κR < 2 and next to a the value itself; next to R its amplitude as κ changes, (R − a) d; elsewhere its amplitude as r
/// changes, by a difference quotient in multi-precision.
fn response_scale<const D: usize>(case: &Case, radius: f64, precise: &PreciseProfile<D>, point: &Point) -> f64 {
    let response = rounded(&point.wavenumber_derivative);
    let (inner, outer) = (case.annulus.inner_radius(), case.annulus.outer_radius());
    let length = radius.min(1.0 / case.wavenumber);
    if case.argument() < 2.0 || radius - inner < 0.5 * length {
        return response.abs();
    }
    if outer - radius < 0.5 * length {
        return response.hypot((outer - inner) * rounded(&point.value));
    }
    let step = 1e-3 * length;
    let [left, right] = [radius - step, radius + step].map(|r| rounded(&precise.point(r).wavenumber_derivative));
    response.hypot(length * (right - left) / (2.0 * step))
}

fn profiles_have_their_digits<const D: usize>(count: u32) {
    holds(&format!("screened, D = {D}"), count, cases(3), |case| {
        // A pole to rounding would be one case in 10¹².
        let medium = Screened::<D>::new(case.annulus, 1.0, case.wavenumber).expect("no pole");
        let rim = RimSolution::<D>::new(case.annulus, case.wavenumber).expect("valid");
        let (inner, outer) = (case.annulus.inner_radius(), case.annulus.outer_radius());
        let precise = PreciseProfile::<D>::new(Sign::Screened, inner, outer, case.wavenumber);
        let condition = condition::<D>(case);
        let mut shares = Vec::new();
        for &radius in &case.radii {
            let point = precise.point(radius);
            let [value, slope, response] = rim_scales(case, radius, &point);
            let ratio = (rounded(&point.value) / rounded(&point.rim[0])).abs();
            let mut take = |found: f64, exact, scale: f64| shares.push(error(found, exact) / scale / CLAIMED);
            take(rim.value(radius), &point.rim[0], value);
            take(rim.derivative(radius), &point.rim[1], slope);
            take(rim.wavenumber_derivative(radius), &point.rim[2], response);
            take(medium.value(radius), &point.value, ratio * value * condition);
            take(medium.derivative(radius), &point.derivative, ratio * slope * condition);
            // The pole is of second order in ∂d/∂κ, so its condition is twice that of d.
            let scale = response_scale(case, radius, &precise, &point);
            take(medium.wavenumber_derivative(radius), &point.wavenumber_derivative, scale * 2.0 * condition);
        }
        shares.push((medium.value(inner) - 1.0).abs());
        shares
    });
}

#[test]
fn screened_profiles_and_both_derivatives_have_their_digits_in_two_dimensions() {
    profiles_have_their_digits::<2>(250);
}

#[test]
fn screened_profiles_and_both_derivatives_have_their_digits_in_three_dimensions() {
    profiles_have_their_digits::<3>(250);
}

fn second_order_in_small_wavenumbers<const D: usize>() {
    // ∂d/∂κ = κ g(r) with a limit g: at a tenth of κ it is a tenth, but for a relative (κR)²/10.
    for (inner, outer) in [(0.5, 42.0), (3.0, 4.0), (1.0, 1e7)] {
        let annulus = annulus(inner, outer);
        for radius in radii(annulus, 20) {
            let reduced = |argument: f64| {
                let wavenumber = argument / outer;
                let medium = Screened::<D>::new(annulus, 0.1, wavenumber).expect("no pole");
                medium.wavenumber_derivative(radius) / wavenumber
            };
            let limit = reduced(1e-9);
            assert!(limit > 0.0, "{limit} at {radius}");
            for argument in [1e-150, 1e-30, 1e-8, 1.1e-8, 1e-7] {
                let found = reduced(argument);
                assert!((found / limit - 1.0).abs() < 2.0 * CLAIMED + argument * argument, "{found}, not {limit}");
            }
        }
    }
}

#[test]
fn derivative_in_the_wavenumber_vanishes_with_it() {
    second_order_in_small_wavenumbers::<2>();
    second_order_in_small_wavenumbers::<3>();
    let annulus = annulus(0.5, 42.0);
    let elastic = Screened::<2>::new(annulus, 0.1, 0.0).expect("elastic");
    assert!(radii(annulus, 20).all(|radius| elastic.wavenumber_derivative(radius) == 0.0));
}

fn ends_are_fixed<const D: usize>(annulus: Annulus, wavenumber: f64) {
    let medium = Screened::<D>::new(annulus, -0.3, wavenumber).expect("no pole");
    let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
    // d_0 is prescribed at a and 0 at R, whatever κ.
    assert_eq!((medium.wavenumber_derivative(inner), medium.wavenumber_derivative(outer)), (0.0, 0.0));
    assert!(medium.wavenumber_derivative(inner.next_down()).is_nan());
    assert!(medium.wavenumber_derivative(outer.next_up()).is_nan());
    let rim = RimSolution::<D>::new(annulus, wavenumber).expect("valid");
    assert_eq!(rim.wavenumber_derivative(outer), 0.0);
    assert!(rim.wavenumber_derivative(f64::NAN).is_nan());
    // d_0 of the other sign and another size.
    let other = Screened::<D>::new(annulus, 0.6, wavenumber).expect("no pole");
    for radius in radii(annulus, 9) {
        let (one, two) = (medium.wavenumber_derivative(radius), other.wavenumber_derivative(radius));
        assert!((two + 2.0 * one).abs() <= 4.0 * f64::EPSILON * two.abs(), "{one} and {two} at {radius}");
    }
}

#[test]
fn ends_do_not_move_with_the_wavenumber() {
    for (annulus, wavenumber) in crate::cases() {
        ends_are_fixed::<2>(annulus, wavenumber);
        ends_are_fixed::<3>(annulus, wavenumber);
    }
}
