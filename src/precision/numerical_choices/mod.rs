//! [`ChoiceTable`]: the effect of other numerical choices, measured on one sample.
//!
//! Ring widths and the range and search of the fit are varied on the first reference. The time step is varied on one
//! explicit trajectory from the inflated start; its reference is the same trajectory at a quarter of the shortest step.
//! The methods for the screened profile are compared on the annulus of the sample. Estimators of a ring are those of
//! disks.

mod angular;
#[cfg(feature = "fit")]
mod fits;
mod routes;
mod trajectory;

use serde::Serialize;

use crate::inflation::Grown;
use crate::law::damping::DampingChoice;
use crate::law::pair_law::PairLaw;
use crate::packing::PackingError;
use crate::precision::state::State;
use crate::scene::Observables;

/// One choice and its effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChoiceTable {
    /// Its name in files.
    pub name: &'static str,
    /// What is varied, and on which data, for readers.
    pub title: &'static str,
    /// Name of the first column, then the names of the numbers, with units.
    pub columns: Vec<&'static str>,
    /// One row per setting.
    pub rows: Vec<ChoiceRow>,
}

/// One setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChoiceRow {
    /// The setting.
    pub setting: String,
    /// One number per column; the last one, the time in seconds, differs between measurements.
    pub values: Vec<Option<f64>>,
}

/// All tables of a sample.
pub(super) fn choice_tables<const D: usize>(
    state: &State<D>,
    grown: &Grown<D>,
    law: &dyn PairLaw,
    damping: DampingChoice,
    observables: &Observables,
) -> Result<Vec<ChoiceTable>, PackingError> {
    #[cfg(feature = "fit")]
    let mut tables = fits::tables(state, grown, observables);
    #[cfg(not(feature = "fit"))]
    let (mut tables, _) = (Vec::new(), observables);
    let damping = law.contact_damping(&damping);
    tables.push(trajectory::time_steps(grown, law, &damping)?);
    tables.push(trajectory::skins(grown, law, &damping)?);
    let wavenumber = state.measured.fitted.map_or(0.0, |fitted| fitted.wavenumber);
    // A ring belongs to the plane.
    tables.extend(state.field(grown).in_plane().and_then(angular::estimators));
    tables.extend(routes::routes(grown, wavenumber));
    Ok(tables)
}
