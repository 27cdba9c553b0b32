//! Angular modes of the annulus in two dimensions, and of the elastic shell: the response of the medium to a
//! displacement cos nθ of the inner circle.
//!
//! A mode n = 0, 1, 2, … has two complex amplitudes, one along the radius and one along the circle,
//!
//! ```text
//! u_r(r, θ) = Re[U(r) e^(inθ)]        u_θ(r, θ) = Re[V(r) e^(inθ)]
//! ```
//!
//! They are given at the inner circle and zero at the held rim: U(a) = U_a, V(a) = V_a, U(R) = V(R) = 0. Their phases
//! rotate the pattern: `c cos nθ + s sin nθ` has the amplitude c − is. [`ModeAmplitudes::in_phase`] makes the common
//! pair `u_r ∝ cos nθ, u_θ ∝ sin nθ`. Between the circles, divided by the shear modulus μ,
//!
//! ```text
//! Δu + (λ+μ)/μ ∇(∇·u) + Γ u = 0        Γ = [[Γ_e, −Γ_o], [Γ_o, Γ_e]]
//! ```
//!
//! [`ElasticMode`](elastic::ElasticMode) is the closed form for Γ = 0. [`PointForce`](point_force::PointForce) is the n
//! = 1 mode of a force at the centre, [`ForceDipole`](force_dipole::ForceDipole) the n = 0 and n = 2 modes of two opposite
//! forces there. [`ScreenedMode`](screened::ScreenedMode) allows any even and odd screening; odd
//! screening turns radial inflation (n = 0) into radial and transverse displacement.
//! [`ScreenedSource`](screened_source::ScreenedSource) is the force and the dipole with even screening. All implement [`AngularSolution`],
//! which also gives the stretch of bonds. Start from [`ElasticMode::new`](elastic::ElasticMode::new). The modes of an
//! elastic shell, in three dimensions, are [`SphericalMode`](spherical::SphericalMode).
//!
//! # Poisson's ratio
//!
//! In two dimensions ν = λ/(λ+2μ), between −1 and 1. A slab in plane stress has the ν of its material. In plane strain,
//! with ν₃ of the material, ν = ν₃/(1 − ν₃), so ν₃ = 1/2 is ν = 1. The equations contain only ε = μ/(λ+2μ) = (1 − ν)/2.
//!
//! # Source
//! Michell (1899), Proc. Lond. Math. Soc. 31, 100, for the elastic modes; Lemaître et al. (2021), Phys. Rev. E 104,
//! 024904, for screening; Cohen, Schiller, Wang, Dijksman, Moshe (2023), arXiv:2310.09942, for the odd one.

pub mod elastic;
pub(super) mod exponential_differences;
pub(super) mod first_order_system;
pub mod force_dipole;
mod node_solution;
pub mod point_force;
pub mod screened;
pub mod screened_source;
pub(super) mod solution_basis;
mod source_series;
pub mod spherical;

pub use num_complex::Complex;
use thiserror::Error;

use crate::vector::two_product;

/// The two amplitudes of a mode: of the displacement \[length\], or of its derivative along the radius \[1\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeAmplitudes {
    /// U, along the radius \[length\].
    pub radial: Complex<f64>,
    /// V, along the circle, counterclockwise \[length\].
    pub transverse: Complex<f64>,
}

impl ModeAmplitudes {
    /// `u_r = radial · cos nθ`, `u_θ = transverse · sin nθ`: mirror-symmetric about θ = 0.
    pub fn in_phase(radial: f64, transverse: f64) -> Self {
        // Re[−i e^(inθ)] = sin nθ.
        ModeAmplitudes { radial: Complex::new(radial, 0.0), transverse: Complex::new(0.0, -transverse) }
    }

    /// The radial and the transverse component at `angle` θ, `[Re(U e^(inθ)), Re(V e^(inθ))]`, for mode n = `mode`
    /// \[length\].
    pub fn at_angle(&self, mode: u32, angle: f64) -> [f64; 2] {
        let wave = phase_factor(mode, angle);
        [(self.radial * wave).re, (self.transverse * wave).re]
    }

    /// The same pattern rotated counterclockwise by `angle`: both amplitudes times `e^(−in·angle)`.
    pub fn rotated(&self, mode: u32, angle: f64) -> Self {
        let turn = phase_factor(mode, angle).conj();
        ModeAmplitudes { radial: self.radial * turn, transverse: self.transverse * turn }
    }

