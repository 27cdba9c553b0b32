//! G(θ) and S(f) of every cell of a series, and S(f) in rings.

use std::f64::consts::PI;

use crate::reference::lorentzian::{Lorentzian, USUAL_EXPONENT};
use crate::report::figures::Figure;
use crate::report::figures::plot::{Guide, Plot, PlotAxis, PlotPoint, Series as Curve, Style, bare, colour};
use crate::report::number::significant;
use crate::report::study::figure_data::{Subject, reduced, short};
use crate::study::{MeanCurve, MeanPoint};
use crate::transition::{RingSlope, Series, SeriesPoint};

/// G(θ) and S(f) at every p̂ of the series with the base inflation.
pub(super) fn functions(subject: &Subject<'_>) -> Vec<Figure> {
    let all = &subject.transition.series;
    let largest = all.iter().map(|series| series.cell.increase).fold(0.0, f64::max);
    // With several inflations: the one nearest to that of the study.
    let away = |series: &&Series| (series.cell.increase - 0.1f64.min(largest)).abs();
    let nearest = all.iter().map(|series| away(&series)).fold(f64::INFINITY, f64::min);
    let chosen = all.iter().filter(|series| away(series) <= nearest + 1e-12);
    let of = |series| match subject.dimension() {
        3 => [shell_correlation(subject, series), shell_spectrum(subject, series)],
        _ => [correlation(subject, series), spectrum(subject, series)],
    };
    chosen.flat_map(of).flatten().collect()
}

fn with_error(point: &MeanPoint, unit: f64) -> PlotPoint {
    let interval = point.standard_error.map(|error| [(point.y - error) / unit, (point.y + error) / unit]);
    PlotPoint { x: point.x, y: point.y / unit, interval }
}

fn correlation(subject: &Subject<'_>, series: &Series) -> Option<Figure> {
    let mut curves = Vec::new();
    for (index, point) in series.points.iter().enumerate() {
        let Some(curve) = subject.samples(point).curves.get("angular_correlation") else { continue };
        curves.push(Curve {
            label: reduced(point.reduced_pressure),
            points: bare(curve.points().iter().map(|point| (point.x / PI, point.y))),
            style: Style::Line,
            colour: colour(index, series.points.len().max(5)),
        });
    }
    let scale_free = Lorentzian::scale_free(USUAL_EXPONENT).ok()?;
    let exact = (0..=100).map(|step| f64::from(step) / 100.0).map(|share| (share, scale_free.correlation(PI * share)));
    curves.push(dashed("S ∼ f^−1.5", exact));
    (curves.len() > 1)
        .then(|| Plot {
            title: format!("G(θ), {}", short(series, &subject.transition.series)),
            description: "Mean angular correlation at several reduced pressures, and of a scale-free spectrum".into(),
            x: PlotAxis::linear("θ / π").within(0.0, 1.0),
            y: PlotAxis::linear("G(θ)").within(-0.6, 1.0),
            series: curves,
            guides: vec![Guide::Horizontal(0.0, String::new()), Guide::Horizontal(0.1, "G = 0.1".into())],
        })?
        .draw()
}

/// The mean curves of a name at every p̂ of a series.
fn means(subject: &Subject<'_>, series: &Series, name: &str, style: Style, unit: f64) -> Vec<Curve> {
    let count = series.points.len().max(5);
    let of = |(index, point): (usize, &SeriesPoint)| {
        let points = subject.samples(point).curves.get(name)?.points();
        let points = points.iter().map(|point| PlotPoint { x: point.x / unit, ..with_error(point, 1.0) }).collect();
        Some(Curve { label: reduced(point.reduced_pressure), points, style, colour: colour(index, count) })
    };
    series.points.iter().enumerate().filter_map(of).collect()
}

fn shell_correlation(subject: &Subject<'_>, series: &Series) -> Option<Figure> {
    let curves = means(subject, series, "shell_correlation", Style::Joined, PI);
    (!curves.is_empty())
        .then(|| Plot {
            title: format!("G(γ), {}", short(series, &subject.transition.series)),
            description: "Mean angular correlation in the shell at several reduced pressures, with standard errors"
                .into(),
            x: PlotAxis::linear("γ / π").within(0.0, 1.0),
            y: PlotAxis::linear("G(γ)").within(-0.6, 1.0),
            series: curves,
            guides: vec![Guide::Horizontal(0.0, String::new()), Guide::Horizontal(0.1, "G = 0.1".into())],
        })?
        .draw()
}

fn shell_spectrum(subject: &Subject<'_>, series: &Series) -> Option<Figure> {
    let curves = means(subject, series, "shell_spectrum", Style::Joined, 1.0);
    (!curves.is_empty())
        .then(|| Plot {
            title: format!("S(ℓ), {}", short(series, &subject.transition.series)),
            description: "Mean power of a harmonic over the variance in the shell, with standard errors".into(),
            x: PlotAxis::linear("ℓ"),
            y: PlotAxis::linear("S(ℓ) / ⟨δdᵣ²⟩"),
            series: curves,
            guides: vec![Guide::Horizontal(0.0, String::new())],
        })?
        .draw()
}

