//! G, G' and Σ S against values of 25 digits, closed forms, and the sum of the terms.

use std::f64::consts::PI;

use jamscope::reference::lorentzian::{Lorentzian, USUAL_EXPONENT};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use serde_json::Value;

use super::{at, claimed, continuum, lorentzian, steepness};
use crate::seeds::config;
use crate::{Worst, fixture, number, rows};

/// An angle of a fixture; the name `pi` stands for π.
fn angle(value: &Value) -> f64 {
    if value == "pi" { PI } else { number(value) }
}

#[test]
fn correlation_has_its_digits_at_the_usual_exponent() {
    let fixture = fixture("lorentzian.json");
    let mut worst = Worst::default();
    for row in rows(&fixture) {
        let (angle, expected) = (angle(&row[1]), number(&row[2]));
        let found = lorentzian(number(&row[0]), USUAL_EXPONENT);
        worst.take((found.correlation(angle) - expected).abs() / claimed(USUAL_EXPONENT), || row.to_string());
    }
    worst.finish("G", 104);
}

#[test]
fn totals_and_crossings_have_their_digits_at_the_usual_exponent() {
    let fixture = fixture("lorentzian.json");
    let mut worst = Worst::default();
    for row in fixture["theta_star"].as_array().expect("rows") {
        let crossover = number(&row["fd"]);
        let found = lorentzian(crossover, USUAL_EXPONENT);
        // The fixture has A = 1; S(1) = 1 is A = 1 + f†^(−s), known to three roundings.
        let total = number(&row["norm_sum"]) * (1.0 + crossover.powf(-USUAL_EXPONENT));
        worst.take((found.total() / total - 1.0).abs() / claimed(USUAL_EXPONENT), || format!("total of {row}"));
        let expected = number(&row["theta_star_0p1"]);
        let angle = at(found.crossing(0.1));
        let allowed = claimed(USUAL_EXPONENT) / (expected * found.derivative(expected).abs()) + 2.0 * f64::EPSILON;
        worst.take((angle / expected - 1.0).abs() / allowed, || format!("θ* of {row}"));
        let anticorrelation = number(&row["minus_G_pi"]);
        worst.take((found.anticorrelation() - anticorrelation).abs() / claimed(USUAL_EXPONENT), || {
            format!("G* of {row}")
        });
    }
    worst.finish("total, θ*, G*", 39);
}

#[test]
fn both_limits_have_their_digits_at_the_usual_exponent() {
    let fixture = fixture("lorentzian.json");
    let (zero, infinite) = (&fixture["limit_fd_to_0"], &fixture["limit_fd_to_inf"]);
    let mut worst = Worst::default();
    let scale_free = lorentzian(0.0, USUAL_EXPONENT);
    for row in zero["G_table"].as_array().expect("rows") {
        let error = scale_free.correlation(angle(&row[0])) - number(&row[1]);
        worst.take(error.abs() / claimed(USUAL_EXPONENT), || format!("f† → 0, {row}"));
    }
    worst.take((scale_free.total() / number(&zero["zeta_3_2"]) - 1.0).abs() / claimed(USUAL_EXPONENT), || {
        "ζ(3/2)".into()
    });
    worst.take((scale_free.anticorrelation() - (1.0 - 0.5_f64.sqrt())).abs() / claimed(USUAL_EXPONENT), || {
        "1 − 1/√2".into()
    });
    for (threshold, name) in [(0.1, "theta_star_0p1"), ((-1.0_f64).exp(), "theta_star_1_over_e"), (0.0, "theta_zero")] {
        let expected = number(&zero[name]);
        // |dG/dθ| θ is above 0.2 at all three.
        assert!(expected * scale_free.derivative(expected) < -0.2);
        worst.take((at(scale_free.crossing(threshold)) / expected - 1.0).abs() * 0.2 / claimed(USUAL_EXPONENT), || {
            name.into()
        });
    }
    let limit = continuum(USUAL_EXPONENT);
    for row in infinite["g_table"].as_array().expect("rows") {
        let error = limit.correlation(number(&row[0])) - number(&row[1]);
        worst.take(error.abs() / claimed(USUAL_EXPONENT), || format!("f† → ∞, {row}"));
    }
    for (threshold, name) in [(0.1, "k_0p1"), ((-1.0_f64).exp(), "k_1_over_e")] {
        let expected = number(&infinite[name]);
        assert!(expected * limit.derivative(expected) < -0.1);
        worst.take((at(limit.crossing(threshold)) / expected - 1.0).abs() * 0.1 / claimed(USUAL_EXPONENT), || {
            name.into()
        });
    }
    worst.finish("limits", 8 + 1 + 1 + 3 + 9 + 2);
    // θ* = 0.303004 π as f† → 0; f†θ* = 1.681334 as f† → ∞.
    assert!((at(scale_free.crossing(0.1)) / PI - 0.303004).abs() < 5e-7);
    assert!((at(limit.crossing(0.1)) - 1.681334).abs() < 5e-7);
}

