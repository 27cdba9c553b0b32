//! [`ElasticMode`]: an angular mode of the elastic annulus, in closed form.

use crate::reference::angular_modes::exponential_differences::{Gap, product_difference};
use crate::reference::angular_modes::{
    AngularModeError, AngularSolution, ModeAmplitudes, ModeState, compliance_ratio, finite_amplitudes,
};
use crate::reference::{Annulus, RadialSolution, elastic::Elastic};
use crate::vector::two_product;

/// An angular mode of an isotropic elastic medium whose inner circle is displaced and whose rim is held.
///
/// ```text
/// Δu + (λ+μ)/μ ∇(∇·u) = 0        u_r = Re[U e^(inθ)],  u_θ = Re[V e^(inθ)]
/// U(a) = U_a,  V(a) = V_a,  U(R) = V(R) = 0
/// ```
///
/// n = 0: U and V each as [`Elastic`]: inflation and torsion. n ≥ 1: Michell's powers r^(±n±1), for n = 1 with a
/// logarithm. The combinations s = U + iV and d = U − iV each contain only one power of each sign. With x = r/R, α =
/// a/R, t = ln(R/r), τ = ln(R/a), ε = (1 − ν)/2 and E_m(t) = (1 − x^m)/m,
///
/// ```text
/// s = (a/r)^(n+1) [4ε E_q(τ) E_p(t) + (1−ε)² (E_q(τ) E_p(t) − α^q E_2(τ) E_2(t))]/Δ · s_a
///   + (1−ε²) (a/r)^(n−1) [E_2(τ) E_p(t) − E_p(τ) E_2(t)]/(x² Δ) · d_a
/// d = (1−ε²) (a/r)^(n+1) x² [α^q E_2(τ) E_q(t) − x^q E_q(τ) E_2(t)]/Δ · s_a
///   + (a/r)^(n−1) [4ε E_p(τ) E_q(t) + (1−ε)² (E_p(τ) E_q(t) − x^q E_2(τ) E_2(t))]/Δ · d_a
/// Δ = 4ε E_p(τ) E_q(τ) + (1−ε)² (E_p(τ) E_q(τ) − α^q E_2(τ)²) > 0        p = 2n+2,  q = 2n−2
/// ```
///
/// No power exceeds 1, so nothing overflows for any n and R/a. Differences are computed from exact terms, so a thin
/// annulus loses no digits.
///
/// # Units
/// Radii and amplitudes in lengths.
///
/// # Source
/// Michell (1899), Proc. Lond. Math. Soc. 31, 100; Timoshenko & Goodier (1970), Theory of Elasticity, §43; here for the
/// displacement, with both boundary conditions.
///
/// # Accuracy
/// Relative to |u| + ℓ|u'|, where ℓ is the length over which u changes, and u' times ℓ relative to the same: below
/// 7.5·10⁻¹⁵. Largest error found against 160 bits: 1.2·10⁻¹⁵, for n from 0 to 1000, R/a from 1 + 10⁻⁷ to 10⁷, ν from
/// −0.99999 to 1 − 10⁻¹⁰. Beyond n = 1000 it agrees with
/// [`ScreenedMode`](crate::reference::angular_modes::screened::ScreenedMode) without screening, tested to n = 5000.
///
/// # Cost
/// See `cargo bench --features measurements --bench reference_modes`.
///
/// # Example
/// ```
/// use jamscope::reference::Annulus;
/// use jamscope::reference::angular_modes::{AngularSolution, ModeAmplitudes, elastic::ElasticMode};
/// // The inner disk moves along x by 0.1: u_r = 0.1 cos θ, u_θ = −0.1 sin θ.
/// let boundary = ModeAmplitudes::in_phase(0.1, -0.1);
/// let mode = ElasticMode::new(Annulus::new(0.5, 170.0)?, 0.3, 1, boundary)?;
/// assert_eq!(mode.displacement(0.5, 0.0), [0.1, 0.0]);
/// // The displacement falls with the logarithm of the distance: at 17 = R/10 it is still more than a quarter.
/// assert!(mode.displacement(17.0, 0.0)[0] > 0.025);
/// assert_eq!(mode.displacement(170.0, 1.0), [0.0, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticMode {
    annulus: Annulus,
    mode: u32,
    boundary: ModeAmplitudes,
    /// ε.
    compliance_ratio: f64,
    /// ln(R/a).
    depth: f64,
}

/// The factors of s_a and d_a in s and d, all over Δ, and the t-derivatives of the brackets.
struct Kernels {
    value: [[f64; 2]; 2],
    derivative: [[f64; 2]; 2],
}

impl ElasticMode {
    /// Mode n = `mode` in `annulus`, with Poisson's ratio ν of two dimensions and the amplitudes at the inner circle.
    ///
    /// # Errors
    /// A Poisson's ratio that is not between −1 and 1; an amplitude that is not finite.
    pub fn new(
        annulus: Annulus,
        poisson_ratio: f64,
        mode: u32,
        boundary: ModeAmplitudes,
    ) -> Result<Self, AngularModeError> {
        let compliance_ratio = compliance_ratio(poisson_ratio)?;
        finite_amplitudes(boundary)?;
        let depth = log_ratio(annulus.outer_radius(), annulus.inner_radius());
        Ok(ElasticMode { annulus, mode, boundary, compliance_ratio, depth })
    }

    /// The annulus.
    pub fn annulus(&self) -> Annulus {
        self.annulus
    }

