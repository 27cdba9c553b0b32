//! Exact solutions for comparison with measured displacement fields. They are independent of packings.
//!
//! The medium fills the [`Annulus`] between the inflated disk, radius a, and the held rim at R. The radial displacement
//! d(r) is d_0 at a and vanishes at R. In between, in D = 2 or 3 dimensions,
//!
//! ```text
//! d'' + (D−1) d'/r − (D−1) d/r² + κ² d = 0
//! ```
//!
//! With D = 1 this is a strip: r is the distance from an inflated row of disks, R that of a straight wall.
//!
//! With κ = 0 this is the elastic medium, [`Elastic`](elastic::Elastic). With a screening wavenumber κ > 0 plastic
//! events screen the elastic field, [`Screened`](screened::Screened). Both implement [`RadialSolution`]. Start from
//! [`Annulus::new`].
//!
//! With the opposite sign of κ² the medium lies on an elastic foundation, [`Antiscreened`](antiscreened::Antiscreened).
//! All have derivatives with respect to r and κ. The amplitude of the response of a screened medium, as a function of
//! κ, is [`Amplitude`](amplitude::Amplitude), with [`poles`]. All are computed from [`bessel`].
//!
//! The screened solution is computed from the one with unit slope at the rim, [`RimSolution`](rim::RimSolution). That
//! one is smooth in κ, while d_0 d/d(a) has a pole wherever the rim solution has a node at r = a.
//!
//! The exact angular spectrum is a power law with a crossover, [`Lorentzian`](lorentzian::Lorentzian).
//!
//! # Source
//! Ranges and errors are given with each type, and together in the book (`book/src/reference.md`, *What is exact*).
//!
//! | solution | source |
//! |---|---|
//! | [`Elastic`](elastic::Elastic), annulus and shell | Love (1927), §98 and §100 |
//! | [`Screened`](screened::Screened) | Lemaître et al. (2021), Phys. Rev. E 104, 024904; in three dimensions Charan et al. (2023), Phys. Rev. E 107, 055005 |
//! | [`Antiscreened`](antiscreened::Antiscreened) | derived there; Abramowitz & Stegun (1964), 9.6.1 and 10.2.1 |
//! | [`poles`] | derived there; Watson, A Treatise on the Theory of Bessel Functions, §13.74 |
//! | [`Amplitude`](amplitude::Amplitude) | derived there; Hadamard's theorem |
//! | [`ElasticMode`](angular_modes::elastic::ElasticMode) | Michell (1899), Proc. Lond. Math. Soc. 31, 100 |
//! | [`SphericalMode`](angular_modes::spherical::SphericalMode) | Love (1927), ch. XI; the closed form derived there |
//! | [`PointForce`](angular_modes::point_force::PointForce) | Timoshenko & Goodier (1970), ch. 4; the rim derived there |
//! | [`ForceDipole`](angular_modes::force_dipole::ForceDipole) | derived there, from [`PointForce`](angular_modes::point_force::PointForce) |
//! | [`ScreenedSource`](angular_modes::screened_source::ScreenedSource) | derived there; Lemaître et al. (2021) |
//! | [`StripMode`](strip_modes::StripMode) | derived there; Lemaître et al. (2021) |
//! | [`ScreenedMode`](angular_modes::screened::ScreenedMode) | Lemaître et al. (2021); odd screening Cohen et al. (2023), arXiv:2310.09942 |
//! | [`bessel`] | Abramowitz & Stegun (1964), 9.1, 9.2, 9.6, 9.7, 10.1, 10.2 |
//! | [`Lorentzian`](lorentzian::Lorentzian) | Fu, Jin, Pan, Procaccia, supplement; DLMF 2.10.2 |
//! | [`Lattice`](crate::lattice::Lattice), for long waves | derived there |

pub mod amplitude;
pub mod angular_modes;
pub mod antiscreened;
pub mod bessel;
mod cylindrical;
pub mod elastic;
mod exponential;
mod local_series;
pub mod lorentzian;
mod oscillating;
pub mod poles;
pub mod rim;
mod rim_distance;
pub mod screened;
mod sensitivity;
mod small_wavenumber;
mod spherical;
mod strip;
pub mod strip_modes;

