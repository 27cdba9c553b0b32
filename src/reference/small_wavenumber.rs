//! [`Pair`]: the regular and the singular solution as power series in κ², for κr of order one or less.
//!
//! ```text
//! D = 2:  M = r Σ q^k/(k! (k+1)!)                              q = ∓(κr)²/4
//!         N = 1/r ± (κ² r/4) [Σ (H_k + H_(k+1)) q^k/(k! (k+1)!) + 2 ln(R/r) Σ q^k/(k! (k+1)!)]
//! D = 3:  M = r Σ 3 p^k/(2^k k! (2k+3)!!)                      p = ∓(κr)²
//!         N = r⁻² Σ (1 − 2k) p^k/(2k)!
//!
//! v = (R^(D−1)/D) [N(r) M(R) − M(r) N(R)]
//! ```
//!
//! M is 2 J_1(κr)/κ or 3 j_1(κr)/κ. N is −(π κ/2) Y_1 without the term of M with the logarithm of κ, or −κ² y_1. Upper
//! signs: screened; lower: antiscreened. The derivatives `(1/κ) ∂/∂κ` are also series, without terms of order κ⁰ that
//! would cancel. In the profile they are combined so that common terms of r and a cancel analytically:
//!
//! ```text
//! (1/κ) ∂(d/d_0)/∂κ = {[N°N_a − N N°_a] − ρ [M°N_a − M N°_a + N°M_a − N M°_a] + ρ² [M°M_a − M M°_a] − ρ° [M N_a − N M_a]}
//!                     / (N_a − ρ M_a)²          ρ = N(R)/M(R)
//! ```
//!
//! # Source
//! Abramowitz & Stegun (1964), 9.1.10 and 9.1.11; DLMF 10.53.

use crate::reference::bessel::polynomial::polynomial;
use crate::reference::local_series::Sign;

/// Number of terms: 1/14!² = 10⁻²² at κr = 2.
const LENGTH: usize = 14;

/// Up to this κR the pair is used: it is below the first pole, 3.83, and no term exceeds the first.
pub(crate) const SMALL_BELOW: f64 = 2.0;

/// 1/(k! (k+n)!).
const fn planar(order: usize) -> [f64; LENGTH] {
    let mut terms = [1.0; LENGTH];
    let mut k = 1;
    while k <= order {
        terms[0] /= k as f64;
        k += 1;
    }
    k = 1;
    while k < LENGTH {
        terms[k] = terms[k - 1] / (k * (k + order)) as f64;
        k += 1;
    }
    terms
}

/// (H_k + H_(k+1)) times another series.
const fn harmonic(plain: [f64; LENGTH]) -> [f64; LENGTH] {
    let mut terms = [0.0; LENGTH];
    let mut sum = 0.0;
    let mut k = 0;
    while k < LENGTH {
        let next = sum + 1.0 / (k + 1) as f64;
        terms[k] = plain[k] * (sum + next);
        sum = next;
        k += 1;
    }
    terms
}

/// 3/(2^k k! (2k+2n+1)!!), n = 1 or 2.
const fn spherical(order: usize) -> [f64; LENGTH] {
    let mut terms = [if order == 1 { 1.0 } else { 0.2 }; LENGTH];
    let mut k = 1;
    while k < LENGTH {
        terms[k] = terms[k - 1] / (2 * k * (2 * k + 2 * order + 1)) as f64;
        k += 1;
    }
    terms
}

/// (1−2k)/(2k)!, or the factor of `p^k` in its derivative, (k+1)(−1−2k)/(2k+2)!.
const fn singular(derivative: bool) -> [f64; LENGTH] {
    let mut terms = [1.0; LENGTH];
    let mut inverse_factorial = 1.0;
    let mut k = 1;
    while k <= LENGTH {
        inverse_factorial /= (2 * k * (2 * k - 1)) as f64;
        let factor = (1.0 - 2.0 * k as f64) * inverse_factorial;
        if derivative {
            terms[k - 1] = k as f64 * factor;
        } else if k < LENGTH {
            terms[k] = factor;
        }
        k += 1;
    }
    terms
}

