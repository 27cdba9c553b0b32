//! [`correlation_figure`]: the angular correlation G(θ).

use std::f64::consts::PI;

use plotters::prelude::*;

use crate::report::figures::chart::{Chart, Entry, LegendLine, SCALE, Sign};
use crate::report::figures::palette::SEQUENCE;
use crate::report::figures::{Around, Figure, FigureError};

/// One curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrelationCurve<'a> {
    /// Its label in the legend; may contain SVG markup.
    pub label: String,
    /// θ \[rad\].
    pub angles: &'a [f64],
    /// G(θ) \[1\].
    pub values: Vec<f64>,
    /// Standard errors, drawn as a band; may be empty.
    pub standard_errors: Vec<f64>,
}

/// Curves of G against θ/π, one colour each, with bands of one standard error.
///
/// `threshold`, which defines θ*, is drawn as a dashed line.
///
/// # Errors
/// No curve with a finite number.
pub fn correlation_figure(
    name: &str,
    around: Around,
    curves: &[CorrelationCurve<'_>],
    threshold: Option<f64>,
) -> Result<Figure, FigureError> {
    let (x_label, y_label) = match around {
        Around::Ring => ("θ/π", "G(θ)"),
        Around::Row => ("2x/L", "G(x)"),
        Around::Shell => ("γ/π", "G(γ)"),
    };
    let colour = |index: usize| SEQUENCE[index % SEQUENCE.len()];
    let legend = curves.iter().enumerate().map(|(index, curve)| {
        let sign = Sign::Line { colour: colour(index), dashed: false };
        LegendLine(vec![Entry { sign, text: curve.label.clone() }])
    });
    let lowest = curves.iter().flat_map(|curve| &curve.values).copied().filter(|value| value.is_finite());
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    let chart = Chart {
        title: format!("{name}: angular correlation"),
        description: format!(
            "Angular correlation G of the radial displacement against {x_label}, {} curves",
            curves.len()
        ),
        x_label,
        x_range: [0.0, 1.0],
        y_label,
        y_unit: "1",
        y_range: [(lowest - 0.1).min(-0.3), 1.05],
        legend: legend.collect(),
    };
    chart.draw(|axes, scaling| {
        if let Some(threshold) = threshold {
            let ends = [0.0, 1.0].map(|x| (x, scaling.apply(threshold)));
            let grey = RGBColor(0x66, 0x66, 0x66).stroke_width(SCALE * 7 / 10);
            axes.draw_series(DashedLineSeries::new(ends, 4 * SCALE, 4 * SCALE, grey))?;
        }
        for (index, curve) in curves.iter().enumerate() {
            let [red, green, blue] = colour(index);
            let style = RGBColor(red, green, blue);
            let finite = |(_, value): &(f64, f64)| value.is_finite();
            let at = |angle: &f64, value: f64| (angle / PI, scaling.apply(value));
            if !curve.standard_errors.is_empty() {
                let edge = |sign: f64| {
                    let ends = curve.values.iter().zip(&curve.standard_errors).map(move |(y, e)| y + sign * e);
                    curve.angles.iter().zip(ends).map(|(x, y)| at(x, y)).filter(finite).collect::<Vec<_>>()
                };
                let band: Vec<(f64, f64)> = edge(1.0).into_iter().chain(edge(-1.0).into_iter().rev()).collect();
                axes.draw_series([Polygon::new(band, style.mix(0.2).filled())])?;
            }
            let line = curve.angles.iter().zip(&curve.values).map(|(x, &y)| at(x, y)).filter(finite);
            axes.draw_series(LineSeries::new(line, style.stroke_width(SCALE * 3 / 2)))?;
        }
        Ok(())
    })
}
