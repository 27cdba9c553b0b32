//! [`ShellResponse`]: spectrum and correlation of one shell of spheres, and the fits to the spectrum.

use serde::Serialize;

use crate::displacement::DisplacementField;
#[cfg(feature = "fit")]
use crate::fit::angular::{CrossoverFit, SlopeFit, fit_shell_crossover, fit_shell_slope};
#[cfg(feature = "fit")]
use crate::observe::shell::ShellSample;
use crate::observe::shell::{ShellAnalysis, ShellError};
#[cfg(feature = "fit")]
use crate::response::measurement::Measurement;
use crate::scene::{Observables, ShellCorrelationSettings};

/// Spectrum and correlation of one shell, and the fits to the spectrum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShellResponse {
    /// S(ℓ), G(γ), G*, γ*.
    #[serde(flatten)]
    pub analysis: ShellAnalysis,
    /// Slope of log S against log ℓ.
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slope: Option<Measurement<SlopeFit>>,
    /// ℓ† and γ†.
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crossover: Option<Measurement<CrossoverFit>>,
}

impl ShellResponse {
    pub(super) fn of(
        field: &DisplacementField<3>,
        settings: &ShellCorrelationSettings,
        observables: &Observables,
        no_fit: Option<&str>,
    ) -> Result<Self, ShellError> {
        let ShellCorrelationSettings { relative_radius, half_width, .. } = *settings;
        #[cfg(not(feature = "fit"))]
        let _ = (observables, no_fit);
        #[cfg(feature = "fit")]
        let shell = match (observables.shell_fit, no_fit) {
            (Some(_), None) => vec![ShellSample::of_field(field, relative_radius, half_width)?],
            _ => Vec::new(),
        };
        Ok(ShellResponse {
            analysis: ShellAnalysis::of(field, relative_radius, half_width, &settings.shell)?,
            #[cfg(feature = "fit")]
            slope: observables.shell_fit.map(|fit| match no_fit {
                Some(reason) => Measurement::Refused(reason.into()),
                None => fit_shell_slope(&shell, &fit.slope).into(),
            }),
            #[cfg(feature = "fit")]
            crossover: observables.shell_fit.map(|fit| match no_fit {
                Some(reason) => Measurement::Refused(reason.into()),
                None => fit_shell_crossover(&shell, &fit.crossover).into(),
            }),
        })
    }
}
