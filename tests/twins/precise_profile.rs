//! The radial profiles and their derivatives by the plain formulas, to as many digits as it takes: what cancels, cancels in
//! hundreds of bits.
//!
//! ```text
//! N(r) = S_1(κr) F_1(κR) − F_1(κr) S_1(κR)        F, S: J, Y; j, y; I, K; i, k
//! d = N(r)/N(a)                                   v = −N(r)/N'(R)
//! ```

use crate::precise_bessel::{Functions, Real, cylinder, modified, modified_spherical, real, rounded, spherical};

/// Bits of the Bessel functions: near the rim (R − r)³ cancels, up to 160 bits, the square of κR where it is small, and at a pole
/// twice 53 bits.
pub const BITS: usize = 512;

/// Bits kept of products and quotients.
const WORK: usize = BITS + 64;

/// The sign of κ² in the equation.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Sign {
    Screened,
    Antiscreened,
}

/// A profile of D dimensions between two radii.
pub struct PreciseProfile<const D: usize> {
    wavenumber: Real,
    sign: Sign,
    outer: At,
    inner: At,
}

/// What is needed of one radius.
struct At {
    radius: Real,
    functions: Functions,
    /// Derivatives of the functions of order one.
    slopes: [Real; 2],
}

/// All there is to know at one radius.
pub struct Point {
    pub value: Real,
    pub derivative: Real,
    pub wavenumber_derivative: Real,
    /// v, v' and ∂v/∂κ of the rim solution.
    pub rim: [Real; 3],
}

impl<const D: usize> PreciseProfile<D> {
    pub fn new(sign: Sign, inner_radius: f64, outer_radius: f64, wavenumber: f64) -> Self {
        Self::with(sign, inner_radius, outer_radius, real(wavenumber, WORK))
    }

    /// At a wavenumber of more than 53 bits.
    pub fn with(sign: Sign, inner_radius: f64, outer_radius: f64, wavenumber: Real) -> Self {
        let [inner, outer] = [inner_radius, outer_radius].map(|radius| Self::at(sign, &wavenumber, radius));
        PreciseProfile { wavenumber, sign, outer, inner }
    }

    fn at(sign: Sign, wavenumber: &Real, radius: f64) -> At {
        let radius = real(radius, WORK);
        let x = wavenumber * &radius;
        let functions = match (D, sign) {
            (2, Sign::Screened) => cylinder(&x, BITS),
            (2, Sign::Antiscreened) => modified(&x, BITS),
            (_, Sign::Screened) => spherical(&x, BITS),
            (_, Sign::Antiscreened) => modified_spherical(&x, BITS),
        };
        // F_1' = F_0 − (D−1) F_1/x; K_1' = −K_0 − (D−1) K_1/x.
        let slope =
            |f: &[Real; 2], sign: i32| real(f64::from(sign), WORK) * &f[0] - real((D - 1) as f64, WORK) * &f[1] / &x;
        let second_sign = if sign == Sign::Screened { 1 } else { -1 };
        let slopes = [slope(&functions.first, 1), slope(&functions.second, second_sign)];
        At { radius, functions, slopes }
    }

    /// N, N' and ∂N/∂κ.
    fn cross(&self, here: &At) -> [Real; 3] {
        let (f, s) = (&here.functions.first[1], &here.functions.second[1]);
        let (f_rim, s_rim) = (&self.outer.functions.first[1], &self.outer.functions.second[1]);
        let slope = &here.slopes[1] * f_rim - &here.slopes[0] * s_rim;
        let slope_at_rim = s * &self.outer.slopes[0] - f * &self.outer.slopes[1];
        [s * f_rim - f * s_rim, &self.wavenumber * &slope, &here.radius * &slope + &self.outer.radius * slope_at_rim]
    }

    pub fn point(&self, radius: f64) -> Point {
        let here = Self::at(self.sign, &self.wavenumber, radius);
        let [n, slope, response] = self.cross(&here);
        let [n_inner, _, response_inner] = self.cross(&self.inner);
        let rim = self.rim(&n, &slope, &response);
        Point {
            value: &n / &n_inner,
            derivative: &slope / &n_inner,
            wavenumber_derivative: (response * &n_inner - &n * &response_inner) / (&n_inner * &n_inner),
            rim,
        }
    }

    /// v, v' and ∂v/∂κ: v = −N/N'(R), and N'(R) is κ x^(1−D) times a constant (the Wronskian), so it goes as κ^(2−D).
    fn rim(&self, n: &Real, slope: &Real, response: &Real) -> [Real; 3] {
        let [_, rim_slope, _] = self.cross(&self.outer);
        let logarithmic = real(2.0 - D as f64, WORK) / &self.wavenumber;
        let scale = -real(1.0, WORK) / &rim_slope;
        [&scale * n, &scale * slope, &scale * (response - n * logarithmic)]
    }

    /// v(a), and ∂v(a)/∂κ.
    pub fn rim_at_inner(&self) -> [Real; 2] {
        let [n, slope, response] = self.cross(&self.inner);
        let [value, _, response] = self.rim(&n, &slope, &response);
        [value, response]
    }
}

/// |found − exact|.
pub fn error(found: f64, exact: &Real) -> f64 {
    let difference = rounded(&(real(found, WORK) - exact));
    difference.abs()
}
