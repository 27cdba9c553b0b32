//! [`write()`]: a report as files in a folder.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::io::write_atomically;
use crate::precision::csv;
use crate::precision::results::PrecisionReport;
use crate::report::{Kind, OutputFolder, ReportError};

/// Writes a report into `folder`, which is created if necessary. Returns the paths of the files in the order written.
///
/// All files of an earlier report are replaced together; other files are not changed.
///
/// # Errors
/// [`ReportError`] with the file and the problem.
pub fn write(report: &PrecisionReport, folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
    write_into(report, OutputFolder::open(folder, Kind::Precision)?)
}

/// Like [`write()`], into a folder that was opened before the measurement.
///
/// # Errors
/// [`ReportError`] with the file and the problem.
pub fn write_into(report: &PrecisionReport, output: OutputFolder) -> Result<Vec<PathBuf>, ReportError> {
    let folder = output.inside();
    let json_path = folder.join("precision.json");
    let json = serde_json::to_string_pretty(report).map_err(|source| ReportError::Json { path: json_path, source })?;
    #[cfg_attr(not(feature = "plot"), allow(unused_mut, reason = "figures are of the feature `plot`"))]
    let mut texts = vec![
        ("precision.csv".to_string(), csv::runs(report)),
        ("choices.csv".to_string(), csv::choices(report)),
        ("precision.json".to_string(), json + "\n"),
    ];
    #[cfg(feature = "plot")]
    {
        for sample in &report.samples {
            for (name, figure) in super::figure::figures(sample) {
                texts.push((format!("{}.{name}.svg", sample.name), figure.to_svg()));
            }
        }
        texts.push(("precision.html".to_string(), super::page::page(report)));
    }
    let mut written = Vec::new();
    for (name, text) in texts {
        write_atomically(folder.join(&name), |writer| writer.write_all(text.as_bytes()))?;
        written.push(name);
    }
    output.commit(written)
}
