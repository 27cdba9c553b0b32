//! [`runs`]: all runs of a report as comma-separated values, a row of names, a row of units, then one row per run;
//! [`choices`]: the same for other numerical choices.

use std::fmt::Write as _;

use crate::precision::results::{PrecisionReport, stop_name};

/// Names and units of the columns.
const COLUMNS: [(&str, &str); 19] = [
    ("sample", ""),
    ("method", ""),
    ("varied", ""),
    ("value", "1"),
    ("stop", ""),
    ("residual", "1"),
    ("minimum", ""),
    ("minimum_distance", "length"),
    ("displacement_error", "length"),
    ("energy_error", "1"),
    ("pressure_error", "1"),
    ("wavenumber_error", "1/length"),
    ("amplitude_error", "length"),
    ("contacts_differing", "1"),
    ("seconds", "s"),
    ("steps", "1"),
    ("force_evaluations", "1"),
    ("factorisations", "1"),
    ("iterations", "1"),
];

/// The runs of all samples. Numbers are the shortest decimals that reproduce the `f64`; absent values are empty.
pub fn runs(report: &PrecisionReport) -> String {
    let names: Vec<&str> = COLUMNS.iter().map(|column| column.0).collect();
    let units: Vec<&str> = COLUMNS.iter().map(|column| column.1).collect();
    let mut text = format!("{}\n{}\n", names.join(","), units.join(","));
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
    for sample in &report.samples {
        for run in &sample.runs {
            let (errors, cost) = (&run.errors, &run.cost);
            // The names of methods contain commas, those of samples only letters, digits and "-_.".
            let _ = writeln!(
                text,
                "{},\"{}\",{},{:e},{},{:e},{},{:e},{:e},{},{},{},{},{},{},{},{},{},{}",
                sample.name,
                run.method.name(),
                run.varied.name(),
                run.value,
                stop_name(run.stop),
                run.residual,
                run.minimum,
                run.minimum_distance,
                errors.displacement,
                number(errors.energy),
                number(errors.pressure),
                number(errors.wavenumber),
                number(errors.amplitude),
                errors.contacts,
                run.seconds,
                cost.step_count,
                cost.force_evaluation_count,
                cost.factorisation_count,
                cost.iteration_count,
            );
        }
    }
    text
}

/// The effects of other choices, for all samples and tables: one row per number.
pub fn choices(report: &PrecisionReport) -> String {
    let mut text = String::from("sample,choice,setting,quantity,value\n");
    for sample in &report.samples {
        for table in &sample.choices {
            for row in &table.rows {
                for (quantity, value) in table.columns[1..].iter().zip(&row.values) {
                    let value = value.map_or(String::new(), |value| format!("{value:e}"));
                    let _ = writeln!(text, "{},{},{},\"{quantity}\",{value}", sample.name, table.name, row.setting);
                }
            }
        }
    }
    text
}
