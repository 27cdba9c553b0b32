//! The screening wavenumbers κ_n at which the response diverges.
//!
//! The rim solution has a node at the inner edge, v(a; κ_n) = 0, so no displacement can be prescribed there. In two
//! dimensions
//!
//! ```text
//! J_1(aκ) Y_1(Rκ) − Y_1(aκ) J_1(Rκ) = 0    ⇔    θ(κR) − θ(κa) = n π
//! ```
//!
//! with θ the phase of J_1 + i Y_1 ([`bessel`](crate::reference::bessel)); in three dimensions the same with j_1 + i
//! y_1. In a strip, D = 1, they are n π/(R − a). With θ(x) = x + φ(x) + constant the condition is
//!
//! ```text
//! F(κ) = κ(R − a) + φ(κR) − φ(κa) = n π
//! ```
//!
//! F is strictly increasing: κF' = y θ'(y) − x θ'(x) at y = κR > x = κa, and x θ' grows because x M² falls (Watson, A
//! Treatise on the Theory of Bessel Functions, §13.74; in three dimensions x θ' = x³/(1 + x²)). φ falls from φ(0) = π/4
//! (two dimensions) or π/2 (three) to 0, so `κ_n (R − a)` is between `n π` and `n π + φ(0)`. Every n ≥ 1 therefore has
//! exactly one root in a known bracket. The poles are *not* n π/R: for a ≪ R they are the zeros of J_1 over R, 3.8317,
//! 7.0156, 10.1735, … .

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use crate::reference::Annulus;
use crate::reference::bessel::modulus_phase::modulus_phase;
use crate::reference::rim_distance::RimDistance;

/// Limit of Newton steps; 3 to 6 are needed, but rounding may make the last ones alternate.
const STEP_LIMIT: usize = 40;

/// Pole number `index` \[1/length\] in two (`D = 2`) or three (`D = 3`) dimensions or a strip (`D = 1`), counted from 1.
///
/// `index` 0 gives 0, where F also vanishes: not a pole, but the lower end of the first branch.
///
/// # Accuracy
/// Relative error below 8·10⁻¹⁶ (F to 1.2·10⁻¹⁵ over κF' > 3, and two roundings of nπ and κ). Largest errors found:
/// 1.8·10⁻¹⁶ for the rows of `fixtures/reference`, n ≤ 20, R/a from 60 to 2·10⁴; 2.4·10⁻¹⁶ for n ≤ 1000 and R/a from
/// 1.001 to 10⁷, against multi-precision (`reference::precise_poles::poles_lie_between_numbers_of_opposite_sign`).
///
/// # Cost
/// See `cargo bench --features measurements --bench reference -- pole/`.
///
/// # Example
/// ```
/// use jamscope::reference::{Annulus, poles::pole};
/// let annulus = Annulus::new(0.5, 170.0)?;
/// assert!((170.0 * pole::<2>(annulus, 1) - 3.831808108).abs() < 5e-10);
/// assert!((170.0 * pole::<2>(annulus, 2) - 7.015923260).abs() < 5e-10);
/// # Ok::<(), jamscope::reference::ReferenceError>(())
/// ```
pub fn pole<const D: usize>(annulus: Annulus, index: usize) -> f64 {
    if index == 0 {
        return 0.0;
    }
    let width = annulus.outer_radius() - annulus.inner_radius();
    let start = index as f64 * PI;
    let (mut low, mut high) = (start / width, (start + largest_shift::<D>()) / width);
    let mut wavenumber = 0.5 * (low + high);
    for _ in 0..STEP_LIMIT {
        let phase = Phase::new::<D>(annulus, wavenumber);
        let beyond = phase.beyond(index as f64);
        if beyond > 0.0 {
            high = wavenumber;
        } else {
            low = wavenumber;
        }
        let step = wavenumber * beyond / phase.logarithmic_slope;
        let next = wavenumber - step;
        // Outside the bracket, or NaN: bisect instead.
        let next = if next >= low && next <= high { next } else { 0.5 * (low + high) };
        let moved = (next - wavenumber).abs();
        wavenumber = next;
        if moved <= f64::EPSILON * wavenumber {
            break;
        }
    }
    wavenumber
}

/// Number of poles below `wavenumber` \[1/length\], which is the number of its branch, counted from 0.
///
/// It is also the number of nodes of the displacement between the inflated disk and the rim. It is 0 for a negative
/// wavenumber or NaN.
pub fn pole_count_below<const D: usize>(annulus: Annulus, wavenumber: f64) -> usize {
    if wavenumber.is_nan() || wavenumber <= 0.0 {
        return 0;
    }
    let phase = Phase::new::<D>(annulus, wavenumber);
    let nearest = phase.nearest_index();
    // A pole is not below itself.
    if phase.beyond(nearest as f64) > 0.0 { nearest } else { nearest.saturating_sub(1) }
}

/// The index of the pole that equals `wavenumber` to rounding, if there is one.
///
/// Within 4·2⁻⁵² of κ_n, relative: the sum of the rounding of κ (2⁻⁵³) and of F (6·10⁻¹⁶ of an F' κ above 3).
pub(crate) fn pole_at<const D: usize>(annulus: Annulus, wavenumber: f64) -> Option<usize> {
    let phase = Phase::new::<D>(annulus, wavenumber);
    let nearest = phase.nearest_index();
    let close = phase.beyond(nearest as f64).abs() <= 4.0 * f64::EPSILON * phase.logarithmic_slope;
    (nearest > 0 && close).then_some(nearest)
}

/// φ(0).
fn largest_shift<const D: usize>() -> f64 {
    match D {
        1 => 0.0,
        2 => FRAC_PI_4,
        _ => FRAC_PI_2,
    }
}

/// F at one κ.
struct Phase {
    distance: RimDistance,
    /// φ(κR) − φ(κa).
    shift: f64,
    /// κ F'(κ).
    logarithmic_slope: f64,
}

impl Phase {
    fn new<const D: usize>(annulus: Annulus, wavenumber: f64) -> Self {
        let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
        let distance = RimDistance::new(wavenumber, outer, inner);
        let (at_rim, at_disk) = (shift_and_slope::<D>(wavenumber * outer), shift_and_slope::<D>(wavenumber * inner));
        Phase { distance, shift: at_rim.0 - at_disk.0, logarithmic_slope: distance.value() + at_rim.1 - at_disk.1 }
    }

    /// `F − n π`.
    fn beyond(&self, index: f64) -> f64 {
        self.distance.beyond(self.shift, index)
    }

    /// The integer nearest to F/π.
    fn nearest_index(&self) -> usize {
        // A float-to-integer cast saturates: beyond 2⁵³ poles the index is not exact in any case.
        ((self.distance.value() + self.shift) / PI).round() as usize
    }
}

/// φ(x) and x φ'(x).
fn shift_and_slope<const D: usize>(x: f64) -> (f64, f64) {
    if D == 1 {
        // κ_n (R − a) = n π.
        (0.0, 0.0)
    } else if D == 2 {
        let here = modulus_phase(x);
        // θ' = 1/P.
        (here.shift, x * (1.0 / here.reduced_square - 1.0))
    } else {
        (libm::atan2(1.0, x), -x / (1.0 + x * x))
    }
}
