//! Protocols in a report: rows of the table, the endings as CSV and on the page, a sentence on the ensemble.

use std::fmt::Write as _;

use crate::protocol::{Ending, ProtocolSensitivity, Spread};
use crate::relax::{Criterion, Stop};
use crate::report::number::{count, pressure_unit, significant};
use crate::report::rows::section::{Rows, Section};
use crate::run::{Report, SampleReport, SampleResult};

/// The comparison of a sample, if it was made.
pub(crate) fn measured(result: &SampleResult) -> Option<&ProtocolSensitivity> {
    result.protocol.as_ref()?.measured().map(Box::as_ref)
}

/// The rows of the table.
pub(crate) fn section(report: &Report, samples: &[SampleReport]) -> Section {
    let dimension = report.scene.dimension;
    let mut rows = Rows::of_samples(samples);
    let deviation = |spread: Option<Spread>| {
        spread.filter(|spread| spread.count > 1).map(|spread| significant(spread.standard_deviation, 2))
    };
    rows.add("protocols, at rest", |it| {
        let sensitivity = measured(it)?;
        let at_rest = sensitivity.endings.iter().filter(|ending| ending.at_rest()).count();
        Some(format!("{}, {at_rest}", sensitivity.endings.len()))
    })
    .add("minima", |it| measured(it).map(|it| count(it.minimum_count)))
    .add("relaxers in each minimum", |it| {
        let sensitivity = measured(it).filter(|it| it.minimum_count > 0)?;
        let members = |minimum| sensitivity.endings.iter().filter(|it| it.minimum == Some(minimum)).count();
        let counts = (1..=sensitivity.minimum_count).map(|minimum| members(minimum).to_string());
        Some(counts.collect::<Vec<_>>().join(" + "))
    })
    .add("largest distance [length]", |it| {
        measured(it).filter(|it| it.minimum_count > 0).map(|it| significant(it.largest_distance, 3))
    })
    .add("disks that differ, at most", |it| {
        let sensitivity = measured(it).filter(|it| it.minimum_count > 0)?;
        sensitivity.endings.iter().map(|ending| ending.differing.len()).max().map(count)
    })
    .add("contacts that differ, at most", |it| {
        measured(it)?.endings.iter().filter_map(|ending| ending.contact_difference_count).max().map(count)
    })
    .add(format!("scatter of minima: Δp [{}]", pressure_unit(dimension)), |it| {
        deviation(measured(it)?.spreads.pressure_change)
    })
    .add("scatter of minima: G*", |it| deviation(measured(it)?.spreads.anticorrelation))
    .add(format!("scatter of minima: {} [rad]", angle(dimension)), |it| {
        deviation(measured(it)?.spreads.correlation_angle)
    })
    .add("scatter of minima: contact changes", |it| deviation(measured(it)?.spreads.contact_change_count));
    #[cfg(feature = "fit")]
    rows.add("scatter of minima: elastic d_0^eff", |it| deviation(measured(it)?.spreads.elastic_amplitude))
        .add("scatter of minima: screened d_0^eff", |it| deviation(measured(it)?.spreads.screened_amplitude))
        .add("scatter of minima: κ [1/length]", |it| deviation(measured(it)?.spreads.wavenumber));
    rows.section("Protocols")
}

/// A summary of the compared samples.
pub(crate) fn summary(report: &Report) -> Option<String> {
    let all = report.protocol.as_ref()?;
    let mut text = format!(
        "Protocols: {} of {} samples compared, {} of them with more than one minimum ({} on average), largest distance {}",
        all.compared_count,
        all.sample_count,
        all.several_minima_count,
        significant(all.mean_minimum_count, 3),
        significant(all.largest_distance, 3),
    );
    let bars = [
        ("Δp", all.pressure_change),
        ("G*", all.anticorrelation),
        (angle(report.scene.dimension), all.correlation_angle),
        ("contact changes", all.contact_change_count),
        #[cfg(feature = "fit")]
        ("elastic d_0^eff", all.elastic_amplitude),
        #[cfg(feature = "fit")]
        ("screened d_0^eff", all.screened_amplitude),
        #[cfg(feature = "fit")]
        ("κ", all.wavenumber),
    ];
    for (name, deviation) in bars {
        if let Some(deviation) = deviation {
            let _ = write!(text, "; {name} ± {}", significant(deviation, 2));
        }
    }
    Some(text + " (standard deviations over minima, root mean square over samples).")
}

/// Why a relaxer stopped, in words.
fn stop(stop: Stop) -> &'static str {
    match stop {
        Stop::Converged(Criterion::Unjammed) => "no contacts",
        Stop::Converged(_) => "at rest",
        Stop::StepLimit => "step limit",
        Stop::RoundingFloor => "rounding floor",
        Stop::NonFinite => "not finite",
        Stop::Underflow => "underflow",
        Stop::Unstable => "unstable",
        Stop::EnergyGained => "energy gained",
        Stop::NoMinimum => "no minimum",
        Stop::Stagnation => "does not come to rest",
        Stop::OutOfMemory => "out of memory",
        Stop::NoDescent => "no descent",
        Stop::Interrupted => "interrupted",
    }
}

