//! [`Screened`]: the medium whose elastic field is screened by plastic events.

use std::sync::OnceLock;

use crate::reference::elastic::Elastic;
use crate::reference::local_series::Sign;
use crate::reference::poles::{pole, pole_at};
use crate::reference::rim::RimSolution;
use crate::reference::sensitivity::{Profile, Sensitivity};
use crate::reference::{Annulus, RadialSolution, ReferenceError};

/// Radial displacement of a medium with dipole screening.
///
/// ```text
/// D = 2:  d(r) = d_0 [Y_1(κr) J_1(κR) − J_1(κr) Y_1(κR)] / [Y_1(κa) J_1(κR) − J_1(κa) Y_1(κR)]
/// D = 3:  the same with the spherical j_1 and y_1
/// ```
///
/// As κ → 0 it tends to [`Elastic`] with an error of order κ²; κ = 0 is exactly elastic, and so is κR ≤ 10⁻⁸, where
/// that error is below 1.3·10⁻¹⁷ ([`ELASTIC_BELOW`](crate::reference::rim::ELASTIC_BELOW)). It has poles at κ_n
/// ([`poles`](crate::reference::poles)); between κ_n and κ_(n+1) the displacement changes sign n times.
///
/// # Units
/// Radii and displacement in lengths, κ in 1/length.
///
/// # Source
/// Lemaître et al. (2021), Phys. Rev. E 104, 024904; in three dimensions Charan et al. (2023), Phys. Rev. E 107, 055005.
///
/// # Accuracy
/// Relative error, next to a node relative to the local envelope, below 3.2·10⁻¹⁵ (1 + κ_n/|κ − κ_n|), the factor being
/// the condition of the problem in κ; d(a) = d_0 and d(R) = 0 exactly. Largest found over the rows of
/// `fixtures/reference`, R/a from 60 to 2·10⁴, κR from 10⁻¹¹ to 10⁵: 3.1·10⁻¹⁶ of that factor in two dimensions,
/// 4.7·10⁻¹⁶ in three; over random annuli, R/a from 1.001 to 10⁷, κR from 10⁻⁸ to 10⁶: 6·10⁻¹⁶.
///
/// # Cost
/// 1000 radii, κR from 10⁻⁴ to 10⁵: 28 to 56 µs in two dimensions, 18 to 21 µs in three (`cargo bench --bench reference -- profile`,
/// least of six runs on two shared cores); the derivative 41 to 72 µs and 21 to 25 µs (`-- derivative`); 0.5 to 1.3 µs and 0.06 µs to
/// set up (`-- setup`, both least of four).
///
/// # Example
/// ```
/// use jamscope::reference::{Annulus, RadialSolution, ReferenceError, screened::Screened};
/// let annulus = Annulus::new(0.5, 30.0)?;
/// let medium = Screened::<2>::new(annulus, 0.1, 0.2)?;
/// assert_eq!(medium.value(0.5), 0.1);
/// // Beyond the first pole, κ_1 = 0.1278, the displacement changes sign once.
/// assert!(medium.value(1.0) > 0.0 && medium.value(20.0) < 0.0);
/// assert!(matches!(
///     Screened::<2>::new(annulus, 0.1, 0.12783227015145804),
///     Err(ReferenceError::AtPole { index: 1, .. })
/// ));
/// # Ok::<(), ReferenceError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Screened<const D: usize> {
    annulus: Annulus,
    amplitude: f64,
    wavenumber: f64,
    form: Form<D>,
    /// Set up when first asked for.
    sensitivity: OnceLock<Box<Sensitivity<D>>>,
}

#[derive(Debug, Clone)]
enum Form<const D: usize> {
    Elastic(Elastic<D>),
    Waves {
        rim: RimSolution<D>,
        /// v(a).
        inner_value: f64,
    },
}

