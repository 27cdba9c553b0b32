//! `jamscope exact`: any exact solution as a table, 17 significant digits.
//!
//! A kind of solution is a file here with its arguments and `table`, and a line in [`Solution`] and in [`Solution::table`].

mod annulus;
mod grid;
mod lorentzian;
mod poles;
mod profile;
mod table;

use clap::{Args, Subcommand};

use crate::Failure;

#[derive(Args)]
pub struct ExactArguments {
    #[command(subcommand)]
    solution: Solution,
    /// Print JSON instead of comma-separated values.
    #[arg(long, global = true)]
    json: bool,
}

#[derive(Subcommand)]
enum Solution {
    /// Radial displacement between the inflated disk and the rim, elastic or screened, with its derivative.
    Profile(profile::ProfileArguments),
    /// Wavenumbers at which the screened solution has poles.
    Poles(poles::PolesArguments),
    /// Correlation function, spectrum or threshold angles of the generalised Lorentzian.
    Lorentzian(lorentzian::LorentzianArguments),
}

impl Solution {
    fn table(&self) -> Result<table::Table<'_>, Failure> {
        match self {
            Solution::Profile(arguments) => arguments.table(),
            Solution::Poles(arguments) => arguments.table(),
            Solution::Lorentzian(arguments) => arguments.table(),
        }
    }
}

/// Prints the table row by row; nothing is printed if an argument makes no sense.
pub fn print(arguments: &ExactArguments) -> Result<(), Failure> {
    let table = arguments.solution.table()?;
    let mut output = std::io::BufWriter::new(std::io::stdout().lock());
    match if arguments.json { table.write_json(&mut output) } else { table.write_csv(&mut output) } {
        // A reader that has gone away (`| head`) is no failure.
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
