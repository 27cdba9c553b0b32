//! The results of a run, for people and for programs: a terminal table, data files, and, with the feature `plot`,
//! figures and one HTML page.
//!
//! Start from [`write()`], which fills a folder, and [`table::terminal_table`]. Nothing is computed here: a report
//! presents a [`Report`] with units. What its scene does not request has no row, no column and no file.
//!
//! | file | content |
//! |---|---|
//! | `report.json` | the whole [`Report`], every number to the last bit, no wall times |
//! | `timings.json` | wall times \[s\], the only file in which two runs of one scene differ |
//! | `NAME.packing.xyz` | the prepared packing, if the scene asks for the displacement field |
//! | `NAME.before.xyz` | the packing before the inflation, cut out and with its rim held if the scene requests it |
//! | `NAME.displacement.xyz` | the packing after the inflation, with its displacement field |
//! | `NAME.deflated.xyz` | the packing after the deflation, with the displacement that remains |
//! | `NAME.radial_profile.csv` | mean radial displacement, ring by ring, and the fitted solutions |
//! | `NAME.angular_profiles.csv` | radial displacement against angle |
//! | `NAME.angular_correlation.csv` | G(θ) in one ring |
//! | `NAME.power_spectrum.csv` | S(f) in that ring |
//! | `NAME.radial_dependence.csv` | G*, θ* in rings from the inflated disk to the rim |
//! | `NAME.multipoles.csv` | amplitudes and phases of angular modes, ring by ring |
//! | `NAME.contact_changes.csv` | contacts made and broken, with their positions |
//! | `NAME.bond_changes.csv` | the stretch of every bond |
//! | `NAME.isostatic_length.csv` | the curve from which ℓ_iso is read |
//! | `NAME.plastic_profile.csv` | radial profile of the plastic part |
//! | `NAME.drive_modes.csv` | angular modes of a force, a dipole or a displaced disk, beside those of the continuum |
//! | `NAME.protocol.csv` | the end state of every relaxer, if the scene compares them |
//! | `report.html` | all of it on one page (feature `plot`) |

mod columns;
pub mod csv;
mod curve;
mod data_file;
mod error;
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
mod state_file;
#[cfg(all(feature = "fit", feature = "plot"))]
pub mod study;
pub mod table;

pub use columns::DiskResponse;
pub use error::ReportError;
#[cfg(feature = "fit")]
pub use files::write_study;
pub use files::{write, write_analyses, write_analyses_into, write_into};
pub use output::{Kind, OutputFolder};
pub use state_file::write_state;

#[cfg(doc)]
use crate::run::Report;
