//! Modes cos qx of a strip in two dimensions between a displaced line and a held wall: [`StripMode`].
//!
//! The line is y = a and the wall y = H. Periodic along x, the displacement has two amplitudes,
//!
//! ```text
//! u_y(x, y) = U(y) cos qx        u_x(x, y) = V(y) sin qx
//! U(a) = A,  V(a) = B,  U(H) = V(H) = 0
//! Δu + (λ+μ)/μ ∇(∇·u) + Γ u = 0
//! ```
//!
//! ν is that of two dimensions, ν = λ/(λ+2μ), as for the modes of the [annulus](crate::reference::angular_modes).

mod elastic;
mod screened;
mod state;

pub use state::{NODE_LIMIT, StripAmplitudes, StripModeError, StripState};

use crate::reference::angular_modes::compliance_ratio;
use crate::reference::rim_distance::RimDistance;
use crate::reference::screened::Screened;
use crate::reference::strip_modes::elastic::Factors;
use crate::reference::strip_modes::screened::ScreenedStrip;
use crate::reference::{Annulus, RadialSolution, ReferenceError};
use crate::vector::larger;

/// A mode cos qx of an elastic or screened strip whose line y = a is displaced and whose wall y = H is held.
///
/// ```text
/// Δu + (λ+μ)/μ ∇(∇·u) + Γ u = 0        u_y = U cos qx,  u_x = V sin qx
/// U(a) = A,  V(a) = B,  U(H) = V(H) = 0
/// ```
///
/// *Elastic*, Γ = 0. With z = H − y, h = H − a, ε = (1−ν)/2 and G(z) = (1 − e^(−2qz))/(2q), s = U + V and d = U − V are
///
/// ```text
/// s = e^(−q(h−z)) {[(1+ε)² G(h) G(z) − (1−ε)² h z e^(−2qh)] s_a + (1−ε²) [h G(z) − z G(h)] d_a}/Δ
/// d = e^(−q(h−z)) {(1−ε²) [h e^(−2qh) G(z) − z e^(−2qz) G(h)] s_a + [(1+ε)² G(h) G(z) − (1−ε)² h z e^(−2qz)] d_a}/Δ
/// Δ = (1+ε)² G(h)² − (1−ε)² h² e^(−2qh) > 0
/// ```
///
/// No exponential exceeds 1, and the differences are computed without cancellation, as in
/// [`ElasticMode`](crate::reference::angular_modes::elastic::ElasticMode). For h → ∞ this is the half space,
/// U = e^(−qη) [A + (1−ε)/(1+ε) qη (A − B)], V = e^(−qη) [B + (1−ε)/(1+ε) qη (A − B)], η = y − a.
///
/// *Screened*. U and V are a gradient and a curl of exponentials of ±√(q² − k²)y, k_L² = Γμ/(λ+2μ) and k_T² = Γ: waves
/// or decay. They become equal for small Γ, so they are not used. The four first-order equations are integrated from
/// the wall, as in [`ScreenedMode`](crate::reference::angular_modes::screened::ScreenedMode).
///
/// *q = 0*. U = A sin k_L(H−y)/sin k_L(H−a), elastic A (H−y)/(H−a) for any ν, and u_x = 0: B has no meaning, V is 0.
///
/// # Units
/// Lengths; q in 1/length, Γ in 1/length².
///
/// # Source
/// The elastic strip: Timoshenko & Goodier (1970), Theory of Elasticity, §24, for given stresses; here for given
/// displacements. Screening: Lemaître et al. (2021), Phys. Rev. E 104, 024904. The integration: Conte (1966), SIAM Rev.
/// 8, 309.
///
/// # Accuracy
/// Relative to |u| + ℓ|u'|, where ℓ is the length over which u changes, and u' times ℓ relative to the same. Elastic:
/// below 7.5·10⁻¹⁵ times the [condition](StripMode::condition). Screened: below `2⁻⁵² (8 + node_count) · condition`.
/// Largest errors found against 25 digits: 5.1·10⁻¹⁶ and 9.1·10⁻¹⁴ of the condition (7 % and 47 % of these bounds), for
/// q(H−a) from 0 to 1000, |Γ|(H−a)² to 5·10⁶, ν from −0.5 to 1 − 10⁻¹⁰, away from poles and next to them. With Γ < 0, B
/// alone of small q decays faster than A would. The error is then relative to what decays slowest.
///
/// # Cost
/// Screened: the setup in proportion to the number of nodes, 1 to 2 times (H−a) max(q, √|Γ|); constant per place.
///
/// # Example
/// ```
/// use jamscope::reference::Annulus;
/// use jamscope::reference::strip_modes::{StripAmplitudes, StripMode};
/// let strip = Annulus::new(0.5, 100.5)?;
/// let wave = StripAmplitudes { normal: 0.1, tangential: 0.0 };
/// let mode = StripMode::new(strip, 0.3, 0.0, 0.2, wave)?;
/// assert_eq!(mode.displacement(0.0, 0.5), [0.0, 0.1]);
/// // ε = 0.35; 5 lengths away, qη = 1: e^(−1) (1 + 0.65/1.35), as in a half space.
/// let expected = 0.1 * f64::exp(-1.0) * (1.0 + 0.65 / 1.35);
/// assert!((mode.at(5.5).value.normal - expected).abs() < 1e-14);
/// // Screened, q = 0: a sine.
/// let wavenumber = f64::sqrt(0.35 * 0.001);
/// let sine = StripMode::new(strip, 0.3, 0.001, 0.0, wave)?;
/// let exact = 0.1 * (wavenumber * 50.0).sin() / (wavenumber * 100.0).sin();
/// assert!((sine.at(50.5).value.normal - exact).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct StripMode {
    interval: Annulus,
    wavenumber: f64,
    boundary: StripAmplitudes,
    form: Form,
}

