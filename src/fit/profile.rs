//! Fits of the elastic and the screened solution to the radial profile of one sample: [`fit_radial_profile`].
//!
//! The fit is to the rescaled displacement `r^(D−1) d_r` of every ring, in D = 2 or 3 dimensions, or D = 1 for a strip:
//!
//! ```text
//! elastic          r^(D−1) d_r = d_0^eff a^(D−1) (R^D − r^D)/(R^D − a^D)                       one parameter
//! screened, D = 2      r d_r   = d_0^eff r [Y_1(κr)J_1(κR) − J_1(κr)Y_1(κR)] / [same at a]     two parameters
//! screened, D = 3      r² d_r  = d_0^eff r² [y_1(κr)j_1(κR) − j_1(κr)y_1(κR)] / [same at a]    two parameters
//! ```
//!
//! In two dimensions a ring is a part of the annulus, in three a part of the shell. In a strip a ring is a row at one
//! distance from the line, d = d_0^eff (R − r)/(R − a) or d_0^eff sin κ(R−r)/sin κ(R−a).
//!
//! These describe the curve of a single sample. A mean over samples mixes amplitudes and wavenumbers and is not such a
//! curve.
//!
//! **Weights.** Each ring is weighted by its standard error, shrunk towards the pooled one if the ring has few disks
//! (`rings`). These errors are too small: d_r has dipolar and quadrupolar parts, so the disks of a ring are not
//! independent, and neighbouring rings are correlated. Every standard error is therefore scaled by √(χ²/(n_eff − p)),
//! at least 1. n_eff is the number of independent rings, estimated from the autocorrelation of the residuals
//! (`significance`). With independent rings, the true value is then within one standard error in 67 to 75 % of samples
//! (68 % would be exact). With noise whose correlation is one half between neighbouring rings, it is in 60 to 70 %.
//! Noise that varies slowly over the whole range cannot be distinguished from a screened profile.
//!
//! **Search.** All branches up to κ_max, with the rim solution, which is smooth through the poles (`screening`). So
//! d_0^eff passes through zero at a pole and may be negative; it is reported with its sign.
//!
//! **Decision.** Screened if the decrease of χ² against elastic is significant (F test with n_eff − 2 degrees of
//! freedom, corrected for the number of branches). Otherwise elastic. Neither, if the selected one is not significantly
//! better than zero displacement, or describes too little of the variance. A κ below about κ_1/3 changes d_r by at most
//! (κR)²/8 ≈ 20 % (D = 2) or (κR)²/10 ≈ 22 % (D = 3), at the rim, where d_r vanishes. Unless the rings are that
//! accurate, the decision is elastic, and the bound on κ states what is excluded.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

pub use crate::fit::profile_fit::{Decision, ElasticFit, ProfileFit, ScreenedFit};

use crate::fit::dimension::Dimension;
use crate::fit::rings::Rings;
use crate::fit::screening::{Landscape, Projection};
use crate::fit::significance::{chance, corrected, effective_count, freedom};
use crate::fit::units::Units;
use crate::fit::{Estimate, FitError};
use crate::observe::radial_profile::RadialProfile;
use crate::reference::Annulus;

/// Minimum number of rings for an autocorrelation and two parameters.
pub const LEAST_RING_COUNT: usize = 8;

/// 95 % of a normal variate are below √2.706 standard deviations: the rise of χ² at a one-sided bound.
const BOUND_RISE: f64 = 2.705_543_454_095_404;

/// Range of the fit, and levels of evidence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ProfileFitSettings {
    /// Width excluded around the inflated disk, in its diameters 2a before inflation \[1\]. Changes results.
    pub inner_margin: f64,
    /// Width excluded at the rim, in the same diameters \[1\]. Changes results.
    pub rim_margin: f64,
    /// Number of rings per shortest wavelength \[1\], which sets κ_max; at most one branch per ring. Changes results.
    pub rings_per_wavelength: f64,
    /// Level of significance \[1\]. Changes decisions, no numbers.
    pub significance: f64,
    /// Minimum share of the variance of `r^(D−1) d_r` that the selected solution must describe \[1\]. Changes decisions, no
    /// numbers.
    pub least_share: f64,
}

impl Default for ProfileFitSettings {
    /// Two diameters at the disk, where the packing is not a continuum; one at the rim, where held disks contribute;
    /// eight rings per wavelength; 1 %; half of the variance.
    fn default() -> Self {
        ProfileFitSettings {
            inner_margin: 2.0,
            rim_margin: 1.0,
            rings_per_wavelength: 8.0,
            significance: 0.01,
            least_share: 0.5,
        }
    }
}

