//! [`Lorentzian`]: a power spectrum with a crossover, and its correlation function.
//!
//! ```text
//! S(f) = A / (1 + (f/f†)^s)        f = 1, 2, …        S(1) = 1
//! G(θ) = Σ_f S(f) cos fθ / Σ_f S(f)
//! ```
//!
//! s = 1.5 describes the angular spectrum of the displacements below the plastic-to-elastic transition. S is flat up to
//! about f† and falls as f^(−s) beyond. The limit f† → 0 is scale-free, S = f^(−s) ([`Lorentzian::scale_free`]); in the
//! limit f† → ∞ G depends on f†θ alone ([`ContinuumLorentzian`]).
//!
//! The sum converges slowly, as f^(1−s) at θ = 0. It is computed as an integral along a ray in the complex plane, at a
//! cost that depends neither on f† nor on θ (`contour.rs` has the formula, the quadrature and its error bound).

mod complex;
mod continuum;
mod contour;
mod crossing;
mod cusp;
mod error;
mod gauss;
mod lanes;
mod tail_integral;

use std::f64::consts::PI;

pub use continuum::ContinuumLorentzian;
pub use crossing::Crossing;
pub use error::{LARGEST_EXPONENT, LorentzianError};

use crate::reference::lorentzian::complex::{Complex, reciprocal};
use crate::reference::lorentzian::continuum::last_panel;
use crate::reference::lorentzian::contour::{Contour, Kind};
use crate::reference::lorentzian::crossing::{SCAN_STEP, first_crossing, only_crossing, scan_end};
use crate::reference::lorentzian::cusp::Cusp;
use crate::reference::lorentzian::error::{check_exponent, check_threshold};
use crate::vector::two_product;

/// The exponent s of the angular power spectrum of the displacements.
pub const USUAL_EXPONENT: f64 = 1.5;

/// Start of the contour on the real axis; f = 1 is added separately, so that S on the contour does not exceed S(1).
const CONTOUR_START: f64 = 1.5;

/// First panel: a quarter of the distance to the nearest integer.
const FIRST_PANEL: f64 = 0.125;

/// Above this f† the limit f† → ∞ is used: the difference is 1/(2 Σ S), less than 2⁻⁵⁶.
const CONTINUUM_FROM: f64 = 72_057_594_037_927_936.0;

/// 2π as the nearest number and the rest.
const TURN: (f64, f64) = (2.0 * PI, 2.449_293_598_294_706_4e-16);

/// The generalised Lorentzian with crossover frequency f† and exponent s.
///
/// ```text
/// S(f) = (1 + f†^s) / (f†^s + f^s)        G(θ) = Σ_(f ≥ 1) S(f) cos fθ / Σ_(f ≥ 1) S(f)
/// ```
///
/// G is even and 2π-periodic, G(0) = 1. For s ≤ 2 it falls and is convex on [0, π], because `Σ S cos fθ = −A/2 + ∫_0^∞
/// K(t) cosh((π−θ)t)/sinh(πt) dt` with K ≥ 0. For s > 2 it may oscillate.
///
/// # Units
/// f and f† are numbers of waves around the circle, θ in rad; S, G without unit.
///
/// # Source
/// S: Fu, Jin, Pan, Procaccia, Long-range angular correlations of particle displacements at a plastic-to-elastic
/// transition in jammed amorphous solids, supplement. The integral: DLMF 2.10.2 (Abel–Plana) with a rotated contour.
///
/// # Accuracy
/// Absolute error of G, and relative error of Σ S, below (8 s + 14)·2⁻⁵²/sin(π/2s), 6.7·10⁻¹⁵ at s = 1.5. Largest
/// errors found for the rows of `fixtures/reference/lorentzian*.json`, s from 1.05 to 31, f† from 10⁻⁶ to 10⁶, θ from
/// 10⁻⁹ to π: 1.8·10⁻¹⁵ in G, 5.6·10⁻¹⁶ in Σ S. In units of m·max(1, (mθ)^(s−2)), m = max(1, f†), the bound for the
/// derivative is four times that for G; largest found: 2.1·10⁻¹⁵.
///
/// # Cost
/// Independent of θ and f†; grows with s (`cargo bench --features measurements --bench lorentzian`). Memory: 0.7 kB per panel at s = 1.5, with
/// 42 panels of 16 nodes for f† ≤ 1 and 62 at f† = 10⁶; 28 nodes at s = 4.
///
/// # Example
/// ```
/// use jamscope::reference::lorentzian::{Crossing, Lorentzian, USUAL_EXPONENT};
/// let medium = Lorentzian::new(5.0, USUAL_EXPONENT)?;
/// assert_eq!((medium.spectrum(1.0), medium.correlation(0.0)), (1.0, 1.0));
/// // Positively correlated up to 0.55 rad, anticorrelated on the far side.
/// let Crossing::At(angle) = medium.crossing(0.0)? else { panic!("G(π) is negative") };
/// assert!((angle - 0.55).abs() < 0.01 && medium.anticorrelation() > 0.0);
/// // The scale-free limit: −G(π) = 1 − 1/√2.
/// let scale_free = Lorentzian::scale_free(USUAL_EXPONENT)?;
/// assert!((scale_free.anticorrelation() - (1.0 - 0.5_f64.sqrt())).abs() < 1e-15);
/// # Ok::<(), jamscope::reference::lorentzian::LorentzianError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Lorentzian {
    exponent: f64,
    crossover: f64,
    total: f64,
    form: Form,
}

