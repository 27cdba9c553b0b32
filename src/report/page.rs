//! [`page`]: the whole report on one self-contained HTML page: no scripts, no fonts, no network.

use std::fmt::Write as _;

use crate::analysis::Analysis;
use crate::inflation::{Boundary, Drive};
use crate::report::data_file::DataFile;
use crate::report::figures::map::MapFrame;
#[cfg(feature = "linear")]
use crate::report::figures::multipoles::{Component, multipole_figure};
use crate::report::figures::{Figure, FigureError, escaped};
use crate::report::number::{count, significant};
use crate::report::response_page;
use crate::report::rows::estimators::sentences;
use crate::report::rows::section::{Section, done};
use crate::report::rows::{Times, law, sections, settings};
use crate::response::Response;
use crate::run::{Report, SampleOutcome, SampleReport, SampleResult};
use crate::scene::Source;
use crate::verdict::RestVerdict;

pub(crate) const STYLE: &str = include_str!("page.css");

/// Title and heading of reports of samples.
const TITLE: &str = "jamscope: response to an inflation";
const HEADING: &str = "Response of a packing to the inflation of one disk";
const DRIVE_TITLE: &str = "jamscope: response to a drive";
const DRIVE_HEADING: &str = "Response of a packing to a force, a displacement or a strain";

/// The page of a report. Two runs of one scene on one processor give the same bytes, since wall times are left out.
///
/// # Errors
/// A figure whose numbers are not finite.
pub fn page(report: &Report) -> Result<String, FigureError> {
    let (title, heading) =
        if report.scene.inflation.drive.is_inflation() { (TITLE, HEADING) } else { (DRIVE_TITLE, DRIVE_HEADING) };
    let mut html = head(title, heading, &introduction(report));
    html.push_str(&not_at_rest(crate::report::rows::verdicts(&report.samples)));
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

/// The page of analyses.
///
/// # Errors
/// A figure whose numbers are not finite.
pub fn analysis_page<const D: usize>(analyses: &[Analysis<D>]) -> Result<String, FigureError> {
    let responses: Vec<_> = analyses.iter().map(|analysis| &analysis.response).collect();
    let introduction = format!(
        "Two states of each packing, before and after one disk grew, as they were read. {}",
        response_page::legend(&responses, true).trim_end()
    );
    let mut html = head(TITLE, HEADING, &introduction);
    html.push_str(&not_at_rest(analyses.iter().map(|analysis| (analysis.name.as_str(), &analysis.response.verdict))));
    for analysis in analyses {
        let name = escaped(&analysis.name);
        let facts = [
            format!("p = {}", significant(analysis.before.pressure, 4)),
            format!("N = {}", count(analysis.mobile_count)),
        ];
        let facts: Vec<String> = facts.into_iter().chain(decided(&analysis.response)).collect();
        let _ = write!(
            html,
            "<section class=\"sample\" aria-label=\"Sample {name}\">\n<h2>{name}</h2>\n<p class=\"facts\">{}</p>\n",
            facts.join(", ")
        );
        // A map in the open plane needs no sides of a box.
        let sides = analysis.pair.before.domain().lengths().unwrap_or([2.0 * analysis.outer_radius; D]);
        let (radii, boundary) = (analysis.pair.before.radii(), analysis.boundary());
        let frame = MapFrame::new(boundary, analysis.outer_radius, [sides[0], sides[1]], widest(radii));
        html.push_str(&pictures(response_page::figures(&analysis.name, &analysis.response, radii, &frame, true)?));
        let files = crate::report::csv::response::files(&analysis.response);
        html.push_str(&links(files.map(|file| format!("{}.{}", analysis.name, file.ending))));
        html.push_str("</section>\n");
    }
    let names: Vec<&str> = analyses.iter().map(|analysis| analysis.name.as_str()).collect();
    let _ = write!(
        html,
        "<section aria-label=\"Numbers\">\n<h2>Numbers</h2>\n{}{}</section>\n",
        numbers_table(&names, &crate::report::rows::analysis::sections(analyses)),
        estimators(responses.iter().copied())
    );
    let law = analyses.first().map_or(String::new(), |first| law(&first.law));
    let _ = write!(
        html,
        "</main>\n<footer>\n<p>jamscope {}, {}. All numbers: <a href=\"analysis.json\">analysis.json</a>.</p>\n\
         </footer>\n</body>\n</html>\n",
        env!("CARGO_PKG_VERSION"),
        escaped(&law),
    );
    Ok(html)
}

/// The part before the first section.
pub(crate) fn head(title: &str, heading: &str, introduction: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <header>\n<h1>{heading}</h1>\n<p>{introduction}</p>\n</header>\n<main>\n"
    )
}

