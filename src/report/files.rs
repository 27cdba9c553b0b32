//! [`write()`]: a report as files in a folder.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::analysis::Analysis;
use crate::certificate::Certificate;
use crate::displacement::DisplacementField;
use crate::io::{Column, write_atomically, write_packing};
use crate::packing::Packing;
use crate::processor::{Processor, Vectors};
use crate::report::columns::ResponseColumns;
use crate::report::csv;
use crate::report::data_file::DataFile;
use crate::report::error::ReportError;
use crate::report::output::Kind;
use crate::report::output::OutputFolder;
use crate::report::rows::law;
use crate::report::rows::section::done;
use crate::report::state_file::numbers_of;
use crate::response::Detail;
use crate::run::{Report, SampleReport, SampleResult, States, StatesOf};

/// Writes a report into `folder`, which is created if necessary. Returns the paths of the files in the order written.
///
/// All files of an earlier report are replaced together; other files are not changed
/// ([`output`](crate::report::output)).
///
/// # Errors
/// [`ReportError`] with the file and the problem.
pub fn write(report: &Report, folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
    write_into(report, OutputFolder::open(folder, Kind::Report)?)
}

/// Like [`write()`], into a folder that was opened before the run.
///
/// # Errors
/// [`ReportError`] with the file and the problem.
pub fn write_into(report: &Report, output: OutputFolder) -> Result<Vec<PathBuf>, ReportError> {
    let mut files = Files { folder: output.inside(), written: Vec::new() };
    files.json("report.json", report)?;
    files.json("timings.json", &timings(report))?;
    for sample in &report.samples {
        if let Some(result) = done(sample) {
            files.sample(report, sample, result)?;
        }
    }
    #[cfg(feature = "plot")]
    files.text("report.html", &crate::report::page::page(report)?)?;
    let written = files.written;
    output.commit(written)
}

/// Writes analyses into `folder` as [`write()`] writes a report: `analysis.json`, the tables of each, and with the
/// feature `plot` one page.
///
/// # Errors
/// [`ReportError`] with the file and the problem.
pub fn write_analyses<const D: usize>(analyses: &[Analysis<D>], folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
    write_analyses_into(analyses, OutputFolder::open(folder, Kind::Analysis)?)
}

/// Like [`write_analyses()`], into a folder that was opened before the analysis.
///
/// # Errors
/// [`ReportError`] with the file and the problem.
pub fn write_analyses_into<const D: usize>(
    analyses: &[Analysis<D>],
    output: OutputFolder,
) -> Result<Vec<PathBuf>, ReportError> {
    let mut files = Files { folder: output.inside(), written: Vec::new() };
    let vectors = Processor::own().vectors();
    let document = Analyses { jamscope_version: env!("CARGO_PKG_VERSION"), vectors, analyses };
    files.json("analysis.json", &document)?;
    for analysis in analyses {
        for file in csv::response::files(&analysis.response) {
            if let Some(text) = (file.text)(&analysis.response) {
                files.text(&format!("{}.{}", analysis.name, file.ending), &text)?;
            }
        }
    }
    #[cfg(feature = "plot")]
    files.text("analysis.html", &crate::report::page::analysis_page(analyses)?)?;
    let written = files.written;
    output.commit(written)
}

/// Writes the results of a merged study on the transition: `transition.json`, `transition.csv`, and with the feature
/// `plot` `report.html`.
///
/// # Errors
/// [`ReportError`] with the file and the problem.
#[cfg(feature = "fit")]
pub fn write_study(
    merged: &crate::study::Merged,
    transition: &crate::transition::Transition,
    folder: &Path,
) -> Result<Vec<PathBuf>, ReportError> {
    let mut files = Files { folder, written: Vec::new() };
    files.json("transition.json", transition)?;
    files.text("transition.csv", &csv::transition::table(&transition.comparisons))?;
    #[cfg(feature = "plot")]
    files.text("report.html", &crate::report::study::study_page(merged, transition))?;
    #[cfg(not(feature = "plot"))]
    let _ = merged;
    Ok(files.written.iter().map(|name| folder.join(name)).collect())
}

