//! [`SphericalMode`]: an angular mode of the elastic shell between a displaced sphere and a held rim, in closed form.
//!
//! A mode ℓ = 0, 1, 2, … is built from one spherical harmonic Y of degree ℓ, the same for every order m:
//!
//! ```text
//! u = U(r) Y r̂ + V(r) r∇Y + W(r) r̂×r∇Y        U, V: spheroidal,  W: toroidal
//! ```
//!
//! *Derivation.* The dilation is Δ Y with Δ = U' + (2U − LV)/r, L = ℓ(ℓ+1). The curl of the spheroidal part is w r̂×r∇Y
//! with w = V' + (V − U)/r. With ε = μ/(λ+2μ) the two components of (λ+2μ) ∇(∇·u) − μ ∇×(∇×u) = 0 are
//!
//! ```text
//! Δ' + ε L w/r = 0        Δ + ε (r w)' = 0
//! ```
//!
//! so Δ is harmonic, r^ℓ or r^(−ℓ−1). Four powers solve them, with these ratios:
//!
//! ```text
//! r^(ℓ−1)     V/U = 1/ℓ                                                 Δ = w = 0: gradient of a harmonic function
//! r^(−ℓ−2)    V/U = −1/(ℓ+1)                                            the same
//! r^(ℓ+1)     V/U = [ℓ+3 − ε(ℓ+1)]/((ℓ+1)[ℓ − ε(ℓ+2)])
//! r^(−ℓ)      V/U = [2−ℓ + εℓ]/(ℓ[ℓ+1 + ε(1−ℓ)])                        ℓ = 1: a point force, (3−4ν)/(4−4ν)
//! ```
//!
//! The toroidal part has the powers r^ℓ and r^(−ℓ−1). Without logarithms, unlike in the plane.

use crate::reference::angular_modes::AngularModeError;
use crate::reference::angular_modes::exponential_differences::{Coupling, Gap, Kernels, log_ratio, ratio_power};
use crate::reference::{Annulus, RadialSolution, elastic::Elastic};
use crate::vector::{Vector, scaled, sum};

/// The three amplitudes of a mode of the shell: of the displacement \[length\], or of its derivative along the radius
/// \[1\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SphericalAmplitudes {
    /// U, along the radius \[length\].
    pub radial: f64,
    /// V, along the gradient of Y on the sphere \[length\]; without meaning for ℓ = 0.
    pub gradient: f64,
    /// W, across both \[length\]; without meaning for ℓ = 0.
    pub toroidal: f64,
}

impl SphericalAmplitudes {
    /// The vector `U Y r̂ + V ∇Y + W r̂×∇Y`.
    ///
    /// `direction` is r̂, `harmonic` is Y there, and `gradient` is r∇Y, its gradient on the unit sphere.
    ///
    /// # Example
    /// ```
    /// use jamscope::reference::angular_modes::spherical::SphericalAmplitudes;
    /// // A translation along z: Y = cos θ, so U = V = 1. At the equator Y = 0 and r∇Y = ẑ.
    /// let translation = SphericalAmplitudes { radial: 1.0, gradient: 1.0, toroidal: 0.0 };
    /// assert_eq!(translation.along([1.0, 0.0, 0.0], 0.0, [0.0, 0.0, 1.0]), [0.0, 0.0, 1.0]);
    /// ```
    pub fn along(&self, direction: Vector<3>, harmonic: f64, gradient: Vector<3>) -> Vector<3> {
        let [x, y, z] = direction;
        let [u, v, w] = gradient;
        let across = [y * w - z * v, z * u - x * w, x * v - y * u];
        let spheroidal = sum(scaled(self.radial * harmonic, direction), scaled(self.gradient, gradient));
        sum(spheroidal, scaled(self.toroidal, across))
    }

    fn is_finite(&self) -> bool {
        self.radial.is_finite() && self.gradient.is_finite() && self.toroidal.is_finite()
    }