/// The angle at which G falls to its threshold, on a ring or a shell.
fn angle(dimension: usize) -> &'static str {
    if dimension == 3 { "γ*" } else { "θ*" }
}

/// Names and units of the columns of the endings; the pressure is that of disks.
const COLUMNS: [(&str, &str); 18] = [
    ("relaxer", "1"),
    ("stop", "1"),
    ("minimum", "1"),
    ("distance", "length"),
    ("differing_disk_count", "1"),
    ("contact_difference_count", "1"),
    ("contact_count", "1"),
    ("energy", "energy"),
    ("pressure_change", "force/length"),
    ("anticorrelation", "1"),
    ("correlation_angle", "rad"),
    ("made_contact_count", "1"),
    ("broken_contact_count", "1"),
    ("elastic_amplitude", "length"),
    ("screened_amplitude", "length"),
    ("wavenumber", "1/length"),
    ("force_evaluation_count", "1"),
    ("factorisation_count", "1"),
];

/// The endings: a row of names, a row of units, one row per ending; missing numbers are empty fields.
pub(crate) fn csv(sensitivity: &ProtocolSensitivity, dimension: usize) -> String {
    let of_dimension = |(name, unit)| (name, if unit == "force/length" { pressure_unit(dimension) } else { unit });
    let (names, units): (Vec<_>, Vec<_>) = COLUMNS.into_iter().map(of_dimension).unzip();
    let mut text = format!("{}\n{}\n", names.join(","), units.join(","));
    for ending in &sensitivity.endings {
        let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        let integer = |value: Option<usize>| value.map_or(String::new(), |value| value.to_string());
        let [elastic, screened, wavenumber] = fitted(ending);
        let cells = [
            format!("\"{}\"", ending.relaxer),
            stop(ending.stop).into(),
            integer(ending.minimum),
            number(ending.distance),
            ending.differing.len().to_string(),
            integer(ending.contact_difference_count),
            ending.contact_count.to_string(),
            number(Some(ending.energy)),
            number(ending.pressure_change),
            number(ending.response.and_then(|it| it.anticorrelation)),
            number(ending.response.and_then(|it| it.correlation_angle)),
            integer(ending.response.map(|it| it.made_count)),
            integer(ending.response.map(|it| it.broken_count)),
            number(elastic),
            number(screened),
            number(wavenumber),
            ending.cost.force_evaluation_count.to_string(),
            ending.cost.factorisation_count.to_string(),
        ];
        text.push_str(&(cells.join(",") + "\n"));
    }
    text
}

/// The endings as a table of the page.
#[cfg(feature = "plot")]
pub(crate) fn html(sensitivity: &ProtocolSensitivity, dimension: usize) -> String {
    use crate::report::figures::escaped;

    let (pressure, angle) = (format!("Δp [{}]", pressure_unit(dimension)), format!("{} [rad]", angle(dimension)));
    let mut heads = vec![
        "Relaxer",
        "ends by",
        "minimum",
        "distance [length]",
        "disks that differ",
        "contacts that differ",
        pressure.as_str(),
        "G*",
        angle.as_str(),
        "contacts made",
        "broken",
    ];
    if cfg!(feature = "fit") {
        heads.extend(["elastic d_0^eff [length]", "screened d_0^eff [length]", "κ [1/length]"]);
    }
    let mut html =
        String::from("<h3>Minima reached by other relaxers</h3>\n<div class=\"table\">\n<table>\n<thead>\n<tr>");
    for head in &heads {
        let _ = write!(html, "<th scope=\"col\">{}</th>", escaped(head));
    }
    html.push_str("</tr>\n</thead>\n<tbody>\n");
    for ending in &sensitivity.endings {
        let number = |value: Option<f64>, digits| value.map_or("–".into(), |value| significant(value, digits));
        let integer = |value: Option<usize>| value.map_or("–".into(), count);
        let compared = ending.distance.map(|_| ending.differing.len());
        let mut cells = vec![
            stop(ending.stop).into(),
            integer(ending.minimum),
            number(ending.distance, 3),
            integer(compared),
            integer(ending.contact_difference_count),
            number(ending.pressure_change, 6),
            number(ending.response.and_then(|it| it.anticorrelation), 3),
            number(ending.response.and_then(|it| it.correlation_angle), 3),
            integer(ending.response.map(|it| it.made_count)),
            integer(ending.response.map(|it| it.broken_count)),
        ];
        if cfg!(feature = "fit") {
            cells.extend(fitted(ending).map(|value| number(value, 5)));
        }
        let _ = write!(html, "<tr><th scope=\"row\">{}</th>", escaped(&ending.relaxer));
        for cell in cells {
            let _ = write!(html, "<td>{}</td>", escaped(&cell));
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody>\n</table>\n</div>\n");
    html
}

/// Amplitude of the elastic solution, amplitude and κ of the screened one.
fn fitted(ending: &Ending) -> [Option<f64>; 3] {
    #[cfg(feature = "fit")]
    if let Some(fit) = ending.fit {
        let screened = fit.screened;
        return [
            Some(fit.elastic_amplitude),
            screened.map(|screened| screened.amplitude),
            screened.map(|screened| screened.wavenumber),
        ];
    }
    let _ = ending;
    [None; 3]
}
