//! ℓ_s and ℓ_iso against the pressure, the curves from which ℓ_iso is read, and ξ below jamming.

use crate::report::figures::Figure;
use crate::report::figures::plot::{Guide, Plot, PlotAxis, PlotPoint, Series as Curve, Style, bare, colour};
use crate::report::number::with_error;
use crate::report::study::figure_data::{Subject, reduced, series_colour, short};
use crate::transition::{ISOSTATIC_THRESHOLD, JAMMING, JammingSeries, Series, poles};

/// Both lengths of every series.
pub(super) fn matching(subject: &Subject<'_>) -> Vec<Figure> {
    let all = &subject.transition.series;
    let figure = |(index, series): (usize, &Series)| {
        let colour = series_colour(index, all);
        let screening = series.lengths.iter().filter_map(|it| {
            let length = it.screening?;
            let interval = length.standard_error.map(|error| [length.mean - error, length.mean + error]);
            Some(PlotPoint { x: it.point.pressure, y: length.mean, interval })
        });
        let isostatic = series.lengths.iter().filter_map(|it| {
            let found = it.isostatic?.found;
            Some(PlotPoint { x: it.point.pressure, y: found.best, interval: found.interval })
        });
        let isostatic: Vec<PlotPoint> = isostatic.collect();
        let published =
            series.points.iter().map(|point| (point.pressure, 75.0 * libm::pow(point.pressure, -1.0 / 3.0)));
        let radius = series.points.iter().find_map(|point| subject.number(point.cell, "outer_radius"))?.mean;
        let some = !isostatic.is_empty();
        // ℓ_iso of a cell is of disks, and so is the figure.
        let curves = vec![
            Curve { label: "ℓₛ = 1/κ".into(), points: screening.collect(), style: Style::Points, colour },
            Curve { label: "ℓ_iso".into(), points: isostatic, style: Style::Joined, colour: [0x22; 3] },
            Curve {
                label: "75 p^(−1/3), published".into(),
                points: bare(published),
                style: Style::Dashed,
                colour: [0x77; 3],
            },
        ];
        some.then(|| Plot {
            title: format!("Screening and isostatic length, {}", short(series, all)),
            description: "Screening length of the screened samples and isostatic length against the pressure".into(),
            x: PlotAxis::logarithmic("p (force / length)"),
            y: PlotAxis::logarithmic("length"),
            series: curves,
            guides: vec![Guide::Horizontal(radius / poles(2)[0], "1/κ₁".into())],
        })?
        .draw()
    };
    all.iter().enumerate().filter_map(figure).collect()
}

/// y against r ΔZ, for bonds and for disks, one figure per series.
pub(super) fn fluctuations(subject: &Subject<'_>) -> Vec<Figure> {
    let all = &subject.transition.series;
    let mut figures = Vec::new();
    for series in all {
        let is_plane = subject.dimension() == 2;
        for (place, symbol, word) in [(2, "∥", "bonds"), (3, "ᵣ", subject.particles())] {
            let curves =
                series.lengths.iter().enumerate().filter(|(_, it)| !it.curve.is_empty()).map(|(index, it)| Curve {
                    label: reduced(it.point.reduced_pressure),
                    points: bare(it.curve.iter().map(|row| (row[1], row[place]))),
                    style: Style::Joined,
                    colour: colour(index, series.lengths.len().max(5)),
                });
            let plot = Plot {
                title: format!("Fluctuations of {word}, {}", short(series, all)),
                description: format!(
                    "Rescaled fluctuation of the displacement of {word} at one distance against rescaled distance, means over samples"
                ),
                x: PlotAxis::logarithmic("r ΔZ"),
                y: PlotAxis::logarithmic(format!(
                    "h{symbol}(r) {} / h{symbol}(1.5)",
                    if is_plane { "r ΔZ" } else { "(r ΔZ)²" }
                )),
                series: curves.collect(),
                guides: is_plane.then(|| Guide::Horizontal(ISOSTATIC_THRESHOLD, "1.3".into())).into_iter().collect(),
            };
            figures.extend(plot.draw());
        }
    }
    figures
}

/// ξ against φ and against φ_J − φ.
pub(super) fn jamming(subject: &Subject<'_>) -> Vec<Figure> {
    let all = &subject.transition.jamming;
    let mut thresholds: Vec<f64> = all.iter().map(|it| it.threshold).collect();
    thresholds.dedup();
    thresholds
        .into_iter()
        .flat_map(|threshold| {
            let own: Vec<&JammingSeries> = all.iter().filter(|it| it.threshold == threshold).collect();
            [penetration(&own, threshold, false), penetration(&own, threshold, true)]
        })
        .flatten()
        .collect()
}

fn penetration(all: &[&JammingSeries], threshold: f64, from_jamming: bool) -> Option<Figure> {
    let mut curves = Vec::new();
    for (index, series) in all.iter().enumerate() {
        let colour = colour(index, all.len());
        let x = |fraction: f64| if from_jamming { JAMMING - fraction } else { fraction };
        let points = series.points.iter().map(|point| {
            let interval = point.length.standard_error.map(|it| [point.length.mean - it, point.length.mean + it]);
            PlotPoint { x: x(point.packing_fraction), y: point.length.mean, interval }
        });
        let points: Vec<PlotPoint> = points.collect();
        let mut label = format!("{} disks", series.cell.disk_count);
        if all.iter().any(|other| other.cell.relaxer != series.cell.relaxer) {
            label = format!("{label}, {}", series.cell.relaxer.description());
        }
        if let Some(fit) = series.at_jamming.filter(|_| from_jamming) {
            label = format!("{label}, ν = {}", with_error(fit.exponent.value, fit.exponent.standard_error));
            let line =
                points.iter().map(|point| (point.x, fit.amplitude.value * libm::pow(point.x, -fit.exponent.value)));
            curves.push(Curve { label: String::new(), points: bare(line), style: Style::Line, colour });
        }
        curves.push(Curve { label, points, style: Style::Points, colour });
    }
    let (x, title) = match from_jamming {
        true => (PlotAxis::logarithmic("φ_J − φ, φ_J = 0.842"), "distance from jamming"),
        false => (PlotAxis::linear("φ"), "packing fraction"),
    };
    Plot {
        title: format!("Penetration length against {title}, threshold {threshold}"),
        description: format!(
            "How far from the inflated disk the mean displacement stays above {threshold}, against the {title}"
        ),
        x,
        y: PlotAxis::logarithmic("ξ (length)"),
        series: curves,
        guides: Vec::new(),
    }
    .draw()
}
