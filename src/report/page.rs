//! [`page`]: the whole report on one HTML page that needs nothing else: no scripts, no fonts, no network.

use std::fmt::Write as _;

use crate::inflation::Boundary;
use crate::report::data_file::DataFile;
use crate::report::figures::map::MapFrame;
use crate::report::figures::{Figure, FigureError, escaped};
use crate::report::number::{count, significant};
use crate::report::response_page;
use crate::report::rows::{Times, done, law, sections, settings};
use crate::run::{Report, SampleOutcome, SampleReport, SampleResult};
use crate::scene::Source;

pub(crate) const STYLE: &str = include_str!("page.css");

/// The page of a report. Two runs of one scene give the same bytes: wall times are left out.
///
/// # Errors
/// A figure whose numbers are not finite.
pub fn page(report: &Report) -> Result<String, FigureError> {
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>jamscope: response to an inflation</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <header>\n<h1>Response of a packing to the inflation of one disk</h1>\n<p>{}</p>\n</header>\n<main>\n",
        introduction(report)
    );
    for sample in &report.samples {
        html.push_str(&section(report, sample)?);
    }
    html.push_str(&numbers(report));
    let _ = write!(
        html,
        "</main>\n<footer>\n<p>jamscope {}, {}. Lengths in diameters of a small disk. \
         The whole report: <a href=\"report.json\">report.json</a>; \
         wall times: <a href=\"timings.json\">timings.json</a>.</p>\n</footer>\n</body>\n</html>\n",
        escaped(report.jamscope_version),
        escaped(&law(&report.scene.law)),
    );
    Ok(html)
}

/// What is seen, in a paragraph; only what is there.
fn introduction(report: &Report) -> String {
    let scene = &report.scene;
    let place = match scene.inflation.boundary {
        Boundary::HeldRim { .. } => "at the centre of a circle whose rim is held",
        Boundary::Periodic => "in a periodic box",
    };
    let mut text = format!(
        "A disk {place} grows in radius by d<sub>0</sub> = {} and the packing around it comes to rest again. ",
        significant(scene.inflation.increase, 3)
    );
    let responses: Vec<_> = report.samples.iter().filter_map(done).map(|result| &result.response).collect();
    text.push_str(&response_page::legend(&responses, scene.observables.displacement_field.is_some()));
    text.trim_end().into()
}

/// One sample: heading, pictures, files.
fn section(report: &Report, sample: &SampleReport) -> Result<String, FigureError> {
    let name = escaped(&sample.name);
    let result = match &sample.result {
        SampleOutcome::Done(result) => result,
        SampleOutcome::Failed(reason) => {
            return Ok(format!(
                "<section class=\"sample failed\" aria-label=\"Sample {name}\">\n<h2>{name}: failed</h2>\n\
                 <p class=\"reason\">{}</p>\n<p>Asked for: {}.</p>\n</section>\n",
                escaped(reason),
                escaped(&asked(report, sample))
            ));
        }
    };
    let mut html = format!(
        "<section class=\"sample\" aria-label=\"Sample {name}\">\n<h2>{name}</h2>\n<p class=\"facts\">{}</p>\n",
        facts(result)
    );
    let figures = figures(report, &sample.name, result)?;
    if !figures.is_empty() {
        html.push_str("<div class=\"figures\">\n");
        for figure in figures {
            let _ = write!(html, "<figure>\n{}</figure>\n", figure.to_inline_svg());
        }
        html.push_str("</div>\n");
    }
    #[cfg(feature = "linear")]
    if let Some(sensitivity) = crate::report::protocol::measured(result) {
        html.push_str(&crate::report::protocol::html(sensitivity));
    }
    html.push_str("<p class=\"files\">Data:");
    for (place, file) in DataFile::of(report, result).into_iter().enumerate() {
        let file = escaped(&file.name(&sample.name));
        let comma = if place > 0 { "," } else { "" };
        let _ = write!(html, "{comma} <a href=\"{file}\">{file}</a>");
    }
    html.push_str("</p>\n</section>\n");
    Ok(html)
}