#[test]
fn correlation_and_derivative_have_their_digits_at_other_exponents() {
    let fixture = fixture("lorentzian_exponents.json");
    let (mut values, mut slopes, mut totals) = (Worst::default(), Worst::default(), Worst::default());
    for case in fixture["cases"].as_array().expect("cases") {
        let (exponent, crossover) = (number(&case["s"]), number(&case["fd"]));
        let claimed = claimed(exponent);
        let found = lorentzian(crossover, exponent);
        let name = |what: &str| format!("{what} of s = {exponent}, f† = {crossover}");
        totals.take((found.total() / number(&case["total"]) - 1.0).abs() / claimed, || name("total"));
        for row in rows(case) {
            let (angle, value, slope) = (angle(&row[0]), number(&row[1]), number(&row[2]));
            // The angle is rounded too, by half an ulp.
            let rounding = 0.5 * f64::EPSILON * (angle * slope).abs();
            values.take((found.correlation(angle) - value).abs() / (claimed + rounding), || name(&row.to_string()));
            // Weights times frequencies: the error is that of G times the steepness; and the rounding of the angle.
            let allowed = 4.0 * claimed * steepness(crossover, exponent, angle);
            slopes.take((found.derivative(angle) - slope).abs() / allowed, || name(&row.to_string()));
        }
    }
    values.finish("G", 9 * 8 * 7);
    slopes.finish("dG/dθ", 9 * 8 * 7);
    totals.finish("total", 9 * 8);
}

/// Σ cos fθ/(1 + f²/c²) and its derivative; with A = 1 + c^(−2) in front of both.
fn square(crossover: f64, angle: f64) -> (f64, f64) {
    let c = crossover;
    let (near, far) = ((-c * angle).exp(), (-c * (2.0 * PI - angle)).exp());
    let front = 0.5 * PI * c / -(-2.0 * PI * c).exp_m1();
    let amplitude = 1.0 + 1.0 / (c * c);
    (amplitude * (front * (near + far) - 0.5), amplitude * front * c * (far - near))
}

/// The same for the exponent 4: `c⁴/(f⁴ + c⁴) = c² Im 1/(f² + b²)` with b = c e^(−iπ/4).
fn quartic(crossover: f64, angle: f64) -> (f64, f64) {
    let (c, b) = (crossover, crossover * 0.5_f64.sqrt());
    // e^(−bx), b → b(1 − i): real and imaginary part.
    let wave = |x: f64| ((-b * x).exp() * (b * x).cos(), (-b * x).exp() * (b * x).sin());
    let (near, far, turn) = (wave(angle), wave(2.0 * PI - angle), wave(2.0 * PI));
    let divided = |(x, y): (f64, f64), (u, v): (f64, f64)| {
        let norm = u * u + v * v;
        ((x * u + y * v) / norm, (y * u - x * v) / norm)
    };
    let kernel = (1.0 - turn.0, -turn.1);
    let (sum, difference) =
        (divided((near.0 + far.0, near.1 + far.1), kernel), divided((far.0 - near.0, far.1 - near.1), kernel));
    let value = divided(sum, (b, -b)).1;
    let amplitude = 1.0 + c.powi(-4);
    (amplitude * (0.5 * c * c * PI * value - 0.5), amplitude * 0.5 * c * c * PI * difference.1)
}

