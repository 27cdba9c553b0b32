//! `jamscope exact profile`: the radial displacement, elastic and screened.

use clap::Args;
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};

use super::annulus::{AnnulusArguments, named};
use super::grid::places;
use super::table::{Cell, Table};
use crate::Failure;

#[derive(Args)]
pub struct ProfileArguments {
    #[command(flatten)]
    annulus: AnnulusArguments,
    /// Screening wavenumber κ [1/length]; 0 is the elastic medium.
    #[arg(long, value_name = "KAPPA", default_value_t = 0.0, allow_negative_numbers = true)]
    wavenumber: f64,
    /// Displacement d_0 of the edge of the inflated disk [length].
    #[arg(long, value_name = "LENGTH", default_value_t = 0.1, allow_negative_numbers = true)]
    amplitude: f64,
    /// Radii, separated by commas [length].
    #[arg(long, value_name = "LENGTHS", value_delimiter = ',', allow_hyphen_values = true, conflicts_with = "count")]
    radii: Option<Vec<f64>>,
    /// So many evenly spaced radii from disk to rim.
    #[arg(long, value_name = "N", default_value_t = 100)]
    count: u64,
}

impl ProfileArguments {
    pub fn table(&self) -> Result<Table<'_>, Failure> {
        let annulus = self.annulus.annulus()?;
        match self.annulus.dimension {
            3 => self.of(annulus, Screened::<3>::new(annulus, self.amplitude, self.wavenumber).map_err(named)?),
            _ => self.of(annulus, Screened::<2>::new(annulus, self.amplitude, self.wavenumber).map_err(named)?),
        }
    }

    fn of<'a>(&'a self, annulus: Annulus, medium: impl RadialSolution + 'a) -> Result<Table<'a>, Failure> {
        let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
        if let Some(radius) = self.radii.iter().flatten().find(|&&radius| !annulus.contains(radius)) {
            return Err(format!("--radii {radius}: not between disk and rim, {inner} to {outer}").into());
        }
        let radii = places(self.radii.as_deref(), self.count, inner, outer)?;
        Ok(Table {
            solution: "profile",
            columns: vec![("radius", "length"), ("radial_displacement", "length"), ("derivative", "1")],
            rows: Box::new(radii.map(move |radius| {
                [radius, medium.value(radius), medium.derivative(radius)].map(Cell::Number).to_vec()
            })),
        })
    }
}
