//! The data of figures, and words for cells and series.

use crate::packing::particles;
use crate::report::figures::plot::{PlotPoint, colour};
use crate::report::number::significant;
use crate::study::{Cell, CellSamples, Merged, NumberStatistics, Target};
use crate::transition::{Series, SeriesPoint, Transition};

/// The data of figures.
pub(super) struct Subject<'a> {
    pub merged: &'a Merged,
    pub transition: &'a Transition,
}

impl<'a> Subject<'a> {
    /// Dimension of space.
    pub fn dimension(&self) -> usize {
        self.merged.study.scene.dimension
    }

    /// Number of dimensions in which the responses spread: 1 in strips.
    pub fn spreading_dimension(&self) -> usize {
        if self.merged.study.scene.inflation.boundary.is_strip() { 1 } else { self.dimension() }
    }

    /// What the packings consist of: disks or spheres.
    pub fn particles(&self) -> &'static str {
        particles(self.dimension())
    }

    /// The symbol of an angle: θ in a ring, γ in a shell.
    pub fn angle(&self) -> &'static str {
        if self.dimension() == 3 { "γ" } else { "θ" }
    }

    pub fn samples(&self, point: &SeriesPoint) -> &'a CellSamples {
        &self.merged.samples[point.cell]
    }

    /// Mean of a number in a cell, with its interval.
    pub fn number(&self, cell: usize, name: &str) -> Option<NumberStatistics> {
        self.merged.cells[cell].numbers.get(name).copied()
    }

    /// A number along a series, against p̂ or the `abscissa` of each point.
    pub fn along(&self, series: &Series, name: &str, abscissa: impl Fn(&SeriesPoint) -> f64) -> Vec<PlotPoint> {
        let point = |point: &SeriesPoint| {
            let found = self.number(point.cell, name)?;
            Some(PlotPoint { x: abscissa(point), y: found.mean, interval: found.mean_interval })
        };
        series.points.iter().filter_map(point).collect()
    }
}

/// p̂ as SVG text.
pub(super) fn reduced(value: f64) -> String {
    format!("p̂ = {}", significant(value, 1))
}

/// Size and, if they differ between series, law, inflation and relaxer.
pub(super) fn short(series: &Series, all: &[Series]) -> String {
    let Cell { law, disk_count, increase, relaxer, .. } = series.cell;
    let mut text = format!("{disk_count}");
    if all.iter().any(|other| other.cell.law != law) {
        text = format!("{} {text}", law.name());
    }
    if all.iter().any(|other| other.cell.increase != increase) {
        text = format!("{text}, {increase}");
    }
    if all.iter().any(|other| other.cell.relaxer != relaxer) {
        text = format!("{text}, {}", relaxer.description());
    }
    text + &series.cell.drive_words()
}

/// The colour of a series among all.
pub(super) fn series_colour(index: usize, all: &[Series]) -> [u8; 3] {
    colour(index, all.len())
}

/// Words for a cell, with its relaxer if the study has several.
pub(super) fn with_relaxer(text: String, cell: &Cell, merged: &Merged) -> String {
    match merged.cells.iter().any(|other| other.cell.relaxer != cell.relaxer) {
        true => format!("{text}, {}{}", cell.relaxer.description(), cell.drive_words()),
        false => text + &cell.drive_words(),
    }
}

/// Target of the preparation of a cell, as SVG text.
pub(super) fn target(cell: &Cell) -> String {
    match cell.target {
        Target::Pressure(value) => format!("p = {}", significant(value, 2)),
        Target::ReducedPressure(value) => reduced(value),
        Target::PackingFraction(value) => format!("φ = {value}"),
    }
}
