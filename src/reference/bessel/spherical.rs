//! The spherical Bessel functions of orders zero and one, of real and of imaginary argument. They are elementary
//! functions, but their textbook forms suffer from cancellation at small argument.
//!
//! ```text
//! j_0 = sin x/x      j_1 = (sin x/x − cos x)/x         y_0 = −cos x/x        y_1 = −(cos x/x + sin x)/x
//! i_0 = sinh x/x     i_1 = (cosh x − sinh x/x)/x       k_0 = (π/2) e^(−x)/x  k_1 = (π/2) e^(−x) (1 + 1/x)/x
//! ```
//!
//! i_n and k_n are DLMF's i_n^(1) and k_n, including the factor π/2: `i_n = √(π/(2x)) I_(n+1/2)`, `k_n = √(π/(2x))
//! K_(n+1/2)`. j_1 and i_1 are power series up to x = 2 (j_1) and 3 (i_1); beyond, the difference of their two terms
//! loses at most a bit or two.
//!
//! # Accuracy
//! Relative error of j_0, y_0, i_n, k_n below 10⁻¹⁵. Error of j_1, y_1 below 10⁻¹⁵ of the modulus √(j_1² + y_1²), and
//! for x < 2 of j_1 itself. Largest found: 5·10⁻¹⁶
//! (`reference::bessel_functions::spherical_functions_have_their_digits_at_any_argument`).
//!
//! # Limits
//! j_n and i_n take any x; i_n overflows to ∞ at 718. y_0, y_1, k_0, k_1 at 0 are ∓∞ and ∞; NaN for x < 0. y_1 and k_1,
//! of order 1/x², overflow for x < 10⁻¹⁵⁴.
//!
//! # Cost
//! See `cargo bench --features measurements --bench reference -- bessel`.
//!
//! # Source
//! Abramowitz & Stegun (1964), 10.1 and 10.2; DLMF §10.49 (closed forms) and §10.53 (series).
//!
//! # Example
//! ```
//! use jamscope::reference::bessel::spherical::j1;
//! // x/3, where the closed form subtracts 1 from 1.
//! assert!((j1(1e-9) / (1e-9 / 3.0) - 1.0).abs() < 1e-15);
//! ```

use std::f64::consts::FRAC_PI_2;

use crate::reference::bessel::polynomial::polynomial;

/// Below this argument j_1 is computed by its series \[1\].
const ALTERNATING_BELOW: f64 = 2.0;

/// Below this argument i_1 is computed by its series \[1\].
const POSITIVE_BELOW: f64 = 3.0;

/// 4.5^15 · 3/(15! 33!!) = 10⁻²¹.
const SERIES_LENGTH: usize = 15;

/// 1/(k! (2k+3)!!): `j_1 = x Σ (−x²/2)^k /(k! (2k+3)!!)`, DLMF 10.53.1.
const SERIES: [f64; SERIES_LENGTH] = {
    let mut terms = [1.0 / 3.0; SERIES_LENGTH];
    let mut k = 1;
    while k < SERIES_LENGTH {
        terms[k] = terms[k - 1] / (k * (2 * k + 3)) as f64;
        k += 1;
    }
    terms
};

/// j_0(x), even in x, j_0(0) = 1.
pub fn j0(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { libm::sin(x) / x }
}

/// j_1(x), odd in x, x/3 for small x.
pub fn j1(x: f64) -> f64 {
    if x.abs() < ALTERNATING_BELOW {
        return x * polynomial(&SERIES, -0.5 * x * x);
    }
    let (sine, cosine) = libm::sincos(x);
    (sine / x - cosine) / x
}

/// y_0(x), −1/x for small x; −∞ at 0, NaN for x < 0.
pub fn y0(x: f64) -> f64 {
    if x < 0.0 { f64::NAN } else { -libm::cos(x) / x.abs() }
}

/// y_1(x), −1/x² for small x; −∞ at 0, NaN for x < 0.
pub fn y1(x: f64) -> f64 {
    if x < 0.0 {
        return f64::NAN;
    }
    let (sine, cosine) = libm::sincos(x);
    -(cosine / x.abs() + sine) / x.abs()
}

/// i_0(x), even in x, i_0(0) = 1.
pub fn i0(x: f64) -> f64 {
    // In two factors, since sinh overflows before sinh x/x does.
    let x = x.abs();
    if x < 1.0 { if x == 0.0 { 1.0 } else { libm::sinh(x) / x } } else { grown(i0_scaled(x), x) }
}

/// i_1(x), odd in x, x/3 for small x.
pub fn i1(x: f64) -> f64 {
    if x.abs() < POSITIVE_BELOW { x * polynomial(&SERIES, 0.5 * x * x) } else { grown(i1_scaled(x), x.abs()) }
}

/// e^(−|x|) i_0(x).
pub fn i0_scaled(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { -libm::expm1(-2.0 * x.abs()) / (2.0 * x.abs()) }
}

/// e^(−|x|) i_1(x).
pub fn i1_scaled(x: f64) -> f64 {
    let size = x.abs();
    if size < POSITIVE_BELOW {
        return x * polynomial(&SERIES, 0.5 * x * x) * libm::exp(-size);
    }
    let vanishing = libm::exp(-2.0 * size);
    (((1.0 + vanishing) - (1.0 - vanishing) / size) / (2.0 * size)).copysign(x)
}

/// k_0(x), π/(2x) for small x; ∞ at 0, NaN for x < 0.
pub fn k0(x: f64) -> f64 {
    k0_scaled(x) * libm::exp(-x)
}

/// k_1(x), π/(2x²) for small x; ∞ at 0, NaN for x < 0.
pub fn k1(x: f64) -> f64 {
    k1_scaled(x) * libm::exp(-x)
}

/// `e^x k_0(x)`.
pub fn k0_scaled(x: f64) -> f64 {
    if x < 0.0 { f64::NAN } else { FRAC_PI_2 / x.abs() }
}

/// `e^x k_1(x)`.
pub fn k1_scaled(x: f64) -> f64 {
    if x < 0.0 { f64::NAN } else { FRAC_PI_2 * (1.0 + 1.0 / x.abs()) / x.abs() }
}

/// `scaled · e^x`, in two factors since e^x overflows first.
fn grown(scaled: f64, x: f64) -> f64 {
    if x == f64::INFINITY {
        return x.copysign(scaled);
    }
    let half = libm::exp(0.5 * x);
    scaled * half * half
}
