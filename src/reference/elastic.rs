//! [`Elastic`]: the elastic medium between an inflated disk and a held rim, annulus (D = 2), shell (D = 3) or strip (D = 1).

use crate::reference::{Annulus, RadialSolution, ReferenceError};

/// Radial displacement of an isotropic elastic medium.
///
/// ```text
/// d(r) = d_0 (a/r)^(D−1) (R^D − r^D) / (R^D − a^D)
///
/// D = 1:  d_0 (R − r) / (R − a)
/// D = 2:  d_0 (a/r) (r² − R²) / (a² − R²)
/// D = 3:  d_0 (a/r)² (R³ − r³) / (R³ − a³)
/// ```
///
/// It does not depend on the elastic moduli. The factor R − r is separated, R^D − r^D = (R − r) Σ r^k R^(D−1−k), so no
/// digits are lost near the rim.
///
/// # Units
/// Radii and displacement in lengths.
///
/// # Source
/// Love (1927), A Treatise on the Mathematical Theory of Elasticity, §98 and §100, with given displacements at both
/// boundaries.
///
/// # Accuracy
/// Relative error below 8·2⁻⁵³ for D = 2, 12·2⁻⁵³ for D = 3 (number of roundings), d(a) = d_0 and d(R) = 0 exactly; at
/// most 4·10⁻¹⁶ for the rows of `fixtures/reference`.
///
/// # Example
/// ```
/// use jamscope::reference::{Annulus, RadialSolution, elastic::Elastic};
/// let shell = Elastic::<3>::new(Annulus::new(1.0, 2.0)?, 0.7)?;
/// // (1/1.5)² (8 − 3.375) / (8 − 1) · 0.7
/// assert!((shell.value(1.5) - 0.7 * 4.625 / 7.0 / 2.25).abs() < 1e-16);
/// # Ok::<(), jamscope::reference::ReferenceError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic<const D: usize> {
    annulus: Annulus,
    amplitude: f64,
}

impl<const D: usize> Elastic<D> {
    /// The medium in `annulus` whose inner edge is displaced by `amplitude` d_0 \[length\].
    ///
    /// # Errors
    /// An amplitude that is not finite.
    pub fn new(annulus: Annulus, amplitude: f64) -> Result<Self, ReferenceError> {
        const { assert!(D >= 1 && D <= 3, "a strip has D = 1, an annulus D = 2, a shell D = 3") };
        if !amplitude.is_finite() {
            return Err(ReferenceError::AmplitudeNotFinite { amplitude });
        }
        Ok(Elastic { annulus, amplitude })
    }

    /// Displacement d_0 of the inner edge \[length\].
    pub fn amplitude(&self) -> f64 {
        self.amplitude
    }

    /// The annulus.
    pub fn annulus(&self) -> Annulus {
        self.annulus
    }

    /// d/d_0, at a radius in the annulus.
    pub(crate) fn relative(&self, radius: f64) -> f64 {
        let (inner, outer) = (self.annulus.inner_radius(), self.annulus.outer_radius());
        (inner / radius).powi(D as i32 - 1) * (power_gap::<D>(outer, radius) / power_gap::<D>(outer, inner))
    }

    /// d'/d_0, at a radius in the annulus.
    pub(crate) fn relative_derivative(&self, radius: f64) -> f64 {
        let (inner, outer) = (self.annulus.inner_radius(), self.annulus.outer_radius());
        // d ∝ R^D r^(1−D) − r, so d' ∝ −((D−1) (R/r)^D + 1): two terms of one sign.
        -(inner / outer).powi(D as i32 - 1)
            * (((D - 1) as f64 * (outer / radius).powi(D as i32) + 1.0) / power_gap::<D>(outer, inner))
    }
}

impl<const D: usize> RadialSolution for Elastic<D> {
    fn value(&self, radius: f64) -> f64 {
        if !self.annulus.contains(radius) {
            return f64::NAN;
        }
        self.amplitude * self.relative(radius)
    }

    fn derivative(&self, radius: f64) -> f64 {
        if !self.annulus.contains(radius) {
            return f64::NAN;
        }
        self.amplitude * self.relative_derivative(radius)
    }
}

/// `(R^D − r^D) / R^(D−1)` as `(R − r) Σ_(k<D) (r/R)^k`, all terms of one sign \[length\].
pub(crate) fn power_gap<const D: usize>(outer_radius: f64, radius: f64) -> f64 {
    let ratio = radius / outer_radius;
    let sum = (1..D).fold(1.0, |sum, _| sum * ratio + 1.0);
    (outer_radius - radius) * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_gap_is_the_difference_of_powers() {
        // 3 and 2 and their powers are exact; 2/3 is not, hence a few roundings.
        assert!((power_gap::<2>(3.0, 2.0) * 3.0 - 5.0).abs() < 1e-15 * 5.0);
        assert!((power_gap::<3>(3.0, 2.0) * 9.0 - 19.0).abs() < 1e-15 * 19.0);
    }
}