#[test]
fn closed_forms_of_exponents_two_and_four_hold() {
    let (mut values, mut slopes) = (Worst::default(), Worst::default());
    for (exponent, closed) in [(2.0, square as fn(f64, f64) -> (f64, f64)), (4.0, quartic)] {
        for crossover in [1.0, 1.3, 1.5, 2.0, 7.0, 31.4, 1e3, 1e6] {
            let found = lorentzian(crossover, exponent);
            // At θ = 0.
            let total = closed(crossover, 0.0).0;
            values.take((found.total() / total - 1.0).abs() / claimed(exponent), || format!("total at {crossover}"));
            for step in 0..60 {
                let angle = PI / crossover * 1.3_f64.powi(step - 40);
                if angle > PI {
                    continue;
                }
                let (value, slope) = closed(crossover, angle);
                // The closed form itself subtracts 1/2 and rounds f†θ.
                let name = || format!("s = {exponent}, f† = {crossover}, θ = {angle}");
                values.take((found.correlation(angle) - value / total).abs() / claimed(exponent), name);
                let allowed = 4.0 * claimed(exponent) * steepness(crossover, exponent, angle);
                slopes.take((found.derivative(angle) - slope / total).abs() / allowed, name);
            }
        }
    }
    let (value_count, slope_count) = (values.count, slopes.count);
    assert!(slope_count > 600);
    values.finish("closed forms", value_count);
    slopes.finish("closed forms, derivative", slope_count);
}

#[test]
fn scale_free_limit_has_the_bernoulli_polynomials() {
    // Σ cos fθ/f² = π²/6 − πθ/2 + θ²/4,  Σ cos fθ/f⁴ = π⁴/90 − π²θ²/12 + πθ³/12 − θ⁴/48 (A&S 27.8.6).
    let (two, four) = (lorentzian(0.0, 2.0), lorentzian(0.0, 4.0));
    assert!((two.total() / (PI * PI / 6.0) - 1.0).abs() < claimed(4.0));
    assert!((four.total() / (PI.powi(4) / 90.0) - 1.0).abs() < claimed(4.0));
    for step in 1..=100 {
        let x = PI * f64::from(step) / 100.0;
        let second = 1.0 + (0.25 * x * x - 0.5 * PI * x) * 6.0 / (PI * PI);
        let fourth = 1.0 + (-PI * PI / 12.0 + PI * x / 12.0 - x * x / 48.0) * x * x * 90.0 / PI.powi(4);
        assert!((two.correlation(x) - second).abs() < claimed(4.0), "{x}");
        assert!((four.correlation(x) - fourth).abs() < claimed(4.0), "{x}");
        let slope = (0.5 * x - 0.5 * PI) * 6.0 / (PI * PI);
        assert!((two.derivative(x) - slope).abs() < 4.0 * claimed(4.0), "{x}");
    }
}

/// Σ S(f) cos fθ by its terms to F and summation by parts beyond, with the largest error there can be.
///
/// With z = e^(iθ) and differences Δ of S,
/// `Σ_(f≥F) S z^f = z^F/(1−z) Σ_(j<m) (z/(1−z))^j Δ^j S(F) + (z/(1−z))^m Σ_(f≥F) Δ^m S z^f`, and for F > 2 s f† and beyond
/// all Δ^m S up to m = 2 have one sign, so that the last term is at most |Δ^(m−1) S(F)|/|1−z|^m, here with m = 2.
fn direct(medium: &Lorentzian, angle: f64, last: u32) -> (f64, f64) {
    let spectrum = |f: u32| medium.spectrum(f64::from(f));
    let (mut sum, mut sizes) = (0.0, 0.0);
    for f in (1..last).rev() {
        let term = spectrum(f);
        sum += term * (f64::from(f) * angle).cos();
        // cos of a rounded argument, and the rounding of S and of the sum.
        sizes += term * (4.0 + f64::from(f) * angle) * 0.5 * f64::EPSILON;
    }
    let (first, second) = (spectrum(last), spectrum(last + 1));
    let difference = second - first;
    // 1/(1−z) = (1 + i cot(θ/2))/2, z/(1−z) = (−1 + i cot(θ/2))/2; z^F turns by Fθ.
    let cotangent = 1.0 / (0.5 * angle).tan();
    let (a, b) = ((0.5, 0.5 * cotangent), (-0.5, 0.5 * cotangent));
    let bracket = (first + b.0 * difference, b.1 * difference);
    let (re, im) = (a.0 * bracket.0 - a.1 * bracket.1, a.0 * bracket.1 + a.1 * bracket.0);
    let turn = f64::from(last) * angle;
    let chord = 2.0 * (0.5 * angle).sin();
    let remainder = difference.abs() / (chord * chord);
    (sum + re * turn.cos() - im * turn.sin(), remainder + sizes + turn * first / chord * f64::EPSILON)
}

