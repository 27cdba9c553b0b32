//! Fits of the exact elastic angular modes to measured ones: [`fit_elastic_modes`].
//!
//! ```text
//! U_n(r), V_n(r): mode n of an elastic annulus from r_1 to R, rim held        unknown: U_n(r_1), V_n(r_1) of each n, one ν
//! χ²_n = Σ_rings (|U − U_n|²/σ_U² + |V − V_n|²/σ_V²)
//! ```
//!
//! For a given ν the fit is linear: each mode is the sum of the two solutions with (1, 0) and (0, 1) at r_1. ν
//! minimises Σ_n χ²_n. An elastic medium has no other parameters: its values at r_1 determine those between r_1 and R.
//! The mean over the angle, n = 0, is that of [`Elastic`](crate::reference::elastic::Elastic) and does not depend on ν.
//!
//! The standard errors of the measured modes assume independent disks. Correlated disks make χ² per degree of freedom
//! exceed 1 even for an elastic medium. The result therefore includes the described share of Σ |U|²/σ² + |V|²/σ².

use serde::{Deserialize, Serialize};

use crate::fit::search::minimum;
use crate::fit::{Estimate, FitError};
use crate::observe::multipoles::{ModeFit, MultipoleFit, Multipoles};
use crate::reference::Annulus;
use crate::reference::angular_modes::elastic::ElasticMode;
use crate::reference::angular_modes::{AngularSolution, Complex, ModeAmplitudes};

/// Minimum number of rings of a fit: the amplitudes use up two.
pub const LEAST_RING_COUNT: usize = 4;

/// First Poisson's ratio of the grid, and its step.
const RATIO_GRID: [f64; 2] = [-0.95, 0.05];

/// Number of Poisson's ratios of the grid: up to 0.95.
const RATIO_COUNT: usize = 39;

/// Settings of the fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ElasticModeSettings {
    /// r_1, the smallest radius of a ring \[length\].
    pub from: f64,
    /// ν, if it is known \[1\]; if absent, it is fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poisson_ratio: Option<f64>,
}

impl ElasticModeSettings {
    /// Checks the settings.
    pub(crate) fn check(&self) -> Result<(), FitError> {
        if !(self.from > 0.0 && self.from.is_finite()) {
            return Err(FitError::RangeEmpty { from: self.from, to: f64::INFINITY });
        }
        match self.poisson_ratio {
            Some(ratio) if !(ratio > -1.0 && ratio < 1.0) => Err(FitError::PoissonRatioOutside { ratio }),
            _ => Ok(()),
        }
    }
}

impl Default for ElasticModeSettings {
    /// From a radius of two diameters of a small disk on, as in the fit of the radial profile; ν is fitted.
    fn default() -> Self {
        ElasticModeSettings { from: 2.0, poisson_ratio: None }
    }
}

/// Elastic modes fitted to measured ones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ElasticModesFit {
    /// ν in two dimensions \[1\]; without error if it was given or the rings do not determine it.
    pub poisson_ratio: f64,
    /// Where Σ χ² has risen by its mean per degree of freedom on either side of ν; absent if ν was given or an end is
    /// outside (−1, 1).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poisson_ratio_range: Option<[f64; 2]>,
    /// r_1 and R \[length\].
    pub annulus: [f64; 2],
    /// Number of rings.
    pub ring_count: usize,
    /// Modes 0 to n_max.
    pub modes: Vec<ElasticModeFit>,
}

/// One mode.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ElasticModeFit {
    /// n.
    pub mode: usize,
    /// U_n(r_1), real and imaginary part \[length\].
    pub radial: [f64; 2],
    /// V_n(r_1) \[length\].
    pub transverse: [f64; 2],
    /// χ²_n.
    pub chi_squared: f64,
    /// Degrees of freedom: number of data minus number of parameters.
    pub freedom: usize,
    /// 1 − (χ²/freedom)/(χ²_0/numbers), with χ²_0 for zero displacement \[1\]; absent if nothing moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share_described: Option<f64>,
}

