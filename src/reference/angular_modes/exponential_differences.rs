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
//!
//! [`Kernels`] are the elastic modes made of them, in the annulus and in the shell.

use crate::reference::Annulus;
use crate::vector::two_product;

/// Up to this size of the arguments, differences are computed from those of the exponents and of shc − 1.
const NEAR: f64 = 1.0;

/// `width · e^exponent · shc(argument)`.
#[derive(Debug, Clone, Copy)]
pub(in crate::reference) struct Gap {
    width: f64,
    exponent: f64,
    argument: f64,
    value: f64,
}

impl Gap {
    /// E_m(t), m ≥ 0, t ≥ 0.
    pub(in crate::reference) fn integral(m: f64, t: f64) -> Self {
        let decay = m * t;
        let value = if decay == 0.0 { t } else { -libm::expm1(-decay) / m };
        Gap { width: t, exponent: -0.5 * decay, argument: 0.5 * decay, value }
    }

    /// e^(−mt), the derivative of E_m.
    pub(in crate::reference) fn power(m: f64, t: f64) -> Self {
        Gap { width: 1.0, exponent: -m * t, argument: 0.0, value: libm::exp(-m * t) }
    }

    /// This times e^(−mt).
    pub(in crate::reference) fn times_power(self, m: f64, t: f64) -> Self {
        let exponent = -m * t;
        Gap { exponent: self.exponent + exponent, value: self.value * libm::exp(exponent), ..self }
    }

    pub(in crate::reference) fn value(self) -> f64 {
        self.value
    }
}

/// `a_1 a_2 − b_1 b_2`, where both products have equal widths.
///
/// # Accuracy
/// Small arguments: let A = shc·shc of the first product, B of the second, and δ half the difference of their
/// exponents. Then `e^δ A − e^(−δ) B = (A − B) cosh δ + (A + B) sinh δ`, where A − B is of second order in the
/// arguments and δ of first. Otherwise the two products are subtracted directly.
pub(in crate::reference) fn product_difference(a: [Gap; 2], b: [Gap; 2]) -> f64 {
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

/// Coefficients of the products of integrals in an elastic mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::reference) struct Coupling {
    /// That of E_p E_q: vanishes in an incompressible medium.
    pub(in crate::reference) soft: f64,
    /// That of the difference `E_p E_q − x^q E_2 E_2`.
    pub(in crate::reference) stiff: f64,
    /// Those of d_a in s, and of s_a in d.
    pub(in crate::reference) mixed: [f64; 2],
}

/// The factors of s_a and d_a in s and d, all over Δ, and the t-derivatives of the brackets.
///
/// s and d are the two combinations of the amplitudes of an elastic mode that each contain three of its four powers,
/// `x^(−σ), x^(−σ+2), x^(−σ+p)` in s and `x^(−σ+2), x^(−σ+2+q), x^(−σ+4+q)` in d, with x = r/R and p = q + 4. Both
/// vanish at the rim.
pub(in crate::reference) struct Kernels {
    pub(in crate::reference) value: [[f64; 2]; 2],
    pub(in crate::reference) derivative: [[f64; 2]; 2],
}

impl Kernels {
    /// The factors at `radius`, for `depth` ln(R/a), the exponents p and q, and σ = `steepness`.
    pub(in crate::reference) fn new(
        annulus: Annulus,
        depth: f64,
        [p, q]: [f64; 2],
        steepness: f64,
        coupling: &Coupling,
        radius: f64,
    ) -> Self {
        let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
        let (t, tau, eta) = (log_ratio(outer, radius), depth, log_ratio(radius, inner));
        let Coupling { soft, stiff, mixed: [into_sum, into_difference] } = *coupling;

        let [whole_p, whole_q, whole_2] = [p, q, 2.0].map(|m| Gap::integral(m, tau));
        let [here_p, here_q, here_2] = [p, q, 2.0].map(|m| Gap::integral(m, t));
        let [slope_p, slope_2] = [p, 2.0].map(|m| Gap::power(m, t));
        let one = Gap::power(0.0, t);
        let whole_2_q = whole_2.times_power(q, tau);
        let (here_2_q, slope_2_q) = (here_2.times_power(q, t), slope_2.times_power(q, t));
        let both = |a: [Gap; 2], b: [Gap; 2]| soft * a[0].value() * a[1].value() + stiff * product_difference(a, b);

        let determinant = both([whole_p, whole_q], [whole_2, whole_2_q]);
        let steep = ratio_power(inner, radius, steepness) / determinant;
        let flat = ratio_power(inner, radius, steepness - 2.0) / determinant;
        let share = (radius / outer).powi(2);
        // [E_2(τ) E_p(t) − E_p(τ) E_2(t)]/x² = E_2(η) E_p(t) − x^(p−2) E_p(η) E_2(t) with η = ln(r/a) = τ − t.
        let [inner_p, inner_2] = [p, 2.0].map(|m| Gap::integral(m, eta));
        let from_inner = product_difference([inner_2, here_p], [inner_p.times_power(p - 2.0, t), here_2]);
        let value = [
            [steep * both([whole_q, here_p], [whole_2_q, here_2]), flat * into_sum * from_inner],
            [
                steep * into_difference * share * product_difference([whole_2_q, here_q], [whole_q, here_2_q]),
                flat * both([whole_p, here_q], [whole_2, here_2_q]),
            ],
        ];
        let derivative = [
            [
                steep * both([whole_q, slope_p], [whole_2_q, slope_2]),
                flat * into_sum * product_difference([whole_2, Gap::power(p - 2.0, t)], [whole_p, one]),
            ],
            [
                steep * into_difference * share * product_difference([whole_2_q, one], [whole_q, slope_2_q]),
                flat * both([whole_p, one], [whole_2, slope_2_q]),
            ],
        ];
        Kernels { value, derivative }
    }
}

/// ln(larger/smaller) to rounding, also if the ratio is near 1.
pub(in crate::reference) fn log_ratio(larger: f64, smaller: f64) -> f64 {
    let ratio = larger / smaller;
    if smaller > 0.5 * larger {
        -libm::log1p(-(larger - smaller) / larger)
    } else if ratio.is_finite() {
        libm::log(ratio)
    } else {
        libm::log(larger) - libm::log(smaller)
    }
}

/// (a/b)^power for a ≤ b, corrected for the rounding of a/b, which would be multiplied by `power`.
pub(in crate::reference) fn ratio_power(a: f64, b: f64, power: f64) -> f64 {
    let ratio = a / b;
    let value = libm::pow(ratio, power);
    let (product, rest) = two_product(ratio, b);
    let lost = ((a - product) - rest) / a;
    // NaN if the product overflows (b > 2⁹⁹⁵), and not needed if a/b is subnormal: radii beyond 10²⁹⁹.
    if lost.abs() < f64::EPSILON { value * (1.0 + power * lost) } else { value }
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
