//! [`write()`]: a report as files in a folder.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::io::write_atomically;
use crate::precision::csv;
use crate::precision::results::PrecisionReport;
use crate::report::ReportError;

/// Writes a report into `folder`, made if it is not there, and names the files written in that order.
///
/// Each file is there whole or not at all. Files of an earlier report with the same names are replaced, others left.
///
/// # Errors
/// [`ReportError`] names the file and what is wrong.
pub fn write(report: &PrecisionReport, folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
    std::fs::create_dir_all(folder).map_err(|source| ReportError::Folder { folder: folder.into(), source })?;
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
        let path = folder.join(name);
        write_atomically(&path, |writer| writer.write_all(text.as_bytes()))?;
        written.push(path);
    }
    Ok(written)
}
