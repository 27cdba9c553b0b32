//! [`Section`]: rows under one heading, and [`Rows`], which collects them.

use crate::run::{SampleOutcome, SampleReport, SampleResult};

/// Rows under one heading.
pub(crate) struct Section {
    pub title: &'static str,
    pub rows: Vec<Row>,
}

/// One quantity.
pub(crate) struct Row {
    /// The quantity with its unit.
    pub label: String,
    /// One cell per sample; a dash if a sample has no value.
    pub cells: Vec<String>,
}

/// Collects the rows of several results, one per column; none for a sample without a result.
pub(crate) struct Rows<'a, T> {
    results: Vec<Option<&'a T>>,
    rows: Vec<Row>,
}

impl<'a> Rows<'a, SampleResult> {
    /// Starts without rows, for the results of these samples.
    pub(crate) fn of_samples(samples: &'a [SampleReport]) -> Self {
        Rows::new(samples.iter().map(done).collect())
    }
}

impl<'a, T> Rows<'a, T> {
    /// Starts without rows.
    pub(crate) fn new(results: Vec<Option<&'a T>>) -> Self {
        Rows { results, rows: Vec::new() }
    }

    /// Adds a row if at least one sample has the quantity.
    pub(crate) fn add(&mut self, label: impl Into<String>, cell: impl Fn(&T) -> Option<String>) -> &mut Self {
        self.add_row(label.into(), &cell);
        self
    }

    fn add_row(&mut self, label: String, cell: &dyn Fn(&T) -> Option<String>) {
        let cells: Vec<Option<String>> = self.results.iter().map(|result| result.and_then(cell)).collect();
        if cells.iter().any(Option::is_some) {
            let cells = cells.into_iter().map(|cell| cell.unwrap_or_else(|| "–".into())).collect();
            self.rows.push(Row { label, cells });
        }
    }

    /// Adds a row of given cells.
    pub(crate) fn add_cells(&mut self, label: &str, cells: impl Iterator<Item = String>) {
        self.rows.push(Row { label: label.into(), cells: cells.collect() });
    }

    pub(crate) fn section(self, title: &'static str) -> Section {
        Section { title, rows: self.rows }
    }
}

/// The result of a sample, if it has one.
pub(crate) fn done(sample: &SampleReport) -> Option<&SampleResult> {
    match &sample.result {
        SampleOutcome::Done(result) => Some(result),
        SampleOutcome::Failed(_) => None,
    }
}
