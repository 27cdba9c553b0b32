//! The generalised Lorentzian.

mod crossings;
mod digits;
mod limits;
mod shape;

use std::f64::consts::PI;

use jamscope::reference::lorentzian::{ContinuumLorentzian, Crossing, Lorentzian, LorentzianError};

/// Absolute error claimed for G, and relative for Σ S.
///
/// Left out by the quadrature: 2⁻⁵⁹ of Σ S (a unit test of `contour.rs`). Rounding, in units of 2⁻⁵³: a weight is S at a
/// complex frequency known to 4 in modulus and angle, and |w S'/S| ≤ s, so 4 s in each, 8 s; 8 for the other operations; an
/// exponential is squared as often as it decays, which leaves at most 6. Taken over Σ |weight|, at most 2 Σ S/sin(π/2s)
/// (another unit test there). 6.7·10⁻¹⁵ at s = 1.5, if all roundings had one sign.
fn claimed(exponent: f64) -> f64 {
    (8.0 * exponent + 14.0) * f64::EPSILON / (0.5 * PI / exponent).sin()
}

fn lorentzian(crossover: f64, exponent: f64) -> Lorentzian {
    if crossover == 0.0 { Lorentzian::scale_free(exponent) } else { Lorentzian::new(crossover, exponent) }
        .expect("valid")
}

fn continuum(exponent: f64) -> ContinuumLorentzian {
    ContinuumLorentzian::new(exponent).expect("valid")
}

fn at(crossing: Result<Crossing, LorentzianError>) -> f64 {
    crossing.expect("a threshold below 1").angle().expect("a crossing")
}

/// A scale on which G changes near an angle: the largest |dG/dθ| of a cusp, or f† where it is smooth.
fn steepness(crossover: f64, exponent: f64, angle: f64) -> f64 {
    let scale = crossover.max(1.0);
    scale * (scale * angle).powf((exponent - 2.0).min(0.0)).max(1.0)
}
