//! The rim solution in two dimensions: a cross product of Bessel functions without cancellation.
//!
//! ```text
//! v(r) = −(π R / 2) [Y_1(x) J_1(y) − J_1(x) Y_1(y)]        x = κr,  y = κR
//! ```
//!
//! A direct evaluation of the bracket loses all digits as r → R (two nearly equal products), and for large y as many as
//! the rounding of κR. There are therefore three methods, with δ = κ(R − r) the distance from the rim:
//!
//! 1. `ln(R/r) ≤ 1` and `δ ≤ 1.2`: power series in ln(R/r) from the differential equation ([`LocalSeries`]), with
//!    stored coefficients;
//! 2. `x ≥ 2`: `v = R √(P(x) P(y) / (x y)) sin(δ + φ(y) − φ(x))`, with δ as a sum of two numbers;
//! 3. otherwise the bracket, with arguments corrected for their rounding.

use std::f64::consts::FRAC_PI_2;

use crate::reference::bessel::modulus_phase::{
    EXPANDED_FROM, ModulusPhase, first_order, modulus_phase, reduced_square_slope,
};
use crate::reference::local_series::{LocalSeries, Sign, rim_reach};
use crate::reference::rim_distance::RimDistance;
use crate::vector::two_product;

/// The rim solution for one κ > 0.
#[derive(Debug, Clone)]
pub(crate) struct Cylindrical {
    wavenumber: f64,
    outer_radius: f64,
    /// κR.
    rim_argument: f64,
    /// J_1 and Y_1 at κR.
    rim_values: (f64, f64),
    /// P and φ at κR.
    rim: ModulusPhase,
    /// Near the rim.
    series: LocalSeries,
    /// The radius at which the series ends.
    series_from: f64,
}

impl Cylindrical {
    pub(crate) fn new(wavenumber: f64, outer_radius: f64) -> Self {
        let (rim_argument, low) = two_product(wavenumber, outer_radius);
        let reach = rim_reach(rim_argument);
        let series = LocalSeries::new::<2>(Sign::Screened, rim_argument, outer_radius, reach, (0.0, -1.0));
        Cylindrical {
            wavenumber,
            outer_radius,
            rim_argument,
            rim_values: first_order(rim_argument, low),
            rim: modulus_phase(rim_argument),
            series_from: series.end(),
            series,
        }
    }

    pub(crate) fn value(&self, radius: f64) -> f64 {
        if radius >= self.series_from {
            return self.series.value(radius);
        }
        let (x, x_low) = two_product(self.wavenumber, radius);
        if x >= EXPANDED_FROM {
            return self.wave(radius, x).0;
        }
        let (j, y) = first_order(x, x_low);
        self.bracket(j, y)
    }

    pub(crate) fn derivative(&self, radius: f64) -> f64 {
        if radius >= self.series_from {
            return self.series.derivative(radius);
        }
        let (x, x_low) = two_product(self.wavenumber, radius);
        if x >= EXPANDED_FROM {
            return self.wave(radius, x).1;
        }
        let (j, y) = first_order(x, x_low);
        // J_1' = J_0 − J_1/x, and J_0' = −J_1 corrects the rounding of the argument; the same for Y.
        let (j_zero, y_zero) = (libm::j0(x) - x_low * j, libm::y0(x) - x_low * y);
        self.wavenumber * self.bracket(j_zero, y_zero) - self.bracket(j, y) / radius
    }

    /// `−(π R / 2) [y J_1(κR) − j Y_1(κR)]`.
    fn bracket(&self, j: f64, y: f64) -> f64 {
        -FRAC_PI_2 * self.outer_radius * (y * self.rim_values.0 - j * self.rim_values.1)
    }

    /// Value and derivative from modulus and phase, x = κr ≥ 2.
    fn wave(&self, radius: f64, x: f64) -> (f64, f64) {
        let here = modulus_phase(x);
        let distance = RimDistance::new(self.wavenumber, self.outer_radius, radius);
        let (sine, cosine) = distance.sine_cosine(self.rim.shift - here.shift);
        let height =
            self.outer_radius * (here.reduced_square / x * (self.rim.reduced_square / self.rim_argument)).sqrt();
        // M'/M of M² = 2P/(πx), and θ' = 1/P.
        let growth = 0.5 * (reduced_square_slope(x) / here.reduced_square - 1.0 / x);
        (height * sine, self.wavenumber * height * (growth * sine - cosine / here.reduced_square))
    }
}
