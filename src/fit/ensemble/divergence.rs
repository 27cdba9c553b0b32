//! [`fit_divergence`]: y = A (x_c − x)^(−μ), x_c given or fitted.
//!
//! For a divergence as x decreases to x_c, fit with −x in place of x.

use serde::{Deserialize, Serialize};

use crate::fit::Estimate;
use crate::fit::angular::Interval;
use crate::fit::ensemble::error::EnsembleFitError;
use crate::fit::ensemble::measured_point::MeasuredPoint;
use crate::fit::ensemble::power_law::{Line, different, fit_power_law};
use crate::fit::search::minimum;

/// Search range of ln((c − m)/(m − l)), with c = x_c, m the largest and l the smallest x: −16 to 12 in steps of 1/4.
/// Beyond 12, at μ = 1, the law differs from an exponential by less than e⁻¹² in ln y.
const FIRST: f64 = -16.0;
const STEP: f64 = 0.25;
const STEPS: u32 = 112;

/// Rise of χ² at two standard errors of one parameter.
const RISE: f64 = 4.0;

/// The divergence at a given x_c.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DivergenceAt {
    /// x_c \[x\].
    pub critical: f64,
    /// A, y at x_c − x = 1 \[y\].
    pub amplitude: Estimate,
    /// μ \[1\].
    pub exponent: Estimate,
    /// Σ ((ln y − model) y/dy)².
    pub chi_squared: f64,
    /// Number of points minus two.
    pub freedom: usize,
}

/// The divergence with x_c fitted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Divergence {
    /// x_c, with the interval where χ², minimised over A and μ, has risen by 4; no upper end if it includes an
    /// exponential \[x\].
    pub critical: Interval,
    /// μ; its error includes that of x_c \[1\].
    pub exponent: Estimate,
    /// A, y at x_c − x = 1; its error includes that of x_c \[y\].
    pub amplitude: Estimate,
    /// χ² at its minimum.
    pub chi_squared: f64,
    /// Number of points minus three.
    pub freedom: usize,
    /// Rise of χ² of y ∝ e^(x/ℓ), the limit of large x_c, above the minimum.
    pub exponential_rise: f64,
}

/// The result for a divergence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DivergenceOutcome {
    /// χ² has its minimum at a finite x_c.
    Found(Divergence),
    /// χ² decreases up to infinite x_c: there is no sign of a divergence.
    Unbounded {
        /// The lower end of the interval of x_c; none if it includes any x_c \[x\].
        smallest: Option<f64>,
        /// χ² of y ∝ e^(x/ℓ).
        chi_squared: f64,
    },
    /// χ² decreases as x_c approaches the last point, which then alone determines the fit.
    AtLastPoint {
        /// The upper end of the interval of x_c; none if it includes any x_c \[x\].
        largest: Option<f64>,
    },
}

/// A and μ at a given x_c, by weighted least squares in ln y, like [`fit_power_law`] in x_c − x.
///
/// # Errors
/// See [`fit_power_law`]; a point that is not below x_c.
pub fn fit_divergence_at(points: &[MeasuredPoint], critical: f64) -> Result<DivergenceAt, EnsembleFitError> {
    for (point, &MeasuredPoint { x, .. }) in points.iter().enumerate() {
        if !(x < critical && critical.is_finite()) {
            return Err(EnsembleFitError::NotBelowCritical { point, x, critical });
        }
    }
    let from_critical: Vec<MeasuredPoint> =
        points.iter().map(|&point| MeasuredPoint { x: critical - point.x, ..point }).collect();
    let fit = fit_power_law(&from_critical)?;
    let exponent = Estimate { value: -fit.exponent.value, ..fit.exponent };
    let (amplitude, chi_squared, freedom) = (fit.amplitude, fit.chi_squared, fit.freedom);
    Ok(DivergenceAt { critical, amplitude, exponent, chi_squared, freedom })
}

