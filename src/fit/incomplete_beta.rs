//! The regularised incomplete beta function, computed with `libm`: the same bits on every processor.
//!
//! ```text
//! I_x(a, b) = x^a (1 − x)^b / (a B(a, b)) · 1/(1 + d_1/(1 + d_2/(1 + …)))        x ≤ (a + 1)/(a + b + 2)
//! d_2m = m (b − m) x / ((a + 2m − 1)(a + 2m))        d_(2m+1) = −(a + m)(a + b + m) x / ((a + 2m)(a + 2m + 1))
//! ```
//!
//! For larger x, I_x(a, b) = 1 − I_(1−x)(b, a). The continued fraction takes about √max(a, b) terms.
//!
//! # Source
//! DLMF 8.17.22 and 8.17.4; Lentz's method as in Thompson, Barnett (1986), J. Comput. Phys. 64, 490.

/// Limit of terms of the fraction: enough for a and b up to 10⁸.
const TERM_LIMIT: usize = 100_000;

/// I_x(a, b) for a, b > 0 and 0 ≤ x ≤ 1; none for other arguments or if the fraction has not converged.
///
/// # Accuracy
/// Relative 10⁻¹⁵ times 10 + a + b, by the logarithm of the gamma function.
pub(crate) fn incomplete_beta(a: f64, b: f64, x: f64) -> Option<f64> {
    if !(a > 0.0 && b > 0.0 && a.is_finite() && b.is_finite() && (0.0..=1.0).contains(&x)) {
        return None;
    }
    if x == 0.0 || x == 1.0 {
        return Some(x);
    }
    let front = libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * libm::log(x) + b * libm::log1p(-x);
    let front = libm::exp(front);
    if x <= (a + 1.0) / (a + b + 2.0) {
        Some(front / a * fraction(a, b, x)?)
    } else {
        Some(1.0 - front / b * fraction(b, a, 1.0 - x)?)
    }
}

/// The continued fraction.
fn fraction(a: f64, b: f64, x: f64) -> Option<f64> {
    // Replaces a vanishing denominator.
    let kept = |value: f64| if value.abs() < f64::MIN_POSITIVE { f64::MIN_POSITIVE } else { value };
    let (mut above, mut below, mut value) = (f64::INFINITY, 1.0, 1.0);
    for place in 1..TERM_LIMIT {
        let m = (place / 2) as f64;
        let term = match place % 2 {
            0 => m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m)),
            _ => -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0)),
        };
        below = 1.0 / kept(1.0 + term * below);
        above = kept(1.0 + term / above);
        value *= above * below;
        if (above * below - 1.0).abs() <= f64::EPSILON {
            return Some(value);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The accuracy stated in the doc comment.
    fn near(found: f64, expected: f64, a: f64, b: f64) -> bool {
        (found - expected).abs() <= 1e-15 * (10.0 + a + b) * expected
    }

    #[test]
    fn closed_forms_have_their_digits() {
        for x in [1e-9, 0.01, 0.3, 0.5, 0.77, 0.99, 1.0 - 1e-6] {
            for a in [0.5, 1.0, 3.5, 20.0, 400.5] {
                let found = incomplete_beta(a, 1.0, x).expect("in range");
                assert!(near(found, libm::pow(x, a), a, 1.0), "x^{a} at {x}: {found}");
                let found = incomplete_beta(1.0, a, x).expect("in range");
                assert!(near(found, -libm::expm1(a * libm::log1p(-x)), 1.0, a), "1 − (1 − x)^{a} at {x}: {found}");
            }
            let found = incomplete_beta(0.5, 0.5, x).expect("in range");
            let expected = 2.0 / std::f64::consts::PI * libm::asin(libm::sqrt(x));
            // asin of a root near 1 loses half of the digits of 1 − x: 10⁻¹⁶/√(1 − x).
            assert!((found - expected).abs() < 1e-14 * expected / libm::sqrt(1.0 - x), "arcsine at {x}: {found}");
        }
    }

    #[test]
    fn it_is_the_one_of_another_library() {
        for (a, b) in [(0.5, 0.5), (7.5, 0.5), (19.0, 1.0), (44.25, 1.5), (350.0, 0.5), (3.0, 12.0)] {
            for x in [0.02, 0.2, 0.6, 0.9, 0.999] {
                let found = incomplete_beta(a, b, x).expect("in range");
                // Compared with closed forms, the error of puruspe is 3·10⁻¹².
                let expected = puruspe::betai(a, b, x);
                assert!((found - expected).abs() <= 1e-11 * (1.0 + a + b) * expected, "{found:e}, {expected:e}");
            }
        }
    }

    #[test]
    fn ends_and_nonsense_are_told_apart() {
        assert_eq!(incomplete_beta(3.0, 0.5, 0.0), Some(0.0));
        assert_eq!(incomplete_beta(3.0, 0.5, 1.0), Some(1.0));
        for (a, b, x) in
            [(0.0, 1.0, 0.5), (1.0, f64::NAN, 0.5), (1.0, 1.0, 1.5), (1.0, 1.0, f64::NAN), (f64::INFINITY, 1.0, 0.5)]
        {
            assert_eq!(incomplete_beta(a, b, x), None);
        }
    }
}
