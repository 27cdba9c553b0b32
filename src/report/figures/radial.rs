//! [`radial_figure`]: r·d_r against r, ring by ring, with the fitted solutions.

use plotters::prelude::*;

use crate::observe::RadialProfile;
use crate::report::curve::{Curve, curves, fitted_range, power};
#[cfg(feature = "fit")]
use crate::report::figures::AMPLITUDE;
use crate::report::figures::chart::{Axes, Chart, Drawn, Entry, LegendLine, SCALE, Scaling, Sign};
use crate::report::figures::palette::{BLUE, VERMILLION};
use crate::report::figures::{DISPLACEMENT, Figure, FigureError, RESCALED, RESCALED_IN_SPACE};
use crate::response::Response;

/// Number of points of a fitted curve: two pixels apart.
const CURVE_POINTS: usize = 200;

/// Colour of the measured rings.
const MEASURED: [u8; 3] = [0x22, 0x22, 0x22];

/// The radial profile of a sample: rings with their standard errors, hollow if not fitted. The selected solution is
/// solid, the other dashed.
///
/// # Errors
/// A profile without a finite number.
pub fn radial_figure(name: &str, response: &Response, profile: &RadialProfile) -> Result<Figure, FigureError> {
    let range = fitted_range(response);
    let curves: Vec<Curve> = curves(response).into_iter().filter(|curve| distinct(response, curve)).collect();
    let fitted = |radius: f64| range.is_none_or(|[from, to]| from <= radius && radius <= to);
    let [_, outer_radius] = response.detail.radii();
    let power = power(response);
    let y_range = y_range(profile, &curves, outer_radius, power);
    // r·d_r, r²·d_r of spheres, d_r in a strip.
    let (words, label, unit) = match power {
        2 => ("r²·d_r", RESCALED_IN_SPACE, "length³"),
        0 => ("d_r", DISPLACEMENT, "length"),
        _ => ("r·d_r", RESCALED, "length²"),
    };
    let chart = Chart {
        title: format!("{name}: radial profile"),
        description: format!(
            "Mean rescaled radial displacement {words} of {} rings with standard errors against the distance r from the \
             inflated disk{}",
            profile.rings.len(),
            if curves.is_empty() { "" } else { ", and the fitted solutions" }
        ),
        x_label: "r (length)",
        x_range: [0.0, 1.02 * outer_radius],
        y_label: label,
        y_unit: unit,
        y_range,
        legend: legend(response, &curves),
    };
    chart.draw(|axes, scaling| {
        for curve in curves.iter().filter(|curve| !curve.decided).chain(curves.iter().filter(|curve| curve.decided)) {
            draw_curve(axes, scaling, curve, response, y_range)?;
        }
        draw_rings(axes, scaling, (profile, power), fitted)
    })
}

/// Range that contains all rings with their errors, zero, and the selected solution.
fn y_range(profile: &RadialProfile, curves: &[Curve], outer_radius: f64, power: i32) -> [f64; 2] {
    let rings = profile.rings.iter().flat_map(|ring| {
        [ring.mean - ring.standard_error, ring.mean + ring.standard_error].map(|value| ring.radius.powi(power) * value)
    });
    let first = profile.rings.first().map_or(outer_radius, |ring| ring.radius);
    let decided = curves.iter().filter(|curve| curve.decided).flat_map(|curve| {
        (0..=CURVE_POINTS).map(move |i| {
            let share = i as f64 / CURVE_POINTS as f64;
            curve.rescaled(first + share * (outer_radius - first))
        })
    });
    with_margin(rings.chain(decided))
}

/// From the smallest to the largest value, including zero, with a margin.
pub(crate) fn with_margin(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((0.0f64, 0.0f64), |(low, high), value| (low.min(value), high.max(value)));
    // If nothing moves there is still an axis.
    let span = if high > low { high - low } else { 1.0 };
    [low - 0.06 * span, high + 0.06 * span]
}

fn legend(response: &Response, curves: &[Curve]) -> Vec<LegendLine> {
    let point = |filled: bool, text: &str| Entry { sign: Sign::Point { colour: MEASURED, filled }, text: text.into() };
    let mut measured = vec![point(true, "rings ± standard error")];
    if fitted_range(response).is_some() {
        measured.push(point(false, "not fitted"));
    }
    let mut lines = vec![LegendLine(measured)];
    for curve in curves {
        let sign = Sign::Line { colour: colour(curve), dashed: !curve.decided };
        lines.push(LegendLine(vec![Entry { sign, text: parameters(response, curve) }]));
    }
    lines
}

