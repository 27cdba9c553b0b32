//! [`terminal_table`], [`analysis_table`]: a report, or analyses, as plain text, one column per sample, at most
//! [`WIDTH`] wide.

use crate::analysis::Analysis;
use crate::report::rows::estimators::sentences;
use crate::report::rows::section::{Section, done};
use crate::report::rows::{Times, failures, refusals, sections};
use crate::response::Response;
use crate::run::{Report, SampleReport};
use crate::verdict::RestVerdict;

/// Largest number of characters in a line.
pub const WIDTH: usize = 100;

/// Width of the column of labels, in characters.
const LABEL_WIDTH: usize = 40;

/// Indent of a second line, in characters.
const INDENT: usize = 4;

/// Number of samples in a row.
const SAMPLES_ABREAST: usize = 3;

/// Width of the column of a sample, in characters.
const CELL_WIDTH: usize = (WIDTH - LABEL_WIDTH) / SAMPLES_ABREAST;

/// The numbers of a report as a table for a terminal, with wall times.
///
/// Samples are in columns, three at a time. Failed samples are listed below, with the reason.
pub fn terminal_table(report: &Report) -> String {
    let mut lines = not_at_rest(crate::report::rows::verdicts(&report.samples));
    lines.push(format!("jamscope {}, {}", report.jamscope_version, crate::report::rows::law(&report.scene.law)));
    for samples in report.samples.chunks(SAMPLES_ABREAST) {
        let names = samples.iter().map(|sample| sample.name.as_str());
        columns(names, &sections(report, samples, Times::Shown), &mut lines);
    }
    estimators(report.samples.iter().filter_map(done).map(|result| &result.response), &mut lines);
    #[cfg(feature = "linear")]
    if let Some(text) = crate::report::protocol::summary(report) {
        lines.push(String::new());
        lines.extend(wrapped(&text));
    }
    failure_lines(&report.samples, &mut lines);
    text(&lines)
}

/// The numbers of analyses, in the form of a report.
pub fn analysis_table<const D: usize>(analyses: &[Analysis<D>]) -> String {
    let law = analyses.first().map_or(String::new(), |first| format!(", {}", crate::report::rows::law(&first.law)));
    let mut lines = not_at_rest(analyses.iter().map(|analysis| (analysis.name.as_str(), &analysis.response.verdict)));
    lines.push(format!("jamscope {}{law}", env!("CARGO_PKG_VERSION")));
    for analyses in analyses.chunks(SAMPLES_ABREAST) {
        let names = analyses.iter().map(|analysis| analysis.name.as_str());
        columns(names, &crate::report::rows::analysis::sections(analyses), &mut lines);
    }
    estimators(analyses.iter().map(|analysis| &analysis.response), &mut lines);
    for analysis in analyses {
        for (what, reason) in crate::report::rows::response::refusals(&analysis.response) {
            lines.push(String::new());
            lines.extend(wrapped(&format!("{}, {what}: {reason}", analysis.name)));
        }
    }
    text(&lines)
}

/// The estimator of each observable.
fn estimators<'a>(responses: impl Iterator<Item = &'a Response>, lines: &mut Vec<String>) {
    let sentences = sentences(responses);
    if !sentences.is_empty() {
        lines.push("Estimators".into());
    }
    for sentence in sentences {
        let wrapped = wrapped(&sentence).into_iter().enumerate();
        lines.extend(wrapped.map(|(at, line)| format!("{}{line}", if at == 0 { "  " } else { "    " })));
    }
}

/// Warnings about states that are not at rest, with likely causes.
fn not_at_rest<'a>(verdicts: impl Iterator<Item = (&'a str, &'a RestVerdict)>) -> Vec<String> {
    let mut lines = Vec::new();
    for (name, verdict) in verdicts {
        let paragraphs = verdict.paragraphs();
        lines.extend(paragraphs.iter().flat_map(|paragraph| wrapped(&format!("{name}: {paragraph}"))));
        if !paragraphs.is_empty() {
            lines.push(String::new());
        }
    }
    lines
}

fn text(lines: &[String]) -> String {
    lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
}

/// Names, followed by all rows of all sections.
fn columns<'a>(names: impl Iterator<Item = &'a str>, sections: &[Section], lines: &mut Vec<String>) {
    lines.push(String::new());
    lines.push(line("", names));
    for section in sections {
        lines.push(section.title.into());
        for row in &section.rows {
            lines.push(line(&format!("  {}", row.label), row.cells.iter().map(String::as_str)));
        }
    }
}

fn failure_lines(samples: &[SampleReport], lines: &mut Vec<String>) {
    let failed = failures(samples).map(|(name, reason)| format!("{name} failed: {reason}"));
    let unfitted = refusals(samples).into_iter().map(|(name, what, reason)| format!("{name}, {what}: {reason}"));
    for text in failed.chain(unfitted) {
        lines.push(String::new());
        lines.extend(wrapped(&text));
    }
}

/// A label and right-aligned cells.
fn line<'a>(label: &str, cells: impl Iterator<Item = &'a str>) -> String {
    let mut line = format!("{label:<LABEL_WIDTH$}");
    for cell in cells {
        // A name longer than its column is cut, so that columns stay aligned.
        let cell: String = if cell.chars().count() < CELL_WIDTH {
            cell.into()
        } else {
            cell.chars().take(CELL_WIDTH - 2).chain(['…']).collect()
        };
        line.push_str(&format!("{cell:>CELL_WIDTH$}"));
    }
    line
}

/// Text in lines of at most [`WIDTH`] characters, less an indent of four, broken between words; a longer word has its own line.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= WIDTH - INDENT => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_between_words() {
        let lines = wrapped(&"residual ".repeat(40));
        assert!(lines.iter().all(|line| line.chars().count() <= WIDTH && line.starts_with("residual")));
        assert_eq!(lines.join(" ").split(' ').count(), 40);
    }
}