#[derive(Debug, Clone)]
enum Form {
    Discrete { contour: Contour, cusp: Cusp },
    Continuum(ContinuumLorentzian),
}

impl Lorentzian {
    /// The Lorentzian with crossover frequency f† > 0 \[1\] and exponent s \[1\].
    ///
    /// # Errors
    /// A crossover that is not positive and finite; an exponent that is not above 1 and at most [`LARGEST_EXPONENT`].
    pub fn new(crossover: f64, exponent: f64) -> Result<Self, LorentzianError> {
        if !(crossover > 0.0 && crossover.is_finite()) {
            return Err(LorentzianError::CrossoverNotPositive { crossover });
        }
        Self::of(crossover, exponent)
    }

    /// The limit f† → 0: S = f^(−s), G = Re Li_s(e^(iθ))/ζ(s).
    ///
    /// # Errors
    /// See [`new`](Self::new).
    pub fn scale_free(exponent: f64) -> Result<Self, LorentzianError> {
        Self::of(0.0, exponent)
    }

    fn of(crossover: f64, exponent: f64) -> Result<Self, LorentzianError> {
        check_exponent(exponent)?;
        if crossover >= CONTINUUM_FROM {
            let limit = ContinuumLorentzian::new(exponent)?;
            let total = crossover * limit.area();
            return Ok(Lorentzian { exponent, crossover, total, form: Form::Continuum(limit) });
        }
        let spectrum = |w: Complex| complex_spectrum(crossover, exponent, w);
        let scale = crossover.max(1.0);
        let kind = Kind::Sum { start: CONTOUR_START };
        let contour = Contour::new(kind, exponent, FIRST_PANEL, last_panel(exponent, scale), spectrum);
        let power = libm::pow(crossover / scale, exponent);
        // The factor of 1/(power + (f/scale)^s), which is S for f† < 1, and A otherwise.
        let front = power + libm::pow(scale, -exponent);
        let integral = if crossover <= CONTOUR_START {
            (1.0 + libm::pow(crossover, exponent)) * tail_integral::scaled_beyond(exponent, crossover, CONTOUR_START)
        } else {
            front * crossover * tail_integral::beyond(exponent, CONTOUR_START / crossover)
        };
        let total = 1.0 + integral + contour.sum_minus_integral();
        let cusp = if crossover <= 1.0 {
            Cusp::new(exponent, 1.0, [front, -front * power])
        } else {
            Cusp::new(exponent, crossover, [front * crossover, -front * crossover])
        };
        Ok(Lorentzian { exponent, crossover, total, form: Form::Discrete { contour, cusp } })
    }

    /// The crossover frequency f† \[1\], 0 if [`scale_free`](Self::scale_free).
    pub fn crossover(&self) -> f64 {
        self.crossover
    }

    /// The exponent s \[1\].
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// S(f) \[1\] at any frequency f > 0 \[1\], S(1) = 1; NaN for f < 0.
    pub fn spectrum(&self, frequency: f64) -> f64 {
        if frequency == 1.0 {
            return 1.0;
        }
        if frequency.is_nan() || frequency < 0.0 {
            return f64::NAN;
        }
        let scale = self.crossover.max(1.0);
        let power = libm::pow(self.crossover / scale, self.exponent);
        (power + libm::pow(scale, -self.exponent)) / (power + libm::pow(frequency / scale, self.exponent))
    }

