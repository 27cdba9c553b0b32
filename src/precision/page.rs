//! [`page`]: a report on one self-contained HTML page.

use std::fmt::Write as _;

use crate::precision::figure::figures;
use crate::precision::numerical_choices::ChoiceTable;
use crate::precision::results::{PrecisionReport, SamplePrecision, stop_name};
use crate::precision::state::Measured;
use crate::precision::table::facts;
use crate::report::figures::escaped;
use crate::report::number::{count, significant};
use crate::report::page::STYLE;

/// The page of a report.
pub fn page(report: &PrecisionReport) -> String {
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>jamscope: what accuracy costs</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <header>\n<h1>What accuracy costs</h1>\n<p>One disk of a packing has grown. Every relaxer relaxes the packing \
         from the same state, with several force limits, time steps or tolerances. An error is the difference from the \
         minimum of the run, which is known within rounding. Filled symbols: this minimum is a reference, found by two \
         methods. Hollow symbols: it is another minimum. Crossed symbols: the run ended at the step limit. Values below \
         the axis, including zero, are drawn at its edge.</p>\n</header>\n<main>\n"
    );
    for sample in &report.samples {
        section(sample, &mut html);
    }
    let _ = write!(
        html,
        "</main>\n<footer>\n<p>jamscope {}. All numbers: <a href=\"precision.csv\">precision.csv</a>, \
         <a href=\"choices.csv\">choices.csv</a>, <a href=\"precision.json\">precision.json</a>; two measurements of one \
         scene give the same bytes, except for the seconds.</p>\n</footer>\n</body>\n</html>\n",
        escaped(report.jamscope_version)
    );
    html
}

fn section(sample: &SamplePrecision, html: &mut String) {
    let name = escaped(&sample.name);
    let _ = write!(
        html,
        "<section class=\"sample\" aria-label=\"Sample {name}\">\n<h2>{name}</h2>\n<p class=\"facts\">N = {}, p = {}. {}.</p>\n\
         <div class=\"figures\">\n",
        count(sample.mobile_count),
        significant(sample.pressure, 4),
        escaped(&facts(sample).join(". ")).replace(". they", "; they").replace(". the packing", "; the packing")
    );
    for (_, figure) in figures(sample) {
        let _ = write!(html, "<figure>\n{}</figure>\n", figure.to_inline_svg());
    }
    html.push_str("</div>\n");
    minima(sample, html);
    runs(sample, html);
    for table in &sample.choices {
        choices(table, html);
    }
    html.push_str("</section>\n");
}

fn head(html: &mut String, caption: &str, columns: &[&str]) {
    let _ = write!(html, "<h3>{}</h3>\n<div class=\"table\">\n<table>\n<thead>\n<tr>", escaped(caption));
    for column in columns {
        let _ = write!(html, "<th scope=\"col\">{}</th>", escaped(column));
    }
    html.push_str("</tr>\n</thead>\n<tbody>\n");
}

fn row(html: &mut String, cells: &[String]) {
    html.push_str("<tr>");
    for (place, cell) in cells.iter().enumerate() {
        let cell = escaped(cell);
        let _ =
            if place == 0 { write!(html, "<th scope=\"row\">{cell}</th>") } else { write!(html, "<td>{cell}</td>") };
    }
    html.push_str("</tr>\n");
}

const FOOT: &str = "</tbody>\n</table>\n</div>\n";

fn short(value: Option<f64>) -> String {
    value.map_or("–".into(), |value| significant(value, 2))
}

fn minima(sample: &SamplePrecision, html: &mut String) {
    let columns =
        ["minimum", "found by", "from a reference (length)", "energy", "p", "κ (1/length)", "d_0^eff (length)"];
    head(html, "Minima", &columns);
    for minimum in &sample.minima {
        let Measured { energy, pressure, fitted, .. } = minimum.measured;
        let fit = |of: fn(&crate::precision::state::Fitted) -> f64| {
            fitted.as_ref().map_or("–".into(), |fitted| significant(of(fitted), 6))
        };
        row(
            html,
            &[
                minimum.label.clone(),
                minimum.found_by.clone(),
                significant(minimum.distance, 2),
                significant(energy, 9),
                significant(pressure, 9),
                fit(|fitted| fitted.wavenumber),
                fit(|fitted| fitted.amplitude()),
            ],
        );
    }
    html.push_str(FOOT);
}

fn runs(sample: &SamplePrecision, html: &mut String) {
    let columns = [
        "relaxer",
        "varied",
        "value",
        "ends by",
        "minimum",
        "displacement (length)",
        "energy (relative)",
        "p (relative)",
        "κ (1/length)",
        "d_0^eff (length)",
        "contacts",
        "seconds",
        "evaluations",
        "factorisations",
    ];
    head(html, "Runs and their errors", &columns);
    for run in &sample.runs {
        let errors = &run.errors;
        row(
            html,
            &[
                run.method.name().into(),
                run.varied.name().into(),
                significant(run.value, 2),
                stop_name(run.stop),
                run.minimum.clone(),
                significant(errors.displacement, 2),
                short(errors.energy),
                short(errors.pressure),
                short(errors.wavenumber),
                short(errors.amplitude),
                errors.contacts.to_string(),
                significant(run.seconds, 3),
                count(run.cost.force_evaluation_count),
                count(run.cost.factorisation_count),
            ],
        );
    }
    html.push_str(FOOT);
}

fn choices(table: &ChoiceTable, html: &mut String) {
    head(html, table.title, &table.columns);
    for line in &table.rows {
        let numbers = line.values.iter().map(|&value| value.map_or("–".into(), |value| significant(value, 4)));
        row(html, &[line.setting.clone()].into_iter().chain(numbers).collect::<Vec<_>>());
    }
    html.push_str(FOOT);
}
