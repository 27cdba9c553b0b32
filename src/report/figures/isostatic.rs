//! [`isostatic_figure`]: (h_∥/h_0) xⁿ against x = r ΔZ or r √ΔZ.

use plotters::prelude::*;

use crate::observe::IsostaticLength;
use crate::observe::isostatic::{IsostaticOutcome, Scale, Tail};
use crate::report::figures::chart::{Chart, Entry, LegendLine, SCALE, Sign};
use crate::report::figures::palette::SEQUENCE;
use crate::report::figures::radial::with_margin;
use crate::report::figures::{Figure, FigureError, escaped};
use crate::report::number::significant;

/// Entries per line of the legend.
const ENTRIES_A_LINE: usize = 2;

/// Axis label.
fn across(scale: Scale) -> &'static str {
    match scale {
        Scale::Excess => "r ΔZ",
        Scale::RootExcess => "r √ΔZ",
    }
}

/// h_∥/h_0 times a factor, as SVG text.
macro_rules! fluctuation_times {
    ($scaled:literal) => {
        concat!(
            "(h<tspan dy=\"3\" font-size=\"10\">∥</tspan><tspan dy=\"-3\"> / h</tspan>",
            "<tspan dy=\"3\" font-size=\"10\">0</tspan><tspan dy=\"-3\">) ",
            $scaled,
            "</tspan>"
        )
    };
}

/// Axis label as SVG text.
fn up(tail: Tail, scale: Scale) -> &'static str {
    match (tail, scale) {
        (Tail::InverseDistance, Scale::Excess) => fluctuation_times!("r ΔZ"),
        (Tail::InverseDistance, Scale::RootExcess) => fluctuation_times!("r √ΔZ"),
        (Tail::InverseSquare, Scale::Excess) => fluctuation_times!("(r ΔZ)²"),
        (Tail::InverseSquare, Scale::RootExcess) => fluctuation_times!("r² ΔZ"),
        (Tail::InverseCube, Scale::Excess) => fluctuation_times!("(r ΔZ)³"),
        (Tail::InverseCube, Scale::RootExcess) => fluctuation_times!("(r √ΔZ)³"),
    }
}

/// Curves of several samples or pressures, each with its name, connected rings and standard errors. Thresholds are
/// dashed, and a circle marks where a curve reaches its threshold. All curves have the tail and the scale of the first.
///
/// # Errors
/// Curves without a finite number.
pub fn isostatic_figure(name: &str, curves: &[(&str, &IsostaticLength)]) -> Result<Figure, FigureError> {
    let colour = |index: usize| SEQUENCE[index % SEQUENCE.len()];
    let entries: Vec<(usize, String)> =
        curves.iter().map(|(name, length)| format!("{}{}", escaped(name), outcome(length))).enumerate().collect();
    let legend = entries.chunks(ENTRIES_A_LINE).map(|line| {
        let entry =
            |(index, text): &(usize, String)| Entry { sign: Sign::PointOnLine(colour(*index)), text: text.clone() };
        LegendLine(line.iter().map(entry).collect())
    });
    let points = || curves.iter().flat_map(|(_, length)| &length.curve);
    let thresholds = || curves.iter().filter_map(|(_, length)| length.threshold);
    let widest = points().map(|point| point.scaled_radius).fold(0.0, f64::max);
    let heights = points().map(|point| point.scaled_fluctuation + point.standard_error);
    let (tail, scale) = curves.first().map_or_else(Default::default, |(_, length)| (length.tail, length.scale));
    let chart = Chart {
        title: format!("{name}: fluctuation of the stretching of bonds"),
        description: format!(
            "Rescaled fluctuation of the stretching of bonds around rings against rescaled distance, {} curves, with the threshold that \
             defines the isostatic length",
            curves.len()
        ),
        x_label: across(scale),
        x_range: [0.0, 1.02 * widest],
        y_label: up(tail, scale),
        y_unit: "1",
        y_range: with_margin(heights.chain(thresholds())),
        legend: legend.collect(),
    };
    chart.draw(|axes, scaling| {
        let mut drawn: Vec<f64> = thresholds().collect();
        drawn.sort_by(f64::total_cmp);
        drawn.dedup();
        for threshold in drawn {
            let ends = [(0.0, scaling.apply(threshold)), (1.02 * widest, scaling.apply(threshold))];
            let style = RGBColor(0x77, 0x77, 0x77).stroke_width(SCALE);
            axes.draw_series(DashedLineSeries::new(ends, 6 * SCALE, 4 * SCALE, style))?;
        }
        for (index, (_, length)) in curves.iter().enumerate() {
            let [red, green, blue] = colour(index);
            let style = RGBColor(red, green, blue);
            let place = |x: f64, y: f64| (x, scaling.apply(y));
            axes.draw_series(LineSeries::new(
                length.curve.iter().map(|point| place(point.scaled_radius, point.scaled_fluctuation)),
                style.stroke_width(SCALE * 7 / 10),
            ))?;
            axes.draw_series(length.curve.iter().map(|point| {
                let ends = [-1.0, 1.0].map(|sign| point.scaled_fluctuation + sign * point.standard_error);
                let ends = ends.map(|end| place(point.scaled_radius, end));
                PathElement::new(ends.to_vec(), style.stroke_width(SCALE * 6 / 10))
            }))?;
            axes.draw_series(length.curve.iter().map(|point| {
                Circle::new(
                    place(point.scaled_radius, point.scaled_fluctuation),
                    f64::from(SCALE) * 1.8,
                    style.filled(),
                )
            }))?;
            if let (IsostaticOutcome::Reached { product, .. }, Some(threshold)) = (length.outcome, length.threshold) {
                let ink = RGBColor(0x22, 0x22, 0x22).stroke_width(SCALE * 3 / 2);
                axes.draw_series([Circle::new(place(product, threshold), f64::from(SCALE) * 4.5, ink)])?;
            }
        }
        Ok(())
    })
}

/// C, if the curve has one.
fn outcome(length: &IsostaticLength) -> String {
    match length.outcome {
        IsostaticOutcome::Reached { product, .. } => format!(": C = {}", significant(product, 2)),
        IsostaticOutcome::NeverReached { .. } => ": not reached".into(),
        IsostaticOutcome::AboveFromTheStart { .. } => ": above throughout".into(),
        _ => ": none".into(),
    }
}