/// A row of figures.
pub(crate) fn pictures(figures: Vec<Figure>) -> String {
    if figures.is_empty() {
        return String::new();
    }
    let each = figures.iter().map(|figure| format!("<figure>\n{}</figure>\n", figure.to_inline_svg()));
    format!("<div class=\"figures\">\n{}</div>\n", each.collect::<String>())
}

/// Links to data files.
fn links(files: impl Iterator<Item = String>) -> String {
    let each = files.map(|file| escaped(&file)).map(|file| format!(" <a href=\"{file}\">{file}</a>"));
    format!("<p class=\"files\">Data:{}</p>\n", each.collect::<Vec<_>>().join(","))
}

/// A warning about states that are not at rest, with likely causes; empty if all are at rest.
fn not_at_rest<'a>(verdicts: impl Iterator<Item = (&'a str, &'a RestVerdict)>) -> String {
    let mut html = String::new();
    for (name, verdict) in verdicts {
        let paragraphs = verdict.paragraphs();
        if paragraphs.is_empty() {
            continue;
        }
        let name = escaped(name);
        let _ = write!(
            html,
            "<section class=\"sample failed\" aria-label=\"{name} is not at rest\">\n<h2>{name}: not at rest</h2>\n"
        );
        for paragraph in paragraphs {
            let _ = writeln!(html, "<p class=\"reason\">{}</p>", escaped(&paragraph));
        }
        html.push_str("</section>\n");
    }
    html
}

/// The largest radius \[length\].
fn widest(radii: &[f64]) -> f64 {
    radii.iter().copied().fold(0.0, f64::max)
}

/// A paragraph on the content of the figures.
fn introduction(report: &Report) -> String {
    let scene = &report.scene;
    let responses: Vec<_> = report.samples.iter().filter_map(done).map(|result| &result.response).collect();
    let legend = response_page::legend(&responses, scene.observables.displacement_field.is_some());
    let done_to = match scene.inflation.drive {
        Drive::Inflation => None,
        Drive::PointForce { .. } => Some("A force acts on a disk at the centre of a circle whose rim is held"),
        Drive::ForceDipole { .. } => Some("Two opposite forces act on two disks in contact"),
        Drive::Displacement { .. } => Some("A disk at the centre of a circle whose rim is held is displaced"),
        Drive::Shear { .. } => {
            Some("The rim of a circle is sheared at constant area; the field is the non-affine displacement")
        }
        Drive::Compression { .. } => {
            Some("The rim of a circle is compressed; the field is the non-affine displacement")
        }
    };
    if let Some(done_to) = done_to {
        return format!("{done_to}, and the packing comes to rest again. {}", legend.trim_end());
    }
    let place = match scene.inflation.boundary {
        Boundary::HeldRim { .. } if !scene.inflation.centre_held => {
            "A disk that is free to move, in the middle of a circle whose rim is held, grows"
        }
        Boundary::HeldRim { .. } => "A disk at the centre of a circle whose rim is held grows",
        Boundary::Periodic => "A disk in a periodic box grows",
        Boundary::HeldWalls { .. } => "The disks of a row in the middle of a strip between held walls grow",
    };
    let mut text = format!(
        "{place} in radius by d<sub>0</sub> = {} and the packing around comes to rest again. ",
        significant(scene.inflation.increase, 3)
    );
    text.push_str(&legend);
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
                 <p class=\"reason\">{}</p>\n<p>Requested: {}.</p>\n</section>\n",
                escaped(reason),
                escaped(&requests(report, sample))
            ));
        }
    };
    let mut html = format!(
        "<section class=\"sample\" aria-label=\"Sample {name}\">\n<h2>{name}</h2>\n<p class=\"facts\">{}</p>\n",
        facts(result)
    );
    html.push_str(&pictures(figures(report, &sample.name, result)?));
    #[cfg(feature = "linear")]
    if let Some(sensitivity) = crate::report::protocol::measured(result) {
        html.push_str(&crate::report::protocol::html(sensitivity, report.scene.dimension));
    }
    html.push_str(&links(DataFile::of(report, result).into_iter().map(|file| file.name(&sample.name))));
    html.push_str("</section>\n");
    Ok(html)
}

