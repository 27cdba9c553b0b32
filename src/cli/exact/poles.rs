//! `jamscope exact poles`: the wavenumbers at which the screened solution diverges, and its residues there.

use clap::Args;
use jamscope::reference::Annulus;
use jamscope::reference::amplitude::Amplitude;
use jamscope::reference::poles::pole;

use super::annulus::AnnulusArguments;
use super::table::{Cell, Table};
use crate::Failure;

#[derive(Args)]
pub struct PolesArguments {
    #[command(flatten)]
    annulus: AnnulusArguments,
    /// Number of poles, from the first.
    #[arg(long, value_name = "N", default_value_t = 20)]
    count: u32,
}

impl PolesArguments {
    pub fn table(&self) -> Result<Table<'_>, Failure> {
        if self.count == 0 {
            return Err("--count 0: must be at least 1".into());
        }
        let annulus = self.annulus.annulus()?;
        Ok(match self.annulus.dimension {
            3 => self.of_dimension::<3>(annulus),
            _ => self.of_dimension::<2>(annulus),
        })
    }

    fn of_dimension<const D: usize>(&self, annulus: Annulus) -> Table<'_> {
        let amplitude = Amplitude::<D>::new(annulus);
        Table {
            solution: "poles",
            columns: vec![
                ("pole", "1"),
                ("wavenumber", "1/length"),
                ("rim_argument", "1"),
                ("amplitude_residue", "1/length"),
            ],
            rows: Box::new((1..=self.count).map(move |index| {
                let wavenumber = pole::<D>(annulus, index as usize);
                let (reduced, residue) = (wavenumber * annulus.outer_radius(), amplitude.residue(index as usize));
                let numbers = [wavenumber, reduced, residue].map(Cell::Number);
                [vec![Cell::Count(index.into())], numbers.to_vec()].concat()
            })),
        }
    }
}
