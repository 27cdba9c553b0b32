//! The rows on how often similar samples have the same phase.

use crate::report::number::significant;
use crate::report::rows::section::{Rows, Section};
use crate::response::PhaseFrequency;
use crate::run::{SampleReport, SampleResult};

pub(super) fn section(samples: &[SampleReport]) -> Section {
    let mut rows = Rows::of_samples(samples);
    let of =
        |it: &SampleResult, what: fn(&PhaseFrequency) -> Option<String>| it.phase_frequency.as_ref().and_then(what);
    rows.add("reduced pressure, p̂ = p N^(α−1)", |it| of(it, |it| Some(significant(it.reduced_pressure, 3))))
        .add("p̂ over p̂_c by κ", |it| of(it, |it| Some(over(it, it.critical_by_wavenumber?))))
        .add("p̂ over p̂_c by Δp", |it| of(it, |it| Some(over(it, it.critical_by_pressure_change?))))
        .add("samples at the nearest p̂", |it| of(it, |it| Some(significant(it.cell_reduced_pressure, 2))))
        .add("… with the same phase", |it| of(it, |it| Some(share(it))));
    rows.section("Phases in an ensemble of similar samples")
}

fn over(of: &PhaseFrequency, critical: f64) -> String {
    significant(of.reduced_pressure / critical, 2)
}

/// "55 of 100".
fn share(of: &PhaseFrequency) -> String {
    format!("{} of {}", of.alike_count, of.sample_count)
}