    /// Both amplitudes times a real factor.
    fn times(&self, factor: f64) -> Self {
        ModeAmplitudes { radial: self.radial * factor, transverse: self.transverse * factor }
    }

    /// U + iV and U − iV.
    fn sum_and_difference(&self) -> [Complex<f64>; 2] {
        let quarter = times_i(self.transverse);
        [self.radial + quarter, self.radial - quarter]
    }

    fn from_sum_and_difference([sum, difference]: [Complex<f64>; 2]) -> Self {
        ModeAmplitudes { radial: (sum + difference) * 0.5, transverse: -times_i((sum - difference) * 0.5) }
    }

    fn is_finite(&self) -> bool {
        self.radial.is_finite() && self.transverse.is_finite()
    }

    fn undefined() -> Self {
        let nan = Complex::new(f64::NAN, f64::NAN);
        ModeAmplitudes { radial: nan, transverse: nan }
    }
}

/// i times a number, exactly.
fn times_i(z: Complex<f64>) -> Complex<f64> {
    Complex::new(-z.im, z.re)
}

/// `e^(inθ)`, corrected for the rounding of nθ.
fn phase_factor(mode: u32, angle: f64) -> Complex<f64> {
    let (high, low) = two_product(f64::from(mode), angle);
    let (sine, cosine) = libm::sincos(high);
    Complex::new(cosine - low * sine, sine + low * cosine)
}

/// The amplitudes at one radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeState {
    /// U and V \[length\].
    pub value: ModeAmplitudes,
    /// U' and V' \[1\].
    pub derivative: ModeAmplitudes,
}

impl ModeState {
    fn undefined() -> Self {
        ModeState { value: ModeAmplitudes::undefined(), derivative: ModeAmplitudes::undefined() }
    }
}

/// One angular mode of a displacement field between the inner circle and the rim.
pub trait AngularSolution {
    /// n, the number of periods around the circle.
    fn mode(&self) -> u32;

    /// The amplitudes and their derivatives at distance `radius` from the centre \[length\]; NaN outside the annulus.
    fn at(&self, radius: f64) -> ModeState;

    /// The displacement `[u_r, u_θ]` \[length\] at `radius` \[length\] and `angle`.
    fn displacement(&self, radius: f64, angle: f64) -> [f64; 2] {
        self.at(radius).value.at_angle(self.mode(), angle)
    }

    /// Standard deviation of the stretch of short bonds of all directions around the circle at `radius`, over their
    /// length \[1\]. For bonds of length s, [h_∥](crate::observe::fluctuations) is s times this.
    ///
    /// ```text
    /// n·ε·n = ε_rr cos²φ + ε_θθ sin²φ + 2 ε_rθ sin φ cos φ        φ: from the radius to the bond
    /// h_∥²/s² = ⟨(n·ε·n)²⟩ − ⟨n·ε·n⟩² = (3|E_rr|² + 3|E_θθ|² + 2 Re E_rr E_θθ* + 4|E_rθ|²)/16        n ≥ 1
    ///         = ((E_rr − E_θθ)² + 4 E_rθ²)/8        n = 0
    /// E_rr = U'        E_θθ = (U + inV)/r        2 E_rθ = V' + (inU − V)/r
    /// ```
    ///
    /// The squares of modes with different n add up.
    fn stretch_fluctuation(&self, radius: f64) -> f64 {
        let ModeState { value, derivative } = self.at(radius);
        let n = f64::from(self.mode());
        let [radial, around] = [derivative.radial, (value.radial + times_i(value.transverse) * n) / radius];
        let twice_shear = derivative.transverse + (times_i(value.radial) * n - value.transverse) / radius;
        let variance = if self.mode() == 0 {
            // The value at angle 0 is that at all angles.
            ((radial.re - around.re).powi(2) + twice_shear.re.powi(2)) / 8.0
        } else {
            let both = (radial * around.conj()).re;
            (3.0 * radial.norm_sqr() + 3.0 * around.norm_sqr() + 2.0 * both + twice_shear.norm_sqr()) / 16.0
        };
        variance.sqrt()
    }
}

