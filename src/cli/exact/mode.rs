//! `jamscope exact mode`: an angular mode of the annulus, elastic or screened, in two dimensions.

use clap::Args;
use jamscope::reference::angular_modes::elastic::ElasticMode;
use jamscope::reference::angular_modes::screened::{ScreenedMode, Screening};
use jamscope::reference::angular_modes::{AngularModeError, AngularSolution, Complex, ModeAmplitudes};
use jamscope::reference::{Annulus, ReferenceError};

use super::annulus::{CirclesArguments, named, refused};
use super::radii::RadiiArguments;
use super::table::{Cell, Table};
use crate::Failure;

#[derive(Args)]
pub struct ModeArguments {
    #[command(flatten)]
    circles: CirclesArguments,
    /// n, the number of periods around the circle.
    #[arg(long, value_name = "N")]
    mode: u32,
    /// Poisson's ratio in two dimensions, between -1 and 1.
    #[arg(long, value_name = "NU", allow_negative_numbers = true)]
    poisson: f64,
    /// U at the inflated disk, u_r = Re[U e^(inθ)], such as 0.1, -0.1i or 0.1+0.2i [length].
    #[arg(long, value_name = "U", default_value = "0", allow_hyphen_values = true)]
    radial: Complex<f64>,
    /// V at the inflated disk, u_θ = Re[V e^(inθ)]; V = -i gives sin nθ [length].
    #[arg(long, value_name = "V", default_value = "0", allow_hyphen_values = true)]
    transverse: Complex<f64>,
    /// Even screening Γ_e over the shear modulus, of either sign [1/length²].
    #[arg(long, value_name = "GAMMA", allow_negative_numbers = true)]
    even: Option<f64>,
    /// Odd screening Γ_o over the shear modulus, of either sign [1/length²].
    #[arg(long, value_name = "GAMMA", allow_negative_numbers = true)]
    odd: Option<f64>,
    /// Wavenumber κ of the radial inflation, which sets the even screening Γ_e = 2κ²/(1 − ν) [1/length].
    #[arg(long, value_name = "KAPPA", allow_negative_numbers = true, conflicts_with_all = ["even", "odd"])]
    wavenumber: Option<f64>,
    #[command(flatten)]
    radii: RadiiArguments,
}

impl ModeArguments {
    pub fn table(&self) -> Result<Table<'_>, Failure> {
        let annulus = self.circles.annulus()?;
        let boundary = ModeAmplitudes { radial: self.radial, transverse: self.transverse };
        match self.screening()? {
            None => {
                let elastic = ElasticMode::new(annulus, self.poisson, self.mode, boundary);
                self.of(elastic.map_err(|error| self.named(error))?, annulus, None)
            }
            Some(screening) => {
                let screened = ScreenedMode::new(annulus, self.poisson, screening, self.mode, boundary);
                let screened = screened.map_err(|error| self.named(error))?;
                let condition = screened.condition();
                self.of(screened, annulus, Some(condition))
            }
        }
    }

    /// None if no argument sets a screening.
    fn screening(&self) -> Result<Option<Screening>, Failure> {
        if let Some(wavenumber) = self.wavenumber {
            if !(wavenumber >= 0.0 && wavenumber.is_finite()) {
                return Err(named(ReferenceError::WavenumberNegative { wavenumber }));
            }
            return Ok(Some(Screening::from_wavenumber(wavenumber, self.poisson)));
        }
        let screened = self.even.is_some() || self.odd.is_some();
        Ok(screened.then(|| Screening { even: self.even.unwrap_or(0.0), odd: self.odd.unwrap_or(0.0) }))
    }

    fn of<'a>(
        &'a self,
        mode: impl AngularSolution + 'a,
        annulus: Annulus,
        condition: Option<f64>,
    ) -> Result<Table<'a>, Failure> {
        let radii = self.radii.within(annulus)?;
        let mut columns = vec![
            ("radius", "length"),
            ("radial_real", "length"),
            ("radial_imaginary", "length"),
            ("transverse_real", "length"),
            ("transverse_imaginary", "length"),
            ("radial_derivative_real", "1"),
            ("radial_derivative_imaginary", "1"),
            ("transverse_derivative_real", "1"),
            ("transverse_derivative_imaginary", "1"),
        ];
        columns.extend(condition.map(|_| ("condition", "1")));
        Ok(Table {
            solution: "mode",
            columns,
            rows: Box::new(radii.map(move |radius| {
                let state = mode.at(radius);
                let parts = [state.value, state.derivative]
                    .into_iter()
                    .flat_map(|pair| [pair.radial.re, pair.radial.im, pair.transverse.re, pair.transverse.im]);
                std::iter::once(radius).chain(parts).chain(condition).map(Cell::Number).collect()
            })),
        })
    }

    /// The error with the argument that caused it.
    fn named(&self, error: AngularModeError) -> Failure {
        match error {
            AngularModeError::PoissonRatioOutside { poisson_ratio } => refused("poisson", poisson_ratio, error),
            AngularModeError::AmplitudeNotFinite { radial, .. } if !radial.is_finite() => {
                refused("radial", radial, error)
            }
            AngularModeError::AmplitudeNotFinite { transverse, .. } => refused("transverse", transverse, error),
            AngularModeError::ScreeningNotFinite { even, odd }
            | AngularModeError::ScreeningTooLarge { even, odd, .. }
            | AngularModeError::AtPole { even, odd, .. } => {
                let (argument, value) = self.strongest_screening(even, odd);
                refused(argument, value, error)
            }
            AngularModeError::TooManyNodes { mode, .. } => refused("mode", mode, error),
            _ => error.into(),
        }
    }

    /// The argument that caused the error of a screening: the one that is not finite, or the larger one.
    fn strongest_screening(&self, even: f64, odd: f64) -> (&'static str, f64) {
        match self.wavenumber {
            Some(wavenumber) => ("wavenumber", wavenumber),
            None if odd.is_nan() || odd.abs() > even.abs() => ("odd", odd),
            None => ("even", even),
        }
    }
}
