//! The report of a study: figures of every cell and series, tables with intervals, what agrees with the literature.
//!
//! A figure is drawn where the study has what it shows; nothing is said of what it has not.

mod angular;
mod lengths;
mod order;
mod page;
mod radial;
mod scaling;
mod subject;

pub use page::study_page;
