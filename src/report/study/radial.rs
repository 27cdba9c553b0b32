//! Radial profiles of single samples and their means; angular modes and contact changes, cell by cell.

use crate::reference::elastic::Elastic;
use crate::reference::screened::Screened;
use crate::reference::{Annulus, RadialSolution};
use crate::report::figures::Figure;
use crate::report::figures::plot::{Guide, Plot, PlotAxis, PlotPoint, Series as Curve, Style, bare, colour};
use crate::report::study::figure_data::{Subject, series_colour, short, target, with_relaxer};
use crate::study::{CellSamples, Single};
use crate::transition::{Series, poles};
use crate::vector::larger;

/// Number of points of a fitted curve.
const CURVE_POINTS: u32 = 120;

/// Largest number of cells in a row.
const MOST_CELLS: usize = 6;

/// One sample of every cell with the solution that describes it better; r^(D−1) d_r over its largest value.
pub(super) fn singles(subject: &Subject<'_>) -> Vec<Figure> {
    let (size, increase) = base(subject);
    let cells: Vec<&CellSamples> =
        cells(subject).filter(|it| it.cell.disk_count == size && it.cell.increase == increase).collect();
    let weight = weight_of(subject);
    let mut curves = Vec::new();
    for (index, samples) in spread(&cells).into_iter().enumerate() {
        let Some(single) = samples.singles.first() else { continue };
        // Stored profiles are finite.
        let unit = single.profile.iter().map(|&[r, d]| (weight(r) * d).abs()).fold(0.0, larger);
        let radius = single.numbers.get("outer_radius").copied().unwrap_or(f64::NAN);
        let colour = colour(index, cells.len().clamp(5, MOST_CELLS));
        let points = bare(single.profile.iter().map(|&[r, d]| (r / radius, weight(r) * d / unit)));
        let label = with_relaxer(target(&samples.cell), &samples.cell, subject.merged);
        curves.push(Curve { label, points, style: Style::Points, colour });
        if let Some(solution) = solution(subject, single, radius) {
            let at = |step: u32| 0.05 + 0.95 * f64::from(step) / f64::from(CURVE_POINTS);
            let points = (0..=CURVE_POINTS)
                .map(at)
                .map(|share| (share, weight(share * radius) * solution(share * radius) / unit));
            curves.push(Curve { label: String::new(), points: bare(points), style: Style::Line, colour });
        }
    }
    let plot = Plot {
        title: format!("Radial profiles of single samples, {size} {}, d_0 = {increase}", subject.particles()),
        description:
            "Rescaled radial displacement of one sample of every cell over its largest value, with the better solution"
                .into(),
        x: PlotAxis::linear("r / R").within(0.0, 1.0),
        y: PlotAxis::linear(format!("{} / max", rescaled(subject))).within(-1.1, 1.1),
        series: curves,
        guides: vec![Guide::Horizontal(0.0, String::new())],
    };
    plot.draw().into_iter().collect()
}

/// The elastic solution fitted to a sample, or the screened one if its κ is not zero.
fn solution(subject: &Subject<'_>, single: &Single, radius: f64) -> Option<Box<dyn Fn(f64) -> f64>> {
    let inner = subject.merged.study.scene.mixture.components.iter().map(|it| it.radius).fold(f64::INFINITY, f64::min);
    let annulus = Annulus::new(inner, radius).ok()?;
    let number = |name: &str| single.numbers.get(name).copied();
    let kappa = number("wavenumber")?;
    let is_screened = kappa * radius >= 0.5 * poles(subject.spreading_dimension())[0];
    let amplitude = number(if is_screened { "screened_amplitude" } else { "elastic_amplitude" })?;
    let kappa = is_screened.then_some(kappa);
    match subject.spreading_dimension() {
        1 => solution_in::<1>(annulus, amplitude, kappa),
        3 => solution_in::<3>(annulus, amplitude, kappa),
        _ => solution_in::<2>(annulus, amplitude, kappa),
    }
}

/// The screened solution with κ, or else the elastic one.
fn solution_in<const D: usize>(
    annulus: Annulus,
    amplitude: f64,
    kappa: Option<f64>,
) -> Option<Box<dyn Fn(f64) -> f64>> {
    match kappa {
        Some(kappa) => {
            let solution = Screened::<D>::new(annulus, amplitude, kappa).ok()?;
            Some(Box::new(move |r| solution.value(r)))
        }
        None => {
            let solution = Elastic::<D>::new(annulus, amplitude).ok()?;
            Some(Box::new(move |r| solution.value(r)))
        }
    }
}