impl<const D: usize> Screened<D> {
    /// The medium in `annulus` whose inner edge is displaced by `amplitude` d_0 \[length\], at `wavenumber` κ ≥ 0.
    ///
    /// # Errors
    /// An amplitude that is not finite; a wavenumber that is negative, not finite, or a pole to rounding.
    pub fn new(annulus: Annulus, amplitude: f64, wavenumber: f64) -> Result<Self, ReferenceError> {
        let elastic = Elastic::new(annulus, amplitude)?;
        let rim = RimSolution::new(annulus, wavenumber)?;
        let form = if rim.is_elastic() {
            Form::Elastic(elastic)
        } else {
            if let Some(index) = pole_at::<D>(annulus, wavenumber) {
                return Err(ReferenceError::AtPole { index, wavenumber, pole: pole::<D>(annulus, index) });
            }
            let inner_value = rim.value(annulus.inner_radius());
            Form::Waves { rim, inner_value }
        };
        Ok(Screened { annulus, amplitude, wavenumber, form, sensitivity: OnceLock::new() })
    }

    /// Displacement d_0 of the inner edge \[length\].
    pub fn amplitude(&self) -> f64 {
        self.amplitude
    }

    /// Screening wavenumber κ \[1/length\].
    pub fn wavenumber(&self) -> f64 {
        self.wavenumber
    }

    /// ∂d/∂κ \[length²\] at `radius` \[length\], NaN outside the annulus: 0 at a, at R and at κ = 0.
    ///
    /// # Accuracy
    /// Error below 2 · 3.2·10⁻¹⁵ (1 + κ_n/|κ − κ_n|), twice the condition of d since its poles are of second order, relative to
    ///
    /// - itself, for κR < 2 (so as κ → 0, where it is of order κ) and next to a, where it vanishes as r − a;
    /// - `√((∂d/∂κ)² + (R − a)² d²)`, its amplitude as κ changes, within half of 1/κ of the rim, where it vanishes as R − r;
    /// - the local amplitude of its oscillation in r elsewhere.
    ///
    /// Tested for R/a from 1.001 to 10⁷, κR from 10⁻⁸ to 10⁶
    /// (`reference::wavenumber_derivative::screened_profiles_and_both_derivatives_have_their_digits_in_two_dimensions` and its
    /// twin in three); largest found: 5·10⁻¹⁶ of twice the condition.
    ///
    /// # Cost
    /// Set up when first asked for, 2 to 5 µs in two dimensions (`cargo bench --bench reference -- setup`); then two to six times a
    /// value, 0.07 to 0.15 µs (`-- derivative`; least of four runs on two shared cores).
    pub fn wavenumber_derivative(&self, radius: f64) -> f64 {
        if !self.annulus.contains(radius) {
            return f64::NAN;
        }
        if self.wavenumber == 0.0 {
            return 0.0;
        }
        let sensitivity = self.sensitivity.get_or_init(|| {
            Box::new(Sensitivity::new(&Profile {
                sign: Sign::Screened,
                annulus: self.annulus,
                wavenumber: self.wavenumber,
                ratio: |radius| self.relative(radius),
                inner_slope: self.relative_derivative(self.annulus.inner_radius()),
            }))
        });
        self.amplitude * sensitivity.at(radius, self.relative(radius))
    }

    /// d/d_0.
    fn relative(&self, radius: f64) -> f64 {
        match &self.form {
            Form::Elastic(elastic) => elastic.relative(radius),
            // The quotient is formed first: it is exactly 1 at r = a.
            Form::Waves { rim, inner_value } => rim.value(radius) / inner_value,
        }
    }

    /// d'/d_0.
    fn relative_derivative(&self, radius: f64) -> f64 {
        match &self.form {
            Form::Elastic(elastic) => elastic.relative_derivative(radius),
            Form::Waves { rim, inner_value } => rim.derivative(radius) / inner_value,
        }
    }
}

impl<const D: usize> RadialSolution for Screened<D> {
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
