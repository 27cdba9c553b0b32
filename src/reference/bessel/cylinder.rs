//! J_0, J_1, Y_0, Y_1: the solutions of Bessel's equation at real argument.
//!
//! ```text
//! f'' + f'/x + (1 − n²/x²) f = 0,   n = 0, 1        J_n(0) finite,  Y_n(x) → −∞ as x → 0
//!
//! J_0' = −J_1,  J_1' = J_0 − J_1/x,  the same for Y        J_1 Y_0 − J_0 Y_1 = 2/(π x)
//! ```
//!
//! They are those of the crate `libm`, the most accurate of the libraries compared. Only `libm` keeps the phase at any
//! argument: it reduces x itself, where the others reduce a rounded x − 3π/4. This module documents their accuracy and
//! limits.
//!
//! # Accuracy
//! Error below 10⁻¹⁵ of the modulus √(J_n² + Y_n²), for any x from the smallest subnormal number to 10³⁰⁰ (largest
//! found: 5·10⁻¹⁶). This is a relative error except near a zero. Tested by
//! `reference::bessel_functions::cylinder_functions_have_their_digits_at_any_argument`.
//!
//! # Limits
//! Y_n(0) = −∞ and Y_n(x) is NaN for x < 0. Y_1(x) = −2/(πx) overflows to −∞ for x < 3.55·10⁻³⁰⁹. J_n(∞) = Y_n(∞) = 0.
//! NaN gives NaN.
//!
//! # Cost
//! See `cargo bench --features measurements --bench reference -- bessel`.
//!
//! # Source
//! Abramowitz & Stegun (1964), 9.1; DLMF §10.2. The approximations are those of Sun Microsystems' fdlibm (1993).
//!
//! # Example
//! ```
//! use jamscope::reference::bessel::cylinder::{j0, j1, y0, y1};
//! // The Wronskian at a large argument.
//! let x = 1e6;
//! assert!(((j1(x) * y0(x) - j0(x) * y1(x)) * x * std::f64::consts::FRAC_PI_2 - 1.0).abs() < 1e-15);
//! ```

/// J_0(x), even in x, J_0(0) = 1.
pub fn j0(x: f64) -> f64 {
    libm::j0(x)
}

/// J_1(x), odd in x, x/2 for small x.
pub fn j1(x: f64) -> f64 {
    libm::j1(x)
}

/// Y_0(x), (2/π)(ln(x/2) + γ) for small x; −∞ at 0, NaN for x < 0.
pub fn y0(x: f64) -> f64 {
    libm::y0(x)
}

/// Y_1(x), −2/(πx) for small x; −∞ at 0, NaN for x < 0.
pub fn y1(x: f64) -> f64 {
    libm::y1(x)
}
