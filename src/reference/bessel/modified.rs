//! I_0, I_1, K_0, K_1: the modified Bessel functions, plain and scaled by an exponential.
//!
//! ```text
//! f'' + f'/x − (1 + n²/x²) f = 0,   n = 0, 1        I_n ~ e^x/√(2πx),  K_n ~ e^(−x) √(π/(2x))
//!
//! I_0' = I_1,  I_1' = I_0 − I_1/x,  K_0' = −K_1,  K_1' = −K_0 − K_1/x        I_1 K_0 + I_0 K_1 = 1/x
//! ```
//!
//! The plain ones overflow at x = 713 (I) and underflow at 742 (K); `*_scaled` are `e^(−|x|) I_n` and `e^x K_n`, which
//! do not.
//!
//! | range | method |
//! |---|---|
//! | x < 1 | power series, A&S 9.6.10, 9.6.11 and 9.6.13: every sum has terms of one sign |
//! | 1 ≤ x < 25 | polynomials in 1/x for `√x e^(−x) I_n` and `√x e^x K_n` |
//! | x ≥ 25 | asymptotic expansion, A&S 9.7.1 and 9.7.2 |
//!
//! # Accuracy
//! Relative error below 10⁻¹⁵ for any x > 0, including subnormal numbers and 10³⁰⁰ (largest found: 6·10⁻¹⁶;
//! `reference::bessel_functions::modified_functions_have_their_digits_at_any_argument`). For the plain functions at x >
//! 30 the error of `exp`, one ulp, is added.
//!
//! # Limits
//! K_n(0) = ∞, K_n(x) is NaN for x < 0. K_1(x) = 1/x overflows for x < 5.6·10⁻³⁰⁹. NaN gives NaN.
//!
//! # Cost
//! See `cargo bench --features measurements --bench reference -- bessel`.
//!
//! # Source
//! Abramowitz & Stegun (1964), 9.6 and 9.7; DLMF §10.25. The polynomials: `fixtures/reference/make_modified_tables.py`.
//!
//! # Example
//! ```
//! use jamscope::reference::bessel::modified::{i0_scaled, i1_scaled, k0_scaled, k1_scaled};
//! let x = 1e5; // far beyond e^710
//! assert!(((i1_scaled(x) * k0_scaled(x) + i0_scaled(x) * k1_scaled(x)) * x - 1.0).abs() < 1e-15);
//! ```

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, LN_2};

use crate::reference::bessel::modified_tables::{RANGES, Range};
use crate::reference::bessel::polynomial::polynomial;

/// Euler's constant γ (DLMF 5.2.3).
const EULER: f64 = 0.577_215_664_901_532_9;

/// From here on the asymptotic expansions are used \[1\].
const ASYMPTOTIC_FROM: f64 = 25.0;

/// Below this the power series are used \[1\].
const SERIES_BELOW: f64 = 1.0;

/// 4^(−k)/k!² falls below 2⁻⁶⁰ at k = 11.
const SERIES_LENGTH: usize = 11;

/// Terms of the asymptotic expansion: at 25 the 25th is below 2⁻⁵⁶ of the first.
const TERM_COUNT: usize = 26;

/// 1/(k! (k+n)!).
const fn series(order: usize) -> [f64; SERIES_LENGTH] {
    let mut terms = [1.0; SERIES_LENGTH];
    let mut k = 1;
    while k < SERIES_LENGTH {
        terms[k] = terms[k - 1] / (k * (k + order)) as f64;
        k += 1;
    }
    terms
}

/// H_k/k!², or (H_k + H_(k+1))/(k! (k+1)!).
const fn harmonic_series(order: usize) -> [f64; SERIES_LENGTH] {
    let plain = series(order);
    let mut terms = [0.0; SERIES_LENGTH];
    let mut harmonic = 0.0;
    let mut k = 0;
    while k < SERIES_LENGTH {
        let next = harmonic + 1.0 / (k + 1) as f64;
        terms[k] = plain[k] * if order == 0 { harmonic } else { harmonic + next };
        harmonic = next;
        k += 1;
    }
    terms
}

/// `a_k` of `e^x K_n √(2x/π) = Σ a_k x^(−k)`: `a_k/a_(k−1) = (4n² − (2k−1)²)/(8k)`.
const fn asymptotic(order: usize) -> [f64; TERM_COUNT] {
    let mut terms = [1.0; TERM_COUNT];
    let mut k = 1;
    while k < TERM_COUNT {
        let odd = (2 * k - 1) as f64;
        terms[k] = terms[k - 1] * ((4 * order * order) as f64 - odd * odd) / (8 * k) as f64;
        k += 1;
    }
    terms
}

const SERIES: [[f64; SERIES_LENGTH]; 2] = [series(0), series(1)];
const HARMONIC: [[f64; SERIES_LENGTH]; 2] = [harmonic_series(0), harmonic_series(1)];
const ASYMPTOTIC: [[f64; TERM_COUNT]; 2] = [asymptotic(0), asymptotic(1)];

/// `a_(k+1)` of order one minus that of order zero.
const EXCESS: [f64; TERM_COUNT - 1] = {
    let mut terms = [0.0; TERM_COUNT - 1];
    let mut k = 0;
    while k + 1 < TERM_COUNT {
        terms[k] = ASYMPTOTIC[1][k + 1] - ASYMPTOTIC[0][k + 1];
        k += 1;
    }
    terms
};

/// Number of terms of the asymptotic expansion for 2⁻⁵⁶ of the sum (checked by a unit test).
fn term_count(x: f64) -> usize {
    match x {
        x if x < 60.0 => 25,
        x if x < 200.0 => 13,
        x if x < 1e4 => 8,
        _ => 5,
    }
}