/// Whether a curve differs visibly from the elastic one: a screened one with κ far below its error does not.
#[cfg(feature = "fit")]
fn distinct(response: &Response, curve: &Curve) -> bool {
    let screened = crate::report::curve::fit_of(response).and_then(|fit| fit.screened);
    let undetermined = screened.is_some_and(|fit| fit.wavenumber.standard_error > 10.0 * fit.wavenumber.value);
    curve.decided || curve.name == "elastic" || !undetermined
}

#[cfg(not(feature = "fit"))]
fn distinct(_response: &Response, _curve: &Curve) -> bool {
    true
}

/// The parameters of a solution, in words.
#[cfg(feature = "fit")]
fn parameters(response: &Response, curve: &Curve) -> String {
    use crate::report::number::with_error;
    let with = |estimate: crate::fit::Estimate| with_error(estimate.value, estimate.standard_error);
    let fit = crate::report::curve::fit_of(response);
    match fit.and_then(|fit| if curve.name == "screened" { fit.screened } else { None }) {
        Some(fit) => format!("screened: {AMPLITUDE} = {}, κ = {}", with(fit.amplitude), with(fit.wavenumber)),
        None => format!("elastic: {AMPLITUDE} = {}", fit.map_or(String::new(), |fit| with(fit.elastic.amplitude))),
    }
}

#[cfg(not(feature = "fit"))]
fn parameters(_response: &Response, curve: &Curve) -> String {
    curve.name.into()
}

fn colour(curve: &Curve) -> [u8; 3] {
    if curve.name == "screened" { VERMILLION } else { BLUE }
}

fn draw_curve(
    axes: &mut Axes<'_, '_>,
    scaling: Scaling,
    curve: &Curve,
    response: &Response,
    [low, high]: [f64; 2],
) -> Drawn {
    let [inner, outer] = response.detail.radii();
    let [red, green, blue] = colour(curve);
    let style = RGBColor(red, green, blue).stroke_width(2 * SCALE);
    let point = |i: usize| {
        let radius = inner + (outer - inner) * i as f64 / CURVE_POINTS as f64;
        (radius, curve.rescaled(radius))
    };
    let points: Vec<(f64, f64)> = (0..=CURVE_POINTS).map(point).collect();
    // Plotters draws beyond the axes, so points outside are left out.
    for run in points.split(|&(_, value)| !(low <= value && value <= high)).filter(|run| run.len() > 1) {
        let run = run.iter().map(|&(radius, value)| (radius, scaling.apply(value)));
        if curve.decided {
            axes.draw_series(LineSeries::new(run, style))?;
        } else {
            axes.draw_series(DashedLineSeries::new(run, 6 * SCALE, 4 * SCALE, style))?;
        }
    }
    Ok(())
}

fn draw_rings(
    axes: &mut Axes<'_, '_>,
    scaling: Scaling,
    (profile, power): (&RadialProfile, i32),
    fitted: impl Fn(f64) -> bool,
) -> Drawn {
    let [red, green, blue] = MEASURED;
    let ink = RGBColor(red, green, blue);
    let value = |radius: f64, displacement: f64| scaling.apply(radius.powi(power) * displacement);
    let drawable = || profile.rings.iter().filter(|ring| (ring.radius * ring.mean * ring.standard_error).is_finite());
    axes.draw_series(drawable().map(|ring| {
        let ends = [ring.mean - ring.standard_error, ring.mean + ring.standard_error];
        let ends = ends.map(|end| (ring.radius, value(ring.radius, end)));
        PathElement::new(ends.to_vec(), ink.stroke_width(SCALE))
    }))?;
    for (style, wanted) in [(ink.filled(), true), (WHITE.filled(), false), (ink.stroke_width(SCALE), false)] {
        let rings = drawable().filter(|ring| fitted(ring.radius) == wanted);
        axes.draw_series(
            rings.map(|ring| Circle::new((ring.radius, value(ring.radius, ring.mean)), f64::from(SCALE) * 2.6, style)),
        )?;
    }
    Ok(())
}
