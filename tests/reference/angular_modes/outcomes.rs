//! Angular modes at the boundaries of what they are defined for: both circles, poles, extremes, bad arguments.

use jamscope::reference::angular_modes::elastic::ElasticMode;
use jamscope::reference::angular_modes::screened::{ScreenedMode, Screening};
use jamscope::reference::angular_modes::{AngularModeError, AngularSolution, ModeAmplitudes};
use jamscope::reference::poles::pole;
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};

use super::{boundaries, claimed_screened, elastic, screened, screening, size};
use crate::annulus;

#[test]
fn boundary_values_are_exact_and_nothing_is_defined_outside() {
    for (outer, mode) in [(340.0, 0), (340.0, 1), (1.001, 4), (1e7, 30)] {
        let annulus = annulus(1.0, outer);
        for boundary in boundaries() {
            let media: [&dyn AngularSolution; 3] = [
                &elastic(annulus, 0.3, mode, boundary),
                &screened(annulus, 0.3, screening(annulus, 30.0, 0.0), mode, boundary),
                &screened(annulus, 0.3, screening(annulus, -30.0, 11.0), mode, boundary),
            ];
            for medium in media {
                assert_eq!(medium.mode(), mode);
                assert_eq!(medium.at(1.0).value, boundary);
                assert_eq!(size(&medium.at(outer).value), 0.0);
                for radius in [0.999, outer * 1.001, f64::NAN] {
                    let state = medium.at(radius);
                    for amplitude in [
                        state.value.radial,
                        state.value.transverse,
                        state.derivative.radial,
                        state.derivative.transverse,
                    ] {
                        assert!(amplitude.re.is_nan() && amplitude.im.is_nan(), "{amplitude} at {radius}");
                    }
                }
            }
        }
    }
}

#[test]
fn poles_are_outcomes() {
    // n = 0: the pole of the Bessel profile.
    let here = annulus(0.5, 170.0);
    let boundary = ModeAmplitudes::in_phase(0.1, 0.0);
    let at = |even: f64, mode: u32, boundary: ModeAmplitudes| {
        ScreenedMode::new(here, 0.3, Screening { even, odd: 0.0 }, mode, boundary)
    };
    let square = Screening::from_wavenumber(pole::<2>(here, 1), 0.3).even;
    for away in [1e-2, 1e-4, 1e-6, 1e-9] {
        let medium = at(square * (1.0 + away), 0, boundary).expect("not at the pole");
        let ratio = medium.condition() * away;
        assert!(ratio > 0.2 && ratio < 2.0, "{} at {away}", medium.condition());
        // What the condition leaves is there: κ = √(ε Γ), rounded by 2⁻⁵², its condition 2/away.
        let bessel = Screened::<2>::new(here, 0.1, (0.35 * square * (1.0 + away)).sqrt()).expect("not at the pole");
        let allowed = claimed_screened(&medium) + (3.2e-15 + f64::EPSILON) * 2.0 / away;
        for radius in [1.0, 30.0, 100.0, 160.0] {
            let (found, exact) = (medium.at(radius).value.radial.re, bessel.value(radius));
            assert!((found / exact - 1.0).abs() < allowed, "{found}, not {exact} at {radius}, {away}");
        }
    }
    let nearest = (-4..=4).map(|step| square * (1.0 + f64::from(step) * f64::EPSILON));
    let refused =
        nearest.filter(|&even| matches!(at(even, 0, boundary), Err(AngularModeError::AtPole { mode: 0, .. })));
    assert!(refused.count() > 0, "the first pole of inflation");

    // n = 2: bisection on the sign of the slope at the rim ends at a number that is refused by name.
    let slope = |even: f64| at(even, 2, boundary).map(|medium| medium.at(170.0).derivative.radial.re);
    let (mut low, mut high) = (1e-4, 2e-3);
    let sign = slope(low).expect("not at a pole") > 0.0;
    assert_ne!(sign, slope(high).expect("not at a pole") > 0.0, "a pole lies between");
    let refused = loop {
        let middle = 0.5 * (low + high);
        match slope(middle) {
            Err(error) => break Some(error),
            Ok(slope) if (slope > 0.0) == sign => low = middle,
            Ok(_) => high = middle,
        }
        if high - low <= f64::EPSILON * low {
            break None;
        }
    };
    assert!(
        matches!(refused, Some(AngularModeError::AtPole { mode: 2, condition, .. }) if condition > 1e12),
        "{refused:?}"
    );
}

