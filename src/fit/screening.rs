//! The one-dimensional search for the screening wavenumber over all branches.
//!
//! With the rim solution v(r; κ) as the shape, the model is r^(D−1) d_r = B r^(D−1) v(r; κ). It is linear in the slope B, which
//! is minus d_r' at the rim. For each κ, the best B and χ²(κ) therefore have closed forms (variable projection; Golub &
//! Pereyra (1973), SIAM J. Numer. Anal. 10, 413). v has no poles in κ, so χ²(κ) is smooth through all of them. The
//! branches are connected, and a minimum near a pole is found like any other.

use argmin::core::{CostFunction, Error, Executor, State};
use argmin::solver::brent::BrentOpt;

use crate::fit::dimension::Dimension;
use crate::fit::rings::Rings;
use crate::reference::Annulus;

/// Grid points between two poles. χ² has at most a few extrema per branch, one per node of v in the range.
const POINTS_PER_BRANCH: f64 = 16.0;

/// Number of the lowest minima of the grid that are refined.
const POLISHED_COUNT: usize = 4;

/// Brent's absolute tolerance on κR; the relative one is argmin's, √ε, at which a minimum is flat to rounding.
const BRENT_TOLERANCE: f64 = 1e-10;

/// Brent needs 10 to 30 steps; golden section alone would need 60.
const BRENT_STEP_LIMIT: u64 = 100;

/// A κR below this counts as zero: it changes the profile by (κR)²/8 ≈ 10⁻⁷ or less, and the error of κ grows as 1/κ.
const LEAST_ARGUMENT: f64 = 1e-3;

/// Step in κR of the central difference ∂v/∂κ, with errors 10⁻¹⁰/6 (third derivative) and 10⁻¹⁶/10⁻⁵ (rounding).
const DIFFERENCE_STEP: f64 = 1e-5;

/// The slope B and χ² at one κ.
#[derive(Debug, Clone)]
pub(crate) struct Projection {
    pub wavenumber: f64,
    /// The slope B \[1\].
    pub slope: f64,
    /// Variance of B if the errors of the rings are correct and κ is known.
    pub slope_variance: f64,
    pub chi_squared: f64,
    /// Residuals in units of the errors of the rings.
    pub residuals: Vec<f64>,
}

/// The profile as a function of κ.
pub(crate) struct Landscape<'a> {
    rings: &'a Rings,
    annulus: Annulus,
    dimension: Dimension,
}

impl<'a> Landscape<'a> {
    pub(crate) fn new(rings: &'a Rings, annulus: Annulus, dimension: Dimension) -> Self {
        Landscape { rings, annulus, dimension }
    }

    /// `r^(D−1) v(r; κ)` on the rings, and v(a; κ).
    fn shape(&self, wavenumber: f64) -> (Vec<f64>, f64) {
        let solution = self.dimension.rim_solution(self.annulus, wavenumber);
        let solution = solution.expect("the search stays at finite κ ≥ 0");
        let rescaled = |radius: f64| self.dimension.rescaling(radius) * solution.value(radius);
        let shape = self.rings.radii.iter().map(|&radius| rescaled(radius)).collect();
        (shape, solution.value(self.annulus.inner_radius()))
    }

    /// v(a; κ), the factor from B to d_0.
    pub(crate) fn inner_value(&self, wavenumber: f64) -> f64 {
        self.shape(wavenumber).1
    }

    /// Number of poles below `wavenumber`.
    pub(crate) fn branch(&self, wavenumber: f64) -> usize {
        self.dimension.pole_count_below(self.annulus, wavenumber)
    }

    /// The best slope B at `wavenumber`.
    pub(crate) fn project(&self, wavenumber: f64) -> Projection {
        let (shape, _) = self.shape(wavenumber);
        let slope_variance = 1.0 / self.rings.weighted(&shape, &shape);
        let slope = slope_variance * self.rings.weighted(&shape, &self.rings.rescaled);
        let residuals: Vec<f64> =
            (0..shape.len()).map(|i| (self.rings.rescaled[i] - slope * shape[i]) / self.rings.errors[i]).collect();
        let chi_squared = residuals.iter().map(|e| e * e).sum();
        Projection { wavenumber, slope, slope_variance, chi_squared, residuals }
    }

    /// χ² on a grid of κ from 0 to `largest`, ends included.
    pub(crate) fn grid(&self, largest: f64) -> Vec<(f64, f64)> {
        let width = self.annulus.outer_radius() - self.annulus.inner_radius();
        let count = (largest * width / std::f64::consts::PI * POINTS_PER_BRANCH).ceil().max(2.0) as usize;
        (0..=count)
            .map(|i| largest * (i as f64 / count as f64))
            .map(|wavenumber| (wavenumber, self.project(wavenumber).chi_squared))
            .collect()
    }