    /// Σ S(f) over f = 1, 2, … \[1\].
    pub fn total(&self) -> f64 {
        self.total
    }

    /// G(θ) \[1\] at any angle \[rad\]; NaN if the angle is not finite.
    pub fn correlation(&self, angle: f64) -> f64 {
        self.evaluate::<false>(angle).0
    }

    /// G'(θ) \[1/rad\], odd. NaN at θ = 0 (modulo 2π) for s ≤ 2, where G has a cusp or a kink.
    pub fn derivative(&self, angle: f64) -> f64 {
        self.evaluate::<true>(angle).1
    }

    /// G* = −G(π) \[1\].
    pub fn anticorrelation(&self) -> f64 {
        -self.correlation(PI)
    }

    /// θ*: the first angle in (0, π] at which G falls to `threshold`, or the result that it never does.
    ///
    /// For s > 2 G may have several minima; they are bracketed on a grid of 1/30 of the shortest period.
    ///
    /// # Cost
    /// About ten evaluations of G and G'; for s > 2 up to 225/sin(π/s) additional ones.
    ///
    /// # Errors
    /// A threshold that is not below 1.
    pub fn crossing(&self, threshold: f64) -> Result<Crossing, LorentzianError> {
        check_threshold(threshold)?;
        let curve = |angle: f64| self.evaluate::<true>(angle);
        if self.exponent <= 2.0 {
            return Ok(only_crossing(&curve, threshold, std::iter::once(PI)));
        }
        let scale = self.crossover.max(1.0);
        let end = if self.crossover <= 1.0 { PI } else { PI.min(scan_end(self.exponent) / scale) };
        let step = SCAN_STEP / scale;
        // Beyond the end only the integral over K is left; K has one sign, so G is monotonic.
        let grid = (1_u32..).map(|n| f64::from(n) * step).take_while(|&angle| angle < end).chain([PI]);
        Ok(first_crossing(&curve, threshold, grid))
    }

    fn evaluate<const SLOPE: bool>(&self, angle: f64) -> (f64, f64) {
        let Some((folded, sign)) = fold(angle) else { return (f64::NAN, f64::NAN) };
        if folded == 0.0 {
            return (1.0, if self.exponent > 2.0 { 0.0 } else { f64::NAN });
        }
        match &self.form {
            Form::Continuum(limit) => {
                let x = self.crossover * folded;
                let slope = if SLOPE { sign * self.crossover * limit.derivative(x) } else { 0.0 };
                (limit.correlation(x), slope)
            }
            Form::Discrete { cusp, contour } if cusp.holds(folded) => {
                let slope = if SLOPE { cusp.slope(folded, discrete::<true>(contour, cusp.reach()).1) } else { 0.0 };
                ((self.total + cusp.value(folded)) / self.total, sign * slope / self.total)
            }
            Form::Discrete { contour, .. } => {
                let (value, slope) = discrete::<SLOPE>(contour, folded);
                (value / self.total, sign * slope / self.total)
            }
        }
    }
}

/// Σ S(f) cos fθ and its derivative.
fn discrete<const SLOPE: bool>(contour: &Contour, angle: f64) -> (f64, f64) {
    let (value, slope) = contour.evaluate::<SLOPE>(angle);
    let (sine, cosine) = libm::sincos(angle);
    (value + cosine, slope - sine)
}

/// S at a complex frequency.
fn complex_spectrum(crossover: f64, exponent: f64, w: Complex) -> Complex {
    let scale = crossover.max(1.0);
    let power = libm::pow(crossover / scale, exponent);
    let front = power + libm::pow(scale, -exponent);
    reciprocal(Complex::new(power, 0.0) + complex::power(w.scale(1.0 / scale), exponent)).scale(front)
}

/// The angle in [0, π] with the same G, and the sign of the derivative there; none if the angle is not finite.
fn fold(angle: f64) -> Option<(f64, f64)> {
    if !angle.is_finite() {
        return None;
    }
    let turns = libm::rint(angle / TURN.0);
    let (high, low) = two_product(turns, TURN.0);
    let rest = (angle - high) - (low + turns * TURN.1);
    Some((rest.abs().min(PI), if rest < 0.0 { -1.0 } else { 1.0 }))
}
