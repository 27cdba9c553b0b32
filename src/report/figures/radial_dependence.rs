//! [`radial_dependence_figure`]: G* and θ* against the distance of the ring.

use std::f64::consts::PI;

use plotters::prelude::*;

use crate::observe::angular::{RingAnalysis, RingOutcome};
use crate::report::figures::chart::{Chart, Entry, LegendLine, SCALE, Sign};
use crate::report::figures::palette::SEQUENCE;
use crate::report::figures::radial::with_margin;
use crate::report::figures::{Figure, FigureError};

/// G* of every measured ring, and θ*/π at the first threshold if G falls to it.
///
/// # Errors
/// No ring with a finite number.
pub fn radial_dependence_figure(name: &str, rings: &[RingAnalysis]) -> Result<Figure, FigureError> {
    let measured = || {
        rings.iter().filter_map(|ring| match &ring.outcome {
            RingOutcome::Measured { correlation, .. } => Some((ring.relative_radius, correlation)),
            _ => None,
        })
    };
    let finite = |point: &(f64, f64)| point.1.is_finite();
    let depth: Vec<(f64, f64)> = measured().map(|(radius, it)| (radius, it.anticorrelation)).filter(finite).collect();
    let first = |(radius, it): (f64, &crate::observe::angular::AngularCorrelation)| {
        Some((radius, it.crossings.first()?.outcome.angle()? / PI))
    };
    let angle: Vec<(f64, f64)> = measured().filter_map(first).collect();
    let threshold = measured().find_map(|(_, it)| it.crossings.first()).map(|crossing| crossing.threshold);
    let mut series = vec![("G* = −G(π)".to_string(), depth)];
    if let Some(threshold) = threshold {
        series.push((format!("θ*/π, G = {threshold}"), angle));
    }
    let colour = |index: usize| SEQUENCE[index % SEQUENCE.len()];
    let legend = series
        .iter()
        .enumerate()
        .map(|(index, (label, _))| Entry { sign: Sign::PointOnLine(colour(index)), text: label.clone() });
    let chart = Chart {
        title: format!("{name}: angular correlation by distance"),
        description: format!(
            "G* and θ*/π of the radial displacement in {} rings from the centre to the rim",
            rings.len()
        ),
        x_label: "r/R",
        x_range: [0.0, 1.0],
        y_label: "G*, θ*/π",
        y_unit: "1",
        y_range: with_margin(series.iter().flat_map(|(_, points)| points).map(|point| point.1)),
        legend: vec![LegendLine(legend.collect())],
    };
    chart.draw(|axes, scaling| {
        for (index, (_, points)) in series.iter().enumerate() {
            let [red, green, blue] = colour(index);
            let style = RGBColor(red, green, blue);
            let scaled: Vec<(f64, f64)> = points.iter().map(|&(x, y)| (x, scaling.apply(y))).collect();
            axes.draw_series(LineSeries::new(scaled.iter().copied(), style.stroke_width(SCALE)))?;
            let radius = f64::from(SCALE) * 2.6;
            axes.draw_series(scaled.iter().map(|&point| Circle::new(point, radius, style.filled())))?;
        }
        Ok(())
    })
}
