//! [`Decay`]: the growing and decaying solutions of order one, I and K, without their exponentials, and their
//! dependence on κ.
//!
//! ```text
//! n(x) = −x K'/K − (D−1) = x − ν(x),   ν from 0 to (D−1)/2
//! T(x) = x I'/I − x K'/K = 1/(x^(D−2) I K)   (spherical: with k_1 less its π/2),   T − 2x → 0
//! ζ(r) = I(κr) K(κR)/(K(κr) I(κR)) ≤ 1,      κ ∂ζ/∂κ = −ζ [T(κR) − T(κr)]
//! ```
//!
//! n and T grow as x and 2x. Their differences are κ times that of the radii, plus the differences of the remainders.

use crate::reference::bessel::{modified, modulus_phase, spherical};
use crate::reference::rim_distance::RimDistance;

use std::f64::consts::FRAC_2_PI;

/// Below this x, n itself is small and used directly.
const SMALL: f64 = 1.0;

/// I and K of one argument x = κr.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Decay {
    argument: f64,
    radius: f64,
    /// `e^(−x) I`.
    pub growing: f64,
    /// `e^x K`.
    pub decaying: f64,
    /// n(x), for small x.
    decline: f64,
    /// ν(x).
    excess: f64,
    /// T − 2x.
    rate_excess: f64,
}

impl Decay {
    pub(crate) fn new<const D: usize>(wavenumber: f64, radius: f64) -> Self {
        let x = wavenumber * radius;
        if D == 3 {
            let (growing, decaying) = (spherical::i1_scaled(x), FRAC_2_PI * spherical::k1_scaled(x));
            let vanishing = libm::exp(-2.0 * x);
            // T = 2x³/(x² − 1 + (1+x)² e^(−2x)), except for small x, where its denominator cancels.
            let rate_excess = if x < 3.0 {
                1.0 / (x * growing * decaying) - 2.0 * x
            } else {
                let rest = (1.0 + 1.0 / x).powi(2) * vanishing;
                2.0 * (1.0 / x - x * rest) / (1.0 - 1.0 / (x * x) + rest)
            };
            let (decline, excess) = (x * (x / (1.0 + x)), x / (1.0 + x));
            return Decay { argument: x, radius, growing, decaying, decline, excess, rate_excess };
        }
        let (growing, decaying) = (modified::i1_scaled(x), modified::k1_scaled(x));
        let rate_excess = if x >= modulus_phase::EXPANDED_FROM {
            let deficit = modulus_phase::modified_product_deficit(x);
            2.0 * x * deficit / (1.0 - deficit)
        } else {
            1.0 / (growing * decaying) - 2.0 * x
        };
        let decline = x * (modified::k0_scaled(x) / decaying);
        let excess = if x < SMALL { x - decline } else { modified::second_kind_excess(x) };
        Decay { argument: x, radius, growing, decaying, decline, excess, rate_excess }
    }

    /// n at a larger radius minus n here.
    pub(crate) fn decline_to(&self, wavenumber: f64, outer: &Decay) -> f64 {
        if outer.argument < SMALL {
            return outer.decline - self.decline;
        }
        wavenumber * (outer.radius - self.radius) - (outer.excess - self.excess)
    }

    /// T at a larger radius minus T here.
    fn rate_to(&self, wavenumber: f64, outer: &Decay) -> f64 {
        2.0 * wavenumber * (outer.radius - self.radius) + (outer.rate_excess - self.rate_excess)
    }

    /// ζ, with `rim` at R.
    fn share(&self, wavenumber: f64, rim: &Decay) -> f64 {
        let twice = RimDistance::new(2.0 * wavenumber, rim.radius, self.radius);
        self.growing * rim.decaying / (self.decaying * rim.growing) * twice.decay()
    }

    /// −κ ∂ ln(1 − ζ)/∂κ, with `rim` at R.
    pub(crate) fn reflection(&self, wavenumber: f64, rim: &Decay) -> f64 {
        let share = self.share(wavenumber, rim);
        -share * self.rate_to(wavenumber, rim) / (1.0 - share)
    }
}