    /// The lowest minimum of χ² between κ = 0 and the end of the grid, if there is one below χ²(0).
    pub(crate) fn minimum(&self, grid: &[(f64, f64)]) -> Option<Projection> {
        let mut basins: Vec<&[(f64, f64)]> = grid
            .windows(3)
            .filter(|basin| basin[1].1 <= basin[0].1 && basin[1].1 <= basin[2].1)
            // χ² is even in κ, so a minimum may lie between 0 and the first point; it is then the lowest nearby.
            .chain((grid[0].1 <= grid[1].1).then_some(&grid[..2]))
            .collect();
        let lowest = |basin: &[(f64, f64)]| basin.iter().map(|point| point.1).fold(f64::INFINITY, f64::min);
        basins.sort_by(|a, b| lowest(a).total_cmp(&lowest(b)));
        basins
            .into_iter()
            .take(POLISHED_COUNT)
            .map(|basin| self.polish(basin[0].0, basin[basin.len() - 1].0))
            .min_by(|a, b| a.chi_squared.total_cmp(&b.chi_squared))
            .filter(|best| {
                let improves = best.chi_squared < grid[0].1 && grid[0].1 > self.rounding();
                improves && best.wavenumber * self.annulus.outer_radius() > LEAST_ARGUMENT
            })
    }

    /// χ² of residuals that are only rounding. If κ = 0 leaves no more than that, a lower χ² is not significant.
    fn rounding(&self) -> f64 {
        // For a ring: the profile's 3.2·10⁻¹⁵ twice (in the value and in the amplitude), and some ulps of products.
        const RESIDUAL: f64 = 1e-14;
        RESIDUAL * RESIDUAL * self.rings.weighted(&self.rings.rescaled, &self.rings.rescaled)
    }

    /// The minimum between `low` and `high`: Brent, then one Gauss–Newton step, kept if it reduces χ².
    fn polish(&self, low: f64, high: f64) -> Projection {
        let outer = self.annulus.outer_radius();
        let solver = BrentOpt::new(low * outer, high * outer).set_tolerance(f64::EPSILON.sqrt(), BRENT_TOLERANCE);
        let found = Executor::new(Cost { landscape: self, outer_radius: outer }, solver)
            .configure(|state| state.max_iters(BRENT_STEP_LIMIT))
            .run()
            .ok()
            .and_then(|result| result.state().get_best_param().copied())
            // The cost function never fails; otherwise the middle of the basin is used.
            .unwrap_or(0.5 * (low + high) * outer);
        let rough = self.project(found / outer);
        let curvature = self.curvature(&rough);
        let step = curvature.step[1];
        let next = rough.wavenumber + step;
        if !(step.is_finite() && next >= low && next <= high) {
            return rough;
        }
        let refined = self.project(next);
        if refined.chi_squared <= rough.chi_squared { refined } else { rough }
    }

    /// The Gauss–Newton matrix at `at`: its inverse and its step, in (B, κ).
    pub(crate) fn curvature(&self, at: &Projection) -> Curvature {
        let step = DIFFERENCE_STEP / self.annulus.outer_radius();
        // v is even in κ.
        let (high, low) = (at.wavenumber + step, (at.wavenumber - step).abs());
        let ((upper, upper_inner), (lower, lower_inner)) = (self.shape(high), self.shape(low));
        let (shape, inner_value) = self.shape(at.wavenumber);
        let bend: Vec<f64> =
            upper.iter().zip(&lower).map(|(upper, lower)| at.slope * (upper - lower) / (2.0 * step)).collect();
        let residuals: Vec<f64> = at.residuals.iter().zip(&self.rings.errors).map(|(e, error)| e * error).collect();
        let (ss, sb, bb) = (
            self.rings.weighted(&shape, &shape),
            self.rings.weighted(&shape, &bend),
            self.rings.weighted(&bend, &bend),
        );
        // Eliminating B first avoids cancellation in the determinant: bb − sb²/ss is the curvature of χ²/2.
        let reduced = bb - sb * sb / ss;
        let (var_bend, ratio) = (1.0 / reduced, sb / ss);
        let inverse = [[1.0 / ss + ratio * ratio * var_bend, -ratio * var_bend], [-ratio * var_bend, var_bend]];
        let gradient = [self.rings.weighted(&shape, &residuals), self.rings.weighted(&bend, &residuals)];
        Curvature {
            inverse,
            step: [
                inverse[0][0] * gradient[0] + inverse[0][1] * gradient[1],
                inverse[1][0] * gradient[0] + inverse[1][1] * gradient[1],
            ],
            inner_value,
            inner_slope: (upper_inner - lower_inner) / (2.0 * step),
        }
    }
}

/// Quadratic approximation of χ² at a minimum, and the factors from B to d_0 = B v(a; κ).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Curvature {
    /// Inverse of JᵀWJ in (B, κ): the covariance of both if the errors of the rings are correct.
    pub inverse: [[f64; 2]; 2],
    /// Step to the minimum of the quadratic approximation.
    pub step: [f64; 2],
    /// v(a; κ).
    pub inner_value: f64,
    /// ∂v(a; κ)/∂κ.
    pub inner_slope: f64,
}

/// χ² as a function of κR, for argmin.
struct Cost<'a> {
    landscape: &'a Landscape<'a>,
    outer_radius: f64,
}

impl CostFunction for Cost<'_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, argument: &f64) -> Result<f64, Error> {
        Ok(self.landscape.project(argument / self.outer_radius).chi_squared)
    }
}