impl ElasticModesFit {
    /// The fitted amplitudes of mode n at a distance \[length\]; none outside the annulus or for a mode that was not
    /// fitted.
    pub fn at(&self, mode: usize, radius: f64) -> Option<ModeAmplitudes> {
        let fit = self.modes.iter().find(|fit| fit.mode == mode)?;
        let annulus = Annulus::new(self.annulus[0], self.annulus[1]).ok()?;
        let complex = |[re, im]: [f64; 2]| Complex::new(re, im);
        let boundary = ModeAmplitudes { radial: complex(fit.radial), transverse: complex(fit.transverse) };
        let solution = ElasticMode::new(annulus, self.poisson_ratio, u32::try_from(mode).ok()?, boundary).ok()?;
        let value = solution.at(radius).value;
        (value.radial.re.is_finite() && value.transverse.re.is_finite()).then_some(value)
    }
}

/// One ring of one mode.
struct Point {
    radius: f64,
    /// U and V.
    values: [Complex<f64>; 2],
    /// 1/σ² of both.
    weights: [f64; 2],
}

/// Fits all modes with one ν.
///
/// # Units
/// Lengths as in the rings.
///
/// # Errors
/// Fewer than four rings with modes between `from` and R; an invalid annulus.
pub fn fit_elastic_modes(
    multipoles: &Multipoles,
    outer_radius: f64,
    settings: &ElasticModeSettings,
) -> Result<ElasticModesFit, FitError> {
    settings.check()?;
    let annulus = Annulus::new(settings.from, outer_radius)?;
    let modes = points(multipoles, settings.from, outer_radius);
    let ring_count = modes.first().map_or(0, Vec::len);
    if ring_count < LEAST_RING_COUNT {
        let (from, to) = (settings.from, outer_radius);
        return Err(FitError::TooFewRings { ring_count, needed: LEAST_RING_COUNT, from, to });
    }
    let fit = |ratio: f64| -> Vec<ElasticModeFit> {
        modes.iter().enumerate().map(|(mode, points)| fit_mode(annulus, ratio, mode, points)).collect()
    };
    let total = |ratio: f64| -> f64 { fit(ratio).iter().skip(1).map(|mode| mode.chi_squared).sum() };
    let (ratio, range) = match settings.poisson_ratio {
        Some(ratio) => (ratio, None),
        None => {
            let grid: Vec<f64> = (0..RATIO_COUNT).map(|i| RATIO_GRID[0] + RATIO_GRID[1] * i as f64).collect();
            let best = grid.iter().map(|&ratio| total(ratio)).fold(f64::INFINITY, f64::min);
            let freedom: usize = fit(0.0).iter().skip(1).map(|mode| mode.freedom).sum();
            // One standard error, with each error scaled so that χ² per degree of freedom is 1.
            let found = minimum(&grid, (best / freedom.max(1) as f64).max(f64::MIN_POSITIVE), &total);
            (found.at, found.lower.zip(found.upper).map(|(low, high)| [low, high]))
        }
    };
    Ok(ElasticModesFit {
        poisson_ratio: ratio,
        poisson_ratio_range: range,
        annulus: [settings.from, outer_radius],
        ring_count,
        modes: fit(ratio),
    })
}

impl ElasticModesFit {
    /// ν with half of its range as error, if it has a range.
    pub fn poisson_estimate(&self) -> Option<Estimate> {
        let [low, high] = self.poisson_ratio_range?;
        Some(Estimate { value: self.poisson_ratio, standard_error: 0.5 * (high - low) })
    }
}

/// Rings of every mode; all modes have the same rings.
fn points(multipoles: &Multipoles, from: f64, to: f64) -> Vec<Vec<Point>> {
    let mut modes: Vec<Vec<Point>> = Vec::new();
    for ring in multipoles.rings.iter().filter(|ring| from <= ring.radius && ring.radius <= to) {
        let MultipoleFit::Fitted { radial, transverse } = &ring.fit else { continue };
        modes.resize_with(radial.modes.len().max(modes.len()), Vec::new);
        for (mode, (u, v)) in modes.iter_mut().zip(radial.modes.iter().zip(&transverse.modes)) {
            let weights = [weight(u), weight(v)];
            // A ring with zero or infinite weight is left out.
            if weights.iter().all(|weight| weight.is_finite()) {
                mode.push(Point { radius: ring.radius, values: [complex(u), complex(v)], weights });
            }
        }
    }
    modes
}

