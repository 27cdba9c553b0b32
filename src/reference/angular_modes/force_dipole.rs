//! [`ForceDipole`]: the response of an elastic medium to two opposite forces at the centre of a held circle.

use crate::reference::angular_modes::{AngularModeError, AngularSolution, ModeAmplitudes, ModeState, compliance_ratio};
use crate::reference::{Annulus, RadialSolution, elastic::Elastic};

/// The displacement of an isotropic elastic medium in a held circle, due to two opposite forces at its centre.
///
/// The forces are F x̂ at (s/2, 0) and −F x̂ at (−s/2, 0), with s → 0 and F s fixed. A positive F s pushes outward.
///
/// ```text
/// μ Δu + (λ+μ) ∇(∇·u) − F s x̂ ∂_x δ(r) = 0        u(R) = 0        n = 0 and n = 2
/// n = 0:  u_r = (D/2) (k−1) (1 − x²)/r
/// n = 2:  u_r = U cos 2θ,  u_θ = w sin 2θ        U + w = (D/r) (1 − x⁴)        U − w = (D/r) (1 − x²) (k − 3x²/k)
/// D = F s/(2πμ (1+k))        k = (λ+3μ)/(λ+μ) = (3−ν)/(1+ν)        x = r/R
/// ```
///
/// This is −s ∂/∂x of Kelvin's solution, `c [−k ln r x̂ + x r/r²]`, and the correction for the rim. For n = 0 that is the
/// solution ∝ r. For n = 2 it is `r` with w = −U and `r³` with (U+w)/(U−w) = −k/3.
///
/// # Units
/// Radii in lengths; the moment over μ, F s/μ, in length².
///
/// # Source
/// Love (1927), A Treatise on the Mathematical Theory of Elasticity, §132, for the double force; the correction for the
/// rim is derived here.
///
/// # Accuracy
/// U and w relative to |U| + |w| + r |U'| + r |w'|, and the derivatives times r relative to the same: below 10⁻¹⁴ (at most
/// 30 roundings). Largest error found against 25 digits: 3.8·10⁻¹⁶, for r/R from 10⁻⁵ to 0.95, ν from −0.5 to 0.999999.
///
/// # Example
/// ```
/// use jamscope::reference::Annulus;
/// use jamscope::reference::angular_modes::force_dipole::ForceDipole;
/// let dipole = ForceDipole::new(Annulus::new(0.5, 1000.0)?, 0.3, 0.1)?;
/// // The displacement falls as 1/r.
/// let [near, far] = [10.0, 20.0].map(|radius| dipole.displacement(radius, 0.0)[0]);
/// assert!((near / far - 2.0).abs() < 1e-2);
/// assert_eq!(dipole.displacement(1000.0, 1.0), [0.0, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceDipole {
    modes: [DipoleMode; 2],
}

/// One of the two modes of a [`ForceDipole`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DipoleMode {
    annulus: Annulus,
    /// Whether n = 2, otherwise n = 0.
    elongated: bool,
    /// k.
    kelvin: f64,
    /// n = 0: D (k−1)/2; n = 2: D \[length²\].
    size: f64,
}

impl ForceDipole {
    /// The dipole F s along θ = 0, given as F s/μ \[length²\], in a circle with a held rim; ν in two dimensions. The
    /// solution is defined outside the inner radius only.
    ///
    /// # Errors
    /// A Poisson's ratio that is not between −1 and 1; a moment that is not finite.
    pub fn new(annulus: Annulus, poisson_ratio: f64, moment_over_shear: f64) -> Result<Self, AngularModeError> {
        let epsilon = compliance_ratio(poisson_ratio)?;
        finite_moment(moment_over_shear)?;
        let kelvin = (1.0 + epsilon) / (1.0 - epsilon);
        // (1+k) (1−ε) = 2, and D (k−1)/2 = F s ε/(4πμ).
        let unit = moment_over_shear / (4.0 * std::f64::consts::PI);
        let mode = |elongated: bool, size: f64| DipoleMode { annulus, elongated, kelvin, size };
        Ok(ForceDipole { modes: [mode(false, unit * epsilon), mode(true, unit * (1.0 - epsilon))] })
    }

    /// The modes n = 0 and n = 2.
    pub fn modes(&self) -> &[DipoleMode; 2] {
        &self.modes
    }

    /// The annulus in which it is defined.
    pub fn annulus(&self) -> Annulus {
        self.modes[0].annulus
    }

    /// The displacement `[u_r, u_θ]` \[length\] at `radius` \[length\] and `angle`; NaN outside the annulus.
    pub fn displacement(&self, radius: f64, angle: f64) -> [f64; 2] {
        let [flat, elongated] = self.modes.map(|mode| mode.displacement(radius, angle));
        [flat[0] + elongated[0], flat[1] + elongated[1]]
    }
}

impl DipoleMode {
    /// n = 0: an inflation with the displacement `size`/r far from the rim.
    fn inflation(&self, radius: f64) -> ModeState {
        let inner = self.annulus.inner_radius();
        let share = inner / self.annulus.outer_radius();
        // d_0 = (size/a) (1 − a²/R²), two factors without cancellation.
        let edge = self.size / inner * ((1.0 - share) * (1.0 + share));
        // An edge value that is not finite (a subnormal radius) is an error there and NaN here.
        match Elastic::<2>::new(self.annulus, edge) {
            Ok(profile) => ModeState {
                value: ModeAmplitudes::in_phase(profile.value(radius), 0.0),
                derivative: ModeAmplitudes::in_phase(profile.derivative(radius), 0.0),
            },
            Err(_) => ModeState::undefined(),
        }
    }
}

impl AngularSolution for DipoleMode {
    fn mode(&self) -> u32 {
        if self.elongated { 2 } else { 0 }
    }

    fn at(&self, radius: f64) -> ModeState {
        if !self.annulus.contains(radius) {
            return ModeState::undefined();
        }
        if !self.elongated {
            return self.inflation(radius);
        }
        let (outer, k) = (self.annulus.outer_radius(), self.kelvin);
        let x = radius / outer;
        let square = x * x;
        let gap = (outer - radius) / outer * (1.0 + x);
        let scale = self.size / radius;
        let (sum, difference) = (scale * gap * (1.0 + square), scale * gap * (k - 3.0 * square / k));
        let slope = scale / radius;
        let sum_slope = -slope * (1.0 + 3.0 * square * square);
        let difference_slope = slope * (9.0 * square * square / k - k - (k + 3.0 / k) * square);
        let amplitudes =
            |sum: f64, difference: f64| ModeAmplitudes::in_phase(0.5 * (sum + difference), 0.5 * (sum - difference));
        ModeState { value: amplitudes(sum, difference), derivative: amplitudes(sum_slope, difference_slope) }
    }
}

pub(super) fn finite_moment(moment_over_shear: f64) -> Result<(), AngularModeError> {
    if moment_over_shear.is_finite() { Ok(()) } else { Err(AngularModeError::DipoleNotFinite { moment_over_shear }) }
}
