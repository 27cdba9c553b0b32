//! [`fit_power_law`]: y = A x^b.

use serde::{Deserialize, Serialize};

use crate::fit::Estimate;
use crate::fit::ensemble::error::EnsembleFitError;
use crate::fit::ensemble::measured_point::MeasuredPoint;

/// A power law through points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PowerLaw {
    /// A, y at x = 1 \[y\].
    pub amplitude: Estimate,
    /// b \[1\].
    pub exponent: Estimate,
    /// Σ ((ln y − ln A − b ln x) y/dy)².
    pub chi_squared: f64,
    /// Number of points minus two.
    pub freedom: usize,
}

/// Weighted least squares of ln y against ln x.
///
/// ```text
/// χ² = Σ (ln y − ln A − b ln x)²/(dy/y)²
/// ```
///
/// The errors of A and b are from the given dy, whatever χ² is. A χ² far above the degrees of freedom shows that the
/// errors or the law are wrong. ln y has the error dy/y to first order.
///
/// # Errors
/// Fewer than two different x; an x, y or error that is not positive and finite.
///
/// # Example
/// ```
/// use jamscope::fit::ensemble::{MeasuredPoint, fit_power_law};
/// let points = [1.0, 4.0, 9.0].map(|x: f64| MeasuredPoint { x, y: 3.0 / x.sqrt(), error: 0.1 });
/// let fit = fit_power_law(&points)?;
/// assert!((fit.exponent.value + 0.5).abs() < 1e-14 && (fit.amplitude.value - 3.0).abs() < 1e-13);
/// # Ok::<(), jamscope::fit::ensemble::EnsembleFitError>(())
/// ```
pub fn fit_power_law(points: &[MeasuredPoint]) -> Result<PowerLaw, EnsembleFitError> {
    for (point, &MeasuredPoint { x, y, error }) in points.iter().enumerate() {
        if ![x, y, error, error / y, y / error].iter().all(|value| *value > 0.0 && value.is_finite()) {
            return Err(EnsembleFitError::PointUnusable { point, x, y, error });
        }
    }
    different(points, 2)?;
    let line = Line::of(points, libm::log);
    let freedom = points.len() - 2;
    let value = libm::exp(line.value - line.slope * line.at);
    let variance = 1.0 / line.weight + line.at * line.at / line.square;
    Ok(PowerLaw {
        amplitude: Estimate { value, standard_error: value * variance.sqrt() },
        exponent: Estimate { value: line.slope, standard_error: line.square.sqrt().recip() },
        chi_squared: line.chi_squared,
        freedom,
    })
}

/// Checks the number of different x.
pub(super) fn different(points: &[MeasuredPoint], needed: usize) -> Result<(), EnsembleFitError> {
    let mut all: Vec<f64> = points.iter().map(|point| point.x).collect();
    all.sort_unstable_by(f64::total_cmp);
    all.dedup();
    if all.len() >= needed { Ok(()) } else { Err(EnsembleFitError::TooFewPoints { point_count: all.len(), needed }) }
}

/// The line ln y = value + slope (t(x) − at), with weights (y/dy)².
pub(super) struct Line {
    pub at: f64,
    pub value: f64,
    pub slope: f64,
    /// Σ w.
    pub weight: f64,
    /// Σ w (t − at)².
    pub square: f64,
    pub chi_squared: f64,
}

impl Line {
    /// The line through checked points, against t(x).
    pub fn of(points: &[MeasuredPoint], abscissa: impl Fn(f64) -> f64) -> Line {
        let rows: Vec<[f64; 3]> = points
            .iter()
            .map(|point| [(point.y / point.error).powi(2), abscissa(point.x), libm::log(point.y)])
            .collect();
        let weight: f64 = rows.iter().map(|[w, ..]| w).sum();
        let at = rows.iter().map(|[w, t, _]| w * t).sum::<f64>() / weight;
        let value = rows.iter().map(|[w, _, y]| w * y).sum::<f64>() / weight;
        let square: f64 = rows.iter().map(|[w, t, _]| w * (t - at) * (t - at)).sum();
        let slope = rows.iter().map(|[w, t, y]| w * (t - at) * (y - value)).sum::<f64>() / square;
        let chi_squared = rows.iter().map(|[w, t, y]| w * (y - value - slope * (t - at)).powi(2)).sum();
        Line { at, value, slope, weight, square, chi_squared }
    }
}
