//! `jamscope exact profile`: the radial displacement, elastic, screened, or on an elastic foundation.

use clap::Args;
use jamscope::reference::antiscreened::Antiscreened;
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};

use super::annulus::{AnnulusArguments, named};
use super::radii::RadiiArguments;
use super::table::{Cell, Table};
use crate::Failure;

#[derive(Args)]
pub struct ProfileArguments {
    #[command(flatten)]
    annulus: AnnulusArguments,
    /// Wavenumber κ [1/length] of the screening; 0 is the elastic medium.
    #[arg(long, value_name = "KAPPA", default_value_t = 0.0, allow_negative_numbers = true)]
    wavenumber: f64,
    /// Use the opposite sign of κ²: a medium on an elastic foundation, without poles.
    #[arg(long)]
    antiscreened: bool,
    /// Displacement d_0 of the edge of the inflated disk [length].
    #[arg(long, value_name = "LENGTH", default_value_t = 0.1, allow_negative_numbers = true)]
    amplitude: f64,
    #[command(flatten)]
    radii: RadiiArguments,
}

impl ProfileArguments {
    pub fn table(&self) -> Result<Table<'_>, Failure> {
        let annulus = self.annulus.annulus()?;
        match self.annulus.dimension {
            3 => self.of_dimension::<3>(annulus),
            _ => self.of_dimension::<2>(annulus),
        }
    }

    fn of_dimension<const D: usize>(&self, annulus: Annulus) -> Result<Table<'_>, Failure> {
        let (amplitude, wavenumber) = (self.amplitude, self.wavenumber);
        if self.antiscreened {
            let medium = Antiscreened::<D>::new(annulus, amplitude, wavenumber).map_err(named)?;
            self.of(annulus, medium, Antiscreened::wavenumber_derivative)
        } else {
            let medium = Screened::<D>::new(annulus, amplitude, wavenumber).map_err(named)?;
            self.of(annulus, medium, Screened::wavenumber_derivative)
        }
    }

    fn of<'a, Medium: RadialSolution + 'a>(
        &'a self,
        annulus: Annulus,
        medium: Medium,
        wavenumber_derivative: fn(&Medium, f64) -> f64,
    ) -> Result<Table<'a>, Failure> {
        let radii = self.radii.within(annulus)?;
        Ok(Table {
            solution: "profile",
            columns: vec![
                ("radius", "length"),
                ("radial_displacement", "length"),
                ("derivative", "1"),
                ("wavenumber_derivative", "length^2"),
            ],
            rows: Box::new(radii.map(move |radius| {
                let (value, slope) = (medium.value(radius), medium.derivative(radius));
                [radius, value, slope, wavenumber_derivative(&medium, radius)].map(Cell::Number).to_vec()
            })),
        })
    }
}
