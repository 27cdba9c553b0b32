//! Methods for the screened profile.

use std::time::Instant;

use crate::inflation::{Grown, Shape};
use crate::precision::numerical_choices::{ChoiceRow, ChoiceTable};
use crate::reference::screened::Screened;
use crate::reference::{Annulus, RadialSolution};
use crate::vector::larger;

/// Number of points of a profile.
const POINTS: usize = 400;

/// Number of timed evaluations of a profile.
const REPEATS: usize = 20;

/// J_1 and Y_1, or the spherical j_1 and y_1 in three dimensions.
fn bessel<const D: usize>(x: f64) -> [f64; 2] {
    if D != 3 {
        return [libm::j1(x), libm::y1(x)];
    }
    let (sine, cosine) = libm::sincos(x);
    [(sine / x - cosine) / x, -(cosine / x + sine) / x]
}

/// The closed formula with J and Y of `libm` compared with [`Screened`], on the annulus of the sample, at κ of the fit
/// and fractions of it. None if the annulus has no screened solution.
pub(super) fn routes<const D: usize>(grown: &Grown<D>, wavenumber: f64) -> Option<ChoiceTable> {
    // A strip has sines instead of Bessel functions.
    if grown.shape() != Shape::Round {
        return None;
    }
    let annulus = Annulus::new(grown.inner_radius, grown.outer_radius).ok()?;
    let (inner, outer) = (grown.inner_radius, grown.outer_radius);
    let radii: Vec<f64> = (0..POINTS).map(|i| inner + (i as f64 + 0.5) / POINTS as f64 * (outer - inner)).collect();
    let mut rows = Vec::new();
    // Without a fit, the first wavelength that fits the annulus.
    let largest = if wavenumber > 0.0 { wavenumber } else { 2.0 / outer };
    for share in [1.0, 1e-2, 1e-4, 1e-6] {
        let wavenumber = share * largest;
        let Ok(medium) = Screened::<D>::new(annulus, 1.0, wavenumber) else { continue };
        let bracket = |radius: f64| {
            let ([j, y], [rim_j, rim_y]) = (bessel::<D>(wavenumber * radius), bessel::<D>(wavenumber * outer));
            y * rim_j - j * rim_y
        };
        let at_disk = bracket(inner);
        let timed = |profile: &dyn Fn(f64) -> f64| {
            let start = Instant::now();
            let mut sum = 0.0;
            for _ in 0..REPEATS {
                sum += radii.iter().map(|&radius| profile(std::hint::black_box(radius))).sum::<f64>();
            }
            std::hint::black_box(sum);
            start.elapsed().as_secs_f64() / (REPEATS * POINTS) as f64
        };
        let closed = |radius: f64| bracket(radius) / at_disk;
        let most = radii.iter().map(|&radius| medium.value(radius).abs()).fold(0.0, larger);
        let errors = radii.iter().map(|&radius| (closed(radius) - medium.value(radius)).abs() / most);
        let values =
            vec![Some(errors.fold(0.0, larger)), Some(timed(&closed)), Some(timed(&|radius| medium.value(radius)))];
        rows.push(ChoiceRow { setting: format!("{wavenumber:.3e}"), values });
    }
    (!rows.is_empty()).then(|| ChoiceTable {
        name: "bessel_route",
        title: if D == 3 {
            "Screened profile: the closed formula with j and y of libm's sine and cosine against the route used"
        } else {
            "Screened profile: the closed formula with J and Y of libm against the route used"
        },
        columns: vec![
            "κ (1/length)",
            "largest difference over largest value (1)",
            "closed formula (s a point)",
            "seconds",
        ],
        rows,
    })
}
