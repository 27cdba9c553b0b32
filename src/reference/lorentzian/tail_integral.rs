//! ∫ du/(1 + u^s) from any point to infinity, by series whose terms all have one sign.

use std::f64::consts::PI;

/// `∫_0^∞ du/(1 + u^s) = (π/s)/sin(π/s)`, s > 1.
pub(super) fn whole(exponent: f64) -> f64 {
    // sin(π/s) = sin(π(s−1)/s); the smaller argument is more accurate.
    let angle = PI * f64::min(1.0, exponent - 1.0) / exponent;
    PI / exponent / libm::sin(angle)
}

/// `∫_r^∞ du/(1 + u^s)` for 0 < r < 1.
///
/// `∫_0^r = r F(1, 1/s; 1 + 1/s; −r^s) = r/(1 + r^s) F(1, 1; 1 + 1/s; r^s/(1 + r^s))`, A&S 15.3.4.
pub(super) fn beyond(exponent: f64, from: f64) -> f64 {
    let power = libm::pow(from, exponent);
    whole(exponent) - from / (1.0 + power) * series(1.0 + 1.0 / exponent, power / (1.0 + power))
}

/// `∫_x^∞ df/(c^s + f^s)` for c ≤ x, including c = 0: the same with u → 1/u.
pub(super) fn scaled_beyond(exponent: f64, crossover: f64, from: f64) -> f64 {
    let power = libm::pow(crossover / from, exponent);
    let front = libm::pow(from, 1.0 - exponent) / (exponent - 1.0);
    front / (1.0 + power) * series(2.0 - 1.0 / exponent, power / (1.0 + power))
}

/// `F(1, 1; b; v) = Σ n!/(b (b+1) … (b+n−1)) v^n` for b > 1 and 0 ≤ v ≤ 1/2: each term is at most half the one before.
fn series(b: f64, v: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for n in 0..60 {
        let n = f64::from(n);
        term *= v * (n + 1.0) / (b + n);
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_hold() {
        // s = 2: π/2 − arctan r; s = 4 at r = 1: [π + 2 ln(1 + √2)]/(4√2) is ∫_0^1, the whole is π/(2√2).
        for from in [1e-3_f64, 0.2, 0.7, 0.999] {
            assert!((beyond(2.0, from) - (PI / 2.0 - from.atan())).abs() < 4.0 * f64::EPSILON);
        }
        for from in [1.0_f64, 1.5, 30.0] {
            // c = 1, x = from.
            let expected = (1.0 / from).atan();
            assert!((scaled_beyond(2.0, 1.0, from) / expected - 1.0).abs() < 8.0 * f64::EPSILON);
        }
        let root = 2.0_f64.sqrt();
        let quartic = PI / (2.0 * root) - (PI + 2.0 * (1.0 + root).ln()) / (4.0 * root);
        assert!((scaled_beyond(4.0, 1.0, 1.0) - quartic).abs() < 4.0 * f64::EPSILON);
        // c = 0: x^(1−s)/(s−1).
        assert!((scaled_beyond(1.5, 0.0, 4.0) - 1.0).abs() < 4.0 * f64::EPSILON);
    }

    #[test]
    fn both_series_meet() {
        for exponent in [1.001, 1.2, 1.5, 3.0, 17.0, 100.0] {
            let (left, right) = (beyond(exponent, 1.0), scaled_beyond(exponent, 1.0, 1.0));
            // Both are known to a few roundings of the whole.
            assert!((left - right).abs() < 8.0 * f64::EPSILON * whole(exponent), "{exponent}: {left}, {right}");
        }
    }
}
