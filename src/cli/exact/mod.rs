//! `jamscope exact`: any exact solution as a table, 17 significant digits.
//!
//! Each kind of solution has a file here with its arguments and `table`, and an entry in [`Solution`] and in
//! [`Solution::table`].

mod amplitude;
mod annulus;
mod bessel;
mod grid;
mod lorentzian;
mod mode;
mod poles;
mod profile;
mod radii;
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
    /// Radial displacement between the inflated disk and the rim, elastic or screened, with its derivatives.
    Profile(profile::ProfileArguments),
    /// Wavenumbers at which the screened solution has poles, with the residues of its amplitude.
    Poles(poles::PolesArguments),
    /// Amplitude of the screened solution over that of the elastic one, as a function of the wavenumber.
    Amplitude(amplitude::AmplitudeArguments),
    /// Angular mode in two dimensions, elastic or screened, even and odd.
    Mode(mode::ModeArguments),
    /// Bessel functions of orders zero and one.
    Bessel(bessel::BesselArguments),
    /// Correlation function, spectrum or threshold angles of the generalised Lorentzian.
    Lorentzian(lorentzian::LorentzianArguments),
}

impl Solution {
    fn table(&self) -> Result<table::Table<'_>, Failure> {
        match self {
            Solution::Profile(arguments) => arguments.table(),
            Solution::Poles(arguments) => arguments.table(),
            Solution::Amplitude(arguments) => arguments.table(),
            Solution::Mode(arguments) => arguments.table(),
            Solution::Bessel(arguments) => arguments.table(),
            Solution::Lorentzian(arguments) => arguments.table(),
        }
    }
}

/// Prints the table row by row; nothing is printed if an argument is invalid.
pub fn print(arguments: &ExactArguments) -> Result<(), Failure> {
    let table = arguments.solution.table()?;
    let mut output = std::io::BufWriter::new(std::io::stdout().lock());
    match if arguments.json { table.write_json(&mut output) } else { table.write_csv(&mut output) } {
        // A closed pipe (`| head`) is not an error.
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
