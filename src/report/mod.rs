//! What a run came to, for people and for programs: a terminal table, data files, and, with the feature `plot`, figures
//! and one HTML page.
//!
//! Start from [`write()`], which fills a folder, and [`table::terminal_table`]. Nothing is computed here that a stage
//! computes: a report is a [`Report`] written down, with units. What its scene did not ask for has no row, no column and
//! no file.
//!
//! | file | content |
//! |---|---|
//! | `report.json` | the whole [`Report`], every number to the last bit, no wall times |
//! | `timings.json` | wall times \[s\], the only file in which two runs of one scene differ |
//! | `NAME.packing.xyz` | the prepared packing, if the scene asks for the displacement field |
//! | `NAME.before.xyz` | the packing before the inflation, cut out of it and with its rim held where the scene says so |
//! | `NAME.displacement.xyz` | the packing after the inflation, with its displacement field |
//! | `NAME.deflated.xyz` | the same after the deflation: what is left of the displacement |
//! | `NAME.radial_profile.csv` | mean radial displacement, ring by ring, and the fitted solutions |
//! | `NAME.angular_profiles.csv` | radial displacement against angle |
//! | `NAME.angular_correlation.csv` | G(θ) in one ring |
//! | `NAME.power_spectrum.csv` | S(f) in that ring |
//! | `NAME.radial_dependence.csv` | G*, θ* in rings from the inflated disk to the rim |
//! | `NAME.multipoles.csv` | amplitudes and phases of angular modes, ring by ring |
//! | `NAME.contact_changes.csv` | contacts made and broken, with their places |
//! | `NAME.bond_changes.csv` | how much every bond is stretched |
//! | `NAME.isostatic_length.csv` | the curve ℓ_iso is read from |
//! | `NAME.plastic_profile.csv` | radial part of what is not in the linear response |
//! | `NAME.protocol.csv` | where every relaxer ended, if the scene compares them |
//! | `report.html` | all of it on one page (feature `plot`) |

pub mod csv;
mod curve;
mod data_file;
#[cfg(feature = "plot")]
pub mod figures;
mod files;
pub(crate) mod number;
pub mod output;
#[cfg(feature = "plot")]
pub mod page;
#[cfg(feature = "linear")]
mod protocol;
#[cfg(feature = "plot")]
mod response_page;
mod rows;
#[cfg(all(feature = "fit", feature = "plot"))]
pub mod study;
pub mod table;

use std::path::PathBuf;

#[cfg(feature = "fit")]
pub use files::write_study;
pub use files::{write, write_analyses, write_analyses_into, write_into};
pub use output::{Kind, OutputFolder};

use crate::io::WriteError;
#[cfg(doc)]
use crate::run::Report;

/// Why a report was not written; the files of an earlier one are then untouched, unless the error says otherwise.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The folder could not be made.
    #[error("{folder}: the folder could not be made: {source}")]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Nothing can be written into the folder.
    #[error("{folder}: nothing can be written into the folder: {source}")]
    NotWritable {
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file of this name cannot be made.
    #[error("{field} = \"{value}\": no file `{name}` ({} letters) can be made in {folder}: {source}", name.chars().count())]
    Name {
        /// What the name comes from.
        field: &'static str,
        /// Its value.
        value: String,
        /// The name.
        name: String,
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A complete report could not be put in its place; it stays complete, and the next command on the folder tries again.
    #[error(
        "{path}: {source}; the report is complete in a hidden folder beside it, and the next run or analysis of the folder moves it"
    )]
    Place {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Another process puts a report into the same folder and does not end.
    #[error(
        "{folder}: locked by another process; the report is complete in a hidden folder in it, and the next run or analysis of the folder moves it"
    )]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The report has no form as JSON.
    #[error("{path}: {source}")]
    Json {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: serde_json::Error,
    },
    /// A figure could not be drawn.
    #[cfg(feature = "plot")]
    #[error(transparent)]
    Figure(#[from] figures::FigureError),
}