    fn undefined() -> Self {
        SphericalAmplitudes { radial: f64::NAN, gradient: f64::NAN, toroidal: f64::NAN }
    }
}

/// The amplitudes at one radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalState {
    /// U, V and W \[length\].
    pub value: SphericalAmplitudes,
    /// U', V' and W' \[1\].
    pub derivative: SphericalAmplitudes,
}

/// An angular mode of an isotropic elastic shell whose inner sphere is displaced and whose rim is held.
///
/// ```text
/// (λ+2μ) ∇(∇·u) − μ ∇×(∇×u) = 0        u = U Y r̂ + V r∇Y + W r̂×r∇Y
/// U, V, W given at a, and zero at R
/// ```
///
/// ℓ = 0: U is [`Elastic::<3>`](Elastic); V and W have no meaning and are 0. ℓ ≥ 1: the four powers of the
/// [module](self). The combinations s = U − ℓV and d = U + (ℓ+1)V each contain three of them. With x = r/R, α = a/R, t
/// = ln(R/r), τ = ln(R/a), E_m(t) = (1 − x^m)/m, L = ℓ(ℓ+1) and ε = μ/(λ+2μ) = (1−2ν)/(2−2ν),
///
/// ```text
/// s = (a/r)^(ℓ+2) [ε(2ℓ+1)² E_q(τ) E_p(t) + L(1−ε)² (E_q(τ) E_p(t) − α^q E_2(τ) E_2(t))]/Δ · s_a
///   + ℓ(1−ε)(ℓ + ε(ℓ+1)) (a/r)^ℓ [E_2(τ) E_p(t) − E_p(τ) E_2(t)]/(x² Δ) · d_a
/// d = (ℓ+1)(1−ε)(ℓ+1 + εℓ) (a/r)^(ℓ+2) x² [α^q E_2(τ) E_q(t) − x^q E_q(τ) E_2(t)]/Δ · s_a
///   + (a/r)^ℓ [ε(2ℓ+1)² E_p(τ) E_q(t) + L(1−ε)² (E_p(τ) E_q(t) − x^q E_2(τ) E_2(t))]/Δ · d_a
/// Δ = ε(2ℓ+1)² E_p(τ) E_q(τ) + L(1−ε)² (E_p(τ) E_q(τ) − α^q E_2(τ)²) > 0        p = 2ℓ+3,  q = 2ℓ−1
/// W = (a/r)^(ℓ+1) E_(2ℓ+1)(t)/E_(2ℓ+1)(τ) · W_a
/// ```
///
/// Δ > 0, so a solution exists for all boundary values, ν and radii: there are no poles. No power exceeds 1.
///
/// # Units
/// Radii and amplitudes in lengths. ν is that of the material, between −1 and 1/2.
///
/// # Source
/// The powers: Love (1927), A Treatise on the Mathematical Theory of Elasticity, ch. XI; the closed form is derived in the
/// [module](self), like that of [`ElasticMode`](crate::reference::angular_modes::elastic::ElasticMode).
///
/// # Accuracy
/// Relative to |u| + h|u'|, with |u| = |U| + √L(|V| + |W|) and h the length over which u changes, and u' times h
/// relative to the same: below 7.5·10⁻¹⁵ times the [condition](SphericalMode::condition). Largest error found against 25
/// digits: 2.6·10⁻¹⁵ for a condition below 10, and 9.9·10⁻¹⁵ otherwise, for ℓ from 1 to 20, R/a from 1.001 to 2·10⁴, ν
/// from −0.5 to 0.4999.
///
/// # Example
/// ```
/// use jamscope::reference::Annulus;
/// use jamscope::reference::angular_modes::spherical::{SphericalAmplitudes, SphericalMode};
/// // The inner sphere moves by 0.1: U = V = 0.1. Far away, u falls as 1/r, with V/U = (3−4ν)/(4−4ν).
/// let boundary = SphericalAmplitudes { radial: 0.1, gradient: 0.1, toroidal: 0.0 };
/// let mode = SphericalMode::new(Annulus::new(0.5, 5e4)?, 0.25, 1, boundary)?;
/// let far = mode.at(50.0).value;
/// assert!((far.gradient / far.radial - 2.0 / 3.0).abs() < 1e-3);
/// assert!((mode.at(100.0).value.radial / far.radial - 0.5).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalMode {
    annulus: Annulus,
    degree: u32,
    boundary: SphericalAmplitudes,
    coupling: Coupling,
    /// ln(R/a).
    depth: f64,
}