#[test]
fn correlation_is_the_sum_of_its_terms() {
    let config = Config { source_file: Some(file!()), ..config(300, 5) };
    let inputs = (prop_oneof![1.01..12.0_f64, 12.0..100.0_f64], -3.0..1.3_f64, 0.02..PI);
    TestRunner::new(config)
        .run(&inputs, |(exponent, logarithm, angle)| {
            let medium = lorentzian(10.0_f64.powf(logarithm), exponent);
            let (sum, error) = direct(&medium, angle, 4000);
            let allowed = error / medium.total() + 4.0 * claimed(exponent);
            prop_assert!(allowed < 1e-5);
            let found = medium.correlation(angle);
            prop_assert!((found - sum / medium.total()).abs() < allowed, "{} not {}", found, sum / medium.total());
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn total_is_between_its_integral_bounds() {
    // S falls: Σ_(f ≤ F) + ∫_(F+1)^∞ ≤ Σ ≤ Σ_(f ≤ F) + ∫_F^∞, and ∫_x^∞ S is between A f†^s x^(1−s)/(s−1) (1 − (f†/x)^s) and that.
    for (crossover, exponent) in [(1e-3, 1.5), (0.7, 1.2), (3.0, 1.5), (3.0, 3.3), (20.0, 2.0), (11.0, 60.0)] {
        let medium = lorentzian(crossover, exponent);
        let last = 40_000.0_f64;
        let sum: f64 = (1..=40_000).rev().map(|f| medium.spectrum(f64::from(f))).sum();
        let front = (1.0 + crossover.powf(exponent)) / (exponent - 1.0);
        let least = front * (last + 1.0).powf(1.0 - exponent) * (1.0 - (crossover / last).powf(exponent));
        let most = front * last.powf(1.0 - exponent);
        let total = medium.total();
        let rounding = 1e-12 * total;
        assert!(sum + least - rounding < total && total < sum + most + rounding, "{crossover}, {exponent}: {total}");
    }
}

#[test]
fn continuum_has_the_closed_forms_of_two_and_four() {
    let (two, four) = (continuum(2.0), continuum(4.0));
    for step in -60..60 {
        let x = 1.7_f64.powi(step);
        let allowed = |slope: f64| claimed(4.0) + 2.0 * f64::EPSILON * x * slope.abs();
        assert!((two.correlation(x) - (-x).exp()).abs() < allowed((-x).exp()), "{x}");
        assert!((two.derivative(x) + (-x).exp()).abs() < 4.0 * claimed(4.0), "{x}");
        let y = x * 0.5_f64.sqrt();
        let closed = (-y).exp() * (y.cos() + y.sin());
        assert!((four.correlation(x) - closed).abs() < allowed((-y).exp()), "{x}");
        let slope = -2.0_f64.sqrt() * (-y).exp() * y.sin();
        assert!((four.derivative(x) - slope).abs() < 4.0 * claimed(4.0) + allowed((-y).exp()), "{x}");
    }
    // The tail of s = 1.5, Γ(s+1) sin(πs/2) x^(−s−1)/a, across the handover to the asymptotic series.
    let usual = continuum(1.5);
    let ratio = usual.correlation(4.0e6) / usual.correlation(4.4e6);
    // Absolute errors of 10⁻¹⁷ over a value of 10⁻¹⁷ would drown it: the sum is held to an absolute error only.
    assert!(usual.correlation(4.4e6) > 0.0 && usual.correlation(4.0e6).abs() < 1e-14, "{ratio}");
}
