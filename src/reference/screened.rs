//! [`Screened`]: a medium in which plastic events screen the elastic field.

use std::sync::OnceLock;

use crate::reference::elastic::Elastic;
use crate::reference::local_series::Sign;
use crate::reference::poles::{pole, pole_at};
use crate::reference::rim::RimSolution;
use crate::reference::sensitivity::{Profile, Sensitivity};
use crate::reference::strip;
use crate::reference::{Annulus, RadialSolution, ReferenceError};

/// Radial displacement of a medium with dipole screening.
///
/// ```text
/// D = 1:  d(r) = d_0 sin κ(R−r) / sin κ(R−a)
/// D = 2:  d(r) = d_0 [Y_1(κr) J_1(κR) − J_1(κr) Y_1(κR)] / [Y_1(κa) J_1(κR) − J_1(κa) Y_1(κR)]
/// D = 3:  the same with the spherical j_1 and y_1
/// ```
///
/// As κ → 0 it tends to [`Elastic`] with an error of order κ². κ = 0 is exactly elastic, and so is κR ≤ 10⁻⁸, where
/// that error is below 1.3·10⁻¹⁷ ([`ELASTIC_BELOW`](crate::reference::rim::ELASTIC_BELOW)). It has poles at κ_n
/// ([`poles`](crate::reference::poles)). Between κ_n and κ_(n+1) the displacement changes sign n times.
///
/// # Units
/// Radii and displacement in lengths, κ in 1/length.
///
/// # Source
/// Lemaître et al. (2021), Phys. Rev. E 104, 024904; in three dimensions Charan et al. (2023), Phys. Rev. E 107,
/// 055005.
///
/// # Accuracy
/// Relative error, near a node relative to the local envelope, below 3.2·10⁻¹⁵ (1 + κ_n/|κ − κ_n|), where the factor is
/// the condition number with respect to κ; d(a) = d_0 and d(R) = 0 exactly. Largest errors found for the rows of
/// `fixtures/reference`, R/a from 60 to 2·10⁴, κR from 10⁻¹¹ to 10⁵: 3.1·10⁻¹⁶ of that factor in two dimensions,
/// 4.7·10⁻¹⁶ in three; for random annuli, R/a from 1.001 to 10⁷, κR from 10⁻⁸ to 10⁶: 6·10⁻¹⁶.
///
/// # Cost
/// See `cargo bench --features measurements --bench reference -- profile`, `-- derivative` and `-- setup`.
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
    /// Computed at first use.
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
    /// Error below 2 · 3.2·10⁻¹⁵ (1 + κ_n/|κ − κ_n|), twice the condition number of d since its poles are of second
    /// order, relative to
    ///
    /// - itself, for κR < 2 (also for κ → 0, where it is of order κ) and near a, where it vanishes as r − a;
    /// - `√((∂d/∂κ)² + (R − a)² d²)`, its amplitude as κ changes, within half of 1/κ of the rim, where it vanishes as R
    ///   − r;
    /// - the local amplitude of its oscillation in r elsewhere.
    ///
    /// Tested for R/a from 1.001 to 10⁷, κR from 10⁻⁸ to 10⁶
    /// (`reference::wavenumber_derivative::screened_profiles_and_both_derivatives_have_their_digits_in_two_dimensions`
    /// and the same in three); largest error found: 5·10⁻¹⁶ of twice the condition number.
    ///
    /// # Cost
    /// A setup at first use (`cargo bench --features measurements --bench reference -- setup`); then two to six times that of a value (`--
    /// derivative`).
    pub fn wavenumber_derivative(&self, radius: f64) -> f64 {
        if !self.annulus.contains(radius) {
            return f64::NAN;
        }
        if self.wavenumber == 0.0 {
            return 0.0;
        }
        if D == 1 {
            return self.amplitude * strip::profile_response(self.annulus, self.wavenumber, radius);
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