/// The content of `analysis.json`.
#[derive(Serialize)]
struct Analyses<'a, const D: usize> {
    jamscope_version: &'static str,
    vectors: Vectors,
    analyses: &'a [Analysis<D>],
}

/// A folder being filled.
struct Files<'a> {
    folder: &'a Path,
    /// Names.
    written: Vec<String>,
}

impl Files<'_> {
    fn text(&mut self, name: &str, text: &str) -> Result<(), ReportError> {
        write_atomically(self.folder.join(name), |writer| writer.write_all(text.as_bytes()))?;
        self.written.push(name.into());
        Ok(())
    }

    fn json(&mut self, name: &str, value: &impl Serialize) -> Result<(), ReportError> {
        let text = serde_json::to_string_pretty(value)
            .map_err(|source| ReportError::Json { path: self.folder.join(name), source })?;
        self.text(name, &(text + "\n"))
    }

    fn sample(&mut self, report: &Report, sample: &SampleReport, result: &SampleResult) -> Result<(), ReportError> {
        let name = sample.name.as_str();
        let outer_radius = result.inflation.outer_radius;
        let origin =
            |state, pressure, certificate| Origin { report, sample, state, pressure, outer_radius, certificate };
        for file in DataFile::of(report, result) {
            let path = file.name(name);
            match file {
                DataFile::Packing | DataFile::Before | DataFile::Displacement | DataFile::Deflated => {
                    match (&result.states, &result.response.detail) {
                        (States::Plane(states), Detail::Plane(detail)) => {
                            self.state(&path, file, (states, &detail.field), result, &origin)?;
                        }
                        (States::Space(states), Detail::Space(detail)) => {
                            self.state(&path, file, (states, &detail.field), result, &origin)?;
                        }
                        _ => {}
                    }
                }
                DataFile::OfResponse(file) => {
                    if let Some(text) = (file.text)(&result.response) {
                        self.text(&path, &text)?;
                    }
                }
                #[cfg(feature = "linear")]
                DataFile::PlasticProfile => {
                    if let Some(plastic) = result.plastic_part.as_ref().and_then(|it| it.measured()) {
                        self.text(&path, &csv::plastic_profile(&plastic.radial_profile))?;
                    }
                }
                #[cfg(feature = "linear")]
                DataFile::DriveModes => {
                    if let Some(drive) = result.drive.as_ref().and_then(|it| it.measured()) {
                        self.text(&path, &csv::drive_modes(drive))?;
                    }
                }
                #[cfg(feature = "linear")]
                DataFile::Protocol => {
                    if let Some(sensitivity) = crate::report::protocol::measured(result) {
                        self.text(&path, &crate::report::protocol::csv(sensitivity, report.scene.dimension))?;
                    }
                }
            }
        }
        Ok(())
    }

    /// One of the states of a sample.
    fn state<'a, const D: usize>(
        &mut self,
        path: &str,
        file: DataFile,
        (states, field): (&StatesOf<D>, &DisplacementField<D>),
        result: &'a SampleResult,
        origin: &dyn Fn(&'static str, f64, &'a Certificate) -> Origin<'a>,
    ) -> Result<(), ReportError> {
        let (inflated, inflation) = (&states.inflated, &result.inflation);
        match file {
            DataFile::Before => {
                let origin = origin("before", inflated.before.pressure, &inflation.before.certificate);
                self.packing(path, inflated.before.packing.get(), &[], &origin)
            }
            DataFile::Displacement => {
                let origin = origin("inflated", inflated.after.pressure, &inflation.after.certificate);
                #[cfg(feature = "linear")]
                let plastic = states.plastic_field.as_ref();
                #[cfg(not(feature = "linear"))]
                let plastic = None;
                self.field(path, inflated.after.packing.get(), (field, plastic), &origin)
            }
            DataFile::Deflated => {
                let rest = inflated.deflated.as_ref().zip(inflation.deflated.as_ref());
                let Some((field, (rest, summary))) = states.cycle_field.as_ref().zip(rest) else { return Ok(()) };
                let origin = origin("deflated", rest.pressure, &summary.certificate);
                self.field(path, rest.packing.get(), (field, None), &origin)
            }
            _ => {
                let origin = origin("prepared", result.packing.pressure, &result.packing.certificate);
                self.packing(path, &states.prepared, &[], &origin)
            }
        }
    }

    fn packing<const D: usize>(
        &mut self,
        name: &str,
        packing: &Packing<D>,
        columns: &[Column],
        origin: &Origin<'_>,
    ) -> Result<(), ReportError> {
        let path = self.folder.join(name);
        let (law, seed, pressure) =
            (law(&origin.report.scene.law), origin.sample.seed.to_string(), format!("{:?}", origin.pressure));
        let numbers = [numbers_of(&origin.report.scene.law), numbers_known(origin.certificate)].concat();
        let mut properties = vec![
            ("jamscope_version", origin.report.jamscope_version),
            ("sample", origin.sample.name.as_str()),
            ("state", origin.state),
            ("law", law.as_str()),
            ("seed", seed.as_str()),
            ("pressure", pressure.as_str()),
        ];
        let outer_radius = format!("{:?}", origin.outer_radius);
        if packing.held().contains(&true) {
            properties.push(("outer_radius", outer_radius.as_str()));
        }
        properties.extend(numbers.iter().map(|(key, value)| (*key, value.as_str())));
        write_packing(&path, packing, columns, &properties)?;
        self.written.push(name.into());
        Ok(())
    }

    /// A packing with its displacements, and their plastic part, if that is known.
    fn field<const D: usize>(
        &mut self,
        name: &str,
        packing: &Packing<D>,
        (field, plastic): (&DisplacementField<D>, Option<&DisplacementField<D>>),
        origin: &Origin<'_>,
    ) -> Result<(), ReportError> {
        let columns = ResponseColumns::of(packing.len(), field, plastic);
        self.packing(name, packing, &columns.columns(), origin)
    }
}

