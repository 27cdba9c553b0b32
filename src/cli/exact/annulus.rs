//! Arguments of all solutions between an inflated disk and a rim.

use std::fmt::Display;

use clap::Args;
use jamscope::reference::{Annulus, ReferenceError};

use crate::Failure;

#[derive(Args)]
pub struct AnnulusArguments {
    /// Dimension of space.
    #[arg(long, value_name = "D", default_value_t = 2, value_parser = clap::value_parser!(u8).range(2..=3))]
    pub dimension: u8,
    #[command(flatten)]
    circles: CirclesArguments,
}

impl AnnulusArguments {
    pub fn annulus(&self) -> Result<Annulus, Failure> {
        self.circles.annulus()
    }
}

/// Both radii, for solutions with a fixed dimension.
#[derive(Args)]
pub struct CirclesArguments {
    /// Radius a of the inflated disk [length].
    #[arg(long, value_name = "LENGTH", default_value_t = 0.5, allow_negative_numbers = true)]
    pub inner: f64,
    /// Radius R of the held rim [length].
    #[arg(long, value_name = "LENGTH", default_value_t = 170.0, allow_negative_numbers = true)]
    pub outer: f64,
}

impl CirclesArguments {
    pub fn annulus(&self) -> Result<Annulus, Failure> {
        Annulus::new(self.inner, self.outer).map_err(named)
    }
}

/// The error with the argument that caused it.
pub fn named(error: ReferenceError) -> Failure {
    let (argument, value) = match error {
        ReferenceError::InnerRadiusNotPositive { inner_radius } => ("inner", inner_radius),
        ReferenceError::OuterRadiusNotLarger { outer_radius, .. } => ("outer", outer_radius),
        ReferenceError::AmplitudeNotFinite { amplitude } => ("amplitude", amplitude),
        ReferenceError::WavenumberNegative { wavenumber } => ("wavenumber", wavenumber),
        ReferenceError::AtPole { wavenumber, .. } => ("wavenumber", wavenumber),
        _ => return error.into(),
    };
    refused(argument, value, error)
}

/// An argument, its value, and the error.
pub fn refused(argument: &str, value: impl Display, error: impl Display) -> Failure {
    format!("--{argument} {value}: {error}").into()
}
