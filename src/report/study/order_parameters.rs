//! κ, Δp, G*, θ*, θ† against the pressure.

use std::f64::consts::PI;

use crate::reference::lorentzian::{Lorentzian, USUAL_EXPONENT};
use crate::report::figures::Figure;
use crate::report::figures::plot::{Guide, Plot, PlotAxis, PlotPoint, Series as Curve, Style, bare, colour};
use crate::report::study::figure_data::{Subject, series_colour, short};
use crate::study::NumberStatistics;
use crate::transition::{
    ANGLE, ANTICORRELATION, PUBLISHED, SCALE_FREE_ANGLE, SCALE_FREE_ANTICORRELATION, Series, beta, poles,
};

/// Largest number of samples of a cell drawn as points.
const SINGLES: usize = 200;

/// κ and Δp, one point per sample, with connected means.
pub(super) fn by_sample(subject: &Subject<'_>) -> Vec<Figure> {
    let [first, second] = poles(subject.spreading_dimension());
    let scaled = |values: &[f64], radius: f64| values.iter().map(|kappa| kappa * radius / first).collect();
    let kappa = figure(subject, "wavenumber", "κ of the best screened solution", "κ / κ₁", &scaled);
    let change = figure(
        subject,
        "scaled_pressure_change",
        "pressure change",
        "Δp / p^((α−2)/(α−1))",
        &|values: &[f64], _| values.to_vec(),
    );
    let mut kappa = kappa;
    if let Some(plot) = &mut kappa {
        plot.guides = vec![
            Guide::Horizontal(1.0, "κ₁".into()),
            Guide::Horizontal(second / first, "κ₂".into()),
            Guide::Horizontal(0.5, "counted as screened above".into()),
        ];
    }
    [kappa, change].into_iter().flatten().filter_map(Plot::draw).collect()
}

fn figure(
    subject: &Subject<'_>,
    name: &str,
    title: &str,
    label: &str,
    scaled: &dyn Fn(&[f64], f64) -> Vec<f64>,
) -> Option<Plot> {
    let all = &subject.transition.series;
    let mut curves = Vec::new();
    for (index, series) in all.iter().enumerate() {
        let (mut points, mut means) = (Vec::new(), Vec::new());
        for point in &series.points {
            let samples = subject.samples(point);
            let (Some(values), Some(radii)) = (samples.numbers.get(name), samples.numbers.get("outer_radius")) else {
                continue;
            };
            let values = scaled(values, radii.iter().sum::<f64>() / radii.len() as f64);
            points.extend(bare(values.iter().take(SINGLES).map(|&value| (point.reduced_pressure, value))));
            let mean = NumberStatistics::of(&values);
            means.push(PlotPoint { x: point.reduced_pressure, y: mean.mean, interval: mean.mean_interval });
        }
        let colour = series_colour(index, all);
        let pale = colour.map(|part| 255 - (255 - part) / 3);
        curves.push(Curve { label: String::new(), points, style: Style::Points, colour: pale });
        curves.push(Curve { label: short(series, all), points: means, style: Style::Joined, colour });
    }
    curves.iter().any(|curve| !curve.points.is_empty()).then(|| Plot {
        title: format!("{title} against p̂"),
        description: format!("{title} of single samples and means over samples against the reduced pressure"),
        x: PlotAxis::logarithmic(reduced_axis(subject)),
        y: PlotAxis::linear(label),
        series: curves,
        guides: Vec::new(),
    })
}

