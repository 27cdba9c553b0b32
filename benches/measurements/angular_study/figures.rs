//! G(θ) and S(f) of every p̂, means with their standard errors as bands, beside the scale-free spectrum and the fitted Lorentzians.

use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;

use jamscope::fit::angular::CrossoverOutcome;
use jamscope::observe::angular::Mean;
use jamscope::reference::lorentzian::{Lorentzian, USUAL_EXPONENT};
use jamscope::vector::larger;
use plotters::prelude::*;

use crate::sample::Plan;
use crate::summary::Summary;

/// Size of a picture \[px\].
const SIZE: (u32, u32) = (760, 520);

/// Okabe, Ito (2008), without yellow and black, and a grey: told apart by the colour-blind.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xE6, 0x9F, 0x00),
    RGBColor(0x56, 0xB4, 0xE9),
    RGBColor(0x77, 0x77, 0x77),
];

/// One curve.
struct Curve {
    name: String,
    colour: RGBColor,
    /// (x, mean, standard error).
    points: Vec<(f64, f64, f64)>,
}

fn curves(summaries: &[Summary], points: impl Fn(&Summary) -> Vec<(f64, Mean)>) -> Vec<Curve> {
    let curve = |(index, summary): (usize, &Summary)| Curve {
        name: format!("p̂ = {:.0e}, {} samples", summary.reduced_pressure, summary.sample_count),
        colour: COLOURS[index % COLOURS.len()],
        points: points(summary)
            .into_iter()
            .map(|(x, mean)| (x, mean.value, mean.standard_error.unwrap_or(0.0)))
            .collect(),
    };
    summaries.iter().enumerate().map(curve).collect()
}

/// The Lorentzian fitted to the spectra, or the limit that fits as well.
fn fitted(summary: &Summary) -> Option<Lorentzian> {
    match summary.crossover.outcome {
        CrossoverOutcome::Found { crossover, .. } => Lorentzian::new(crossover.best, USUAL_EXPONENT).ok(),
        _ => None,
    }
}

fn title(plan: &Plan, what: &str) -> String {
    format!("{what}, ring r/R = 0.5 ± 0.03, {} disks in the box", plan.disk_count)
}

