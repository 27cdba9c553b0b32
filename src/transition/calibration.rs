//! The [`Calibration`] of phases by the samples of a study.

use crate::response::{CalibratedCell, CalibratedEnsemble, Calibration};
use crate::study::{Merged, Target};
use crate::transition::pressure::Method;
use crate::transition::series::Series;

/// Significant digits of p̂_c: its interval is tens of percent wide.
const DIGITS: usize = 3;

/// How often samples of every series are classified in each phase, by type of evidence.
pub(super) fn calibration(merged: &Merged, series: &[Series]) -> Calibration {
    let ensemble = |one: &Series| {
        let critical = |method| {
            let found = one.estimates.iter().find(|estimate| estimate.method == method)?.pressure.best()?;
            format!("{found:.*e}", DIGITS - 1).parse().ok()
        };
        let cell = |place: usize, mean: f64| {
            let samples = &merged.samples[place];
            let reduced_pressure = match samples.cell.target {
                Target::ReducedPressure(asked) => asked,
                Target::Pressure(_) | Target::PackingFraction(_) => mean,
            };
            CalibratedCell { reduced_pressure, counts: samples.evidence }
        };
        CalibratedEnsemble {
            law: one.cell.law.name().into(),
            relaxer: one.cell.relaxer.description(),
            disk_count: one.cell.disk_count,
            increase: one.cell.increase,
            critical_by_wavenumber: critical(Method::Wavenumber),
            critical_by_pressure_change: critical(Method::PressureChange),
            cells: one.points.iter().map(|point| cell(point.cell, point.reduced_pressure)).collect(),
        }
    };
    Calibration { ensembles: series.iter().map(ensemble).collect() }
}