/// The single numbers of a certificate.
fn numbers_known(certificate: &Certificate) -> Vec<(&'static str, String)> {
    let mut known = vec![
        ("relative_residual", format!("{:?}", certificate.relative_residual)),
        ("rounding_floor", format!("{:?}", certificate.rounding_floor)),
        ("rattlers", certificate.rattler_count.to_string()),
        ("bucklers", certificate.buckler_count.to_string()),
    ];
    known.extend(certificate.contacts.map(|contacts| ("excess_contacts", contacts.excess.to_string())));
    #[cfg(feature = "linear")]
    known.extend(certificate.stability.negative_eigenvalue_count().map(|n| ("negative_eigenvalues", n.to_string())));
    known
}

/// Origin of a packing, for the comment line of its file.
struct Origin<'a> {
    report: &'a Report,
    sample: &'a SampleReport,
    state: &'a str,
    /// Pressure of the box, or of the circle after the cut \[force / length\].
    pressure: f64,
    /// R \[length\].
    outer_radius: f64,
    certificate: &'a Certificate,
}

/// Wall times of one sample \[s\].
#[derive(Serialize)]
struct Timing<'a> {
    sample: &'a str,
    preparation_seconds: f64,
    before_inflation_seconds: f64,
    after_inflation_seconds: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    after_deflation_seconds: Option<f64>,
    /// Time of the compared relaxers, without Newton's method after them.
    #[cfg(feature = "linear")]
    #[serde(skip_serializing_if = "Option::is_none")]
    protocols_seconds: Option<f64>,
}

/// Wall times of the relaxations of all samples with a result.
fn timings(report: &Report) -> Vec<Timing<'_>> {
    let timing = |sample| {
        let result: &SampleResult = done(sample)?;
        Some(Timing {
            sample: &sample.name,
            preparation_seconds: result.packing.rest.cost.seconds,
            before_inflation_seconds: result.inflation.before.rest.cost.seconds,
            after_inflation_seconds: result.inflation.after.rest.cost.seconds,
            after_deflation_seconds: result.inflation.deflated.as_ref().map(|state| state.rest.cost.seconds),
            #[cfg(feature = "linear")]
            protocols_seconds: crate::report::protocol::measured(result)
                .map(|it| it.endings.iter().map(|ending| ending.cost.seconds).sum()),
        })
    };
    report.samples.iter().filter_map(timing).collect()
}
