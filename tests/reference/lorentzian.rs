//! The generalised Lorentzian against values of 25 digits, closed forms, sums with a proven remainder, and its limits.

use std::f64::consts::PI;

use jamscope::reference::lorentzian::{ContinuumLorentzian, Crossing, Lorentzian, LorentzianError, USUAL_EXPONENT};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use serde_json::Value;

use crate::{Worst, fixture, number, rows};

/// Absolute error claimed for G, and relative for Σ S.
///
/// Left out by the quadrature: 2⁻⁵⁹ of Σ S (a unit test of `contour.rs`). Rounding, in units of 2⁻⁵³: a weight is S at a
/// complex frequency known to 4 in modulus and angle, and |w S'/S| ≤ s, so 4 s in each, 8 s; 8 for the other operations; an
/// exponential is squared as often as it decays, which leaves at most 6. Taken over Σ |weight|, at most 2 Σ S/sin(π/2s)
/// (another unit test there). 6.7·10⁻¹⁵ at s = 1.5, if all roundings had one sign.
fn claimed(exponent: f64) -> f64 {
    (8.0 * exponent + 14.0) * f64::EPSILON / (0.5 * PI / exponent).sin()
}

fn lorentzian(crossover: f64, exponent: f64) -> Lorentzian {
    if crossover == 0.0 { Lorentzian::scale_free(exponent) } else { Lorentzian::new(crossover, exponent) }
        .expect("valid")
}

fn continuum(exponent: f64) -> ContinuumLorentzian {
    ContinuumLorentzian::new(exponent).expect("valid")
}

fn at(crossing: Result<Crossing, LorentzianError>) -> f64 {
    crossing.expect("a threshold below 1").angle().expect("a crossing")
}

/// An angle of a fixture; the name `pi` stands for π.
fn angle(value: &Value) -> f64 {
    if value == "pi" { PI } else { number(value) }
}

/// A scale on which G changes near an angle: the largest |dG/dθ| of a cusp, or f† where it is smooth.
fn steepness(crossover: f64, exponent: f64, angle: f64) -> f64 {
    let scale = crossover.max(1.0);
    scale * (scale * angle).powf((exponent - 2.0).min(0.0)).max(1.0)
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
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[5; 32]);
    let config = Config { cases: 300, failure_persistence: None, ..Config::default() };
    let inputs = (prop_oneof![1.01..12.0_f64, 12.0..100.0_f64], -3.0..1.3_f64, 0.02..PI);
    TestRunner::new_with_rng(config, rng)
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
fn small_crossovers_approach_the_scale_free_limit_with_their_power() {
    // To first order in f†^s: S = f^(−s) (1 + f†^s) − f†^s f^(−2s), so G − G_0 = f†^s ζ(2s)/ζ(s) (G_0 − G_0 of 2s).
    for exponent in [1.2, 1.5, 2.5] {
        let (once, twice) = (lorentzian(0.0, exponent), lorentzian(0.0, 2.0 * exponent));
        for angle in [0.3, 1.0, 2.5] {
            let coefficient = twice.total() / once.total() * (once.correlation(angle) - twice.correlation(angle));
            for crossover in [1e-2, 1e-3] {
                let power = f64::powf(crossover, exponent);
                let found = (lorentzian(crossover, exponent).correlation(angle) - once.correlation(angle)) / power;
                // Next order, with a coefficient of the same size at most twice; rounding over the power.
                let tolerance = 4.0 * power + 2.0 * claimed(exponent) / power;
                assert!((found - coefficient).abs() < tolerance, "{found}, not {coefficient} at {crossover}");
            }
        }
    }
}

#[test]
fn large_crossovers_approach_the_continuum_as_their_reciprocal() {
    // Euler–Maclaurin: Σ S cos fθ = A (f† a g(f†θ) − 1/2 + O(f†^(−s))), so G − g = −(1 − g)/(2 f† a − 1) + O(f†^(−1−s)).
    for exponent in [1.2, 1.5, 2.0, 3.0] {
        let limit = continuum(exponent);
        for crossover in [1e2, 1e4, 1e6, 1e12] {
            let medium = lorentzian(crossover, exponent);
            for x in [1e-12, 1e-6, 0.1, 1.0, 3.0, 20.0] {
                let g = limit.correlation(x);
                let expected = g - (1.0 - g) / (2.0 * crossover * limit.area() - 1.0);
                let found = medium.correlation(x / crossover);
                // The next term: ζ(−s) (f†)^(−1−s) (1 + x²/f†²…) with |ζ(−s)| below 1/4; the rounding of x/f†.
                let rounding = f64::EPSILON * x * limit.derivative(x).abs();
                let tolerance = 0.5 * crossover.powf(-1.0 - exponent) + 2.0 * claimed(exponent) + rounding;
                assert!(
                    (found - expected).abs() < tolerance,
                    "s = {exponent}, f† = {crossover}, x = {x}: {found}, {expected}"
                );
            }
        }
    }
}

