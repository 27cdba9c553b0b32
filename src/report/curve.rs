//! The fitted solutions as curves next to a measured profile.

#[cfg(feature = "fit")]
use crate::fit::profile::{Decision, ProfileFit};
#[cfg(feature = "fit")]
use crate::reference::{Annulus, elastic::Elastic, screened::Screened};

use crate::reference::RadialSolution;
use crate::response::Response;

/// One fitted solution.
pub(crate) struct Curve {
    /// Its name, also the name of its column.
    pub name: &'static str,
    /// Whether the fit selected it.
    #[cfg_attr(not(feature = "plot"), allow(dead_code, reason = "figures draw it in another way"))]
    pub decided: bool,
    solution: Box<dyn RadialSolution>,
    /// D − 1.
    power: i32,
}

/// D − 1: r^(D−1) d_r is constant in an incompressible medium without a rim.
pub(crate) fn power(response: &Response) -> i32 {
    response.detail.spreading_dimension() as i32 - 1
}

impl Curve {
    /// r^(D−1) d_r at distance `radius` \[length^D\], NaN outside the annulus.
    pub(crate) fn rescaled(&self, radius: f64) -> f64 {
        radius.powi(self.power) * self.solution.value(radius)
    }
}

/// The fit of a sample, if there is one.
#[cfg(feature = "fit")]
pub(crate) fn fit_of(response: &Response) -> Option<&ProfileFit> {
    response.profile_fit.as_ref()?.measured()
}

/// Fitted solutions of a sample; empty without a fit.
#[cfg(feature = "fit")]
pub(crate) fn curves(response: &Response) -> Vec<Curve> {
    let Some(fit) = fit_of(response) else { return Vec::new() };
    let Ok(annulus) = Annulus::new(response.detail.radii()[0], response.detail.radii()[1]) else {
        return Vec::new();
    };
    match response.detail.spreading_dimension() {
        1 => curves_of::<1>(fit, annulus),
        3 => curves_of::<3>(fit, annulus),
        _ => curves_of::<2>(fit, annulus),
    }
}

#[cfg(feature = "fit")]
fn curves_of<const D: usize>(fit: &ProfileFit, annulus: Annulus) -> Vec<Curve> {
    let power = D as i32 - 1;
    let elastic = Elastic::<D>::new(annulus, fit.elastic.amplitude.value).ok().map(|solution| Curve {
        name: "elastic",
        decided: fit.decision == Decision::Elastic,
        solution: Box::new(solution),
        power,
    });
    // At a pole, to rounding, there is no finite solution and no curve.
    let screened = fit
        .screened
        .and_then(|fit| Screened::<D>::new(annulus, fit.amplitude.value, fit.wavenumber.value).ok())
        .map(|solution| Curve {
            name: "screened",
            decided: fit.decision == Decision::Screened,
            solution: Box::new(solution),
            power,
        });
    elastic.into_iter().chain(screened).collect()
}

/// No fits without the feature `fit`.
#[cfg(not(feature = "fit"))]
pub(crate) fn curves(_response: &Response) -> Vec<Curve> {
    Vec::new()
}

/// Smallest and largest fitted radius \[length\].
#[cfg(feature = "fit")]
pub(crate) fn fitted_range(response: &Response) -> Option<[f64; 2]> {
    fit_of(response).map(|fit| fit.range)
}

/// No fits without the feature `fit`.
#[cfg(not(feature = "fit"))]
pub(crate) fn fitted_range(_response: &Response) -> Option<[f64; 2]> {
    None
}
