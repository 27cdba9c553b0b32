//! [`RimSolution`]: the solution with slope −1 at the held rim, smooth in κ even at poles.

use std::sync::OnceLock;

use crate::reference::cylindrical::Cylindrical;
use crate::reference::elastic::power_gap;
use crate::reference::sensitivity::RimResponse;
use crate::reference::spherical::Spherical;
use crate::reference::strip::{self, Straight};
use crate::reference::{Annulus, RadialSolution, ReferenceError};

/// Up to this κR the elastic solution is used instead of the screened one. The relative error is (κR)²/8 ≤ 1.3·10⁻¹⁷ in
/// two dimensions, (κR)²/10 in three. It is the next term of J_1(y) = y/2 − y³/16 + …, j_1(y) = y/3 − y³/30 + …, which
/// relates v(a) to v'(R).
pub const ELASTIC_BELOW: f64 = 1e-8;

/// The solution v of the screened equation with `v(R) = 0` and `v'(R) = −1`.
///
/// ```text
/// v'' + (D−1) v'/r − (D−1) v/r² + κ² v = 0
///
/// κ = 0:  v = (R^D − r^D) / (D r^(D−1))
/// D = 1:  v = sin κ(R−r) / κ
/// D = 2:  v = (π R / 2) [J_1(κr) Y_1(κR) − Y_1(κr) J_1(κR)]
/// D = 3:  v = κ R² [j_1(κr) y_1(κR) − y_1(κr) j_1(κR)]
/// ```
///
/// It is an entire function of κ². The solution with displacement d_0 at a is `d_0 v(r)/v(a)`; the zeros of v(a) in κ
/// are its poles.
///
/// # Units
/// κ in 1/length, v in lengths.
///
/// # Accuracy
/// v and v' relative to the local amplitude of the oscillation below 3.2·10⁻¹⁵ in the annulus; near the rim and for κR
/// < 2 relative to themselves. Largest error found for R/a from 1.001 to 10⁷ and κR from 10⁻⁸ to 10⁶: 9·10⁻¹⁶.
///
/// # Cost
/// That of [`Screened`](crate::reference::screened::Screened), a quotient of two values of this.
#[derive(Debug, Clone)]
pub struct RimSolution<const D: usize> {
    annulus: Annulus,
    wavenumber: f64,
    form: Form,
    /// Computed at first use.
    response: OnceLock<Box<RimResponse<D>>>,
}

#[derive(Debug, Clone)]
enum Form {
    Elastic,
    Straight(Straight),
    Cylindrical(Cylindrical),
    Spherical(Spherical),
}

impl<const D: usize> RimSolution<D> {
    /// The rim solution in `annulus` at `wavenumber` κ ≥ 0 \[1/length\].
    ///
    /// # Errors
    /// A wavenumber that is negative or not finite.
    pub fn new(annulus: Annulus, wavenumber: f64) -> Result<Self, ReferenceError> {
        const { assert!(D >= 1 && D <= 3, "a strip has D = 1, an annulus D = 2, a shell D = 3") };
        let argument = checked_wavenumber(annulus, wavenumber)?;
        let outer = annulus.outer_radius();
        let form = if argument <= ELASTIC_BELOW {
            Form::Elastic
        } else if D == 1 {
            Form::Straight(Straight::new(wavenumber, outer))
        } else if D == 2 {
            Form::Cylindrical(Cylindrical::new(wavenumber, outer))
        } else {
            Form::Spherical(Spherical::new(wavenumber, outer))
        };
        Ok(RimSolution { annulus, wavenumber, form, response: OnceLock::new() })
    }

    /// ∂v/∂κ \[length²\] at `radius` \[length\], NaN outside the annulus; of order κ as κ → 0, and of order (R − r)³ as
    /// r → R.
    ///
    /// # Accuracy
    /// Error below 3.2·10⁻¹⁵ of the amplitude of its oscillation in κ, `√((∂v/∂κ)² + (R − r)² v²)`; for κR < 2 and near
    /// the rim relative to itself (largest found: 1.3·10⁻¹⁵).
    pub fn wavenumber_derivative(&self, radius: f64) -> f64 {
        if !self.annulus.contains(radius) {
            return f64::NAN;
        }
        if self.wavenumber == 0.0 {
            return 0.0;
        }
        if D == 1 {
            return strip::rim_response(self.wavenumber, self.annulus.outer_radius(), radius);
        }
        let response =
            self.response.get_or_init(|| Box::new(RimResponse::new(self.annulus.outer_radius(), self.wavenumber)));
        response.at(radius, self.value(radius))
    }

    /// Whether κR is so small that the elastic solution is used.
    pub(crate) fn is_elastic(&self) -> bool {
        matches!(self.form, Form::Elastic)
    }
}

/// κR of a wavenumber, after checks.
pub(crate) fn checked_wavenumber(annulus: Annulus, wavenumber: f64) -> Result<f64, ReferenceError> {
    let argument = wavenumber * annulus.outer_radius();
    if wavenumber >= 0.0 && argument.is_finite() {
        return Ok(argument);
    }
    Err(ReferenceError::WavenumberNegative { wavenumber })
}

impl<const D: usize> RadialSolution for RimSolution<D> {
    fn value(&self, radius: f64) -> f64 {
        if !self.annulus.contains(radius) {
            return f64::NAN;
        }
        match &self.form {
            Form::Elastic => {
                let outer = self.annulus.outer_radius();
                power_gap::<D>(outer, radius) * (outer / radius).powi(D as i32 - 1) / D as f64
            }
            Form::Straight(solution) => solution.value(radius),
            Form::Cylindrical(solution) => solution.value(radius),
            Form::Spherical(solution) => solution.value(radius),
        }
    }

    fn derivative(&self, radius: f64) -> f64 {
        if !self.annulus.contains(radius) {
            return f64::NAN;
        }
        match &self.form {
            Form::Elastic => {
                let power = (self.annulus.outer_radius() / radius).powi(D as i32);
                -((D - 1) as f64 * power + 1.0) / D as f64
            }
            Form::Straight(solution) => solution.derivative(radius),
            Form::Cylindrical(solution) => solution.derivative(radius),
            Form::Spherical(solution) => solution.derivative(radius),
        }
    }
}