#[test]
fn the_continuum_takes_over_without_a_step() {
    let (below, above) = (lorentzian(7.2e16, 1.5), lorentzian(7.3e16, 1.5));
    for x in [1e-3, 0.5, 4.0, 100.0] {
        // G depends on f†θ, rounded once more.
        let (one, other) = (below.correlation(x / 7.2e16), above.correlation(x / 7.3e16));
        assert!((one - other).abs() < 2.0 * claimed(USUAL_EXPONENT), "{one}, {other} at {x}");
        let (one, other) = (below.derivative(x / 7.2e16) / 7.2e16, above.derivative(x / 7.3e16) / 7.3e16);
        assert!((one / other - 1.0).abs() < 1e-10 + 8.0 * claimed(USUAL_EXPONENT) / one.abs(), "{one}, {other} at {x}");
    }
    assert!((below.total() / 7.2e16 / (above.total() / 7.3e16) - 1.0).abs() < claimed(USUAL_EXPONENT));
    // And at the largest numbers there are.
    let huge = lorentzian(1e308, 1.5);
    assert!((huge.correlation(1e-308) - continuum(1.5).correlation(1.0)).abs() < claimed(USUAL_EXPONENT));
}

#[test]
fn the_cusp_takes_over_without_a_step() {
    for exponent in [1.001, 1.1, 1.5, 1.9, 2.0, 2.3, 2.79, 2.81, 2.999, 3.0, 3.001, 3.5, 5.0] {
        for crossover in [1e-4, 0.9, 6.0, 1e7] {
            let (medium, handover) = (lorentzian(crossover, exponent), 1e-10 / crossover.max(1.0));
            let (left, right) = (handover * (1.0 - 1e-8), handover * (1.0 + 1e-8));
            // The step explains 2·10⁻⁸ of a difference that is itself a power of the angle.
            let step = 2e-8 * (1.0 - medium.correlation(right)) * exponent;
            let jump = medium.correlation(left) - medium.correlation(right);
            assert!(jump.abs() < step + claimed(exponent), "{exponent}, {crossover}: {jump}");
            let (one, other) = (medium.derivative(left), medium.derivative(right));
            let scale = one.abs().max(crossover.max(1.0) * 1e-10);
            // Relative: 2·10⁻⁸ (|s − 2| + 1), and the rounding of the sum.
            let allowed =
                2e-8 * (exponent + 1.0) * scale + 4.0 * claimed(exponent) * steepness(crossover, exponent, handover);
            assert!((one - other).abs() < allowed, "{exponent}, {crossover}: {one}, {other}");
        }
    }
    // Far inside: s = 2 has g = e^(−x).
    let kink = continuum(2.0);
    assert!((kink.derivative(1e-200) + 1.0).abs() < claimed(2.0));
    assert!((kink.correlation(5e-11) - (-5e-11_f64).exp()).abs() < f64::EPSILON);
    // s = 3, where two powers become a logarithm: (Σ cos fθ/f³)'' = ln(2 sin(θ/2)), so G' = (θ ln θ − θ)/ζ(3) + O(θ³).
    let cubic = lorentzian(0.0, 3.0);
    let found = cubic.derivative(1e-60) / 1e-60 * cubic.total();
    // The slope at θ = 10⁻¹⁰ has an absolute error and is continued from there.
    assert!((found - ((1e-60_f64).ln() - 1.0)).abs() < 4.0 * claimed(3.0) / 1e-10 * cubic.total(), "{found}");
    // s > 3: parabolic, G'(θ)/θ is constant.
    let smooth = lorentzian(6.0, 4.5);
    let ratio = smooth.derivative(1e-60) / 1e-60 / (smooth.derivative(1e-6) / 1e-6);
    // Next term of order (f†θ)^(s−3); below θ = 10⁻¹⁰/f† the slope there is continued, known to an absolute error.
    let handover = 1e-10 / 6.0;
    let allowed = 1e-7 + 4.0 * claimed(4.5) * 6.0 / smooth.derivative(handover).abs();
    assert!((ratio - 1.0).abs() < allowed && allowed < 2e-3, "{ratio}");
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
    let scanned = (1..=100_000).map(|n| medium.correlation(PI * f64::from(n) / 1e5)).fold(1.0, f64::min);
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