/// What the scene asks of a sample.
fn asked(report: &Report, sample: &SampleReport) -> String {
    match settings(report, &sample.name).map(|sample| &sample.source) {
        Some(Source::PackingFraction(value)) => format!("packing fraction {value}"),
        Some(Source::Pressure(value)) => format!("pressure {value}"),
        Some(Source::File(path)) => format!("the packing in {}", path.display()),
        None => "nothing the scene names".into(),
    }
}

/// Pressure, packing fraction and what was decided.
fn facts(result: &SampleResult) -> String {
    let packing = &result.packing;
    let mut facts = vec![
        format!("p = {}", significant(packing.pressure, 4)),
        format!("φ = {}", significant(packing.packing_fraction, 4)),
        format!("N = {}", count(result.inflation.mobile_count)),
    ];
    facts.extend(decided(result));
    facts.join(", ")
}

#[cfg(feature = "fit")]
fn decided(result: &SampleResult) -> Option<String> {
    use crate::fit::profile::Decision;
    use crate::response::Measurement;
    Some(match result.response.profile_fit.as_ref()? {
        Measurement::Refused(reason) => format!("no fit: {}", escaped(reason)),
        Measurement::Measured(fit) => {
            let kappa = crate::report::rows::response::wavenumber(fit).map_or(String::new(), |text| escaped(&text));
            match fit.decision {
                Decision::Elastic => format!("profile elastic (κ {kappa}, consistent with 0)"),
                Decision::Screened => format!("profile screened (κ = {kappa})"),
                Decision::Neither => "profile neither elastic nor screened".into(),
            }
        }
    })
}

#[cfg(not(feature = "fit"))]
fn decided(_result: &SampleResult) -> Option<String> {
    None
}

fn figures(report: &Report, name: &str, result: &SampleResult) -> Result<Vec<Figure>, FigureError> {
    let radii = result.inflated.before.packing.get().radii();
    // Disks whose centre lies within the boundary reach beyond it by a radius.
    let widest = radii.iter().copied().fold(0.0, f64::max);
    let (boundary, outer_radius) = (report.scene.inflation.boundary, result.response.field.outer_radius);
    let frame = MapFrame::new(boundary, outer_radius, result.packing.box_sides, widest);
    let heat = report.scene.observables.displacement_field.is_some();
    response_page::figures(name, &result.response, radii, &frame, heat)
}

/// All rows of all samples that came to a result.
fn numbers(report: &Report) -> String {
    let mut html = String::from(
        "<section aria-label=\"Numbers\">\n<h2>Numbers</h2>\n<div class=\"table\">\n<table>\n<thead>\n<tr><th scope=\"col\">Quantity</th>",
    );
    for sample in &report.samples {
        let _ = write!(html, "<th scope=\"col\">{}</th>", escaped(&sample.name));
    }
    html.push_str("</tr>\n</thead>\n");
    let width = report.samples.len() + 1;
    for section in sections(report, &report.samples, Times::LeftOut) {
        let _ = write!(
            html,
            "<tbody>\n<tr><th class=\"group\" scope=\"rowgroup\" colspan=\"{width}\">{}</th></tr>\n",
            escaped(section.title)
        );
        for row in &section.rows {
            let _ = write!(html, "<tr><th scope=\"row\">{}</th>", escaped(&row.label));
            for cell in &row.cells {
                let _ = write!(html, "<td>{}</td>", escaped(cell));
            }
            html.push_str("</tr>\n");
        }
        html.push_str("</tbody>\n");
    }
    html.push_str("</table>\n</div>\n");
    #[cfg(feature = "linear")]
    if let Some(text) = crate::report::protocol::summary(report) {
        let _ = writeln!(html, "<p>{}</p>", escaped(&text));
    }
    html.push_str("</section>\n");
    html
}