#[derive(Debug, Clone)]
enum Form {
    /// q = 0, Γ ≥ 0.
    Even(Screened<1>),
    /// q = 0, Γ < 0: k = √(ε|Γ|).
    EvenDecay {
        decay: f64,
    },
    /// Γ = 0, with ε.
    Elastic {
        epsilon: f64,
    },
    Screened(ScreenedStrip),
}

impl StripMode {
    /// The mode with wavenumber q = `wavenumber` \[1/length\] in the `interval` between a and H, with Poisson's ratio ν of
    /// two dimensions, the even `screening` Γ \[1/length²\], and the amplitudes A and B at y = a \[length\].
    ///
    /// # Errors
    /// A Poisson's ratio that is not between −1 and 1; a wavenumber that is negative or not finite; a screening or an
    /// amplitude that is not finite; more than [`NODE_LIMIT`] nodes needed; a screening that is a pole to rounding.
    pub fn new(
        interval: Annulus,
        poisson_ratio: f64,
        screening: f64,
        wavenumber: f64,
        boundary: StripAmplitudes,
    ) -> Result<Self, StripModeError> {
        let epsilon =
            compliance_ratio(poisson_ratio).map_err(|_| StripModeError::PoissonRatioOutside { poisson_ratio })?;
        if !(wavenumber >= 0.0 && (wavenumber * interval.outer_radius()).is_finite()) {
            return Err(StripModeError::WavenumberNegative { wavenumber });
        }
        if !screening.is_finite() {
            return Err(StripModeError::ScreeningNotFinite { screening });
        }
        let StripAmplitudes { normal, tangential } = boundary;
        if !(normal.is_finite() && tangential.is_finite()) {
            return Err(StripModeError::AmplitudeNotFinite { normal, tangential });
        }
        let ends = [interval.inner_radius(), interval.outer_radius()];
        let form = if wavenumber == 0.0 && screening >= 0.0 {
            let longitudinal = libm::sqrt(epsilon * screening);
            Form::Even(Screened::new(interval, 1.0, longitudinal).map_err(|error| match error {
                ReferenceError::AtPole { .. } => {
                    StripModeError::AtPole { wavenumber, screening, condition: f64::INFINITY }
                }
                _ => StripModeError::ScreeningNotFinite { screening },
            })?)
        } else if wavenumber == 0.0 {
            Form::EvenDecay { decay: libm::sqrt(epsilon * -screening) }
        } else if screening == 0.0 {
            Form::Elastic { epsilon }
        } else {
            Form::Screened(ScreenedStrip::new(ends, epsilon, screening, wavenumber, boundary)?)
        };
        let boundary = if wavenumber == 0.0 { StripAmplitudes { tangential: 0.0, ..boundary } } else { boundary };
        Ok(StripMode { interval, wavenumber, boundary, form })
    }

    /// The interval from a to H.
    pub fn interval(&self) -> Annulus {
        self.interval
    }

    /// q \[1/length\].
    pub fn wavenumber(&self) -> f64 {
        self.wavenumber
    }