/// The range of the tables that contains x, 1 ≤ x < 25, and the position in it.
fn range(x: f64) -> (&'static Range, f64) {
    let index = RANGES.iter().take_while(|range| x >= range.below).count();
    let range = &RANGES[index.min(RANGES.len() - 1)];
    (range, (1.0 / x - range.centre) / range.half_width)
}

/// e^(−x) I_n(x) for x ≥ 0 (NaN for NaN).
fn first_kind_scaled(order: usize, x: f64) -> f64 {
    if x < SERIES_BELOW {
        return first_kind_series(order, x) * libm::exp(-x);
    }
    if x < ASYMPTOTIC_FROM {
        let (range, u) = range(x);
        return polynomial(&range.first[order], u) / x.sqrt();
    }
    polynomial(&ASYMPTOTIC[order][..term_count(x)], -1.0 / x) * (FRAC_2_PI.sqrt() * 0.5) / x.sqrt()
}

/// I_n(x) for 0 ≤ x < 1.
fn first_kind_series(order: usize, x: f64) -> f64 {
    let half = 0.5 * x;
    polynomial(&SERIES[order], half * half) * if order == 0 { 1.0 } else { half }
}

/// `e^x K_n(x)` for x ≥ 1.
fn second_kind_scaled(order: usize, x: f64) -> f64 {
    if x < ASYMPTOTIC_FROM {
        let (range, u) = range(x);
        return polynomial(&range.second[order], u) / x.sqrt();
    }
    polynomial(&ASYMPTOTIC[order][..term_count(x)], 1.0 / x) * FRAC_PI_2.sqrt() / x.sqrt()
}

/// K_n(x) for 0 < x < 1, A&S 9.6.13 and 9.6.11.
fn second_kind_series(order: usize, x: f64) -> f64 {
    let half = 0.5 * x;
    let sum = polynomial(&HARMONIC[order], half * half);
    // ln(x/2) as a difference: half of the smallest number would be 0.
    let logarithm = ((libm::log(x) - LN_2) + EULER) * first_kind_series(order, x);
    if order == 0 { sum - logarithm } else { 1.0 / x + (logarithm - 0.5 * half * sum) }
}

/// x (1 − K_0(x)/K_1(x)), from 0 at x = 0 to 1/2 at infinity: avoids cancellation in differences of K_0/K_1.
pub(crate) fn second_kind_excess(x: f64) -> f64 {
    if x < SERIES_BELOW {
        return x - x * (second_kind_series(0, x) / second_kind_series(1, x));
    }
    if x < ASYMPTOTIC_FROM {
        let (range, u) = range(x);
        return polynomial(&range.excess, u);
    }
    let (inverse, count) = (1.0 / x, term_count(x));
    polynomial(&EXCESS[..count], inverse) / polynomial(&ASYMPTOTIC[1][..count], inverse)
}

/// I_0(x), even in x, I_0(0) = 1.
pub fn i0(x: f64) -> f64 {
    first_kind(0, x.abs())
}

/// I_1(x), odd in x, x/2 for small x.
pub fn i1(x: f64) -> f64 {
    first_kind(1, x.abs()).copysign(x)
}

/// e^(−|x|) I_0(x).
pub fn i0_scaled(x: f64) -> f64 {
    first_kind_scaled(0, x.abs())
}

/// e^(−|x|) I_1(x).
pub fn i1_scaled(x: f64) -> f64 {
    first_kind_scaled(1, x.abs()).copysign(x)
}

/// K_0(x), −ln(x/2) − γ for small x; ∞ at 0, NaN for x < 0.
pub fn k0(x: f64) -> f64 {
    second_kind(0, x)
}

/// K_1(x), 1/x for small x; ∞ at 0, NaN for x < 0.
pub fn k1(x: f64) -> f64 {
    second_kind(1, x)
}

/// `e^x K_0(x)`.
pub fn k0_scaled(x: f64) -> f64 {
    second_kind_any_scaled(0, x)
}

/// `e^x K_1(x)`.
pub fn k1_scaled(x: f64) -> f64 {
    second_kind_any_scaled(1, x)
}

fn first_kind(order: usize, x: f64) -> f64 {
    if x < SERIES_BELOW {
        return first_kind_series(order, x);
    }
    if x == f64::INFINITY {
        return x;
    }
    // In two factors: e^x alone overflows at 710, I_n at 714.
    let half = libm::exp(0.5 * x);
    first_kind_scaled(order, x) * half * half
}

fn second_kind(order: usize, x: f64) -> f64 {
    if x > 0.0 && x < SERIES_BELOW {
        return second_kind_series(order, x);
    }
    second_kind_any_scaled(order, x) * libm::exp(-x)
}

fn second_kind_any_scaled(order: usize, x: f64) -> f64 {
    if x >= SERIES_BELOW {
        second_kind_scaled(order, x)
    } else if x > 0.0 {
        second_kind_series(order, x) * libm::exp(x)
    } else if x == 0.0 {
        f64::INFINITY
    } else {
        f64::NAN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_term_left_out_is_below_rounding() {
        for x in [25.0, 59.9, 60.0, 199.0, 200.0, 9999.0, 1e4, 1e300] {
            for terms in &ASYMPTOTIC {
                let count = term_count(x);
                assert!(terms[count].abs() * f64::powi(x, -(count as i32)) < f64::exp2(-56.0), "{count} terms at {x}");
            }
        }
        // Of the power series at 1.
        let last = SERIES[0][SERIES_LENGTH - 1] * f64::powi(0.25, SERIES_LENGTH as i32 - 1);
        assert!(last * 0.25 / (SERIES_LENGTH * SERIES_LENGTH) as f64 <= f64::exp2(-56.0));
    }
}
