//! `RimDistance`: κ(R − r) without rounding; profiles depend on it near the rim and at large κR.

use crate::vector::{two_product, two_sum};

/// `δ = κ(R − r)` as an unevaluated sum of two numbers, so that its sine is known for any κR.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RimDistance {
    high: f64,
    low: f64,
}

impl RimDistance {
    pub(crate) fn new(wavenumber: f64, outer_radius: f64, radius: f64) -> Self {
        let (gap, gap_low) = two_sum(outer_radius, -radius);
        let (high, low) = two_product(wavenumber, gap);
        RimDistance { high, low: low + wavenumber * gap_low }
    }

    /// δ, rounded.
    pub(crate) fn value(self) -> f64 {
        self.high
    }

    /// sin and cos of δ + `shift`.
    pub(crate) fn sine_cosine(self, shift: f64) -> (f64, f64) {
        let (angle, rest) = two_sum(self.high, shift);
        let rest = rest + self.low;
        let (sine, cosine) = libm::sincos(angle);
        (sine + rest * cosine, cosine - rest * sine)
    }

    /// e^(−δ), relative accuracy.
    pub(crate) fn decay(self) -> f64 {
        let decayed = libm::exp(-self.high);
        decayed - decayed * self.low
    }

    /// `δ + shift − n π`, to 2⁻⁵² of n π.
    pub(crate) fn beyond(self, shift: f64, index: f64) -> f64 {
        (self.high - index * std::f64::consts::PI) + (self.low + shift)
    }
}
