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
#[cfg(all(feature = "fit", feature = "plot"))]
pub mod study;
pub mod table;

pub use error::ReportError;
#[cfg(feature = "fit")]
pub use files::write_study;
pub use files::{write, write_analyses, write_analyses_into, write_into};
pub use output::{Kind, OutputFolder};

#[cfg(doc)]
use crate::run::Report;
