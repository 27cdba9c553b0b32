//! `Gap`: integrals of exponentials from the rim, and differences of their products without cancellation.
//!
//! With t = ln(R/r), the powers of the radius in an elastic mode become integrals that vanish at the rim:
//!
//! ```text
//! E_m(t) = ∫_0^t e^(−m s) ds = (1 − e^(−mt))/m = t e^(−mt/2) shc(mt/2)        shc z = sinh z / z
//! ```
//!
//! In a thin annulus all of them are nearly equal to t, and only their differences matter; the second form resolves
//! these.

/// Up to this size of the arguments, differences are computed from those of the exponents and of shc − 1.
const NEAR: f64 = 1.0;

/// `width · e^exponent · shc(argument)`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gap {
    width: f64,
    exponent: f64,
    argument: f64,
    value: f64,
}

impl Gap {
    /// E_m(t), m ≥ 0, t ≥ 0.
    pub(super) fn integral(m: f64, t: f64) -> Self {
        let decay = m * t;
        let value = if decay == 0.0 { t } else { -libm::expm1(-decay) / m };
        Gap { width: t, exponent: -0.5 * decay, argument: 0.5 * decay, value }
    }

    /// e^(−mt), the derivative of E_m.
    pub(super) fn power(m: f64, t: f64) -> Self {
        Gap { width: 1.0, exponent: -m * t, argument: 0.0, value: libm::exp(-m * t) }
    }

    /// This times e^(−mt).
    pub(super) fn times_power(self, m: f64, t: f64) -> Self {
        let exponent = -m * t;
        Gap { exponent: self.exponent + exponent, value: self.value * libm::exp(exponent), ..self }
    }

    pub(super) fn value(self) -> f64 {
        self.value
    }
}

/// `a_1 a_2 − b_1 b_2`, where both products have equal widths.
///
/// # Accuracy
/// Small arguments: let A = shc·shc of the first product, B of the second, and δ half the difference of their
/// exponents. Then `e^δ A − e^(−δ) B = (A − B) cosh δ + (A + B) sinh δ`, where A − B is of second order in the
/// arguments and δ of first. Otherwise the two products are subtracted directly.
pub(super) fn product_difference(a: [Gap; 2], b: [Gap; 2]) -> f64 {
    let reach = a.iter().chain(&b).map(|gap| gap.exponent.abs().max(gap.argument)).sum::<f64>();
    if reach > 4.0 * NEAR {
        return a[0].value * a[1].value - b[0].value * b[1].value;
    }
    let excess = |gaps: [Gap; 2]| {
        let (first, second) = (shc_minus_one(gaps[0].argument), shc_minus_one(gaps[1].argument));
        first + second + first * second
    };
    let (excess_a, excess_b) = (excess(a), excess(b));
    let (exponent_a, exponent_b) = (a[0].exponent + a[1].exponent, b[0].exponent + b[1].exponent);
    let half = 0.5 * (exponent_a - exponent_b);
    let bracket = (excess_a - excess_b) * libm::cosh(half) + (2.0 + excess_a + excess_b) * libm::sinh(half);
    a[0].width * a[1].width * libm::exp(0.5 * (exponent_a + exponent_b)) * bracket
}

/// `sinh z / z − 1`, 0 ≤ z ≤ 4: all terms of its power series have one sign.
fn shc_minus_one(z: f64) -> f64 {
    let square = z * z;
    let mut term = square / 6.0;
    let mut sum = term;
    // At z = 4 the ratio of terms falls below 1/16 from the seventh on: 24 terms leave 10⁻²⁴.
    for k in 2..24 {
        let n = f64::from(2 * k);
        term *= square / (n * (n + 1.0));
        if term <= 0.25 * f64::EPSILON * sum {
            break;
        }
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ways_to_take_a_difference_meet() {
        // E_2(τ) E_8(t) − E_8(τ) E_2(t) on either side of the threshold: the plain form loses a factor of about 10
        // there.
        for (tau, t) in [(0.3, 0.1), (0.4, 0.25), (0.5, 0.49), (0.35, 0.2)] {
            let gaps = |m: f64, t: f64| Gap::integral(m, t);
            let careful = product_difference([gaps(2.0, tau), gaps(8.0, t)], [gaps(8.0, tau), gaps(2.0, t)]);
            let plain = gaps(2.0, tau).value * gaps(8.0, t).value - gaps(8.0, tau).value * gaps(2.0, t).value;
            // Each product is rounded to 4·2⁻⁵³ of itself, and is below τ².
            assert!((careful - plain).abs() < 8.0 * f64::EPSILON * tau * t, "{careful}, not {plain} at {tau}, {t}");
        }
    }

    #[test]
    fn a_thin_gap_keeps_the_leading_term() {
        // E_2(τ) E_8(t) − E_8(τ) E_2(t) = 3 tτ(τ − t) (1 + O(τ)).
        let (tau, t) = (2e-9, 1e-9);
        let gaps = |m: f64, t: f64| Gap::integral(m, t);
        let found = product_difference([gaps(2.0, tau), gaps(8.0, t)], [gaps(8.0, tau), gaps(2.0, t)]);
        assert!((found / (3.0 * tau * t * (tau - t)) - 1.0).abs() < 1e-7, "{found}");
    }
}
