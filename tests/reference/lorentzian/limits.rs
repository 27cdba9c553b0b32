//! How G approaches its limits in f† and θ, and that nothing jumps where one formula hands over to another.

use std::f64::consts::PI;

use jamscope::reference::lorentzian::USUAL_EXPONENT;

use super::{claimed, continuum, lorentzian, steepness};

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

/// Far out only the first terms of the asymptotic series are left, Γ(s+1) sin(πs/2) x^(−s−1) − Γ(2s+1) sin(πs) x^(−2s−1) over the area
/// (π/s)/sin(π/s); at even s they vanish.
#[test]
fn the_algebraic_tail_of_the_continuum_is_the_first_two_terms_of_its_series() {
    // s, Γ(s+1), Γ(2s+1).
    for (exponent, one, two) in [
        (1.5f64, 1.329_340_388_179_137_2, 6.0),
        (3.0, 6.0, 720.0),
        (1.25, 1.133_003_096_319_346_3, 3.323_350_970_447_843),
    ] {
        let limit = continuum(exponent);
        let area = PI / exponent / (PI / exponent).sin();
        for x in [5e6f64, 1e9] {
            let first = one * (0.5 * PI * exponent).sin() * x.powf(-exponent - 1.0);
            let second = -two * (PI * exponent).sin() * x.powf(-2.0 * exponent - 1.0);
            let (value, slope) = (first + second, -((exponent + 1.0) * first + (2.0 * exponent + 1.0) * second) / x);
            // The third term is x^(−2s) of the first, below 10⁻¹⁶; powers of x round (s + 1) ln x times, and the sine of 3π/2 and area.
            assert!((limit.correlation(x) * area / value - 1.0).abs() < 1e-13, "s = {exponent}, x = {x}");
            assert!((limit.derivative(-x) * area / slope + 1.0).abs() < 1e-13, "s = {exponent}, x = {x}");
        }
    }
    assert_eq!((continuum(2.0).correlation(5e6), continuum(4.0).correlation(5e6)), (0.0, 0.0));
}