/// c − is.
fn complex(fit: &ModeFit) -> Complex<f64> {
    Complex::new(fit.cosine, -fit.sine)
}

/// 1/σ², with σ² the mean over both numbers; n = 0 has a single one.
fn weight(fit: &ModeFit) -> f64 {
    let [a, b] = fit.standard_errors;
    if fit.mode == 0 { 1.0 / (a * a) } else { 2.0 / (a * a + b * b) }
}

/// (1, 0) or (0, 1).
fn unit(place: usize) -> ModeAmplitudes {
    let one = |here: bool| Complex::new(f64::from(u8::from(here)), 0.0);
    ModeAmplitudes { radial: one(place == 0), transverse: one(place == 1) }
}

/// The best amplitudes of one mode: two complex unknowns, weighted least squares.
fn fit_mode(annulus: Annulus, ratio: f64, mode: usize, points: &[Point]) -> ElasticModeFit {
    let numbers = if mode == 0 { 2 * points.len() } else { 4 * points.len() };
    let unknowns = if mode == 0 { 2 } else { 4 };
    let nothing: f64 = points.iter().map(|point| chi_squared(point, [Complex::ZERO; 2])).sum();
    let none = |chi_squared| ElasticModeFit {
        mode,
        radial: [0.0; 2],
        transverse: [0.0; 2],
        chi_squared,
        freedom: numbers - unknowns,
        share_described: None,
    };
    let order = mode as u32;
    let (Ok(first), Ok(second)) =
        (ElasticMode::new(annulus, ratio, order, unit(0)), ElasticMode::new(annulus, ratio, order, unit(1)))
    else {
        return none(f64::INFINITY);
    };
    let basis =
        |radius: f64| [first.at(radius).value, second.at(radius).value].map(|value| [value.radial, value.transverse]);
    // Normal equations: Hermitian, two by two.
    let (mut matrix, mut right) = ([[Complex::<f64>::ZERO; 2]; 2], [Complex::<f64>::ZERO; 2]);
    for point in points {
        let columns = basis(point.radius);
        for component in 0..2 {
            let weight = point.weights[component];
            for i in 0..2 {
                right[i] += columns[i][component].conj() * point.values[component] * weight;
                for j in 0..2 {
                    matrix[i][j] += columns[i][component].conj() * columns[j][component] * weight;
                }
            }
        }
    }
    let determinant = matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0];
    let solved = [
        (right[0] * matrix[1][1] - matrix[0][1] * right[1]) / determinant,
        (matrix[0][0] * right[1] - right[0] * matrix[1][0]) / determinant,
    ];
    if !solved.iter().all(|value| value.is_finite()) {
        return none(nothing);
    }
    let fitted: f64 = points
        .iter()
        .map(|point| {
            let columns = basis(point.radius);
            let value = |component: usize| solved[0] * columns[0][component] + solved[1] * columns[1][component];
            chi_squared(point, [value(0), value(1)])
        })
        .sum();
    let freedom = numbers - unknowns;
    let share = 1.0 - (fitted / freedom as f64) / (nothing / numbers as f64);
    ElasticModeFit {
        mode,
        radial: [solved[0].re, solved[0].im],
        transverse: [solved[1].re, solved[1].im],
        chi_squared: fitted,
        freedom,
        share_described: (nothing > 0.0).then_some(share),
    }
}

/// Σ |value − model|²/σ² of both components of a ring.
fn chi_squared(point: &Point, model: [Complex<f64>; 2]) -> f64 {
    (0..2).map(|component| (point.values[component] - model[component]).norm_sqr() * point.weights[component]).sum()
}
