//! `jamscope exact bessel`: the Bessel functions of the profiles.

use clap::{Args, ValueEnum};
use jamscope::reference::bessel::{cylinder, modified, spherical};

use super::annulus::refused;
use super::table::{Cell, Table};
use crate::Failure;

#[derive(Args)]
pub struct BesselArguments {
    /// Order of the function.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=1))]
    order: u8,
    /// Kind of the function.
    #[arg(long, value_name = "KIND")]
    kind: Kind,
    /// Compute the spherical functions j, y, i, k instead of J, Y, I, K.
    #[arg(long)]
    spherical: bool,
    /// Compute the scaled functions e^(-|x|) I(x) and e^x K(x).
    #[arg(long)]
    scaled: bool,
    /// Arguments x, separated by commas [1].
    #[arg(long, value_name = "ARGUMENTS", value_delimiter = ',', allow_hyphen_values = true, required = true)]
    arguments: Vec<f64>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Kind {
    /// Finite at 0, oscillating.
    J,
    /// Infinite at 0, oscillating.
    Y,
    /// Finite at 0, growing.
    I,
    /// Infinite at 0, decaying.
    K,
}

impl BesselArguments {
    pub fn table(&self) -> Result<Table<'_>, Failure> {
        let function = self.function()?;
        if let Some(argument) = self.arguments.iter().find(|argument| argument.is_nan()) {
            return Err(refused("arguments", argument, "must be a number"));
        }
        let unbounded = matches!(self.kind, Kind::Y | Kind::K);
        if let Some(argument) = self.arguments.iter().find(|&&argument| unbounded && argument < 0.0) {
            return Err(refused("arguments", argument, "y and k have no real value below 0"));
        }
        Ok(Table {
            solution: "bessel",
            columns: vec![("argument", "1"), ("value", "1")],
            rows: Box::new(self.arguments.iter().map(move |&x| [x, function(x)].map(Cell::Number).to_vec())),
        })
    }

    fn function(&self) -> Result<fn(f64) -> f64, Failure> {
        let of_order = |functions: [fn(f64) -> f64; 2]| functions[usize::from(self.order)];
        Ok(match (self.kind, self.spherical, self.scaled) {
            (Kind::J | Kind::Y, _, true) => {
                return Err("--scaled: possible only for the kinds i and k".into());
            }
            (Kind::J, false, false) => of_order([cylinder::j0, cylinder::j1]),
            (Kind::Y, false, false) => of_order([cylinder::y0, cylinder::y1]),
            (Kind::I, false, false) => of_order([modified::i0, modified::i1]),
            (Kind::K, false, false) => of_order([modified::k0, modified::k1]),
            (Kind::I, false, true) => of_order([modified::i0_scaled, modified::i1_scaled]),
            (Kind::K, false, true) => of_order([modified::k0_scaled, modified::k1_scaled]),
            (Kind::J, true, false) => of_order([spherical::j0, spherical::j1]),
            (Kind::Y, true, false) => of_order([spherical::y0, spherical::y1]),
            (Kind::I, true, false) => of_order([spherical::i0, spherical::i1]),
            (Kind::K, true, false) => of_order([spherical::k0, spherical::k1]),
            (Kind::I, true, true) => of_order([spherical::i0_scaled, spherical::i1_scaled]),
            (Kind::K, true, true) => of_order([spherical::k0_scaled, spherical::k1_scaled]),
        })
    }
}
