//! [`ContinuumLorentzian`]: the limit f† → ∞, a function of f†θ.

use crate::reference::lorentzian::complex::{Complex, power, reciprocal};
use crate::reference::lorentzian::contour::{Contour, DECAY_LIMIT, Kind, ray_angle};
use crate::reference::lorentzian::crossing::{Crossing, SCAN_STEP, first_crossing, only_crossing, scan_end};
use crate::reference::lorentzian::cusp::{CUSP_BELOW, Cusp};
use crate::reference::lorentzian::error::{LorentzianError, check_exponent, check_threshold};
use crate::reference::lorentzian::tail_integral;

/// First panel of the contour: u^s is singular there, with an error below 2^(−24(1+s)).
const FIRST_PANEL: f64 = 1.0 / 16_777_216.0;

/// From here on the asymptotic series is used; its third term is below (4·10⁶)^(−4) of the first.
const ASYMPTOTIC_FROM: f64 = 4_194_304.0;

/// The correlation function of the generalised Lorentzian in the limit f† → ∞, where it depends on x = f†θ alone.
///
/// ```text
/// g(x) = lim G(x/f†) = ∫_0^∞ cos(ux)/(1 + u^s) du / ∫_0^∞ du/(1 + u^s)        ∫_0^∞ du/(1 + u^s) = (π/s)/sin(π/s)
///
/// s = 2:  g = e^(−x)
/// ```
///
/// # Accuracy
/// Like [`Lorentzian`](super::Lorentzian), with x for θ: absolute error of g below 6.7·10⁻¹⁵ at s = 1.5; largest found
/// for the rows of `fixtures/reference/lorentzian.json`: 3.3·10⁻¹⁶.
///
/// # Cost
/// Like [`Lorentzian`](super::Lorentzian).
///
/// # Example
/// ```
/// use jamscope::reference::lorentzian::{ContinuumLorentzian, Crossing, USUAL_EXPONENT};
/// let limit = ContinuumLorentzian::new(USUAL_EXPONENT)?;
/// let Crossing::At(k) = limit.crossing(0.1)? else { panic!("g falls to 0") };
/// assert!((k - 1.681333697987038).abs() < 1e-13);
/// # Ok::<(), jamscope::reference::lorentzian::LorentzianError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ContinuumLorentzian {
    exponent: f64,
    area: f64,
    contour: Contour,
    cusp: Cusp,
}

impl ContinuumLorentzian {
    /// The limit for an exponent s \[1\].
    ///
    /// # Errors
    /// An exponent that is not above 1 and at most [`LARGEST_EXPONENT`](super::LARGEST_EXPONENT).
    pub fn new(exponent: f64) -> Result<Self, LorentzianError> {
        check_exponent(exponent)?;
        let last = last_panel(exponent, 1.0);
        let contour = Contour::new(Kind::Integral, exponent, FIRST_PANEL, last, |w| spectrum(w, exponent));
        let cusp = Cusp::new(exponent, 1.0, [1.0, -1.0]);
        Ok(ContinuumLorentzian { exponent, area: tail_integral::whole(exponent), contour, cusp })
    }

    /// The exponent s \[1\].
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// `∫_0^∞ du/(1 + u^s)`, the limit of Σ S(f) / f† \[1\].
    pub fn area(&self) -> f64 {
        self.area
    }

    /// g(x) \[1\] at any x = f†θ \[1\]; even. NaN if x is not finite.
    pub fn correlation(&self, reduced_angle: f64) -> f64 {
        self.evaluate::<false>(reduced_angle).0
    }

    /// g'(x) \[1\], odd. NaN at x = 0 for s ≤ 2, where there is a cusp or a kink.
    pub fn derivative(&self, reduced_angle: f64) -> f64 {
        self.evaluate::<true>(reduced_angle).1
    }

    /// The first x = f†θ at which g falls to `threshold`: f†θ* for large f†.
    ///
    /// # Errors
    /// A threshold that is not below 1.
    pub fn crossing(&self, threshold: f64) -> Result<Crossing, LorentzianError> {
        check_threshold(threshold)?;
        let curve = |x: f64| self.evaluate::<true>(x);
        if self.exponent > 2.0 {
            // Beyond the end only the algebraic tail is left, which approaches 0 from below or has been below it.
            let grid = (1_u32..).map(|n| f64::from(n) * SCAN_STEP).take_while(|&x| x < scan_end(self.exponent));
            return Ok(first_crossing(&curve, threshold, grid));
        }
        // A falling function, to 0 at infinity.
        if threshold <= 0.0 {
            return Ok(Crossing::Never { lowest: 0.0 });
        }
        Ok(only_crossing(&curve, threshold, (0..1000).map(|n| libm::exp2(f64::from(n)))))
    }

    fn evaluate<const SLOPE: bool>(&self, reduced_angle: f64) -> (f64, f64) {
        let x = reduced_angle.abs();
        if !x.is_finite() {
            return (f64::NAN, f64::NAN);
        }
        if x == 0.0 {
            return (1.0, if self.exponent > 2.0 { 0.0 } else { f64::NAN });
        }
        let (value, slope) = if self.cusp.holds(x) {
            let slope = if SLOPE { self.cusp.slope(x, self.contour.evaluate::<true>(CUSP_BELOW).1) } else { 0.0 };
            (self.area + self.cusp.value(x), slope)
        } else if x < ASYMPTOTIC_FROM {
            self.contour.evaluate::<SLOPE>(x)
        } else {
            tail(self.exponent, x)
        };
        (value / self.area, reduced_angle.signum() * slope / self.area)
    }
}

/// `1/(1 + w^s)`.
fn spectrum(w: Complex, exponent: f64) -> Complex {
    reciprocal(Complex::new(1.0, 0.0) + power(w, exponent))
}

/// End of the panels, in frequencies, for a crossover: where the exponential is negligible at the smallest angle of the
/// contour, or where S is (2^(−57) left of ∫ f S df).
pub(super) fn last_panel(exponent: f64, scale: f64) -> f64 {
    let exponential = DECAY_LIMIT / (libm::sin(ray_angle(exponent)) * CUSP_BELOW);
    let algebraic = if exponent > 2.0 { libm::exp2(57.0 / (exponent - 2.0)) } else { f64::INFINITY };
    scale * exponential.min(algebraic).max(8.0)
}

/// `Σ (−1)^(m+1) Γ(ms+1) sin(πms/2) x^(−ms−1)`, two terms, and the derivative.
fn tail(exponent: f64, x: f64) -> (f64, f64) {
    let (mut value, mut slope) = (0.0, 0.0);
    for (sign, a) in [(1.0, exponent), (-1.0, 2.0 * exponent)] {
        // sin(πa/2), exact at even a.
        let sine = libm::sin(std::f64::consts::FRAC_PI_2 * libm::remainder(a, 4.0));
        let sine = if libm::remainder(a, 2.0) == 0.0 { 0.0 } else { sine };
        let term = sign * sine * libm::exp(libm::lgamma(a + 1.0) - (a + 1.0) * libm::log(x));
        value += term;
        slope -= (a + 1.0) * term / x;
    }
    (value, slope)
}