/// The requests of the scene for a sample.
fn requests(report: &Report, sample: &SampleReport) -> String {
    match settings(report, &sample.name).map(|sample| &sample.source) {
        Some(Source::PackingFraction(value)) => format!("packing fraction {value}"),
        Some(Source::Pressure(value)) => format!("pressure {value}"),
        Some(Source::File(path)) => format!("the packing in {}", path.display()),
        Some(Source::FileAtPressure { file, pressure }) => {
            format!("the packing in {}, brought to pressure {pressure}", file.display())
        }
        None => "a sample that is not in the scene".into(),
    }
}

/// Pressure, packing fraction and phase.
fn facts(result: &SampleResult) -> String {
    let packing = &result.packing;
    let mut facts = vec![
        format!("p = {}", significant(packing.pressure, 4)),
        format!("φ = {}", significant(packing.packing_fraction, 4)),
        format!("N = {}", count(result.inflation.mobile_count)),
    ];
    facts.extend(decided(&result.response));
    facts.join(", ")
}

#[cfg(feature = "fit")]
fn decided(response: &Response) -> Option<String> {
    use crate::fit::profile::Decision;
    use crate::response::Measurement;
    Some(match response.profile_fit.as_ref()? {
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
fn decided(_response: &Response) -> Option<String> {
    None
}

fn figures(report: &Report, name: &str, result: &SampleResult) -> Result<Vec<Figure>, FigureError> {
    let radii = result.states.radii();
    // Disks with centres within the boundary extend beyond it by a radius.
    let (boundary, [_, outer_radius]) = (report.scene.inflation.boundary, result.response.detail.radii());
    let frame = MapFrame::new(
        boundary,
        outer_radius,
        [result.packing.box_sides[0], result.packing.box_sides[1]],
        widest(radii),
    );
    let heat = report.scene.observables.displacement_field.is_some();
    let mut figures = response_page::figures(name, &result.response, radii, &frame, heat)?;
    figures.extend(drive_figure(name, result));
    Ok(figures)
}

/// No continuum without the moduli.
#[cfg(not(feature = "linear"))]
fn drive_figure(_name: &str, _result: &SampleResult) -> Option<Figure> {
    None
}

/// The modes of another drive than an inflation, with those of the continuum.
#[cfg(feature = "linear")]
fn drive_figure(name: &str, result: &SampleResult) -> Option<Figure> {
    let drive = result.drive.as_ref()?.measured()?;
    let highest = drive.modes.iter().map(|ring| ring.mode).max()?;
    let curve = |mode: usize, radius: f64| {
        let exact = drive.exact_radial(mode, radius)?;
        Some(if mode == 0 { exact } else { exact.abs() })
    };
    let name = format!("{name}, dashed the continuum");
    multipole_figure(&name, result.response.multipoles.as_ref()?.measured()?, Component::Radial, highest, Some(&curve))
        .ok()
}

/// All rows of all samples with a result.
fn numbers(report: &Report) -> String {
    let names: Vec<&str> = report.samples.iter().map(|sample| sample.name.as_str()).collect();
    let mut html = format!(
        "<section aria-label=\"Numbers\">\n<h2>Numbers</h2>\n{}",
        numbers_table(&names, &sections(report, &report.samples, Times::LeftOut))
    );
    html.push_str(&estimators(report.samples.iter().filter_map(done).map(|result| &result.response)));
    #[cfg(feature = "linear")]
    if let Some(text) = crate::report::protocol::summary(report) {
        let _ = writeln!(html, "<p>{}</p>", escaped(&text));
    }
    html.push_str("</section>\n");
    html
}

/// The estimator of each observable.
fn estimators<'a>(responses: impl Iterator<Item = &'a Response>) -> String {
    let sentences = sentences(responses);
    let each = sentences.iter().map(|sentence| format!("<li>{}</li>\n", escaped(sentence)));
    match &sentences[..] {
        [] => String::new(),
        _ => format!("<h3>Estimators</h3>\n<ul>\n{}</ul>\n", each.collect::<String>()),
    }
}

/// A table with one column per name.
fn numbers_table(names: &[&str], sections: &[Section]) -> String {
    let mut html = String::from("<div class=\"table\">\n<table>\n<thead>\n<tr><th scope=\"col\">Quantity</th>");
    for name in names {
        let _ = write!(html, "<th scope=\"col\">{}</th>", escaped(name));
    }
    html.push_str("</tr>\n</thead>\n");
    let width = names.len() + 1;
    for section in sections {
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
    html
}
