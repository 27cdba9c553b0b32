//! [`multipole_figure`]: r times the amplitudes of the angular modes against r.

use plotters::prelude::*;

use crate::observe::Multipoles;
use crate::observe::multipoles::{ComponentModes, MultipoleFit};
use crate::report::figures::chart::{Chart, Entry, LegendLine, SCALE, Sign};
use crate::report::figures::palette::SEQUENCE;
use crate::report::figures::radial::with_margin;
use crate::report::figures::{Figure, FigureError};

/// A component of the displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Component {
    /// d_r.
    Radial,
    /// d_θ.
    Transverse,
}

/// Entries per line of the legend.
const ENTRIES_A_LINE: usize = 3;

/// r·A as SVG text.
const RADIAL: &str = "r·A<tspan dy=\"3\" font-size=\"10\">n</tspan><tspan dy=\"-3\"> of d</tspan><tspan dy=\"3\" \
                      font-size=\"10\">r</tspan><tspan dy=\"-3\">\u{200B}</tspan>";
const TRANSVERSE: &str = "r·A<tspan dy=\"3\" font-size=\"10\">n</tspan><tspan dy=\"-3\"> of d</tspan><tspan dy=\"3\" \
                          font-size=\"10\">θ</tspan><tspan dy=\"-3\">\u{200B}</tspan>";

/// The amplitude of a mode at a distance \[length\]; none if the mode has none there.
pub type ModeCurve<'a> = &'a dyn Fn(usize, f64) -> Option<f64>;

/// Number of points of a curve.
const CURVE_POINTS: usize = 100;

/// The modes of a sample from 0 to `highest_mode`, one colour each, with connected rings and standard errors; rings
/// without modes are left out. `curve` is drawn dashed.
///
/// # Errors
/// No ring with a mode.
pub fn multipole_figure(
    name: &str,
    multipoles: &Multipoles,
    component: Component,
    highest_mode: usize,
    curve: Option<ModeCurve<'_>>,
) -> Result<Figure, FigureError> {
    let rings: Vec<(f64, &ComponentModes)> = multipoles
        .rings
        .iter()
        .filter_map(|ring| match (&ring.fit, component) {
            (MultipoleFit::Fitted { radial, .. }, Component::Radial) => Some((ring.radius, radial)),
            (MultipoleFit::Fitted { transverse, .. }, Component::Transverse) => Some((ring.radius, transverse)),
            _ => None,
        })
        .collect();
    let modes: Vec<usize> = (0..=highest_mode).collect();
    let colour = |mode: usize| SEQUENCE[mode % SEQUENCE.len()];
    let legend = modes.chunks(ENTRIES_A_LINE).map(|line| {
        let entry = |&mode: &usize| Entry { sign: Sign::PointOnLine(colour(mode)), text: format!("n = {mode}") };
        LegendLine(line.iter().map(entry).collect())
    });
    // (r, r A, r error) of one mode.
    let points = |mode: usize| {
        rings.iter().filter_map(move |(radius, component)| {
            let fit = component.modes.get(mode)?;
            Some((*radius, radius * fit.amplitude, radius * fit.amplitude_error))
        })
    };
    let farthest = rings.last().map_or(f64::NAN, |ring| ring.0);
    let values =
        modes.iter().flat_map(|&mode| points(mode).flat_map(|(_, value, error)| [value - error, value + error]));
    let at_rings = |mode: usize| {
        rings.iter().filter_map(move |(radius, _)| Some(radius * curve.and_then(|curve| curve(mode, *radius))?))
    };
    let y_range = with_margin(values.chain(modes.iter().flat_map(|&mode| at_rings(mode))));
    let part = match component {
        Component::Radial => "radial",
        Component::Transverse => "transverse",
    };
    let chart = Chart {
        title: format!("{name}: angular modes, {part}"),
        description: format!(
            "Amplitudes of the angular modes 0 to {highest_mode} of the {part} displacement, times r, in {} rings with standard errors",
            rings.len()
        ),
        x_label: "r (length)",
        x_range: [0.0, 1.02 * farthest],
        y_label: if component == Component::Radial { RADIAL } else { TRANSVERSE },
        y_unit: "length²",
        y_range,
        legend: legend.collect(),
    };
    chart.draw(|axes, scaling| {
        for &mode in &modes {
            let [red, green, blue] = colour(mode);
            let style = RGBColor(red, green, blue);
            let line = points(mode).map(|(radius, value, _)| (radius, scaling.apply(value)));
            axes.draw_series(LineSeries::new(line, style.stroke_width(SCALE)))?;
            if let Some(curve) = curve {
                let at = |i: usize| farthest * i as f64 / CURVE_POINTS as f64;
                let points = (0..=CURVE_POINTS).filter_map(|i| Some((at(i), at(i) * curve(mode, at(i))?)));
                let shown = points.filter(|(_, value)| y_range[0] <= *value && *value <= y_range[1]);
                let shown = shown.map(|(radius, value)| (radius, scaling.apply(value)));
                axes.draw_series(DashedLineSeries::new(shown, 6 * SCALE, 4 * SCALE, style.stroke_width(SCALE)))?;
            }
            axes.draw_series(points(mode).map(|(radius, value, error)| {
                let ends = [value - error, value + error].map(|end| (radius, scaling.apply(end)));
                PathElement::new(ends.to_vec(), style.stroke_width(SCALE * 7 / 10))
            }))?;
            axes.draw_series(points(mode).map(|(radius, value, _)| {
                Circle::new((radius, scaling.apply(value)), f64::from(SCALE) * 2.0, style.filled())
            }))?;
        }
        Ok(())
    })
}