/// Fits the elastic and the screened solution in `annulus` to the profile of one sample in `D` dimensions, and decides
/// between them.
///
/// # Units
/// Lengths as in the profile; d_0^eff in lengths, κ in 1/length.
///
/// # Errors
/// Too few rings in the range, a ring with invalid numbers, no displacement at all, settings out of range.
///
/// # Cost
/// About 16 evaluations of the profile per branch, and 100 more for the refinement.
///
/// # Example
/// ```
/// use jamscope::fit::profile::{Decision, ProfileFitSettings, fit_radial_profile};
/// use jamscope::observe::radial_profile::{RadialProfile, Ring};
/// use jamscope::reference::{Annulus, RadialSolution, screened::Screened};
///
/// let annulus = Annulus::new(0.5, 42.0)?;
/// let medium = Screened::<2>::new(annulus, 0.05, 0.12)?;
/// let ring = |i: i32| {
///     let radius = f64::from(i) + 0.5;
///     Ring { radius, disk_count: 5 * i as usize, mean: medium.value(radius), spread: 0.0, standard_error: 0.0 }
/// };
/// let profile = RadialProfile { rings: (1..41).map(ring).collect() };
/// let fit = fit_radial_profile::<2>(&profile, annulus, &ProfileFitSettings::default())?;
/// assert_eq!(fit.decision, Decision::Screened);
/// let screened = fit.screened.expect("decided so");
/// assert!((screened.wavenumber.value - 0.12).abs() < 1e-9);
/// assert!((screened.amplitude.value - 0.05).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit_radial_profile<const D: usize>(
    profile: &RadialProfile,
    annulus: Annulus,
    settings: &ProfileFitSettings,
) -> Result<ProfileFit, FitError> {
    fit_in(const { Dimension::of::<D>() }, profile, annulus, settings)
}

/// The fit, compiled once for both dimensions.
fn fit_in(
    dimension: Dimension,
    profile: &RadialProfile,
    annulus: Annulus,
    settings: &ProfileFitSettings,
) -> Result<ProfileFit, FitError> {
    let units = Units::of(&profile.rings, annulus, settings.range(annulus)?)?;
    let annulus = units.annulus(annulus)?;
    let [from, to] = settings.range(annulus)?;
    let rings = Rings::new(&units.rings(&profile.rings), [from, to], dimension, LEAST_RING_COUNT)
        .map_err(|error| units.error(error))?;
    let landscape = Landscape::new(&rings, annulus, dimension);
    let ring_count = rings.len() as f64;
    let shortest_wavelength = settings.rings_per_wavelength * (to - from) / ring_count;
    let branch_width = PI / (annulus.outer_radius() - annulus.inner_radius());
    // At most as many branches as rings, even for a narrow range.
    let largest_wavenumber = (2.0 * PI / shortest_wavelength).min(ring_count * branch_width);
    // One shape per branch, with either sign of the amplitude at the disk.
    let trial_count = 2.0 * (dimension.pole_count_below(annulus, largest_wavenumber) + 1) as f64;

    let grid = landscape.grid(largest_wavenumber);
    let criteria = Criteria { rings: &rings, at_rest: rings.weighted(&rings.rescaled, &rings.rescaled) };
    let elastic = fit_elastic(&landscape, &criteria, &grid);
    let screened = landscape
        .minimum(&grid)
        .and_then(|minimum| fit_screened(&landscape, &criteria, &minimum, elastic.chi_squared, trial_count));

    let level = settings.significance;
    let describes = |share: f64, chance: f64| share >= settings.least_share && chance < level;
    let decision = match screened.as_ref().filter(|fit| fit.chance_of_elastic < level) {
        Some(fit) if describes(fit.share_described, fit.chance_of_nothing) => Decision::Screened,
        None if describes(elastic.share_described, elastic.chance_of_nothing) => Decision::Elastic,
        _ => Decision::Neither,
    };
    let fit =
        ProfileFit { decision, elastic, screened, ring_count: rings.len(), range: [from, to], largest_wavenumber };
    Ok(units.fit(fit, dimension, rings.errors_known))
}

impl ProfileFitSettings {
    /// Checks the settings, independently of the profile.
    pub(crate) fn check(&self) -> Result<(), FitError> {
        let margin = |margin: f64| margin.is_finite() && margin >= 0.0;
        if !(margin(self.inner_margin) && margin(self.rim_margin)) {
            return Err(FitError::MarginNegative { inner: self.inner_margin, rim: self.rim_margin });
        }
        if !(self.rings_per_wavelength >= 2.0 && self.rings_per_wavelength.is_finite()) {
            return Err(FitError::WavelengthUnresolved { rings_per_wavelength: self.rings_per_wavelength });
        }
        let level = |level: f64| level > 0.0 && level < 1.0;
        if !(level(self.significance) && level(self.least_share)) {
            let (significance, least_share) = (self.significance, self.least_share);
            return Err(FitError::LevelOutOfRange { significance, least_share });
        }
        Ok(())
    }