#[test]
fn extremes_stay_finite() {
    let finite = |medium: &dyn AngularSolution, annulus: Annulus| {
        let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
        let between = [0.5 * (inner + outer), (inner.ln() * 0.5 + outer.ln() * 0.5).exp().clamp(inner, outer)];
        for radius in [inner, outer].into_iter().chain(between) {
            let state = medium.at(radius);
            assert!((size(&state.value) + size(&state.derivative)).is_finite(), "{state:?} at {radius}, {annulus:?}");
            assert!(size(&state.value) <= 10.0, "{state:?} at {radius}, {annulus:?}");
        }
    };
    for (inner, outer) in [(1e-200, 1e200), (1e-280, 1e-270), (1e291, 1e301), (1.0, 1.0 + 1e-12)] {
        for mode in [1, 2, 1000, u32::MAX] {
            finite(&elastic(annulus(inner, outer), 0.3, mode, boundaries()[3]), annulus(inner, outer));
        }
    }
    let cases = [
        (1e7, 1000, 10.0, 0.0),
        (340.0, 2, 1e8, 0.0),
        (340.0, 2, -1e8, 0.0),
        (340.0, 0, 1e6, 1e8),
        (1.0 + 1e-12, 1, 40.0, 3.0),
    ];
    for (outer, mode, even, odd) in cases {
        let annulus = annulus(1.0, outer);
        finite(&screened(annulus, 0.3, screening(annulus, even, odd), mode, boundaries()[3]), annulus);
    }
}

#[test]
fn bad_arguments_are_named() {
    let annulus = annulus(0.5, 170.0);
    let boundary = ModeAmplitudes::in_phase(0.1, 0.0);
    for ratio in [-1.0, 1.0, 2.0, f64::NAN, f64::INFINITY] {
        let error = ElasticMode::new(annulus, ratio, 2, boundary).expect_err("outside");
        assert!(matches!(error, AngularModeError::PoissonRatioOutside { .. }), "{error}");
        let error = ScreenedMode::new(annulus, ratio, Screening::default(), 2, boundary).expect_err("outside");
        assert!(matches!(error, AngularModeError::PoissonRatioOutside { .. }), "{error}");
    }
    for bad in [f64::NAN, f64::INFINITY] {
        for boundary in [ModeAmplitudes::in_phase(bad, 0.0), ModeAmplitudes::in_phase(0.0, bad)] {
            let error = ElasticMode::new(annulus, 0.3, 2, boundary).expect_err("not finite");
            assert!(matches!(error, AngularModeError::AmplitudeNotFinite { .. }), "{error}");
        }
        for screening in [Screening { even: bad, odd: 0.0 }, Screening { even: 0.0, odd: bad }] {
            let error = ScreenedMode::new(annulus, 0.3, screening, 2, boundary).expect_err("not finite");
            assert!(matches!(error, AngularModeError::ScreeningNotFinite { .. }), "{error}");
        }
    }
    for (even, mode) in [(1e7, 2), (1e300, 2), (0.0, 100_000)] {
        let screening = Screening { even, odd: 0.0 };
        let error = ScreenedMode::new(annulus, 0.3, screening, mode, boundary).expect_err("too fine");
        assert!(matches!(error, AngularModeError::TooManyNodes { .. }), "{error}");
    }
    // κ (R − a) is 10⁵ only, but R − a is 4500 roundings of R.
    let thin = Annulus::new(1.0, 1.0 + 1e-12).expect("radii are in order");
    let error = ScreenedMode::new(thin, 0.3, Screening { even: 0.0, odd: 1e34 }, 2, boundary).expect_err("too large");
    assert!(matches!(error, AngularModeError::ScreeningTooLarge { odd: 1e34, .. }), "{error}");
}