impl SphericalMode {
    /// Mode ℓ = `degree` in the shell `annulus`, with Poisson's ratio ν of the material and the amplitudes at the inner
    /// sphere.
    ///
    /// # Errors
    /// A Poisson's ratio that is not between −1 and 1/2; an amplitude that is not finite.
    pub fn new(
        annulus: Annulus,
        poisson_ratio: f64,
        degree: u32,
        boundary: SphericalAmplitudes,
    ) -> Result<Self, AngularModeError> {
        if !(poisson_ratio > -1.0 && poisson_ratio < 0.5) {
            return Err(AngularModeError::MaterialRatioOutside { poisson_ratio });
        }
        if !boundary.is_finite() {
            let SphericalAmplitudes { radial, gradient, toroidal } = boundary;
            return Err(AngularModeError::SphericalAmplitudeNotFinite { radial, gradient, toroidal });
        }
        let boundary = if degree == 0 {
            SphericalAmplitudes { radial: boundary.radial, ..SphericalAmplitudes::default() }
        } else {
            boundary
        };
        let l = f64::from(degree);
        // 1 − ε without a difference.
        let (epsilon, rest) =
            ((1.0 - 2.0 * poisson_ratio) / (2.0 * (1.0 - poisson_ratio)), 0.5 / (1.0 - poisson_ratio));
        let coupling = Coupling {
            soft: epsilon * (2.0 * l + 1.0).powi(2),
            stiff: l * (l + 1.0) * rest * rest,
            mixed: [l * rest * (l + epsilon * (l + 1.0)), (l + 1.0) * rest * (l + 1.0 + epsilon * l)],
        };
        let depth = log_ratio(annulus.outer_radius(), annulus.inner_radius());
        Ok(SphericalMode { annulus, degree, boundary, coupling, depth })
    }

    /// The shell.
    pub fn annulus(&self) -> Annulus {
        self.annulus
    }

    /// ℓ.
    pub fn degree(&self) -> u32 {
        self.degree
    }

    /// The amplitudes and their derivatives at distance `radius` from the centre \[length\]; NaN outside the shell.
    pub fn at(&self, radius: f64) -> SphericalState {
        if !self.annulus.contains(radius) {
            let nan = SphericalAmplitudes::undefined();
            return SphericalState { value: nan, derivative: nan };
        }
        if self.degree == 0 {
            return self.inflation(radius);
        }
        let l = f64::from(self.degree);
        let kernels = self.kernels(radius);
        let edge = [
            self.boundary.radial - l * self.boundary.gradient,
            self.boundary.radial + (l + 1.0) * self.boundary.gradient,
        ];
        let apply = |row: [f64; 2]| edge[0] * row[0] + edge[1] * row[1];
        let [one, other] = kernels.value.map(apply);
        let [one_slope, other_slope] = kernels.derivative.map(apply);
        // s = x^(−ℓ−2) B(t), d = x^(ℓ−1) C(t): r d/dr of the powers, and −d/dt of B and C.
        let [radial_slope, gradient_slope] =
            components(l, [(one * -(l + 2.0) - one_slope) / radius, (other * (l - 1.0) - other_slope) / radius]);
        let [radial, gradient] = components(l, [one, other]);
        let (toroidal, toroidal_slope) = self.torsion(radius);
        let value = if radius == self.annulus.inner_radius() {
            self.boundary
        } else {
            SphericalAmplitudes { radial, gradient, toroidal }
        };
        let derivative =
            SphericalAmplitudes { radial: radial_slope, gradient: gradient_slope, toroidal: toroidal_slope };
        SphericalState { value, derivative }
    }

