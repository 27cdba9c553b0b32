//! G* and θ* scaled with N and d_0; p_c in the plane of N^β p and N² d_0.

use std::f64::consts::PI;

use crate::law::choice::LawChoice;
use crate::relax::RelaxerChoice;
use crate::report::figures::Figure;
use crate::report::figures::palette::{BLUE, VERMILLION};
use crate::report::figures::plot::{Plot, PlotAxis, PlotPoint, Series as Curve, Style, bare};
use crate::report::study::subject::{Subject, series_colour, short};
use crate::transition::{
    ANGLE, ANTICORRELATION, Method, SCALE_FREE_ANTICORRELATION, Series as Cells, beta, laws_and_relaxers,
};

/// A law in words, with the relaxer if the study has several.
fn words(law: LawChoice, relaxer: RelaxerChoice, subject: &Subject<'_>) -> String {
    match subject.transition.series.iter().any(|series| series.cell.relaxer != relaxer) {
        true => format!("{}, {}", law.name(), relaxer.description()),
        false => law.name().into(),
    }
}

/// Whether a study has several inflations.
fn several(subject: &Subject<'_>) -> bool {
    let all = &subject.transition.series;
    all.iter().any(|series| series.cell.increase != all[0].cell.increase)
}

/// G* and θ* against p N^(β/2)/d_0^(β/4), one figure per law and relaxer.
pub(super) fn with_inflation(subject: &Subject<'_>) -> Vec<Figure> {
    if !several(subject) {
        return Vec::new();
    }
    let all = &subject.transition.series;
    let mut figures = Vec::new();
    for (law, relaxer) in laws_and_relaxers(all) {
        let beta = beta(&law);
        for (name, title, label, unit) in [(ANTICORRELATION, "G*", "G* = −G(π)", 1.0), (ANGLE, "θ*", "θ* / π", PI)]
        {
            let mut curves = Vec::new();
            for (index, series) in
                all.iter().enumerate().filter(|(_, it)| (it.cell.law, it.cell.relaxer) == (law, relaxer))
            {
                let scale = libm::pow(series.mobile_count(), 0.5 * beta) / libm::pow(series.cell.increase, 0.25 * beta);
                let points = subject.along(series, name, |point| point.pressure * scale);
                let points = points.iter().map(|point| PlotPoint {
                    y: point.y / unit,
                    interval: point.interval.map(|ends| ends.map(|end| end / unit)),
                    ..*point
                });
                let colour = series_colour(index, all);
                curves.push(Curve {
                    label: short(series, all),
                    points: points.collect(),
                    style: Style::Joined,
                    colour,
                });
            }
            let (a, b) = (0.5 * beta, 0.25 * beta);
            let plot = Plot {
                title: format!("{title} of all sizes and inflations, {}", words(law, relaxer, subject)),
                description: format!("Mean {title} against p N^{a}/d_0^{b} of several sizes and inflations"),
                x: PlotAxis::logarithmic(format!("p N^{a} / d₀^{b}")),
                y: PlotAxis::linear(label),
                series: curves,
                guides: Vec::new(),
            };
            figures.extend(plot.draw());
        }
    }
    figures
}

/// Every cell coloured by its G*, and p_c with its power law.
pub(super) fn phase_diagram(subject: &Subject<'_>) -> Vec<Figure> {
    if !several(subject) {
        return Vec::new();
    }
    let all = laws_and_relaxers(&subject.transition.series);
    all.into_iter().filter_map(|(law, relaxer)| diagram(subject, law, relaxer)).collect()
}

fn diagram(subject: &Subject<'_>, law: LawChoice, relaxer: RelaxerChoice) -> Option<Figure> {
    let beta = beta(&law);
    let (mut plastic, mut elastic) = (Vec::new(), Vec::new());
    let is_own = |series: &&Cells| (series.cell.law, series.cell.relaxer) == (law, relaxer);
    for series in subject.transition.series.iter().filter(is_own) {
        let mobile = series.mobile_count();
        for point in &series.points {
            let Some(found) = subject.number(point.cell, ANTICORRELATION) else { continue };
            let side = if found.mean < SCALE_FREE_ANTICORRELATION { &mut plastic } else { &mut elastic };
            side.push((libm::pow(mobile, beta) * point.pressure, mobile * mobile * series.cell.increase));
        }
    }
    let mut curves = vec![
        Curve {
            label: "G* below 0.293".into(),
            points: bare(plastic.into_iter()),
            style: Style::Points,
            colour: VERMILLION,
        },
        Curve { label: "G* above 0.293".into(), points: bare(elastic.into_iter()), style: Style::Points, colour: BLUE },
    ];
    let law_of = |method| {
        let mut all = subject.transition.pressure_laws.iter();
        all.find(|it| (it.law, it.relaxer, it.method) == (law, relaxer, method))
    };
    if let Some(found) = law_of(Method::Anticorrelation) {
        let points = bare(found.points.iter().map(|point| (point.y, point.x)));
        curves.push(Curve { label: "p_c by G*".into(), points, style: Style::Hollow, colour: [0x22; 3] });
        if let Some(fit) = &found.fit {
            let points = found
                .points
                .iter()
                .map(|point| (fit.amplitude.value * libm::pow(point.x, fit.exponent.value), point.x));
            let mut points: Vec<(f64, f64)> = points.collect();
            points.sort_by(|a, b| a.1.total_cmp(&b.1));
            let label = format!("exponent {:.2} ± {:.2}", fit.exponent.value, fit.exponent.standard_error);
            curves.push(Curve { label, points: bare(points.into_iter()), style: Style::Line, colour: [0x22; 3] });
            // A line with the published exponent through the middle of the points.
            let middle = found.points.len() / 2;
            let mut sorted = found.points.clone();
            sorted.sort_by(|a, b| a.x.total_cmp(&b.x));
            let through = sorted[middle];
            let line = sorted.iter().map(|point| (through.y * libm::pow(point.x / through.x, 0.25 * beta), point.x));
            let label = format!("exponent {}, published", 0.25 * beta);
            curves.push(Curve { label, points: bare(line), style: Style::Dashed, colour: [0x77; 3] });
        }
    }
    Plot {
        title: format!("Phase diagram, {}", words(law, relaxer, subject)),
        description: "Cells below and above the scale-free value of G* in the plane of rescaled pressure and inflation, with the transition".into(),
        x: PlotAxis::logarithmic(format!("N^{beta} p (force / length)")),
        y: PlotAxis::logarithmic("N² d₀ (length)"),
        series: curves,
        guides: Vec::new(),
    }
    .draw()
}
