//! What S and G are like: power law, even, periodic, a pair of transforms, falling, smooth.

use std::f64::consts::PI;

use super::{claimed, lorentzian, steepness};

#[test]
fn spectrum_falls_from_one_with_the_exponent() {
    for (crossover, exponent) in [(0.0, 1.5), (1e-300, 1.5), (0.3, 2.0), (7.0, 1.5), (1e6, 3.0), (1e300, 4.0)] {
        let medium = lorentzian(crossover, exponent);
        assert_eq!(medium.spectrum(1.0), 1.0);
        // Ten times f†: 1 in (1 + 10^s) of the plateau; far out f^(−s).
        let far = 1e3 * crossover.max(1.0);
        let slope = -(medium.spectrum(2.0 * far) / medium.spectrum(far)).log2();
        // (f†/f)^s is left of the denominator.
        assert!((slope - exponent).abs() < 2.0 * (1e-3_f64).powf(exponent) + 1e-12, "{crossover}: {slope}");
        assert!(medium.spectrum(-1.0).is_nan() && medium.spectrum(f64::NAN).is_nan());
    }
    let half = lorentzian(7.0, 1.5);
    // S(f†) is half of A = 1 + f†^(−s).
    assert!((half.spectrum(7.0) - 0.5 * (1.0 + 7.0_f64.powf(-1.5))).abs() < 4.0 * f64::EPSILON);
}

#[test]
fn correlation_is_even_and_periodic() {
    for (crossover, exponent) in [(0.0, 1.5), (5.0, 1.5), (5.0, 3.0), (1e4, 2.2)] {
        let medium = lorentzian(crossover, exponent);
        for step in 1..50 {
            let angle = PI * f64::from(step) / 50.0;
            let (value, slope) = (medium.correlation(angle), medium.derivative(angle));
            assert_eq!(medium.correlation(-angle), value);
            assert_eq!(medium.derivative(-angle), -slope);
            for turns in [1.0, -3.0, 1000.0] {
                // The angle is rounded by half an ulp of itself, the turns are 2π to twice the digits.
                let moved = turns * 2.0 * PI + angle;
                let tolerance =
                    claimed(exponent) + 2.0 * f64::EPSILON * moved.abs() * steepness(crossover, exponent, angle);
                assert!((medium.correlation(moved) - value).abs() < tolerance, "{angle} + {turns} turns");
            }
            let mirrored = medium.correlation(2.0 * PI - angle);
            assert!(
                (mirrored - value).abs()
                    < claimed(exponent) + 8.0 * f64::EPSILON * steepness(crossover, exponent, angle)
            );
        }
        // 2²⁰ turns as a number are 2²⁰ · 2.449…·10⁻¹⁶ short of 2²⁰ turns, which G on its cusp can tell from none.
        let turns = f64::exp2(20.0);
        let (short, value) = (turns * 2.4492935982947064e-16, medium.correlation(turns * 2.0 * PI));
        let tolerance = claimed(exponent) + f64::EPSILON * short * steepness(crossover, exponent, short);
        assert!((value - medium.correlation(short)).abs() < tolerance, "{value}");
        assert!(exponent > 2.0 || value < 1.0 - 1e-6);
        assert_eq!(medium.correlation(0.0), 1.0);
        assert_eq!(medium.correlation(f64::MIN_POSITIVE * 1e-10), 1.0);
    }
}

/// ∫_0^π by the trapezoidal rule after θ = π/(1 + e^(−π sinh x)), which swallows any cusp at the ends.
fn integral(f: impl Fn(f64) -> f64) -> f64 {
    let step = 1.0 / 64.0;
    (-256..=256)
        .map(|n| {
            let x = step * f64::from(n);
            let share = 1.0 / (1.0 + (-PI * x.sinh()).exp());
            let weight = PI * PI * x.cosh() * share / (1.0 + (PI * x.sinh()).exp());
            if weight > 0.0 { step * weight * f(PI * share) } else { 0.0 }
        })
        .sum()
}

#[test]
fn cosine_coefficients_of_the_correlation_are_the_spectrum() {
    for (crossover, exponent) in [(0.0, 1.5), (0.5, 1.2), (5.0, 1.5), (5.0, 2.0), (8.0, 3.7), (40.0, 1.5)] {
        let medium = lorentzian(crossover, exponent);
        // Errors of G, at most claimed(exponent) each, and the rounding of a sum of 500 terms: together below 4 claimed(exponent) π.
        let tolerance = 4.0 * PI * claimed(exponent);
        // No constant part: f begins at 1.
        assert!(integral(|angle| medium.correlation(angle)).abs() < tolerance, "{crossover}, {exponent}");
        for frequency in [1.0, 2.0, 5.0, 17.0] {
            let found = 2.0 / PI * integral(|angle| medium.correlation(angle) * (frequency * angle).cos());
            let expected = medium.spectrum(frequency) / medium.total();
            assert!(
                (found - expected).abs() < tolerance,
                "{crossover}, {exponent}, f = {frequency}: {found}, {expected}"
            );
        }
    }
}

#[test]
fn correlation_falls_and_is_convex_up_to_an_exponent_of_two() {
    // Σ S cos fθ = −A/2 + ∫ K(t) cosh((π−θ)t)/sinh(πt) dt with K ≥ 0 for s ≤ 2.
    for exponent in [1.05, 1.5, 1.99, 2.0] {
        for crossover in [0.0, 1e-3, 1.0, 12.0, 1e5] {
            let medium = lorentzian(crossover, exponent);
            let mut last: Option<(f64, f64, f64)> = None;
            for step in 1..=200 {
                let angle = PI * (f64::from(step) / 200.0).powi(3);
                let (value, slope) = (medium.correlation(angle), medium.derivative(angle));
                let noise = 4.0 * claimed(exponent) * steepness(crossover, exponent, angle);
                assert!(slope < noise, "{exponent}, {crossover}, {angle}: {slope}");
                if let Some((before, value_before, slope_before)) = last {
                    assert!(
                        value < value_before + claimed(exponent) && slope > slope_before - noise,
                        "{exponent}, {crossover}"
                    );
                    // Convex: above its tangent, below its chord.
                    assert!(
                        value
                            > value_before + slope_before * (angle - before)
                                - claimed(exponent)
                                - noise * (angle - before)
                    );
                }
                last = Some((angle, value, slope));
            }
            // A mirror at π: no slope there.
            assert!(medium.derivative(PI).abs() < 4.0 * claimed(exponent) * crossover.max(1.0));
        }
    }
}

#[test]
fn derivative_is_the_slope_of_the_correlation() {
    for (crossover, exponent) in [(0.0, 1.5), (0.4, 1.1), (9.0, 1.5), (9.0, 2.7), (300.0, 5.0)] {
        let (medium, scale) = (lorentzian(crossover, exponent), crossover.max(1.0));
        for angle in [0.01, 0.2, 1.0, 2.0, 3.0] {
            let step = 1e-3 * f64::min(angle, 1.0 / scale);
            let difference = |h: f64| (medium.correlation(angle + h) - medium.correlation(angle - h)) / (2.0 * h);
            // Richardson: what is left is h⁴ G⁗'/30 with derivatives growing as 1/min(θ, 1/f†), (10⁻³)⁴ times up to 5!.
            let found = (4.0 * difference(0.5 * step) - difference(step)) / 3.0;
            let allowed = (1e-11 + 6.0 * claimed(exponent) / 1e-3) / f64::min(angle, 1.0 / scale);
            assert!((found - medium.derivative(angle)).abs() < allowed, "{crossover}, {exponent}, {angle}: {found}");
        }
    }
}