    /// The loss of digits by cancellation: by how much relative errors of U_a, V_a, W_a and of the formulas are magnified
    /// in the displacement at `radius`. At least 1, infinite or NaN where nothing moves, NaN outside the shell.
    ///
    /// ```text
    /// | |T⁻¹| |K| |T| |b| | / |T⁻¹ K T b|        b: U_a, V_a;  T: to s_a, d_a;  K: the factors of the type
    /// ```
    ///
    /// |…| of a vector is |U| + √L |V|. The factor is of order 1 for most boundary values. It is large where a power that
    /// falls slowly cancels, and for V_a alone in a thin, nearly incompressible shell.
    pub fn condition(&self, radius: f64) -> f64 {
        let value = self.at(radius).value;
        let l = f64::from(self.degree);
        let (radial, gradient) = (self.boundary.radial.abs(), self.boundary.gradient.abs());
        if self.degree == 0 || value.radial.is_nan() {
            return value.radial.abs() / value.radial.abs();
        }
        let edge = [radial + l * gradient, radial + (l + 1.0) * gradient];
        let [one, other] = self.kernels(radius).value.map(|row| edge[0] * row[0].abs() + edge[1] * row[1].abs());
        // T⁻¹ without signs.
        let whole = 2.0 * l + 1.0;
        let terms = SphericalAmplitudes {
            radial: ((l + 1.0) * one + l * other) / whole,
            gradient: (one + other) / whole,
            toroidal: value.toroidal,
        };
        self.size(&terms) / self.size(&value)
    }

    /// |U| + √L (|V| + |W|), in proportion to the mean displacement on a sphere.
    fn size(&self, amplitudes: &SphericalAmplitudes) -> f64 {
        let l = f64::from(self.degree);
        amplitudes.radial.abs() + (l * (l + 1.0)).sqrt() * (amplitudes.gradient.abs() + amplitudes.toroidal.abs())
    }

    /// ℓ = 0.
    fn inflation(&self, radius: f64) -> SphericalState {
        let radial = |radial: f64| SphericalAmplitudes { radial, ..SphericalAmplitudes::default() };
        match Elastic::<3>::new(self.annulus, self.boundary.radial) {
            Ok(profile) => {
                SphericalState { value: radial(profile.value(radius)), derivative: radial(profile.derivative(radius)) }
            }
            // The amplitude is finite, so the error cannot occur.
            Err(_) => {
                SphericalState { value: SphericalAmplitudes::undefined(), derivative: SphericalAmplitudes::undefined() }
            }
        }
    }

    /// The formulas of the type, ℓ ≥ 1.
    fn kernels(&self, radius: f64) -> Kernels {
        let l = f64::from(self.degree);
        Kernels::new(self.annulus, self.depth, [2.0 * l + 3.0, 2.0 * l - 1.0], l + 2.0, &self.coupling, radius)
    }

    /// W and W'; both terms of W' have one sign.
    fn torsion(&self, radius: f64) -> (f64, f64) {
        let l = f64::from(self.degree);
        let t = log_ratio(self.annulus.outer_radius(), radius);
        let [whole, here] = [self.depth, t].map(|t| Gap::integral(2.0 * l + 1.0, t).value());
        let scale = self.boundary.toroidal * ratio_power(self.annulus.inner_radius(), radius, l + 1.0) / whole;
        let power = Gap::power(2.0 * l + 1.0, t).value();
        (scale * here, -scale * ((l + 1.0) * here + power) / radius)
    }
}

/// U and V from s and d.
fn components(l: f64, [one, other]: [f64; 2]) -> [f64; 2] {
    let whole = 2.0 * l + 1.0;
    [((l + 1.0) * one + l * other) / whole, (other - one) / whole]
}