/// Why a mode could not be set up.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum AngularModeError {
    /// Poisson's ratio of two dimensions is not between −1 and 1.
    #[error("Poisson's ratio in two dimensions must lie between -1 and 1, it is {poisson_ratio}")]
    PoissonRatioOutside {
        /// The ratio given.
        poisson_ratio: f64,
    },
    /// Poisson's ratio of the material is not between −1 and 1/2.
    #[error("Poisson's ratio in three dimensions must lie between -1 and 0.5, it is {poisson_ratio}")]
    MaterialRatioOutside {
        /// The ratio given.
        poisson_ratio: f64,
    },
    /// An amplitude at the inner sphere is not finite.
    #[error("the amplitudes at the inner sphere must be finite, they are {radial}, {gradient} and {toroidal}")]
    SphericalAmplitudeNotFinite {
        /// U_a given \[length\].
        radial: f64,
        /// V_a given \[length\].
        gradient: f64,
        /// W_a given \[length\].
        toroidal: f64,
    },
    /// An amplitude at the inner circle is not finite.
    #[error("the amplitudes at the inner radius must be finite, they are {radial} and {transverse}")]
    AmplitudeNotFinite {
        /// U_a given \[length\].
        radial: Complex<f64>,
        /// V_a given \[length\].
        transverse: Complex<f64>,
    },
    /// A force is not finite.
    #[error("the force over the shear modulus must be finite, it is {force_over_shear}")]
    ForceNotFinite {
        /// F/μ given \[length\].
        force_over_shear: f64,
    },
    /// A force dipole is not finite.
    #[error("the force dipole over the shear modulus must be finite, it is {moment_over_shear}")]
    DipoleNotFinite {
        /// F s/μ given \[length²\].
        moment_over_shear: f64,
    },
    /// A screening coefficient is not finite.
    #[error("the screening must be finite, it is {even} (even) and {odd} (odd)")]
    ScreeningNotFinite {
        /// Γ_e given \[1/length²\].
        even: f64,
        /// Γ_o given \[1/length²\].
        odd: f64,
    },
    /// n ln(R/a) + √|Γ| R is too large: the solution would need more nodes than allowed.
    #[error("mode {mode} would need about {node_estimate:.0} nodes between the circles, more than {node_limit}")]
    TooManyNodes {
        /// n.
        mode: u32,
        /// n ln(R/a) + 4 ln(R/a) + √|Γ| (R − a).
        node_estimate: f64,
        /// The limit.
        node_limit: usize,
    },
    /// √|Γ| R is so large that a wavelength is shorter than the spacing of numbers near R.
    #[error("the screening {even} (even), {odd} (odd) is too large for an outer radius of {outer_radius}")]
    ScreeningTooLarge {
        /// Γ_e given \[1/length²\].
        even: f64,
        /// Γ_o given \[1/length²\].
        odd: f64,
        /// R \[length\].
        outer_radius: f64,
    },
    /// The screening is a pole of this mode to rounding: the displacement has no finite value.
    #[error(
        "the screening {even} (even), {odd} (odd) is a pole of mode {mode} within rounding: the condition number is {condition:.1e}"
    )]
    AtPole {
        /// n.
        mode: u32,
        /// Γ_e given \[1/length²\].
        even: f64,
        /// Γ_o given \[1/length²\].
        odd: f64,
        /// The condition number, as that of [`ScreenedMode`](screened::ScreenedMode::condition), at which no digit is left.
        condition: f64,
    },
}

/// ε = μ/(λ+2μ) = (1 − ν)/2.
///
/// # Errors
/// A Poisson's ratio that is not between −1 and 1.
pub(super) fn compliance_ratio(poisson_ratio: f64) -> Result<f64, AngularModeError> {
    if poisson_ratio > -1.0 && poisson_ratio < 1.0 {
        Ok(0.5 * (1.0 - poisson_ratio))
    } else {
        Err(AngularModeError::PoissonRatioOutside { poisson_ratio })
    }
}

fn finite_force(force_over_shear: f64) -> Result<(), AngularModeError> {
    if force_over_shear.is_finite() { Ok(()) } else { Err(AngularModeError::ForceNotFinite { force_over_shear }) }
}

fn finite_amplitudes(boundary: ModeAmplitudes) -> Result<(), AngularModeError> {
    if boundary.is_finite() {
        Ok(())
    } else {
        Err(AngularModeError::AmplitudeNotFinite { radial: boundary.radial, transverse: boundary.transverse })
    }
}