    /// n = 0: inflation and torsion are the same function of the radius for any ν.
    fn axisymmetric(&self, radius: f64) -> ModeState {
        // An amplitude of 1 is finite, so the error cannot occur.
        let Ok(profile) = Elastic::<2>::new(self.annulus, 1.0) else {
            return ModeState::undefined();
        };
        ModeState {
            value: self.boundary.times(profile.value(radius)),
            derivative: self.boundary.times(profile.derivative(radius)),
        }
    }

    /// The formulas of the type, n ≥ 1.
    fn kernels(&self, radius: f64) -> Kernels {
        let (inner, outer) = (self.annulus.inner_radius(), self.annulus.outer_radius());
        let n = f64::from(self.mode);
        let (p, q) = (2.0 * n + 2.0, 2.0 * n - 2.0);
        let (t, tau, eta) = (log_ratio(outer, radius), self.depth, log_ratio(radius, inner));
        let epsilon = self.compliance_ratio;
        let (soft, stiff, mixed) = (4.0 * epsilon, (1.0 - epsilon).powi(2), (1.0 - epsilon) * (1.0 + epsilon));

        let [whole_p, whole_q, whole_2] = [p, q, 2.0].map(|m| Gap::integral(m, tau));
        let [here_p, here_q, here_2] = [p, q, 2.0].map(|m| Gap::integral(m, t));
        let [slope_p, slope_2] = [p, 2.0].map(|m| Gap::power(m, t));
        let one = Gap::power(0.0, t);
        let whole_2_q = whole_2.times_power(q, tau);
        let (here_2_q, slope_2_q) = (here_2.times_power(q, t), slope_2.times_power(q, t));
        let both = |a: [Gap; 2], b: [Gap; 2]| soft * a[0].value() * a[1].value() + stiff * product_difference(a, b);

        let determinant = both([whole_p, whole_q], [whole_2, whole_2_q]);
        let steep = ratio_power(inner, radius, n + 1.0) / determinant;
        let flat = ratio_power(inner, radius, n - 1.0) / determinant;
        let share = (radius / outer).powi(2);
        // [E_2(τ) E_p(t) − E_p(τ) E_2(t)]/x² = E_2(η) E_p(t) − x^(2n) E_p(η) E_2(t) with η = ln(r/a) = τ − t.
        let [inner_p, inner_2] = [p, 2.0].map(|m| Gap::integral(m, eta));
        let from_inner = product_difference([inner_2, here_p], [inner_p.times_power(2.0 * n, t), here_2]);
        let value = [
            [steep * both([whole_q, here_p], [whole_2_q, here_2]), flat * mixed * from_inner],
            [
                steep * mixed * share * product_difference([whole_2_q, here_q], [whole_q, here_2_q]),
                flat * both([whole_p, here_q], [whole_2, here_2_q]),
            ],
        ];
        let derivative = [
            [
                steep * both([whole_q, slope_p], [whole_2_q, slope_2]),
                flat * mixed * product_difference([whole_2, Gap::power(2.0 * n, t)], [whole_p, one]),
            ],
            [
                steep * mixed * share * product_difference([whole_2_q, one], [whole_q, slope_2_q]),
                flat * both([whole_p, one], [whole_2, slope_2_q]),
            ],
        ];
        Kernels { value, derivative }
    }
}

impl AngularSolution for ElasticMode {
    fn mode(&self) -> u32 {
        self.mode
    }

    fn at(&self, radius: f64) -> ModeState {
        if !self.annulus.contains(radius) {
            return ModeState::undefined();
        }
        if self.mode == 0 {
            return self.axisymmetric(radius);
        }
        let n = f64::from(self.mode);
        let kernels = self.kernels(radius);
        let edge = self.boundary.sum_and_difference();
        let apply = |row: [f64; 2]| edge[0] * row[0] + edge[1] * row[1];
        let [sum, difference] = kernels.value.map(apply);
        let [sum_slope, difference_slope] = kernels.derivative.map(apply);
        // s = x^(−n−1) B(t), d = x^(n−1) C(t): r d/dr of the powers, and −d/dt of B and C.
        let slopes = [(sum * -(n + 1.0) - sum_slope) / radius, (difference * (n - 1.0) - difference_slope) / radius];
        let value = if radius == self.annulus.inner_radius() {
            self.boundary
        } else {
            ModeAmplitudes::from_sum_and_difference([sum, difference])
        };
        ModeState { value, derivative: ModeAmplitudes::from_sum_and_difference(slopes) }
    }
}

/// ln(larger/smaller) to rounding, also if the ratio is near 1.
pub(super) fn log_ratio(larger: f64, smaller: f64) -> f64 {
    let ratio = larger / smaller;
    if smaller > 0.5 * larger {
        -libm::log1p(-(larger - smaller) / larger)
    } else if ratio.is_finite() {
        libm::log(ratio)
    } else {
        libm::log(larger) - libm::log(smaller)
    }
}

/// (a/b)^power for a ≤ b, corrected for the rounding of a/b, which would be multiplied by `power`.
fn ratio_power(a: f64, b: f64, power: f64) -> f64 {
    let ratio = a / b;
    let value = libm::pow(ratio, power);
    let (product, rest) = two_product(ratio, b);
    let lost = ((a - product) - rest) / a;
    // NaN if the product overflows (b > 2⁹⁹⁵), and not needed if a/b is subnormal: radii beyond 10²⁹⁹.
    if lost.abs() < f64::EPSILON { value * (1.0 + power * lost) } else { value }
}