    /// The range of radii in `annulus`, for checked settings.
    fn range(&self, annulus: Annulus) -> Result<[f64; 2], FitError> {
        self.check()?;
        let diameter = 2.0 * annulus.inner_radius();
        let from = annulus.inner_radius() + self.inner_margin * diameter;
        let to = annulus.outer_radius() - self.rim_margin * diameter;
        if from < to { Ok([from, to]) } else { Err(FitError::RangeEmpty { from, to }) }
    }
}

/// The common criteria for both fits.
struct Criteria<'a> {
    rings: &'a Rings,
    /// χ² for zero displacement.
    at_rest: f64,
}

impl Criteria<'_> {
    /// The factor by which the variances exceed those from the errors of the rings.
    fn scale(&self, at: &Projection, effective_count: f64, parameter_count: usize) -> f64 {
        let reduced = at.chi_squared / freedom(effective_count, parameter_count);
        if self.rings.errors_known { reduced.max(1.0) } else { reduced }
    }

    fn share(&self, at: &Projection, parameter_count: usize) -> f64 {
        let count = self.rings.len();
        1.0 - (at.chi_squared / (count - parameter_count) as f64) / (self.at_rest / count as f64)
    }
}

fn fit_elastic(landscape: &Landscape<'_>, criteria: &Criteria<'_>, grid: &[(f64, f64)]) -> ElasticFit {
    let at = landscape.project(0.0);
    let count = effective_count(&at.residuals, 1);
    let scale = criteria.scale(&at, count, 1);
    let inner_value = landscape.inner_value(0.0);
    ElasticFit {
        amplitude: Estimate {
            value: at.slope * inner_value,
            standard_error: (scale * at.slope_variance).sqrt() * inner_value,
        },
        wavenumber_bound: wavenumber_bound(landscape, grid, BOUND_RISE * scale),
        chi_squared: at.chi_squared,
        share_described: criteria.share(&at, 1),
        effective_ring_count: count,
        chance_of_nothing: chance(criteria.at_rest, at.chi_squared, 1, freedom(count, 1)),
    }
}

/// The screened solution at the minimum `at`; none if the rings cannot separate κ from the amplitude there.
fn fit_screened(
    landscape: &Landscape<'_>,
    criteria: &Criteria<'_>,
    at: &Projection,
    elastic_chi_squared: f64,
    trial_count: f64,
) -> Option<ScreenedFit> {
    let count = effective_count(&at.residuals, 2);
    let scale = criteria.scale(at, count, 2);
    let curvature = landscape.curvature(at);
    let [[slope_variance, covariance], [_, wavenumber_variance]] = curvature.inverse;
    // With all rings at one radius the matrix is singular to rounding.
    if !(wavenumber_variance > 0.0 && wavenumber_variance.is_finite()) {
        return None;
    }
    // d_0 = B v(a; κ), to first order in both.
    let (by_slope, by_wavenumber) = (curvature.inner_value, at.slope * curvature.inner_slope);
    let amplitude_variance = by_slope * by_slope * slope_variance
        + 2.0 * by_slope * by_wavenumber * covariance
        + by_wavenumber * by_wavenumber * wavenumber_variance;
    let joint = by_slope * covariance + by_wavenumber * wavenumber_variance;
    let degrees = freedom(count, 2);
    Some(ScreenedFit {
        amplitude: Estimate {
            value: at.slope * curvature.inner_value,
            standard_error: (scale * amplitude_variance).sqrt(),
        },
        wavenumber: Estimate { value: at.wavenumber, standard_error: (scale * wavenumber_variance).sqrt() },
        correlation: joint / (amplitude_variance * wavenumber_variance).sqrt(),
        branch: landscape.branch(at.wavenumber),
        chi_squared: at.chi_squared,
        share_described: criteria.share(at, 2),
        effective_ring_count: count,
        chance_of_nothing: corrected(chance(criteria.at_rest, at.chi_squared, 2, degrees), trial_count),
        chance_of_elastic: corrected(chance(elastic_chi_squared, at.chi_squared, 1, degrees), trial_count),
    })
}

/// The κ above the minimum of the first basin at which χ² has risen by `rise`.
fn wavenumber_bound(landscape: &Landscape<'_>, grid: &[(f64, f64)], rise: f64) -> Option<f64> {
    let bottom = (1..grid.len()).take_while(|&i| grid[i].1 < grid[i - 1].1).last().unwrap_or(0);
    let level = grid[bottom].1 + rise;
    let above = (bottom + 1..grid.len()).find(|&i| grid[i].1 > level)?;
    let (mut low, mut high) = (grid[above - 1].0, grid[above].0);
    // 30 bisections of a sixteenth of a branch: 10⁻¹⁰ of it.
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if landscape.project(middle).chi_squared > level {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some(0.5 * (low + high))
}
