//! `jamscope exact amplitude`: the amplitude of the response of a screened medium, as a function of its wavenumber.

use clap::Args;
use jamscope::reference::amplitude::Amplitude;
use jamscope::reference::{Annulus, ReferenceError};

use super::annulus::{AnnulusArguments, refused};
use super::grid::places;
use super::table::{Cell, Table};
use crate::Failure;

#[derive(Args)]
pub struct AmplitudeArguments {
    #[command(flatten)]
    annulus: AnnulusArguments,
    /// Wavenumbers κ, separated by commas [1/length].
    #[arg(long, value_name = "KAPPAS", value_delimiter = ',', allow_hyphen_values = true, conflicts_with_all = ["count", "from", "to"])]
    wavenumbers: Option<Vec<f64>>,
    /// Number of evenly spaced wavenumbers.
    #[arg(long, value_name = "N", default_value_t = 101)]
    count: u64,
    /// First wavenumber [1/length].
    #[arg(long, value_name = "KAPPA", default_value_t = 0.0, allow_negative_numbers = true)]
    from: f64,
    /// Last wavenumber [1/length]; by default 10/(R − a), which is beyond the first two poles.
    #[arg(long, value_name = "KAPPA", allow_negative_numbers = true)]
    to: Option<f64>,
}

impl AmplitudeArguments {
    pub fn table(&self) -> Result<Table<'_>, Failure> {
        let annulus = self.annulus.annulus()?;
        match self.annulus.dimension {
            3 => self.of_dimension::<3>(annulus),
            _ => self.of_dimension::<2>(annulus),
        }
    }

    fn of_dimension<const D: usize>(&self, annulus: Annulus) -> Result<Table<'_>, Failure> {
        let amplitude = Amplitude::<D>::new(annulus);
        let to = self.to.unwrap_or(10.0 / (annulus.outer_radius() - annulus.inner_radius()));
        let given: Vec<(&str, f64)> = match &self.wavenumbers {
            Some(list) => list.iter().map(|&wavenumber| ("wavenumbers", wavenumber)).collect(),
            None => vec![("from", self.from), ("to", to)],
        };
        for (argument, wavenumber) in given {
            // A pole has its own row.
            match amplitude.at(wavenumber) {
                Ok(_) | Err(ReferenceError::AtPole { .. }) => {}
                Err(error) => return Err(refused(argument, wavenumber, error)),
            }
        }
        if self.wavenumbers.is_none() && to <= self.from {
            return Err(refused("to", to, format!("must be larger than --from {}", self.from)));
        }
        let wavenumbers = places(self.wavenumbers.as_deref(), self.count, self.from, to)?;
        Ok(Table {
            solution: "amplitude",
            columns: vec![("wavenumber", "1/length"), ("pole", "1"), ("amplitude", "1")],
            rows: Box::new(wavenumbers.map(move |wavenumber| row(&amplitude, wavenumber))),
        })
    }
}

/// `pole` is the index of the pole at this wavenumber, to rounding, where there is no amplitude; otherwise 0.
fn row<const D: usize>(amplitude: &Amplitude<D>, wavenumber: f64) -> Vec<Cell> {
    let (pole, value) = match amplitude.at(wavenumber) {
        Ok(value) => (0, value),
        Err(ReferenceError::AtPole { index, .. }) => (index as u64, f64::NAN),
        Err(_) => (0, f64::NAN),
    };
    vec![Cell::Number(wavenumber), Cell::Count(pole), Cell::Number(value)]
}
