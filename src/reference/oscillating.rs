//! [`Wave`]: modulus and phase of the oscillating solutions of order one, in two and three dimensions, with their
//! derivatives with respect to κ.
//!
//! ```text
//! J_1 + i Y_1  or  j_1 + i y_1 = M exp(iθ)            x θ' = 2/(π M²)  or  x³/(1 + x²)
//! v(r) = c M(κr) M(κR) sin(θ(κR) − θ(κr))              c = π R/2  or  κ R²
//! ```
//!
//! A derivative with respect to κ at fixed radius is x/κ times one with respect to x. It is computed for the logarithm
//! of M and for the phase, which avoids cancellation at large arguments. Of M'/M only the part beyond the power x^(1−D)
//! is used, `m = x M'/M + D − 1`.

use crate::reference::bessel::modulus_phase::{
    EXPANDED_FROM, modulus_phase, reduced_square_deficit, reduced_square_slope,
};
use crate::reference::bessel::{cylinder, spherical};
use crate::reference::rim_distance::RimDistance;

use std::f64::consts::FRAC_2_PI;

/// Below this x the phase is relative to its value at x = 0, and small.
const SMALL: f64 = 1.0;

/// One of the solutions at one argument x = κr.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wave {
    argument: f64,
    radius: f64,
    /// M.
    pub modulus: f64,
    /// `m = x M'/M + D − 1`, from 0 at x = 0 to (D−1)/2 at infinity.
    pub growth: f64,
    /// φ = θ − x + constant.
    shift: f64,
    /// θ(x) − θ(0), for small x.
    turned: f64,
    /// x θ'.
    turning: f64,
    /// x θ' − x.
    turning_excess: f64,
}

/// The change of the phase between two radii.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turn {
    pub sine: f64,
    pub cosine: f64,
    /// κ ∂/∂κ of the difference of the phases.
    pub rate: f64,
}

impl Wave {
    pub(crate) fn new<const D: usize>(wavenumber: f64, radius: f64) -> Self {
        let x = wavenumber * radius;
        if D == 3 {
            let inverse = 1.0 / x;
            let growth = 1.0 / (1.0 + inverse * inverse);
            return Wave {
                argument: x,
                radius,
                modulus: (1.0 + inverse * inverse).sqrt() * inverse,
                growth,
                shift: libm::atan2(1.0, x),
                turned: if x < SMALL { libm::atan2(spherical::j1(x), -spherical::y1(x)) } else { f64::NAN },
                turning: x * growth,
                turning_excess: -inverse * growth,
            };
        }
        let here = modulus_phase(x);
        if x >= EXPANDED_FROM {
            let p = here.reduced_square;
            return Wave {
                argument: x,
                radius,
                modulus: (FRAC_2_PI * p / x).sqrt(),
                growth: 0.5 * (1.0 + x * reduced_square_slope(x) / p),
                shift: here.shift,
                turned: f64::NAN,
                turning: x / p,
                turning_excess: x * reduced_square_deficit(x) / p,
            };
        }
        let (j, y) = (cylinder::j1(x), cylinder::y1(x));
        let modulus = libm::hypot(j, y);
        // M' of M² = J² + Y² with J_1' = J_0 − J_1/x; two divisions by M, since M² overflows first.
        let growth = x * (cylinder::j0(x) * (j / modulus) + cylinder::y0(x) * (y / modulus)) / modulus;
        let turning = FRAC_2_PI / modulus / modulus;
        Wave {
            argument: x,
            radius,
            modulus,
            growth,
            shift: here.shift,
            turned: libm::atan2(j, -y),
            turning,
            turning_excess: turning - x,
        }
    }

    /// The change to a larger radius, at the same wavenumber.
    pub(crate) fn turn_to(&self, wavenumber: f64, outer: &Wave) -> Turn {
        if outer.argument < SMALL {
            let (sine, cosine) = libm::sincos(outer.turned - self.turned);
            return Turn { sine, cosine, rate: outer.turning - self.turning };
        }
        let distance = RimDistance::new(wavenumber, outer.radius, self.radius);
        let (sine, cosine) = distance.sine_cosine(outer.shift - self.shift);
        Turn { sine, cosine, rate: distance.value() + (outer.turning_excess - self.turning_excess) }
    }
}

/// `c` of `v = c M M sin`, at κ and R.
pub(crate) fn rim_factor<const D: usize>(wavenumber: f64, outer_radius: f64) -> f64 {
    if D == 2 { outer_radius / FRAC_2_PI } else { wavenumber * outer_radius * outer_radius }
}