use serde::Serialize;
use thiserror::Error;

/// A radial displacement field between the inflated disk and the rim.
pub trait RadialSolution {
    /// Radial displacement d(r) \[length\] at distance `radius` from the centre \[length\]; NaN outside the annulus.
    fn value(&self, radius: f64) -> f64;

    /// Its derivative d'(r) \[1\]; NaN outside the annulus.
    fn derivative(&self, radius: f64) -> f64;
}

/// The region between two concentric circles (spheres in three dimensions): 0 < a < R < ∞.
///
/// # Example
/// ```
/// use jamscope::reference::{Annulus, RadialSolution, elastic::Elastic};
/// let annulus = Annulus::new(0.5, 42.0)?;
/// let medium = Elastic::<2>::new(annulus, 0.1)?;
/// assert_eq!(medium.value(0.5), 0.1);
/// assert_eq!(medium.value(42.0), 0.0);
/// # Ok::<(), jamscope::reference::ReferenceError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Annulus {
    inner_radius: f64,
    outer_radius: f64,
}

impl Annulus {
    /// The annulus between `inner_radius` a and `outer_radius` R \[length\].
    ///
    /// # Errors
    /// A radius that is not positive and finite; an outer radius that is not larger than the inner one.
    pub fn new(inner_radius: f64, outer_radius: f64) -> Result<Self, ReferenceError> {
        if !(inner_radius > 0.0 && inner_radius.is_finite()) {
            return Err(ReferenceError::InnerRadiusNotPositive { inner_radius });
        }
        if !(outer_radius > inner_radius && outer_radius.is_finite()) {
            return Err(ReferenceError::OuterRadiusNotLarger { inner_radius, outer_radius });
        }
        Ok(Annulus { inner_radius, outer_radius })
    }

    /// Radius a of the inflated disk \[length\].
    pub fn inner_radius(&self) -> f64 {
        self.inner_radius
    }

    /// Radius R of the rim \[length\].
    pub fn outer_radius(&self) -> f64 {
        self.outer_radius
    }

    /// Whether a ≤ `radius` ≤ R.
    pub fn contains(&self, radius: f64) -> bool {
        self.inner_radius <= radius && radius <= self.outer_radius
    }
}

/// Why an exact solution could not be computed.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// The radius of the inflated disk is not a positive, finite number.
    #[error("the inner radius must be positive and finite, it is {inner_radius}")]
    InnerRadiusNotPositive {
        /// The radius given \[length\].
        inner_radius: f64,
    },
    /// The rim is not outside the inflated disk, or not finite.
    #[error("the outer radius must be finite and larger than the inner one, {inner_radius}; it is {outer_radius}")]
    OuterRadiusNotLarger {
        /// Radius of the inflated disk \[length\].
        inner_radius: f64,
        /// The radius of the rim given \[length\].
        outer_radius: f64,
    },
    /// The displacement at the inflated disk is not finite.
    #[error("the displacement at the inner radius must be finite, it is {amplitude}")]
    AmplitudeNotFinite {
        /// The displacement given \[length\].
        amplitude: f64,
    },
    /// The screening wavenumber is negative or not finite, or κR is not finite.
    #[error("the screening wavenumber must be finite and not negative, it is {wavenumber}")]
    WavenumberNegative {
        /// The wavenumber given \[1/length\].
        wavenumber: f64,
    },
    /// The wavenumber is a pole to rounding: the displacement has no finite value anywhere in the annulus.
    #[error(
        "the screening wavenumber {wavenumber} equals pole number {index}, {pole}, within rounding: there is no finite solution"
    )]
    AtPole {
        /// Number of the pole, counted from 1.
        index: usize,
        /// The wavenumber given \[1/length\].
        wavenumber: f64,
        /// The pole \[1/length\].
        pole: f64,
    },
}
