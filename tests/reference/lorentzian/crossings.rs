//! Threshold angles, their absence, and what is refused.

use std::f64::consts::PI;

use jamscope::reference::lorentzian::{ContinuumLorentzian, Crossing, Lorentzian, LorentzianError};
use jamscope::vector::larger;

use super::{at, claimed, continuum, lorentzian};

#[test]
fn crossings_are_where_the_correlation_is_the_threshold() {
    for exponent in [1.02, 1.5, 2.0, 2.5, 4.0, 9.0] {
        for crossover in [0.0, 1e-5, 0.8, 5.0, 1e3, 1e6] {
            let medium = lorentzian(crossover, exponent);
            for threshold in [0.999, 0.5, 0.2, 0.1, 0.05, 0.02] {
                match medium.crossing(threshold).expect("below 1") {
                    Crossing::At(angle) => {
                        assert!(angle > 0.0 && angle <= PI);
                        let tolerance = claimed(exponent) + 4.0 * f64::EPSILON * angle * medium.derivative(angle).abs();
                        assert!((medium.correlation(angle) - threshold).abs() < tolerance, "{exponent}, {crossover}");
                        // The first one: above the threshold all the way.
                        let above = (1..200).all(|n| medium.correlation(angle * f64::from(n) / 200.0) > threshold);
                        assert!(above, "{exponent}, {crossover}, {threshold}: not the first");
                    }
                    Crossing::Never { lowest } => panic!("{exponent}, {crossover}: never {threshold}, only {lowest}"),
                }
            }
        }
    }
}

#[test]
fn a_threshold_never_reached_has_a_name() {
    for (crossover, exponent) in [(0.0, 1.5), (3.0, 1.5), (3.0, 2.0), (1e6, 1.5)] {
        let medium = lorentzian(crossover, exponent);
        let lowest = medium.correlation(PI);
        assert_eq!(medium.crossing(lowest - 1e-9), Ok(Crossing::Never { lowest }));
        // At the lowest value itself G is flat: every angle with that value to rounding will do.
        let angle = at(medium.crossing(lowest));
        assert!(angle <= PI && medium.correlation(angle) - lowest < claimed(4.0));
    }
    // For s > 2 the lowest value need not be that at π. With f† = 8, s = 6, G is near that of eight equal modes.
    let medium = lorentzian(8.0, 6.0);
    let scanned = -(1..=100_000).map(|n| -medium.correlation(PI * f64::from(n) / 1e5)).fold(-1.0, larger);
    assert!(scanned < medium.correlation(PI) - 0.1);
    let Ok(Crossing::Never { lowest }) = medium.crossing(-0.9) else { panic!("never so low") };
    // The scan is within its step squared times the curvature of the minimum, f†² at most.
    assert!(lowest <= scanned && lowest > scanned - 64.0 * (PI / 1e5).powi(2), "{lowest}, {scanned}");
    // A dip between two points of the grid is found: just above its bottom, and not below it.
    let inside = at(medium.crossing(lowest + 1e-12));
    assert!((medium.correlation(inside) - lowest).abs() < 2e-12);
    assert_eq!(medium.crossing(lowest - 1e-12), Ok(Crossing::Never { lowest }));
    // The limit f† → ∞ tends to 0 and, up to s = 2, stays above.
    assert_eq!(continuum(1.5).crossing(0.0), Ok(Crossing::Never { lowest: 0.0 }));
    assert!((at(continuum(2.0).crossing(0.1)) - 10.0_f64.ln()).abs() < 1e-13);
    let Ok(Crossing::Never { lowest }) = continuum(4.0).crossing(-0.9) else { panic!("never so low") };
    // s = 4: √2 e^(−x/√2) cos(x/√2 − π/4) is lowest where x/√2 = π: −e^(−π).
    assert!((lowest + (-PI).exp()).abs() < claimed(4.0), "{lowest}");
}

#[test]
fn what_makes_no_sense_is_named() {
    for crossover in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = Lorentzian::new(crossover, 1.5).expect_err("bad crossover");
        assert!(matches!(error, LorentzianError::CrossoverNotPositive { .. }), "{error}");
        assert!(error.to_string().contains(&crossover.to_string()));
    }
    for exponent in [1.0, 0.5, -2.0, 100.5, f64::NAN, f64::INFINITY] {
        for error in [
            Lorentzian::new(5.0, exponent).expect_err("bad exponent"),
            Lorentzian::scale_free(exponent).expect_err("bad exponent"),
            ContinuumLorentzian::new(exponent).expect_err("bad exponent"),
        ] {
            assert!(matches!(error, LorentzianError::ExponentOutOfRange { .. }), "{error}");
            assert!(error.to_string().contains(&exponent.to_string()));
        }
    }
    let (medium, limit) = (lorentzian(5.0, 1.5), continuum(1.5));
    for threshold in [1.0, 2.0, f64::NAN, f64::INFINITY] {
        for error in [medium.crossing(threshold), limit.crossing(threshold)] {
            let error = error.expect_err("bad threshold");
            assert!(matches!(error, LorentzianError::ThresholdNotBelowOne { .. }), "{error}");
        }
    }
    for angle in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(medium.correlation(angle).is_nan() && medium.derivative(angle).is_nan());
        assert!(limit.correlation(angle).is_nan() && limit.derivative(angle).is_nan());
    }
    // A cusp has no slope; a smooth top has none to one side.
    assert!(medium.derivative(0.0).is_nan() && limit.derivative(0.0).is_nan());
    assert_eq!(lorentzian(5.0, 2.5).derivative(0.0), 0.0);
}