fn dashed(label: &str, points: impl Iterator<Item = (f64, f64)>) -> Curve {
    Curve { label: label.into(), points: bare(points), style: Style::Dashed, colour: [0x22; 3] }
}

/// S normalised to S(1) = 1, as in the study.
fn normalised(curve: &MeanCurve) -> Vec<PlotPoint> {
    let points = curve.points();
    let Some(first) = points.first().filter(|first| first.y > 0.0) else { return Vec::new() };
    points.iter().filter(|point| point.count == first.count).map(|point| with_error(point, first.y)).collect()
}

fn power_law() -> Curve {
    let points =
        (0..=40).map(|step| libm::pow(10.0, f64::from(step) / 20.0)).map(|f| (f, libm::pow(f, -USUAL_EXPONENT)));
    dashed("f^−1.5", points)
}

fn spectrum(subject: &Subject<'_>, series: &Series) -> Option<Figure> {
    let count = series.points.len().max(5);
    let (mut curves, mut fits, mut highest) = (Vec::new(), Vec::new(), 1.0f64);
    for (index, point) in series.points.iter().enumerate() {
        let Some(curve) = subject.samples(point).curves.get("power_spectrum") else { continue };
        let (points, colour) = (normalised(curve), colour(index, count));
        highest = points.iter().map(|point| point.x).fold(highest, f64::max);
        curves.push(Curve { label: reduced(point.reduced_pressure), points, style: Style::Points, colour });
        let found = series.spectra.iter().find(|it| it.point.cell == point.cell).and_then(|it| it.crossover?.found());
        if let Some(lorentzian) = found.and_then(|found| Lorentzian::new(found, USUAL_EXPONENT).ok()) {
            let points = (0..=60).map(|step| libm::pow(24.0, f64::from(step) / 60.0));
            let points = bare(points.map(|f| (f, lorentzian.spectrum(f) / lorentzian.spectrum(1.0))));
            fits.push(Curve { label: String::new(), points, style: Style::Line, colour });
        }
    }
    if curves.is_empty() {
        return None;
    }
    curves.extend(fits);
    curves.push(power_law());
    Plot {
        title: format!("S(f), {}", short(series, &subject.transition.series)),
        description: "Mean angular power spectrum at several reduced pressures with fitted Lorentzians".into(),
        x: PlotAxis::logarithmic("f").within(0.9, 1.1 * highest),
        y: PlotAxis::logarithmic("S(f) / S(1)").within(1e-3, 3.0),
        series: curves,
        guides: Vec::new(),
    }
    .draw()
}

/// S(f) in rings, for the cell of every series nearest to the transition, and its slopes.
pub(super) fn by_radius(subject: &Subject<'_>) -> Vec<Figure> {
    let all = &subject.transition.series;
    let mut figures = Vec::new();
    let mut slopes = Vec::new();
    for (index, series) in all.iter().enumerate() {
        let slope = |cell: usize| series.spectra.iter().find(|it| it.point.cell == cell)?.slope.map(|it| it.best);
        let away = |point: &&crate::transition::SeriesPoint| slope(point.cell).map_or(f64::MAX, |s| (s - 1.5).abs());
        let Some(point) = series.points.iter().min_by(|a, b| away(a).total_cmp(&away(b))) else { continue };
        let samples = subject.samples(point);
        let found = RingSlope::of(samples);
        if found.is_empty() {
            continue;
        }
        let mut curves = Vec::new();
        for (place, ring) in found.iter().enumerate() {
            let Some(curve) = samples.curves.get(&format!("power_spectrum_at_{}", ring.relative_radius)) else {
                continue;
            };
            let label = format!("r̂ = {}", ring.relative_radius);
            let points = normalised(curve).iter().map(|point| PlotPoint { interval: None, ..*point }).collect();
            curves.push(Curve { label, points, style: Style::Points, colour: colour(place, found.len().max(5)) });
        }
        curves.push(power_law());
        let plot = Plot {
            title: format!("S(f) by distance, {}, {}", short(series, all), reduced(point.reduced_pressure)),
            description: "Mean angular power spectrum in rings from the inflated disk to the rim".into(),
            x: PlotAxis::logarithmic("f"),
            y: PlotAxis::logarithmic("S(f) / S(1)").within(1e-3, 3.0),
            series: curves,
            guides: Vec::new(),
        };
        figures.extend(plot.draw());
        let points = found.iter().map(|ring| PlotPoint {
            x: ring.relative_radius,
            y: ring.slope,
            interval: Some([ring.slope - ring.standard_error, ring.slope + ring.standard_error]),
        });
        slopes.push(Curve {
            label: format!("{}, p̂ = {}", short(series, all), significant(point.reduced_pressure, 1)),
            points: points.collect(),
            style: Style::Joined,
            colour: colour(index, all.len()),
        });
    }
    let plot = Plot {
        title: "Slope of S(f) by distance".into(),
        description: "Slope of the mean angular power spectrum against the distance of the ring".into(),
        x: PlotAxis::linear("r̂ = r/R").within(0.0, 1.0),
        y: PlotAxis::linear("s of S ∼ f^−s"),
        series: slopes,
        guides: vec![Guide::Horizontal(1.5, "1.5".into())],
    };
    figures.extend(plot.draw());
    figures
}