/// The axis of p̂.
fn reduced_axis(subject: &Subject<'_>) -> &'static str {
    if subject.dimension() == 3 {
        "p̂ = p N^(2(α−1)/3) (force / length²)"
    } else {
        "p̂ = p Nᵅ⁻¹ (force / length)"
    }
}

/// The abscissa of a figure.
#[derive(Clone, Copy)]
pub(super) enum Abscissa {
    /// p.
    Pressure,
    /// p N^(α−1).
    Reduced,
    /// p N^(3/2), for any law.
    AsHertzian,
}

/// G* and θ* for all series.
pub(super) fn against(subject: &Subject<'_>, abscissa: Abscissa) -> Vec<Figure> {
    let one = |name, title: &str, label: &str, unit: f64, guide: f64| {
        subject_plot(subject, name, title, label, unit, guide, abscissa).draw()
    };
    let depth = one(ANTICORRELATION, "G*", "G* = −G(π)", 1.0, SCALE_FREE_ANTICORRELATION);
    let symbol = subject.angle();
    let angle = one(ANGLE, &format!("{symbol}*"), &format!("{symbol}* / π"), PI, SCALE_FREE_ANGLE / PI);
    [depth, angle].into_iter().flatten().collect()
}

/// θ* at another threshold of G for all series.
pub(super) fn threshold(subject: &Subject<'_>, threshold: &str) -> Option<Figure> {
    let name = format!("correlation_angle_at_{threshold}");
    let symbol = subject.angle();
    let title = format!("{symbol}*, G = {threshold}");
    subject_plot(subject, &name, &title, &format!("{symbol}* / π"), PI, f64::NAN, Abscissa::Reduced).draw()
}

fn subject_plot(
    subject: &Subject<'_>,
    name: &str,
    title: &str,
    label: &str,
    unit: f64,
    guide: f64,
    abscissa: Abscissa,
) -> Plot {
    let all = &subject.transition.series;
    let (x_label, words) = match abscissa {
        Abscissa::Pressure if subject.dimension() == 3 => ("p (force / length²)", "p"),
        Abscissa::Pressure => ("p (force / length)", "p"),
        Abscissa::Reduced => (reduced_axis(subject), "p̂"),
        Abscissa::AsHertzian => ("p N^(3/2) (force / length)", "p N^(3/2)"),
    };
    let mut curves = Vec::new();
    for (index, series) in all.iter().enumerate() {
        let at = |point: &crate::transition::SeriesPoint| match abscissa {
            Abscissa::Pressure => point.pressure,
            Abscissa::Reduced => point.reduced_pressure,
            Abscissa::AsHertzian => point.pressure * libm::pow(series.mobile_count(), 1.5),
        };
        let mut points = subject.along(series, name, at);
        scale(&mut points, unit);
        curves.push(Curve {
            label: short(series, all),
            points,
            style: Style::Joined,
            colour: series_colour(index, all),
        });
        if name == ANGLE && matches!(abscissa, Abscissa::Reduced) {
            curves.push(crossover_angles(series, index, all));
        }
    }
    // Both guides are of disks.
    let mut guides = Vec::new();
    if subject.dimension() == 2 {
        guides.push(Guide::Horizontal(guide, "S ∼ f^−1.5".into()));
    }
    if subject.dimension() == 2
        && matches!(abscissa, Abscissa::Reduced)
        && all.iter().all(|series| beta(&series.cell.law) == 3.0)
    {
        guides.push(Guide::Vertical(PUBLISHED, "published".into()));
    }
    Plot {
        title: format!("{title} against {words}"),
        description: format!("Mean {title} of {} series with bootstrap intervals against {words}", all.len()),
        x: PlotAxis::logarithmic(x_label),
        y: PlotAxis::linear(label),
        series: curves,
        guides,
    }
}

fn scale(points: &mut [PlotPoint], unit: f64) {
    for point in points {
        point.y /= unit;
        point.interval = point.interval.map(|ends| ends.map(|end| end / unit));
    }
}

/// θ†, hollow, up to the largest possible correlation angle.
fn crossover_angles(series: &Series, index: usize, all: &[Series]) -> Curve {
    let points = series.spectra.iter().filter_map(|spectrum| {
        let (angle, error) = spectrum.angle()?;
        let interval = Some([angle - error, angle + error].map(|end| end / PI));
        Some(PlotPoint { x: spectrum.point.reduced_pressure, y: angle / PI, interval })
    });
    let points = points.filter(|point| point.y < 1.0).collect();
    let label = if index == 0 { "θ† / π, hollow".into() } else { String::new() };
    Curve { label, points, style: Style::Hollow, colour: series_colour(index, all) }
}

/// θ† against the distance from the transition, with the fit; θ* against f†, with the exact curve.
pub(super) fn crossovers(subject: &Subject<'_>) -> Vec<Figure> {
    let all = &subject.transition.series;
    let (mut curves, mut angles) = (Vec::new(), Vec::new());
    for (index, series) in all.iter().enumerate() {
        let colour = series_colour(index, all);
        if let Some(fit) = &series.divergence.at_transition {
            let below = series.spectra.iter().filter_map(|spectrum| {
                let (y, error) = spectrum.angle()?;
                let x = (fit.critical - spectrum.point.reduced_pressure) / fit.critical;
                (x > 0.0).then_some(PlotPoint { x, y: y / PI, interval: Some([(y - error) / PI, (y + error) / PI]) })
            });
            let points: Vec<PlotPoint> = below.collect();
            let line = points.iter().map(|point| {
                (point.x, fit.amplitude.value * libm::pow(point.x * fit.critical, -fit.exponent.value) / PI)
            });
            let line = bare(line);
            let label =
                format!("{}, μ = {:.2} ± {:.2}", short(series, all), fit.exponent.value, fit.exponent.standard_error);
            curves.push(Curve { label, points, style: Style::Points, colour });
            curves.push(Curve { label: String::new(), points: line, style: Style::Line, colour });
        }
        let points = series.spectra.iter().filter_map(|spectrum| {
            let found = spectrum.crossover?.found()?;
            let angle = subject.number(spectrum.point.cell, ANGLE)?;
            let interval = angle.mean_interval.map(|ends| ends.map(|end| end / PI));
            Some(PlotPoint { x: found, y: angle.mean / PI, interval })
        });
        angles.push(Curve { label: short(series, all), points: points.collect(), style: Style::Points, colour });
    }
    let divergence = Plot {
        title: "θ† below the transition".into(),
        description: "Crossover angle against the relative distance from the transition, with power laws".into(),
        x: PlotAxis::logarithmic("(p̂_c − p̂) / p̂_c"),
        y: PlotAxis::logarithmic("θ† / π"),
        series: curves,
        guides: Vec::new(),
    };
    let exact = (0..=80).filter_map(|step| {
        let crossover = 0.1 * libm::pow(10.0, f64::from(step) * 3.0 / 80.0);
        let angle = Lorentzian::new(crossover, USUAL_EXPONENT).ok()?.crossing(0.1).ok()?.angle()?;
        Some((crossover, angle / PI))
    });
    let measured = angles.iter().any(|curve| !curve.points.is_empty());
    let exact = Curve { label: "exact".into(), points: bare(exact), style: Style::Line, colour: colour(3, 4) };
    angles.push(exact);
    let relation = measured.then(|| Plot {
        title: "θ* against f†".into(),
        description: "Correlation angle against crossover frequency, measured and of a Lorentzian spectrum".into(),
        x: PlotAxis::logarithmic("f†"),
        y: PlotAxis::logarithmic("θ* / π"),
        series: angles,
        guides: Vec::new(),
    });
    [Some(divergence), relation].into_iter().flatten().filter_map(Plot::draw).collect()
}
