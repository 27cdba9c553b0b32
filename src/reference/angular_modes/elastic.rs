//! [`ElasticMode`]: an angular mode of the elastic annulus, in closed form.

use crate::reference::angular_modes::exponential_differences::{Coupling, Kernels, log_ratio};
use crate::reference::angular_modes::{
    AngularModeError, AngularSolution, ModeAmplitudes, ModeState, compliance_ratio, finite_amplitudes,
};
use crate::reference::{Annulus, RadialSolution, elastic::Elastic};

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
/// −0.99999 to 1 − 10⁻¹⁰. A transverse displacement alone, U_a = 0, loses more in a thin, nearly incompressible annulus,
/// by up to R/((R−a) n): 4·10⁻¹³ for R/a = 1.001, n = 2, ν = 1 − 10⁻¹⁰. Beyond n = 1000 it agrees with
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
        let (n, epsilon) = (f64::from(self.mode), self.compliance_ratio);
        let mixed = (1.0 - epsilon) * (1.0 + epsilon);
        let coupling = Coupling { soft: 4.0 * epsilon, stiff: (1.0 - epsilon).powi(2), mixed: [mixed, mixed] };
        Kernels::new(self.annulus, self.depth, [2.0 * n + 2.0, 2.0 * n - 2.0], n + 1.0, &coupling, radius)
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
