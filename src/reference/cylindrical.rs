//! The rim solution in two dimensions: a cross product of Bessel functions that keeps its digits everywhere.
//!
//! ```text
//! v(r) = −(π R / 2) [Y_1(x) J_1(y) − J_1(x) Y_1(y)]        x = κr,  y = κR
//! ```
//!
//! Taken as it stands, the bracket loses everything as r → R (two equal products) and, for large y, as much as the
//! rounding of κR. Hence three routes, with δ = κ(R − r) the distance from the rim:
//!
//! 1. `δ ≤ min(0.3 y, 1.5)`: power series in (R − r)/R from the differential equation, its coefficients kept;
//! 2. `x ≥ 25`: `v = R √(P(x) P(y) / (x y)) sin(δ + φ(y) − φ(x))`, δ in two terms;
//! 3. else the bracket, at arguments whose rounding is put back.

use std::f64::consts::FRAC_PI_2;

use crate::reference::bessel::{ASYMPTOTIC_FROM, first_order, modulus_phase, reduced_square_slope};
use crate::reference::rim_distance::RimDistance;
use crate::vector::two_product;

/// Largest (R − r)/R of the series: its singularity is at 1 (r = 0), so a term gains a factor 0.3.
const SERIES_SHARE: f64 = 0.3;

/// Largest δ of the series: the terms behave like δ^n/n!, so none exceeds the sum by more than e^1.5.
const SERIES_REACH: f64 = 1.5;

/// 0.3^44 = 10⁻²³ and 1.5^44/44! = 10⁻⁴⁷: more coefficients are never needed.
const SERIES_LENGTH: usize = 44;

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
    rim_reduced_square: f64,
    rim_shift: f64,
    /// Largest R − r the series is used for \[length\].
    series_width: f64,
    /// `v = (R − r) Σ c_n ((R − r)/series_width)^n`.
    series: Vec<f64>,
}

impl Cylindrical {
    pub(crate) fn new(wavenumber: f64, outer_radius: f64) -> Self {
        let (rim_argument, low) = two_product(wavenumber, outer_radius);
        let rim = modulus_phase(rim_argument);
        let share = SERIES_SHARE.min(SERIES_REACH / rim_argument);
        Cylindrical {
            wavenumber,
            outer_radius,
            rim_argument,
            rim_values: first_order(rim_argument, low),
            rim_reduced_square: rim.reduced_square,
            rim_shift: rim.shift,
            series_width: share * outer_radius,
            series: rim_series(rim_argument, share),
        }
    }

    pub(crate) fn value(&self, radius: f64) -> f64 {
        let gap = self.outer_radius - radius;
        if gap <= self.series_width {
            let t = gap / self.series_width;
            return gap * self.series.iter().rev().fold(0.0, |sum, &c| sum * t + c);
        }
        let (x, x_low) = two_product(self.wavenumber, radius);
        if x >= ASYMPTOTIC_FROM {
            return self.wave(radius, x).0;
        }
        let (j, y) = first_order(x, x_low);
        self.bracket(j, y)
    }

    pub(crate) fn derivative(&self, radius: f64) -> f64 {
        let gap = self.outer_radius - radius;
        if gap <= self.series_width {
            let t = gap / self.series_width;
            // d/dr of Σ c_n gap^(n+1)/width^n.
            return self.series.iter().enumerate().rev().fold(0.0, |sum, (n, &c)| sum * t - (n + 1) as f64 * c);
        }
        let (x, x_low) = two_product(self.wavenumber, radius);
        if x >= ASYMPTOTIC_FROM {
            return self.wave(radius, x).1;
        }
        let (j, y) = first_order(x, x_low);
        // J_1' = J_0 − J_1/x, and J_0' = −J_1 puts the rounding of the argument back; the same for Y.
        let (j_zero, y_zero) = (libm::j0(x) - x_low * j, libm::y0(x) - x_low * y);
        self.wavenumber * self.bracket(j_zero, y_zero) - self.bracket(j, y) / radius
    }

    /// `−(π R / 2) [y J_1(κR) − j Y_1(κR)]`.
    fn bracket(&self, j: f64, y: f64) -> f64 {
        -FRAC_PI_2 * self.outer_radius * (y * self.rim_values.0 - j * self.rim_values.1)
    }

    /// Value and derivative from modulus and phase, x = κr ≥ 25.
    fn wave(&self, radius: f64, x: f64) -> (f64, f64) {
        let here = modulus_phase(x);
        let distance = RimDistance::new(self.wavenumber, self.outer_radius, radius);
        let (sine, cosine) = distance.sine_cosine(self.rim_shift - here.shift);
        let height =
            self.outer_radius * (here.reduced_square / x * (self.rim_reduced_square / self.rim_argument)).sqrt();
        // M'/M of M² = 2P/(πx), and θ' = 1/P.
        let growth = 0.5 * (reduced_square_slope(x) / here.reduced_square - 1.0 / x);
        (height * sine, self.wavenumber * height * (growth * sine - cosine / here.reduced_square))
    }
}

/// Coefficients c_n of `v = (R − r) Σ c_n t^n`, t = (R − r)/(share R), as many as matter at t = 1.
///
/// With s = (r − R)/R and v = −R Σ b_n s^n, b_0 = 0, b_1 = 1, the differential equation in r = R(1 + s),
/// `(1+s)² v'' + (1+s) v' + (y²(1+s)² − 1) v = 0`, gives
///
/// ```text
/// b_(n+2) = −[(2n+1)(n+1) b_(n+1) + (n²+y²−1) b_n + 2y² b_(n−1) + y² b_(n−2)] / ((n+2)(n+1))
/// ```
///
/// and c_(n−1) = b_n (−share)^(n−1). With y·share ≤ 1.5 no coefficient can overflow, whatever y.
fn rim_series(rim_argument: f64, share: f64) -> Vec<f64> {
    let step = -share;
    let square = (rim_argument * share).powi(2);
    // The last four: b_(n−2), b_(n−1), b_n, b_(n+1), each times its power of the step.
    let mut last = [0.0, 0.0, 0.0, 1.0];
    let mut series = Vec::with_capacity(SERIES_LENGTH);
    series.push(1.0);
    for index in 0..SERIES_LENGTH - 1 {
        let n = index as f64;
        let next = -((2.0 * n + 1.0) * (n + 1.0) * step * last[3]
            + ((n * n - 1.0) * step * step + square) * last[2]
            + square * step * (2.0 * last[1] + step * last[0]))
            / ((n + 2.0) * (n + 1.0));
        last = [last[1], last[2], last[3], next];
        series.push(next);
    }
    // Terms below 2⁻⁶⁰ of the first, all the way to the end, change nothing: Σ c_n t^n is of order one on [0, 1].
    while series.last().is_some_and(|c| c.abs() < f64::exp2(-60.0)) {
        series.pop();
    }
    series
}
