//! `jamscope exact poles`: the wavenumbers at which the screened solution has no finite value.

use clap::Args;
use jamscope::reference::poles::pole;

use super::annulus::AnnulusArguments;
use super::table::{Cell, Table};
use crate::Failure;

#[derive(Args)]
pub struct PolesArguments {
    #[command(flatten)]
    annulus: AnnulusArguments,
    /// So many poles, from the first.
    #[arg(long, value_name = "N", default_value_t = 20)]
    count: u32,
}

impl PolesArguments {
    pub fn table(&self) -> Result<Table<'_>, Failure> {
        if self.count == 0 {
            return Err("--count 0: at least one pole".into());
        }
        let annulus = self.annulus.annulus()?;
        let of = if self.annulus.dimension == 3 { pole::<3> } else { pole::<2> };
        Ok(Table {
            solution: "poles",
            columns: vec![("pole", "1"), ("wavenumber", "1/length"), ("rim_argument", "1")],
            rows: Box::new((1..=self.count).map(move |index| {
                let wavenumber = of(annulus, index as usize);
                let reduced = wavenumber * annulus.outer_radius();
                vec![Cell::Count(index.into()), Cell::Number(wavenumber), Cell::Number(reduced)]
            })),
        })
    }
}
