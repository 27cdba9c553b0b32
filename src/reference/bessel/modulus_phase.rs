//! Bessel functions of order one as a modulus and a phase, which avoids cancellation in their differences.
//!
//! ```text
//! J_1(x) + i Y_1(x) = M(x) exp(i θ(x)),      θ(x) = x − 3π/4 + φ(x)
//! ```
//!
//! The phase shift φ falls monotonically from π/4 at x = 0 to 0 at infinity, as 3/(8x). The rest of θ is known exactly,
//! so a difference of two phases only needs the difference of the arguments and two small numbers.
//!
//! For x ≥ [`ASYMPTOTIC_FROM`] both come from the asymptotic expansion. From [`EXPANDED_FROM`] on they come from
//! polynomials in x^(−2) for `(P − 1) x²` and `φ x`, and below it from J_1 and Y_1 of the crate `libm`.
//!
//! # Source
//! Abramowitz & Stegun (1964), 9.2.28 and 9.2.29; DLMF §10.18.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_PI};

use crate::reference::bessel::modulus_tables::{RANGES, Range};
use crate::reference::bessel::polynomial::polynomial;

/// From here on the asymptotic expansions are used \[1\]: their 13th term is below 2⁻⁵⁶ of the first.
pub const ASYMPTOTIC_FROM: f64 = 25.0;

/// From here on polynomials are used \[1\]: the lower end of their tables.
pub const EXPANDED_FROM: f64 = 2.0;

/// Number of terms of the expansions. The terms decrease until their index is about x, so 13 are safe at 25.
const TERM_COUNT: usize = 14;

/// `m_k` of `(π x / 2) M² = Σ m_k x^(−2k)`: `m_k / m_(k−1) = (2k−1)/(2k) · (4 − (2k−1)²)/4`, A&S 9.2.28 with μ = 4.
const MODULUS: [f64; TERM_COUNT] = {
    let mut terms = [1.0; TERM_COUNT];
    let mut k = 1;
    while k < TERM_COUNT {
        let odd = (2 * k - 1) as f64;
        terms[k] = terms[k - 1] * odd / (odd + 1.0) * (4.0 - odd * odd) / 4.0;
        k += 1;
    }
    terms
};

/// `g_k` of `θ' = Σ g_k x^(−2k)`, the reciprocal of the series of the modulus: from the Wronskian `θ' = 2/(π x M²)`.
const PHASE_SLOPE: [f64; TERM_COUNT] = {
    let mut terms = [1.0; TERM_COUNT];
    let mut k = 1;
    while k < TERM_COUNT {
        let mut sum = 0.0;
        let mut j = 1;
        while j <= k {
            sum += MODULUS[j] * terms[k - j];
            j += 1;
        }
        terms[k] = -sum;
        k += 1;
    }
    terms
};

/// `p_k` of `φ = (1/x) Σ p_k x^(−2k)`, the integral of `θ' − 1`: `p_k = −g_(k+1)/(2k+1)`.
const PHASE: [f64; TERM_COUNT - 1] = {
    let mut terms = [0.0; TERM_COUNT - 1];
    let mut k = 0;
    while k + 1 < TERM_COUNT {
        terms[k] = -PHASE_SLOPE[k + 1] / (2 * k + 1) as f64;
        k += 1;
    }
    terms
};

/// Number of terms needed at `x`: the first one left out is below 2⁻⁵⁶ of the sum (checked by a unit test).
fn term_count(x: f64) -> usize {
    match x {
        x if x < 60.0 => 13,
        x if x < 200.0 => 8,
        _ => 5,
    }
}

/// Modulus and phase at one argument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModulusPhase {
    /// `P = (π x / 2) M²` \[1\]; 1 in the limit of large x. Also `1/θ'(x)`.
    pub reduced_square: f64,
    /// `φ = θ − x + 3π/4`, between 0 and π/4.
    pub shift: f64,
}

/// Modulus and phase of `J_1 + i Y_1` at x > 0.
///
/// # Accuracy
/// For x ≥ 2 the relative error of P and the absolute one of φ are below 3·10⁻¹⁶. For smaller x they are those of
/// `libm`, 10⁻¹⁵ and 6·10⁻¹⁶ (in units of the modulus).
///
/// # Cost
/// See `cargo bench --features measurements --bench reference -- bessel`.
pub fn modulus_phase(x: f64) -> ModulusPhase {
    if x >= EXPANDED_FROM {
        let shift = if x >= ASYMPTOTIC_FROM {
            let inverse = 1.0 / x;
            inverse * polynomial(&PHASE[..term_count(x)], inverse * inverse)
        } else {
            let (range, u) = range(x);
            polynomial(&range.phase, u) / x
        };
        return ModulusPhase { reduced_square: 1.0 - reduced_square_deficit(x), shift };
    }
    let (j, y) = (libm::j1(x), libm::y1(x));
    // J_1 and Y_1 rotated by −(x − 3π/4), whose cosine and sine are (sin x − cos x)/√2 and −(sin x + cos x)/√2.
    let (sine, cosine) = libm::sincos(x);
    let (turn_cosine, turn_sine) = ((sine - cosine) * FRAC_1_SQRT_2, -(sine + cosine) * FRAC_1_SQRT_2);
    ModulusPhase {
        reduced_square: x * (j * j + y * y) / FRAC_2_PI,
        shift: libm::atan2(y * turn_cosine - j * turn_sine, j * turn_cosine + y * turn_sine),
    }
}

