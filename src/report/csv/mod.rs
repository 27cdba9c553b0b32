//! Observables as comma-separated values: a row of names, a row of units, then numbers; absent values are empty cells.
//!
//! Numbers are the shortest decimals that reproduce the `f64`.

pub(crate) mod response;
#[cfg(feature = "fit")]
pub(crate) mod transition;

use crate::observe::{AngularProfile, RadialProfile};
use crate::report::curve::{curves, fitted_range, power};
use crate::response::Response;
use crate::strain::ShearState;

/// Columns of equal length under names and units.
struct Table {
    names: Vec<String>,
    units: Vec<&'static str>,
    rows: Vec<String>,
}

impl Table {
    fn new(columns: &[(&str, &'static str)]) -> Self {
        let names = columns.iter().map(|(name, _)| (*name).into()).collect();
        let units = columns.iter().map(|(_, unit)| *unit).collect();
        Table { names, units, rows: Vec::new() }
    }

    /// Adds a column.
    fn column(&mut self, name: &str, unit: &'static str) {
        self.names.push(name.into());
        self.units.push(unit);
    }

    /// Adds a row of numbers.
    fn row<const N: usize>(&mut self, values: [f64; N]) {
        self.cells(values.map(Some).to_vec());
    }

    /// Adds a row in which some cells are empty.
    fn cells(&mut self, cells: Vec<Option<f64>>) {
        // Integers below 2⁵³ are written without a decimal point.
        let cells = cells.into_iter().map(|cell| cell.map_or(String::new(), |value| value.to_string()));
        self.rows.push(cells.collect::<Vec<_>>().join(","));
    }

    /// Adds a row with integers of more digits than an `f64` has: labels.
    fn mixed(&mut self, cells: &[&dyn std::fmt::Display]) {
        self.rows.push(cells.iter().map(|cell| cell.to_string()).collect::<Vec<_>>().join(","));
    }

    fn text(&self) -> String {
        let head = format!("{}\n{}\n", self.names.join(","), self.units.join(","));
        head + &self.rows.iter().map(|row| format!("{row}\n")).collect::<String>()
    }
}

/// A radial profile with the fitted solutions.
///
/// # Shape
/// One row per ring. `fitted` is 1 for rings used in the fit; `elastic` and `screened` are the fitted solutions r^(D−1) d_r
/// at the mean radius of the ring. These columns exist only if there was a fit, `screened` only if there is such a
/// solution.
pub fn radial_profile(response: &Response, profile: &RadialProfile) -> String {
    let power = power(response);
    let unit = if power == 2 { "length^3" } else { "length^2" };
    let mut table = Table::new(&[
        ("radius", "length"),
        ("disk_count", "1"),
        ("radial_displacement", "length"),
        ("spread", "length"),
        ("standard_error", "length"),
        ("rescaled_displacement", unit),
        ("rescaled_standard_error", unit),
    ]);
    let (curves, range) = (curves(response), fitted_range(response));
    if range.is_some() {
        table.column("fitted", "1");
    }
    for curve in &curves {
        table.column(curve.name, unit);
    }
    for ring in &profile.rings {
        let mut row = vec![
            ring.radius,
            ring.disk_count as f64,
            ring.mean,
            ring.spread,
            ring.standard_error,
            ring.radius.powi(power) * ring.mean,
            ring.radius.powi(power) * ring.standard_error,
        ];
        row.extend(range.map(|[from, to]| f64::from(u8::from(from <= ring.radius && ring.radius <= to))));
        row.extend(curves.iter().map(|curve| curve.rescaled(ring.radius)));
        table.cells(row.into_iter().map(Some).collect());
    }
    table.text()
}

/// Columns of [`shear_row`].
const SHEAR: [(&str, &str); 13] = [
    ("step", "1"),
    ("strain", "1"),
    ("shear_stress", "force/length^(D-1)"),
    ("pressure", "force/length^(D-1)"),
    ("energy", "energy"),
    ("contacts", "1"),
    ("coordination", "1"),
    ("made", "1"),
    ("broken", "1"),
    ("non_affine", "length"),
    ("dissipated", "energy"),
    ("event", "1"),
    ("residual", "1"),
];

/// Names and units of the columns of a shear.
pub fn shear_header() -> String {
    Table::new(&SHEAR).text()
}

/// One step of a shear.
pub fn shear_row(state: &ShearState) -> String {
    let mut table = Table::new(&SHEAR);
    table.row([
        state.step as f64,
        state.strain,
        state.shear_stress,
        state.pressure,
        state.energy,
        state.contact_count as f64,
        state.coordination,
        state.made_count as f64,
        state.broken_count as f64,
        state.non_affine,
        state.dissipated,
        f64::from(u8::from(state.is_event)),
        state.residual,
    ]);
    table.text().lines().skip(2).map(|line| format!("{line}\n")).collect()
}

/// Angular profiles, ring after ring.
///
/// # Shape
/// One row per disk.
pub fn angular_profiles(profiles: &[AngularProfile]) -> String {
    let mut table = Table::new(&[
        ("relative_radius", "1"),
        ("angle", "rad"),
        ("radius", "length"),
        ("radial_displacement", "length"),
        ("rescaled_displacement", "length^2"),
    ]);
    for profile in profiles {
        for ((&angle, &radial), &distance) in profile.angles.iter().zip(&profile.radial).zip(&profile.distances) {
            table.row([profile.relative_radius, angle, distance, radial, distance * radial]);
        }
    }
    table.text()
}

/// The angular modes that a drive excites, measured and of the continuum.
///
/// # Shape
/// One row per mode and ring: d_r = U cos n(θ − θ_0), d_θ = w sin n(θ − θ_0).
#[cfg(feature = "linear")]
pub fn drive_modes(drive: &crate::run::DriveSummary) -> String {
    let mut table = Table::new(&[
        ("mode", "1"),
        ("radius", "length"),
        ("disk_count", "1"),
        ("radial", "length"),
        ("radial_error", "length"),
        ("transverse", "length"),
        ("transverse_error", "length"),
        ("continuum_radial", "length"),
        ("continuum_transverse", "length"),
    ]);
    for ring in &drive.modes {
        let ([radial, radial_error], [transverse, transverse_error]) = (ring.radial, ring.transverse);
        let [exact, exact_transverse] = ring.exact;
        table.row([
            ring.mode as f64,
            ring.radius,
            ring.disk_count as f64,
            radial,
            radial_error,
            transverse,
            transverse_error,
            exact,
            exact_transverse,
        ]);
    }
    table.text()
}

/// The radial profile of a plastic part.
///
/// # Shape
/// One row per ring.
#[cfg(feature = "linear")]
pub fn plastic_profile(profile: &RadialProfile) -> String {
    let mut table = Table::new(&[
        ("radius", "length"),
        ("disk_count", "1"),
        ("plastic_radial_displacement", "length"),
        ("spread", "length"),
        ("standard_error", "length"),
    ]);
    for ring in &profile.rings {
        table.row([ring.radius, ring.disk_count as f64, ring.mean, ring.spread, ring.standard_error]);
    }
    table.text()
}