/// r^(D−1) of the rescaled displacement.
fn weight_of(subject: &Subject<'_>) -> impl Fn(f64) -> f64 + use<> {
    let power = subject.spreading_dimension() as i32 - 1;
    move |r| r.powi(power)
}

/// r^(D−1) d_r in symbols.
fn rescaled(subject: &Subject<'_>) -> &'static str {
    match subject.spreading_dimension() {
        1 => "dᵣ",
        3 => "r²·dᵣ",
        _ => "r·dᵣ",
    }
}

/// All cells with radial profiles.
fn cells<'a>(subject: &Subject<'a>) -> impl Iterator<Item = &'a CellSamples> {
    subject.merged.samples.iter().filter(|samples| samples.curves.contains_key("radial_profile"))
}

/// The largest size, and its inflation nearest to that of the study.
fn base(subject: &Subject<'_>) -> (usize, f64) {
    let size = cells(subject).map(|samples| samples.cell.disk_count).max().unwrap_or(0);
    let increases =
        cells(subject).filter(|samples| samples.cell.disk_count == size).map(|samples| samples.cell.increase);
    (size, increases.min_by(|a, b| (a - 0.1).abs().total_cmp(&(b - 0.1).abs())).unwrap_or(0.1))
}

/// As many cells as fit in a figure, including the first and the last.
fn spread<'a>(cells: &[&'a CellSamples]) -> Vec<&'a CellSamples> {
    let count = cells.len().min(MOST_CELLS);
    (0..count).map(|i| cells[i * (cells.len() - 1) / count.saturating_sub(1).max(1)]).collect()
}

/// Mean profiles r^(D−1) d_r/d_0: for every pressure at the base inflation, and for every inflation at every pressure.
pub(super) fn means(subject: &Subject<'_>) -> Vec<Figure> {
    let (size, increase) = base(subject);
    let all: Vec<&CellSamples> = cells(subject).filter(|it| it.cell.disk_count == size).collect();
    let at_base: Vec<&CellSamples> = all.iter().copied().filter(|it| it.cell.increase == increase).collect();
    let mut figures: Vec<Figure> = mean_figure(
        subject,
        format!("Mean radial profiles, {size} {}, d_0 = {increase}", subject.particles()),
        &spread(&at_base),
        |it| with_relaxer(target(&it.cell), &it.cell, subject.merged),
    )
    .into_iter()
    .collect();
    let mut targets: Vec<_> = all.iter().map(|it| it.cell.target).collect();
    targets.dedup();
    for of in targets {
        let own: Vec<&CellSamples> = all.iter().copied().filter(|it| it.cell.target == of).collect();
        if own.len() > 1 {
            let title =
                format!("Mean radial profiles by inflation, {size} {}, {}", subject.particles(), target(&own[0].cell));
            figures.extend(mean_figure(subject, title, &spread(&own), |it| {
                with_relaxer(format!("d_0 = {}", it.cell.increase), &it.cell, subject.merged)
            }));
        }
    }
    figures
}

