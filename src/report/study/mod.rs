//! The report of a study: figures of every cell and series, tables with intervals, and a comparison with the
//! literature.
//!
//! A figure is drawn only if the study has its data.

mod angular;
mod figure_data;
mod lengths;
mod order_parameters;
mod page;
mod radial;
mod scaling;

pub use page::study_page;
