//! [`terminal_table`]: a report as plain text.

use std::fmt::Write as _;

use crate::precision::results::{PrecisionReport, SamplePrecision, stop_name};
use crate::precision::state::Errors;
use crate::report::number::{count, significant};

/// The numbers of a report for a reader at a terminal.
pub fn terminal_table(report: &PrecisionReport) -> String {
    let mut text = String::new();
    for sample in &report.samples {
        section(sample, &mut text);
    }
    text
}

fn section(sample: &SamplePrecision, text: &mut String) {
    let _ = writeln!(
        text,
        "{}: {} mobile disks, p = {}",
        sample.name,
        count(sample.mobile_count),
        significant(sample.pressure, 4)
    );
    for line in facts(sample) {
        let _ = writeln!(text, "  {line}");
    }
    let _ = writeln!(
        text,
        "  {:<20}{:>11} {:>7}  {:<13}{:<4}{:>8}{:>8}{:>8}{:>8}{:>8}{:>5}{:>9}{:>8}{:>6}",
        "relaxer", "", "", "ends by", "in", "disp", "energy", "p", "kappa", "d0eff", "cont", "s", "evals", "fact"
    );
    for run in &sample.runs {
        let errors = &run.errors;
        let short = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.0e}"));
        let _ = writeln!(
            text,
            "  {:<20}{:>11} {:>7}  {:<13}{:<4}{:>8}{:>8}{:>8}{:>8}{:>8}{:>5}{:>9.3}{:>8}{:>6}",
            run.method.name(),
            run.varied.name(),
            format!("{:e}", run.value),
            stop_name(run.stop),
            run.minimum,
            short(Some(errors.displacement)),
            short(errors.energy),
            short(errors.pressure),
            short(errors.wavenumber),
            short(errors.amplitude),
            errors.contacts,
            run.seconds,
            run.cost.force_evaluation_count,
            run.cost.factorisation_count,
        );
    }
    text.push('\n');
}

/// Sentences on the references and the minima, needed to understand the runs of a sample.
pub(super) fn facts(sample: &SamplePrecision) -> Vec<String> {
    let references = &sample.references;
    let residuals = references.residuals.map(|residual| significant(residual, 2));
    let same = match (sample.unjammed, references.same_minimum) {
        (true, _) => "the packing is unjammed, so the positions at rest are not unique; the references differ by",
        (false, true) => "they are the same minimum (A) and differ by",
        (false, false) => "they are two minima, A and B, which differ by",
    };
    let mut lines = vec![
        format!(
            "References: {} (residual {}) and {} (residual {})",
            references.methods[0], residuals[0], references.methods[1], residuals[1]
        ),
        format!("{same} {}", in_words(&references.errors)),
    ];
    let others = sample.minima.iter().filter(|minimum| minimum.distance > 0.0).count();
    if !sample.unjammed {
        let runs =
            |reference: bool| sample.runs.iter().filter(|run| (run.minimum_distance == 0.0) == reference).count();
        lines.push(format!(
            "{} of {} runs ended in a reference minimum, {} in {others} others",
            runs(true),
            sample.runs.len(),
            runs(false)
        ));
    }
    lines
}

/// Errors with their units.
fn in_words(errors: &Errors) -> String {
    let mut parts = vec![format!("{} in displacement (length)", significant(errors.displacement, 2))];
    let mut part = |value: Option<f64>, what: &str| {
        parts.extend(value.map(|value| format!("{} {what}", significant(value, 2))));
    };
    part(errors.energy, "in energy (relative)");
    part(errors.pressure, "in p (relative)");
    part(errors.wavenumber, "in κ (1/length)");
    part(errors.amplitude, "in d_0^eff (length)");
    parts.push(format!("{} contacts", errors.contacts));
    parts.join(", ")
}