    /// The displacement `[u_x, u_y]` \[length\] at (x, y); NaN outside the strip.
    pub fn displacement(&self, x: f64, y: f64) -> [f64; 2] {
        let value = self.at(y).value;
        let (sine, cosine) = libm::sincos(self.wavenumber * x);
        [value.tangential * sine, value.normal * cosine]
    }

    /// U, V and their derivatives by y at y = `place`; NaN outside the strip.
    pub fn at(&self, place: f64) -> StripState {
        if !self.interval.contains(place) {
            return StripState { value: StripAmplitudes::undefined(), derivative: StripAmplitudes::undefined() };
        }
        let ends = [self.interval.inner_radius(), self.interval.outer_radius()];
        let state = match &self.form {
            Form::Even(profile) => even(self.boundary.normal, [profile.value(place), profile.derivative(place)]),
            Form::EvenDecay { decay } => even(self.boundary.normal, decaying(*decay, ends, place)),
            Form::Elastic { epsilon } => self.elastic(&Factors::new(*epsilon, self.wavenumber, ends, place)),
            Form::Screened(solution) => solution.at(place),
        };
        if place == ends[0] { StripState { value: self.boundary, ..state } } else { state }
    }

    /// The loss of digits: approximate ratio of the relative errors of the displacement and of the data. At least 1.
    ///
    /// Screened: of order one away from the poles of the mode, and growing as Γ/|Γ − pole| towards one, as in
    /// [`ScreenedMode`](crate::reference::angular_modes::screened::ScreenedMode::condition). For q = 0, with κ = k_L and
    /// h = H − a: max(1, κh) max(|sin κh|, min(1, κh) |cos κh|)/|sin κh|. Elastic: there are no poles, and it is 1 for
    /// B = 0. Otherwise it is 1/(1 − e^(−qh)), because a tangential displacement of a thin, nearly incompressible strip
    /// is a difference of larger terms.
    pub fn condition(&self) -> f64 {
        let depth = self.interval.outer_radius() - self.interval.inner_radius();
        match &self.form {
            Form::Even(profile) => {
                let angle = profile.wavenumber() * depth;
                let (sine, cosine) = libm::sincos(angle);
                let envelope = larger(sine.abs(), angle.min(1.0) * cosine.abs());
                if angle == 0.0 { 1.0 } else { envelope / sine.abs() * larger(1.0, angle) }
            }
            Form::EvenDecay { .. } => 1.0,
            Form::Elastic { .. } => {
                if self.boundary.tangential == 0.0 {
                    1.0
                } else {
                    1.0 / -libm::expm1(-self.wavenumber * depth)
                }
            }
            Form::Screened(solution) => solution.condition,
        }
    }

    /// Number of nodes at which the solution is stored; 0 for a closed form.
    pub fn node_count(&self) -> usize {
        match &self.form {
            Form::Screened(solution) => solution.node_count(),
            _ => 0,
        }
    }

    fn elastic(&self, factors: &Factors) -> StripState {
        let edge = [self.boundary.normal + self.boundary.tangential, self.boundary.normal - self.boundary.tangential];
        let amplitudes = |rows: [[f64; 2]; 2], sign: f64| {
            let [sum, difference] = rows.map(|row| sign * (edge[0] * row[0] + edge[1] * row[1]));
            StripAmplitudes { normal: 0.5 * (sum + difference), tangential: 0.5 * (sum - difference) }
        };
        // d/dy = −d/dz.
        StripState { value: amplitudes(factors.value, 1.0), derivative: amplitudes(factors.derivative, -1.0) }
    }
}

/// q = 0: only U.
fn even(amplitude: f64, [value, slope]: [f64; 2]) -> StripState {
    let normal = |normal: f64| StripAmplitudes { normal, tangential: 0.0 };
    StripState { value: normal(amplitude * value), derivative: normal(amplitude * slope) }
}

/// sinh k(H−y)/sinh k(H−a) and its derivative by y.
fn decaying(decay: f64, [inner, outer]: [f64; 2], place: f64) -> [f64; 2] {
    let faded = RimDistance::new(decay, place, inner).decay();
    let [here, whole] = [place, inner].map(|from| -libm::expm1(-2.0 * decay * (outer - from)));
    if whole == 0.0 {
        // k underflows.
        return [(outer - place) / (outer - inner), -1.0 / (outer - inner)];
    }
    [faded * here / whole, -decay * faded * (2.0 - here) / whole]
}