/// The range of the tables that contains x, 2 ≤ x < 25, and the position in it.
fn range(x: f64) -> (&'static Range, f64) {
    let index = RANGES.iter().take_while(|range| x >= range.below).count();
    let range = &RANGES[index.min(RANGES.len() - 1)];
    (range, (1.0 / (x * x) - range.centre) / range.half_width)
}

/// `1 − P(x)` for x ≥ [`EXPANDED_FROM`], relative accuracy.
pub(crate) fn reduced_square_deficit(x: f64) -> f64 {
    let inverse = 1.0 / x;
    let t = inverse * inverse;
    if x >= ASYMPTOTIC_FROM {
        return -t * polynomial(&MODULUS[1..term_count(x)], t);
    }
    let (range, u) = range(x);
    -t * polynomial(&range.modulus, u)
}

/// `P'(x)` for x ≥ [`EXPANDED_FROM`], relative accuracy.
pub(crate) fn reduced_square_slope(x: f64) -> f64 {
    let inverse = 1.0 / x;
    let t = inverse * inverse;
    if x >= ASYMPTOTIC_FROM {
        let sum = (1..term_count(x)).rev().fold(0.0, |sum, k| sum * t - 2.0 * k as f64 * MODULUS[k]);
        return sum * t * inverse;
    }
    // P = 1 + t A(t), dt/dx = −2t/x.
    let (range, u) = range(x);
    let (value, slope) =
        range.modulus.iter().rev().fold((0.0, 0.0), |(value, slope), &c| (value * u + c, slope * u + value));
    -2.0 * t * inverse * (value + t * slope / range.half_width)
}

/// `1 − 2x I_1(x) K_1(x)` for x ≥ [`EXPANDED_FROM`], relative accuracy: the analogue of P − 1 for imaginary argument
/// (A&S 9.7.5 has the coefficients of the modulus with alternating signs).
pub(crate) fn modified_product_deficit(x: f64) -> f64 {
    let inverse = 1.0 / x;
    let t = inverse * inverse;
    if x >= ASYMPTOTIC_FROM {
        return t * polynomial(&MODULUS[1..term_count(x)], -t);
    }
    let (range, u) = range(x);
    t * polynomial(&range.product, u)
}

/// J_1 and Y_1 at `x + x_low`, where `x_low` is the rounding error of x (at most half an ulp).
///
/// The phase changes by `x_low θ'`; the change of the modulus is below its own rounding.
pub(crate) fn first_order(x: f64, x_low: f64) -> (f64, f64) {
    let (j, y) = (libm::j1(x), libm::y1(x));
    let turn = x_low * FRAC_2_PI / (x * (j * j + y * y));
    (j - turn * y, y + turn * j)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_term_left_out_is_below_rounding() {
        for x in [25.0, 59.9, 60.0, 199.0, 200.0, 1e6] {
            let count = term_count(x);
            assert!(MODULUS[count].abs() * f64::powi(x, -2 * count as i32) < f64::exp2(-56.0), "modulus at {x}");
            // The expansion of the phase is odd, so one power more; PHASE has one term less, and p_13 is bounded by
            // p_12.
            let next = PHASE[count.min(PHASE.len() - 1)].abs() * f64::powi(x, -2 * count as i32 - 1);
            assert!(next < f64::exp2(-56.0), "phase at {x}");
        }
    }

    #[test]
    fn both_routes_meet() {
        // Errors of libm: 4·10⁻¹⁶ of the modulus in each function, hence 10⁻¹⁵ in P and φ.
        for x in [2.0_f64, 2.99, 3.0, 4.99, 5.0, 8.99, 9.0, 24.99, 25.0, 31.0, 47.0, 60.0, 71.5] {
            let expansion = modulus_phase(x);
            let (j, y) = (libm::j1(x), libm::y1(x));
            let theta = x - 0.75 * std::f64::consts::PI + expansion.shift;
            let modulus = (FRAC_2_PI * expansion.reduced_square / x).sqrt();
            // The rounding of θ ≈ x adds x·2⁻⁵³.
            let tolerance = modulus * (1e-15 + 2.0 * x * f64::EPSILON);
            assert!((j - modulus * theta.cos()).abs() < tolerance, "J at {x}");
            assert!((y - modulus * theta.sin()).abs() < tolerance, "Y at {x}");
        }
    }

    #[test]
    fn phase_shift_falls_from_an_eighth_of_a_turn() {
        // θ(0) = −π/2 and θ' = O(x), so φ = π/4 − x + O(x²).
        assert!((modulus_phase(1e-9).shift + 1e-9 - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
        let mut last = 1.0;
        for step in 1..400 {
            let shift = modulus_phase(0.1 * step as f64).shift;
            assert!(shift < last && shift > 0.0);
            last = shift;
        }
    }
}
