//! The rim solution in three dimensions: spherical Bessel functions of order one, in closed form.
//!
//! ```text
//! y_1(x) j_1(y) − j_1(x) y_1(y) = −[x y sin δ + δ² j_1(δ)] / (x² y²)        δ = y − x
//! v(r) = [x y sin δ + δ² j_1(δ)] / (κ x²)        x = κr,  y = κR
//! ```
//!
//! Both terms have the same sign for δ < π, so there is no cancellation near the rim or as κ → 0. The phase of j_1 + i
//! y_1 is x − π + φ with φ = arctan(1/x) exactly.

use crate::reference::rim_distance::RimDistance;

/// The rim solution for one κ > 0.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spherical {
    wavenumber: f64,
    outer_radius: f64,
}

impl Spherical {
    pub(crate) fn new(wavenumber: f64, outer_radius: f64) -> Self {
        Spherical { wavenumber, outer_radius }
    }

    pub(crate) fn value(&self, radius: f64) -> f64 {
        let distance = RimDistance::new(self.wavenumber, self.outer_radius, radius);
        let (sine, cosine) = distance.sine_cosine(0.0);
        self.value_at(radius, distance, sine, cosine)
    }

    /// `v' = (sin δ − y cos δ)/x − 2 v/r`.
    pub(crate) fn derivative(&self, radius: f64) -> f64 {
        let distance = RimDistance::new(self.wavenumber, self.outer_radius, radius);
        let (sine, cosine) = distance.sine_cosine(0.0);
        sine / (self.wavenumber * radius)
            - self.outer_radius / radius * cosine
            - 2.0 * self.value_at(radius, distance, sine, cosine) / radius
    }

    fn value_at(&self, radius: f64, distance: RimDistance, sine: f64, cosine: f64) -> f64 {
        let x = self.wavenumber * radius;
        let delta = distance.value();
        let rest = if delta < 1.0 { squared_times_order_one(delta) } else { sine - delta * cosine };
        // Two divisions by x: x² would underflow long before x does.
        (self.wavenumber * self.outer_radius * sine / x + rest / x / x) / self.wavenumber
    }
}

/// `δ² j_1(δ) = sin δ − δ cos δ` for 0 ≤ δ < 1, by its power series: the ratio of terms is −δ²/((2k+2)(2k+5)).
fn squared_times_order_one(delta: f64) -> f64 {
    let square = delta * delta;
    let mut term = delta * square / 3.0;
    let mut sum = term;
    // At δ = 1 the tenth term is 10⁻²¹ of the first.
    for k in 0..9 {
        let n = f64::from(2 * k);
        term *= -square / ((n + 2.0) * (n + 5.0));
        sum += term;
    }
    sum
}
