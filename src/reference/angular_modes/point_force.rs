//! [`PointForce`]: the response of an elastic medium to a force at the centre of a held circle.

use crate::reference::Annulus;
use crate::reference::angular_modes::exponential_differences::log_ratio;
use crate::reference::angular_modes::{
    AngularModeError, AngularSolution, ModeAmplitudes, ModeState, compliance_ratio, finite_force,
};

/// The displacement of an isotropic elastic medium in a held circle, due to a force along θ = 0 at its centre.
///
/// ```text
/// μ Δu + (λ+μ) ∇(∇·u) + F x̂ δ(r) = 0        u(R) = 0        n = 1
/// u_r = c [k ln(R/r) − A (1 − x²)] cos θ        u_θ = −c [k ln(R/r) − (1+A) (1 − x²)] sin θ
/// c = F/(2πμ (1+k))        k = (λ+3μ)/(λ+μ) = (3−ν)/(1+ν)        A = (2−k)/(2k)        x = r/R
/// ```
///
/// The sum of Kelvin's solution and the correction for the rim. The strain falls as 1/r. That of a growing disk, whose
/// forces add up to zero, falls as 1/r². A growing disk that is held at its position causes both: its neighbours are
/// not symmetric and push it with a force, which the medium transmits to the rim.
///
/// # Units
/// Radii in lengths; the force over μ, a length in two dimensions.
///
/// # Source
/// Timoshenko & Goodier (1970), Theory of Elasticity, ch. 4, for the force. The correction for the rim is derived here:
/// a translation and the solution ∝ r² of mode 1.
///
/// # Accuracy
/// U and V relative to |U| + |V| + r |U'| + r |V'|, and the derivatives times r relative to the same: below 10⁻¹⁴
/// against [`ElasticMode`](super::elastic::ElasticMode), whose own error may be 7.5·10⁻¹⁵; largest difference found:
/// 3·10⁻¹⁵.
///
/// # Example
/// ```
/// use jamscope::reference::Annulus;
/// use jamscope::reference::angular_modes::{AngularSolution, point_force::PointForce};
/// let force = PointForce::new(Annulus::new(0.5, 1000.0)?, 0.3, 0.1)?;
/// // The strain falls as 1/r.
/// let ratio = force.stretch_fluctuation(10.0) / force.stretch_fluctuation(20.0);
/// assert!((ratio - 2.0).abs() < 1e-2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointForce {
    annulus: Annulus,
    /// k.
    kelvin: f64,
    /// c \[length\].
    size: f64,
}

impl PointForce {
    /// A force F along θ = 0, given as F/μ \[length\], in a circle with a held rim; ν in two dimensions. The solution
    /// is defined outside the inner radius only.
    ///
    /// # Errors
    /// A Poisson's ratio that is not between −1 and 1; a force that is not finite.
    pub fn new(annulus: Annulus, poisson_ratio: f64, force_over_shear: f64) -> Result<Self, AngularModeError> {
        let epsilon = compliance_ratio(poisson_ratio)?;
        finite_force(force_over_shear)?;
        // (1+k) (1−ε) = 2.
        let size = force_over_shear * (1.0 - epsilon) / (4.0 * std::f64::consts::PI);
        Ok(PointForce { annulus, kelvin: (1.0 + epsilon) / (1.0 - epsilon), size })
    }

    /// The annulus in which it is defined.
    pub fn annulus(&self) -> Annulus {
        self.annulus
    }
}

impl AngularSolution for PointForce {
    fn mode(&self) -> u32 {
        1
    }

    fn at(&self, radius: f64) -> ModeState {
        if !self.annulus.contains(radius) {
            return ModeState::undefined();
        }
        let (outer, k, c) = (self.annulus.outer_radius(), self.kelvin, self.size);
        let x = radius / outer;
        let logarithm = k * log_ratio(outer, radius);
        let gap = (outer - radius) / outer * (1.0 + x);
        let along = 0.5 * (2.0 - k) / k;
        let across = 0.5 * (2.0 + k) / k;
        let slope = |share: f64| c / radius * (2.0 * share * x * x - k);
        ModeState {
            value: ModeAmplitudes::in_phase(c * (logarithm - along * gap), -c * (logarithm - across * gap)),
            derivative: ModeAmplitudes::in_phase(slope(along), -slope(across)),
        }
    }
}