const ORDER_ZERO: [f64; LENGTH] = planar(0);
const ORDER_ONE: [f64; LENGTH] = planar(1);
const ORDER_TWO: [f64; LENGTH] = planar(2);
const ORDER_ZERO_HARMONIC: [f64; LENGTH] = harmonic(ORDER_ZERO);
const ORDER_ONE_HARMONIC: [f64; LENGTH] = harmonic(ORDER_ONE);
const REGULAR: [f64; LENGTH] = spherical(1);
const REGULAR_SLOPE: [f64; LENGTH] = spherical(2);
const SINGULAR: [f64; LENGTH] = singular(false);
const SINGULAR_SLOPE: [f64; LENGTH] = singular(true);

/// Both solutions at one radius, and their derivatives `(1/κ) ∂/∂κ`, named `*_response`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pair {
    regular: f64,
    regular_response: f64,
    singular: f64,
    singular_response: f64,
}

impl Pair {
    pub(crate) fn new<const D: usize>(sign: Sign, wavenumber: f64, outer_radius: f64, radius: f64) -> Self {
        let x = wavenumber * radius;
        let sign = sign.factor();
        if D == 3 {
            let p = -sign * x * x;
            return Pair {
                regular: radius * polynomial(&REGULAR, p),
                regular_response: -sign * radius.powi(3) * polynomial(&REGULAR_SLOPE, p),
                singular: polynomial(&SINGULAR, p) / (radius * radius),
                singular_response: -2.0 * sign * polynomial(&SINGULAR_SLOPE, p),
            };
        }
        let q = -0.25 * sign * x * x;
        // ln(R/r): the first form is accurate as r → R, the second as r/R → 0.
        let logarithm = if radius > 0.5 * outer_radius {
            -libm::log1p((radius - outer_radius) / outer_radius)
        } else {
            libm::log(outer_radius / radius)
        };
        let regular = polynomial(&ORDER_ONE, q);
        let correction = 0.5 * polynomial(&ORDER_ONE_HARMONIC, q) + logarithm * regular;
        Pair {
            regular: radius * regular,
            regular_response: -0.5 * sign * radius.powi(3) * polynomial(&ORDER_TWO, q),
            singular: (1.0 + 0.5 * sign * x * x * correction) / radius,
            singular_response: sign
                * radius
                * (0.5 * polynomial(&ORDER_ZERO_HARMONIC, q) + logarithm * polynomial(&ORDER_ZERO, q)),
        }
    }

    /// v at this radius; `rim` is the pair at R.
    pub(crate) fn rim_solution<const D: usize>(&self, rim: &Pair, outer_radius: f64) -> f64 {
        let bracket = self.singular * rim.regular - self.regular * rim.singular;
        outer_radius.powi(D as i32 - 1) / D as f64 * bracket
    }

    /// `(1/κ) ∂v/∂κ` at this radius; `rim` is the pair at R.
    pub(crate) fn rim_solution_response<const D: usize>(&self, rim: &Pair, outer_radius: f64) -> f64 {
        let bracket = (self.singular_response * rim.regular - self.regular * rim.singular_response)
            + (self.singular * rim.regular_response - self.regular_response * rim.singular);
        outer_radius.powi(D as i32 - 1) / D as f64 * bracket
    }

    /// `(1/κ) ∂(d/d_0)/∂κ` at this radius; `inner` and `rim` are the pairs at a and R.
    pub(crate) fn profile_response(&self, inner: &Pair, rim: &Pair) -> f64 {
        let ratio = rim.singular / rim.regular;
        let ratio_response = (rim.singular_response - ratio * rim.regular_response) / rim.regular;
        let (here, a) = (self, inner);
        let numerator = (here.singular_response * a.singular - here.singular * a.singular_response)
            - ratio
                * ((here.regular_response * a.singular - here.singular * a.regular_response)
                    + (here.singular_response * a.regular - here.regular * a.singular_response))
            + ratio * ratio * (here.regular_response * a.regular - here.regular * a.regular_response)
            - ratio_response * (here.regular * a.singular - here.singular * a.regular);
        numerator / (a.singular - ratio * a.regular).powi(2)
    }
}
