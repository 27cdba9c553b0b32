//! The curves of a response that a record contains.

use std::collections::BTreeMap;

use crate::observe::angular::{AngularCorrelation, PowerSpectrum, RingOutcome};
use crate::observe::fluctuations::Fluctuations;
use crate::response::{Detail, Response};
use crate::scene::Scene;

/// Stride of the angles kept of a correlation function: two degrees apart is enough for a figure.
const ANGLE_STRIDE: usize = 4;

/// Significant digits of a curve. Single samples scatter by a percent and more, and a study of a thousand samples has a
/// million points.
const DIGITS: usize = 6;

/// Curves by name, as pairs of abscissa and ordinate.
pub(super) fn curves(scene: &Scene, response: &Response) -> BTreeMap<String, Vec<[f64; 2]>> {
    let mut all = BTreeMap::new();
    let mut put = |name: String, points: Vec<[f64; 2]>| {
        let finite = points.into_iter().filter(|point| point[1].is_finite());
        all.insert(name, finite.map(|point| point.map(rounded)).collect::<Vec<_>>());
    };
    if let Some(profile) = &response.radial_profile {
        put("radial_profile".into(), profile.rings.iter().map(|ring| [ring.radius, ring.mean]).collect());
    }
    if let Some(ring) = response.angular_correlation.as_ref().and_then(|it| it.measured()) {
        put("angular_correlation".into(), correlation(&ring.correlation));
        put("power_spectrum".into(), spectrum(&ring.spectrum));
    }
    if let Some(shell) = response.shell_correlation.as_ref().and_then(|it| it.measured()) {
        let of = &shell.analysis;
        let angles = of.correlation.angles.iter().zip(&of.correlation.values);
        put("shell_correlation".into(), angles.map(|(&angle, &value)| [angle, value]).collect());
        let powers = of.spectrum.power.iter().enumerate().skip(1);
        put("shell_spectrum".into(), powers.map(|(l, &power)| [l as f64, power / of.spectrum.variance]).collect());
    }
    if let Some(rings) = response.radial_dependence.as_ref().and_then(|it| it.measured()) {
        let measured = |of: fn(&AngularCorrelation) -> Option<f64>| -> Vec<[f64; 2]> {
            let point = |ring: &crate::observe::angular::RingAnalysis| match &ring.outcome {
                RingOutcome::Measured { correlation, .. } => Some([ring.relative_radius, of(correlation)?]),
                _ => None,
            };
            rings.iter().filter_map(point).collect()
        };
        put("anticorrelation_by_radius".into(), measured(|it| Some(it.anticorrelation)));
        put("correlation_angle_by_radius".into(), measured(|it| it.crossings.first()?.outcome.angle()));
        for ring in rings {
            if let RingOutcome::Measured { spectrum: of_ring, .. } = &ring.outcome {
                put(format!("power_spectrum_at_{}", ring.relative_radius), spectrum(of_ring));
            }
        }
    }
    if let Some(isostatic) = response.isostatic_length.as_ref().and_then(|it| it.measured()) {
        let points = isostatic.curve.iter().map(|point| [point.scaled_radius, point.scaled_fluctuation]);
        put("isostatic_fluctuation".into(), points.collect());
        // h_∥/h_0 from y = (h_∥/h_0) xⁿ.
        let unit = isostatic.unit.unwrap_or(f64::NAN);
        let stretching = isostatic.curve.iter().map(|point| {
            [point.radius, unit * point.scaled_fluctuation / point.scaled_radius.powi(isostatic.tail.power())]
        });
        put("stretching_fluctuation".into(), stretching.collect());
        let width = scene.observables.isostatic_length.map_or(1.0, |settings| settings.ring_width);
        let rings = match &response.detail {
            Detail::Plane(detail) => Fluctuations::of_radial(&detail.field, width).rings,
            Detail::Space(detail) => Fluctuations::of_radial(&detail.field, width).rings,
        };
        put("radial_fluctuation".into(), rings.iter().map(|ring| [ring.radius, ring.fluctuation]).collect());
    }
    all
}

/// Rounds to [`DIGITS`] significant digits.
fn rounded(value: f64) -> f64 {
    // A printed number can always be parsed.
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

fn correlation(of: &AngularCorrelation) -> Vec<[f64; 2]> {
    let points = of.angles.iter().zip(&of.values).map(|(&angle, &value)| [angle, value]);
    points.step_by(ANGLE_STRIDE).collect()
}

/// P_f over the variance, f from 1 on.
fn spectrum(of: &PowerSpectrum) -> Vec<[f64; 2]> {
    of.power.iter().enumerate().skip(1).map(|(f, &power)| [f as f64, power / of.variance]).collect()
}