/// G(θ).
pub fn correlation(path: &Path, plan: &Plan, summaries: &[Summary]) -> Result<(), Box<dyn Error>> {
    let curves = curves(summaries, |summary| {
        let angles = summary.correlation.angles.iter().map(|angle| angle / PI);
        angles.zip(summary.correlation.values.iter().copied()).collect()
    });
    let area = SVGBackend::new(path, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(title(plan, "Angular correlation G(θ)"), ("sans-serif", 17))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(56)
        .build_cartesian_2d(0.0..1.0, -1.05..1.05)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("θ/π")
        .y_desc("G")
        // Adding nothing to a negative zero makes it one without a sign.
        .y_label_formatter(&|g: &f64| format!("{:.1}", (10.0 * g).round() / 10.0 + 0.0))
        .label_style(("sans-serif", 14))
        .draw()?;
    chart.draw_series([PathElement::new([(0.0, 0.0), (1.0, 0.0)], BLACK.mix(0.3))])?;
    for curve in &curves {
        chart.draw_series([band(curve, f64::MIN)])?;
        let line = curve.points.iter().map(|&(x, mean, _)| (x, mean));
        let style = curve.colour.stroke_width(2);
        chart.draw_series(LineSeries::new(line, style))?.label(&curve.name).legend(move |(x, y)| legend(x, y, style));
    }
    let angles = || (0..=200).map(|step| f64::from(step) / 200.0);
    let scale_free = Lorentzian::scale_free(USUAL_EXPONENT)?;
    let style = BLACK.stroke_width(1);
    chart
        .draw_series(dashed(angles().map(|x| (x, scale_free.correlation(PI * x))), style))?
        .label("S ∝ f^−1.5")
        .legend(move |(x, y)| legend(x, y, style));
    for (summary, curve) in summaries.iter().zip(&curves) {
        if let Some(lorentzian) = fitted(summary) {
            let points = angles().map(|x| (x, lorentzian.correlation(PI * x)));
            chart.draw_series(dashed(points, curve.colour.stroke_width(1)))?;
        }
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .label_font(("sans-serif", 13))
        .background_style(WHITE.mix(0.8))
        .draw()?;
    area.present()?;
    Ok(())
}

/// S(f).
pub fn spectrum(path: &Path, plan: &Plan, summaries: &[Summary]) -> Result<(), Box<dyn Error>> {
    let curves = curves(summaries, |summary| {
        // A power removed of its leakage may be negative: it has no place on the axes.
        let means = summary.spectrum.spectrum.iter().copied().enumerate().skip(1);
        means.filter(|(_, mean)| mean.value > 0.0).map(|(f, mean)| (f as f64, mean)).collect()
    });
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let highest = points().map(|point| point.0).fold(1.0, larger);
    let lowest = -points().map(|point| -point.1).fold(-1.0, larger);
    let area = SVGBackend::new(path, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let bottom = 0.5 * lowest;
    let mut chart = ChartBuilder::on(&area)
        .caption(title(plan, "Angular power spectrum S(f)"), ("sans-serif", 17))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d((0.9..1.2 * highest).log_scale(), (bottom..4.0).log_scale())?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("f")
        .y_desc("S(f)/S(1)")
        .x_label_formatter(&|f| format!("{f:.0}"))
        .y_label_formatter(&|s| format!("{s:.0e}"))
        .label_style(("sans-serif", 14))
        .draw()?;
    for curve in &curves {
        chart.draw_series([band(curve, bottom)])?;
        let colour = curve.colour;
        chart.draw_series(curve.points.iter().map(|&(x, mean, _)| Circle::new((x, mean), 3, colour.filled())))?;
        let line = curve.points.iter().map(|&(x, mean, _)| (x, mean));
        chart
            .draw_series(LineSeries::new(line, colour.stroke_width(1)))?
            .label(&curve.name)
            .legend(move |(x, y)| legend(x, y, colour.stroke_width(2)));
    }
    let frequencies = || (0..=120).map(|step| highest.powf(f64::from(step) / 120.0));
    let style = BLACK.stroke_width(1);
    chart
        .draw_series(dashed(
            frequencies().map(|f| (f, f.powf(-USUAL_EXPONENT))).filter(|point| point.1 > bottom),
            style,
        ))?
        .label("f^−1.5")
        .legend(move |(x, y)| legend(x, y, style));
    for (summary, curve) in summaries.iter().zip(&curves) {
        if let Some(lorentzian) = fitted(summary) {
            let points = frequencies().map(|f| (f, lorentzian.spectrum(f))).filter(|point| point.1 > bottom);
            chart.draw_series(dashed(points, curve.colour.stroke_width(1)))?;
        }
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .label_font(("sans-serif", 13))
        .background_style(WHITE.mix(0.8))
        .draw()?;
    area.present()?;
    Ok(())
}

/// Mean ± standard error, not below the axes.
fn band(curve: &Curve, bottom: f64) -> Polygon<(f64, f64)> {
    let above = curve.points.iter().map(|&(x, mean, error)| (x, mean + error));
    let below = curve.points.iter().rev().map(|&(x, mean, error)| (x, (mean - error).max(bottom)));
    Polygon::new(above.chain(below).collect::<Vec<_>>(), curve.colour.mix(0.2))
}

fn dashed(
    points: impl Iterator<Item = (f64, f64)>,
    style: ShapeStyle,
) -> DashedLineSeries<std::vec::IntoIter<(f64, f64)>, i32> {
    DashedLineSeries::new(points.collect::<Vec<_>>(), 6, 4, style)
}

fn legend(x: i32, y: i32, style: ShapeStyle) -> PathElement<(i32, i32)> {
    PathElement::new([(x, y), (x + 18, y)], style)
}