fn mean_figure(
    subject: &Subject<'_>,
    title: String,
    cells: &[&CellSamples],
    label: impl Fn(&CellSamples) -> String,
) -> Option<Figure> {
    let weight = weight_of(subject);
    let mut curves = Vec::new();
    let mut widest = 0.0f64;
    for (index, samples) in cells.iter().enumerate() {
        let radii = samples.numbers.get("outer_radius")?;
        let radius = radii.iter().sum::<f64>() / radii.len() as f64;
        widest = widest.max(radius);
        let points = samples.curves.get("radial_profile")?.points();
        let unit = samples.cell.increase;
        let points = points.iter().map(|point| {
            let error = point.standard_error.unwrap_or(0.0);
            let interval = Some([-1.0, 1.0].map(|sign| weight(point.x) * (point.y + sign * error) / unit));
            PlotPoint { x: point.x / radius, y: weight(point.x) * point.y / unit, interval }
        });
        let colour = colour(index, cells.len().max(5));
        curves.push(Curve { label: label(samples), points: points.collect(), style: Style::Joined, colour });
    }
    let inner = subject.merged.study.scene.mixture.components.iter().map(|it| it.radius).fold(f64::INFINITY, f64::min);
    let annulus = Annulus::new(inner, widest).ok()?;
    let elastic = match subject.spreading_dimension() {
        1 => solution_in::<1>(annulus, 1.0, None)?,
        3 => solution_in::<3>(annulus, 1.0, None)?,
        _ => solution_in::<2>(annulus, 1.0, None)?,
    };
    let at = |step: u32| 0.02 + 0.98 * f64::from(step) / f64::from(CURVE_POINTS);
    let exact = bare((0..=CURVE_POINTS).map(at).map(|share| (share, weight(share * widest) * elastic(share * widest))));
    curves.push(Curve { label: "elastic".into(), points: exact, style: Style::Dashed, colour: [0x22; 3] });
    Plot {
        title,
        description:
            "Mean rescaled radial displacement over the inflation, with standard errors, and the elastic solution"
                .into(),
        x: PlotAxis::linear("r / R").within(0.0, 1.0),
        y: PlotAxis::linear(match subject.spreading_dimension() {
            1 => "dᵣ / d₀ (1)",
            3 => "r²·dᵣ / d₀ (length²)",
            _ => "r·dᵣ / d₀ (length)",
        }),
        series: curves,
        guides: vec![Guide::Horizontal(0.0, String::new())],
    }
    .draw()
}

/// Shares of the first angular modes, one point per sample, of every cell in the periodic box.
pub(super) fn modes(subject: &Subject<'_>) -> Vec<Figure> {
    let names = ["isotropic", "dipole", "quadrupole", "rest"];
    let periodic = |samples: &&CellSamples| samples.cell.boundary == crate::inflation::Boundary::Periodic;
    let figure = |samples: &CellSamples| {
        let curve = |(index, name): (usize, &&str)| {
            let values = samples.numbers.get(&format!("share_{name}"))?;
            let points = bare(values.iter().enumerate().map(|(place, &value)| ((place + 1) as f64, value)));
            Some(Curve { label: (*name).into(), points, style: Style::Joined, colour: colour(index, names.len()) })
        };
        let series: Vec<Curve> = names.iter().enumerate().filter_map(curve).collect();
        Plot {
            title: format!(
                "Angular modes, periodic box, {} disks, {}",
                samples.cell.disk_count,
                with_relaxer(target(&samples.cell), &samples.cell, subject.merged)
            ),
            description:
                "Shares of the angular modes of the radial displacement at half of the outer radius, sample by sample"
                    .into(),
            x: PlotAxis::linear("sample"),
            y: PlotAxis::linear("share of ⟨dᵣ²⟩").within(0.0, 1.0),
            series,
            guides: Vec::new(),
        }
        .draw()
    };
    subject.merged.samples.iter().filter(periodic).filter_map(figure).collect()
}

/// Contacts changed and restored, for all series.
pub(super) fn contacts(subject: &Subject<'_>) -> Vec<Figure> {
    let all = &subject.transition.series;
    let along = |series: &Series, name: &str| subject.along(series, name, |point| point.reduced_pressure);
    let (mut changes, mut returns) = (Vec::new(), Vec::new());
    for (index, series) in all.iter().enumerate() {
        // Both have the colour of the series.
        let named =
            [("contacts_made", short(series, all), Style::Joined), ("contacts_broken", String::new(), Style::Hollow)];
        for (name, label, style) in named {
            changes.push(Curve { label, points: along(series, name), style, colour: series_colour(index, all) });
        }
        let points = along(series, "contacts_returned_share");
        returns.push(Curve {
            label: short(series, all),
            points,
            style: Style::Joined,
            colour: series_colour(index, all),
        });
    }
    let plot = |title: &str, label: &str, series, logarithmic| Plot {
        title: title.into(),
        description: format!("{title}: means over samples with bootstrap intervals against the reduced pressure"),
        x: PlotAxis::logarithmic(if subject.dimension() == 3 {
            "p̂ (force / length²)"
        } else {
            "p̂ (force / length)"
        }),
        y: if logarithmic { PlotAxis::logarithmic(label) } else { PlotAxis::linear(label).within(0.0, 1.05) },
        series,
        guides: Vec::new(),
    };
    let both = [
        plot("Contacts changed by the inflation", "contacts made (broken, hollow) per sample", changes, true),
        plot("Share of changed contacts that return on deflation", "share", returns, false),
    ];
    both.into_iter().filter_map(Plot::draw).collect()
}