/// A, μ and x_c at the minimum of χ² over all x_c above the largest x.
///
/// # Errors
/// Fewer than four different x; an x that is not finite, a y or error that is not positive and finite.
///
/// # Cost
/// Points × evaluations of a one-dimensional search.
///
/// # Example
/// ```
/// use jamscope::fit::ensemble::{DivergenceOutcome, MeasuredPoint, fit_divergence};
/// let points: Vec<MeasuredPoint> = (0..8)
///     .map(|i| {
///         let x = f64::from(i) / 10.0;
///         let y = 2.0 * (0.85 - x).powf(-1.2);
///         MeasuredPoint { x, y, error: 0.01 * y }
///     })
///     .collect();
/// let DivergenceOutcome::Found(fit) = fit_divergence(&points)? else { panic!() };
/// assert!((fit.critical.best - 0.85).abs() < 1e-6 && (fit.exponent.value - 1.2).abs() < 1e-5);
/// # Ok::<(), jamscope::fit::ensemble::EnsembleFitError>(())
/// ```
pub fn fit_divergence(points: &[MeasuredPoint]) -> Result<DivergenceOutcome, EnsembleFitError> {
    for (point, &MeasuredPoint { x, y, error }) in points.iter().enumerate() {
        if !(x.is_finite() && [y, error, error / y, y / error].iter().all(|value| *value > 0.0 && value.is_finite())) {
            return Err(EnsembleFitError::PointUnusable { point, x, y, error });
        }
    }
    different(points, 4)?;
    let (low, high) =
        points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p.x), high.max(p.x)));
    // Distances from the last point in units of the range: exact even if x_c is close to it.
    let range = high - low;
    let line = |logarithm: f64| {
        let gap = libm::exp(logarithm);
        Line::of(points, |x| libm::log(gap + (high - x) / range))
    };
    let chi_squared = |logarithm: f64| line(logarithm).chi_squared;
    let grid: Vec<f64> = (0..=STEPS).map(|step| FIRST + STEP * f64::from(step)).collect();
    let found = minimum(&grid, RISE, &chi_squared);
    let critical = |logarithm: f64| high + range * libm::exp(logarithm);
    let exponential = Line::of(points, |x| (x - high) / range).chi_squared;
    if exponential <= found.value || found.at >= grid[grid.len() - 1] {
        // The interval is recomputed about the limit.
        let about_limit = minimum(&grid, (RISE + exponential - found.value).max(0.0), &chi_squared);
        let smallest = about_limit.lower.map(critical);
        return Ok(DivergenceOutcome::Unbounded { smallest, chi_squared: exponential });
    }
    let exponential_rise = exponential - found.value;
    let upper = found.upper.map(critical).filter(|_| exponential_rise > RISE);
    if found.at <= grid[0] {
        return Ok(DivergenceOutcome::AtLastPoint { largest: upper });
    }
    let best = line(found.at);
    let (exponent, amplitude) = errors(points, critical(found.at), &best, range);
    Ok(DivergenceOutcome::Found(Divergence {
        critical: Interval { best: critical(found.at), lower: found.lower.map(critical), upper },
        exponent,
        amplitude,
        chi_squared: found.value,
        freedom: points.len() - 3,
        exponential_rise,
    }))
}

/// μ and A with errors that include that of x_c: the inverse of the 3 × 3 information matrix, by adding the part of x_c
/// that is independent of A and μ.
fn errors(points: &[MeasuredPoint], critical: f64, line: &Line, range: f64) -> (Estimate, Estimate) {
    let exponent = -line.slope;
    let rows: Vec<[f64; 3]> = points
        .iter()
        .map(|p| [(p.y / p.error).powi(2), libm::log((critical - p.x) / range) - line.at, -exponent / (critical - p.x)])
        .collect();
    // ∂ ln y/∂x_c = −μ/(x_c − x) = mean + steepness (t − at) + rest.
    let mean = rows.iter().map(|[w, _, d]| w * d).sum::<f64>() / line.weight;
    let steepness = rows.iter().map(|[w, t, d]| w * t * (d - mean)).sum::<f64>() / line.square;
    let rest: f64 = rows.iter().map(|[w, t, d]| w * (d - mean - steepness * t).powi(2)).sum();
    let of_critical = 1.0 / rest;
    let variance = 1.0 / line.square + steepness * steepness * of_critical;
    // ln A = value − slope (at + ln range): its derivatives are 1 for the value, −origin for the slope.
    let origin = line.at + libm::log(range);
    let shift = mean - steepness * origin;
    let of_amplitude = 1.0 / line.weight + origin * origin / line.square + shift * shift * of_critical;
    let amplitude = libm::exp(line.value - line.slope * origin);
    (
        Estimate { value: exponent, standard_error: variance.sqrt() },
        Estimate { value: amplitude, standard_error: amplitude * of_amplitude.sqrt() },
    )
}
