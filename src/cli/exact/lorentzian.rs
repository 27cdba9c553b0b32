//! `jamscope exact lorentzian`: the generalised Lorentzian and both its limits.

use std::f64::consts::PI;

use clap::Args;
use jamscope::reference::lorentzian::{ContinuumLorentzian, Crossing, Lorentzian, LorentzianError, USUAL_EXPONENT};

use super::grid::places;
use super::table::{Cell, Table};
use crate::Failure;

#[derive(Args)]
pub struct LorentzianArguments {
    /// Crossover frequency f† [1]; 0 is the scale-free limit, inf is the continuum limit, as a function of f†θ.
    #[arg(long, value_name = "F", allow_negative_numbers = true)]
    frequency: f64,
    /// Exponent s of the spectrum [1].
    #[arg(long, value_name = "S", default_value_t = USUAL_EXPONENT, allow_negative_numbers = true)]
    exponent: f64,
    /// G at these angles, separated by commas [rad].
    #[arg(long, value_name = "ANGLES", value_delimiter = ',', allow_hyphen_values = true, group = "what")]
    angles: Option<Vec<f64>>,
    /// G at N evenly spaced angles from 0 to π (f†θ from 0 to 10 if the frequency is inf).
    #[arg(long, value_name = "N", default_value_t = 101, group = "what")]
    count: u64,
    /// S(f) at f = 1 to N instead.
    #[arg(long, value_name = "N", group = "what")]
    spectrum: Option<u64>,
    /// The first angles at which G falls to these values instead, separated by commas.
    #[arg(long, value_name = "VALUES", value_delimiter = ',', allow_hyphen_values = true, group = "what")]
    thresholds: Option<Vec<f64>>,
}

/// The spectrum of a table.
enum Medium {
    Discrete(Lorentzian),
    Continuum(ContinuumLorentzian),
}

impl Medium {
    fn of(frequency: f64, exponent: f64) -> Result<Self, LorentzianError> {
        Ok(if frequency == 0.0 {
            Medium::Discrete(Lorentzian::scale_free(exponent)?)
        } else if frequency == f64::INFINITY {
            Medium::Continuum(ContinuumLorentzian::new(exponent)?)
        } else {
            Medium::Discrete(Lorentzian::new(frequency, exponent)?)
        })
    }

    /// Name and unit of the angle, and the end of its range.
    fn angle(&self) -> ((&'static str, &'static str), f64) {
        match self {
            Medium::Discrete(_) => (("angle", "rad"), PI),
            Medium::Continuum(_) => (("reduced_angle", "1"), 10.0),
        }
    }

    fn correlation(&self, angle: f64) -> [f64; 2] {
        match self {
            Medium::Discrete(medium) => [medium.correlation(angle), medium.derivative(angle)],
            Medium::Continuum(limit) => [limit.correlation(angle), limit.derivative(angle)],
        }
    }

    fn crossing(&self, threshold: f64) -> Result<Crossing, LorentzianError> {
        match self {
            Medium::Discrete(medium) => medium.crossing(threshold),
            Medium::Continuum(limit) => limit.crossing(threshold),
        }
    }
}

impl LorentzianArguments {
    pub fn table(&self) -> Result<Table<'_>, Failure> {
        let medium = Medium::of(self.frequency, self.exponent).map_err(named)?;
        if let Some(count) = self.spectrum {
            return spectrum(medium, count);
        }
        match &self.thresholds {
            Some(thresholds) => crossings(&medium, thresholds),
            None => self.correlation(medium),
        }
    }

    fn correlation(&self, medium: Medium) -> Result<Table<'_>, Failure> {
        let (column, end) = medium.angle();
        if let Some(angle) = self.angles.iter().flatten().find(|angle| !angle.is_finite()) {
            return Err(format!("--angles {angle}: must be finite").into());
        }
        let angles = places(self.angles.as_deref(), self.count, 0.0, end)?;
        let per_angle = if column.1 == "rad" { "1/rad" } else { "1" };
        Ok(Table {
            solution: "lorentzian",
            columns: vec![column, ("correlation", "1"), ("derivative", per_angle)],
            rows: Box::new(angles.map(move |angle| {
                let [value, slope] = medium.correlation(angle);
                [angle, value, slope].map(Cell::Number).to_vec()
            })),
        })
    }
}

fn spectrum<'a>(medium: Medium, count: u64) -> Result<Table<'a>, Failure> {
    let Medium::Discrete(medium) = medium else {
        return Err("--spectrum: the limit --frequency inf has S = 1 at every frequency".into());
    };
    if count == 0 {
        return Err("--spectrum 0: must be at least 1".into());
    }
    Ok(Table {
        solution: "lorentzian",
        columns: vec![("frequency", "1"), ("spectrum", "1"), ("share", "1")],
        rows: Box::new((1..=count).map(move |frequency| {
            let value = medium.spectrum(frequency as f64);
            vec![Cell::Count(frequency), Cell::Number(value), Cell::Number(value / medium.total())]
        })),
    })
}

/// One row per threshold: `crosses` is 1 if G falls to it, otherwise 0 (the angle is then NaN).
fn crossings<'a>(medium: &Medium, thresholds: &[f64]) -> Result<Table<'a>, Failure> {
    let rows = thresholds
        .iter()
        .map(|&threshold| {
            let crossing = medium.crossing(threshold).map_err(named)?;
            let angle = crossing.angle().unwrap_or(f64::NAN);
            Ok(vec![Cell::Number(threshold), Cell::Count(crossing.angle().is_some().into()), Cell::Number(angle)])
        })
        .collect::<Result<Vec<_>, Failure>>()?;
    let (column, _) = medium.angle();
    Ok(Table {
        solution: "lorentzian",
        columns: vec![("threshold", "1"), ("crosses", "1"), column],
        rows: Box::new(rows.into_iter()),
    })
}

/// The error with the argument that caused it.
fn named(error: LorentzianError) -> Failure {
    let (argument, value) = match error {
        LorentzianError::CrossoverNotPositive { crossover } => ("frequency", crossover),
        LorentzianError::ExponentOutOfRange { exponent } => ("exponent", exponent),
        LorentzianError::ThresholdNotBelowOne { threshold } => ("thresholds", threshold),
        _ => return error.into(),
    };
    format!("--{argument} {value}: {error}").into()
}
