//! [`EndingFit`]: the fit to the radial profile of an ending.

use serde::Serialize;

use crate::fit::profile::{Decision, ProfileFit};

/// The numbers of a fit that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EndingFit {
    /// The solution that describes the profile.
    pub decision: Decision,
    /// d_0^eff of the elastic solution \[length\].
    pub elastic_amplitude: f64,
    /// The screened solution, if it was fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub screened: Option<EndingScreened>,
}

/// The screened solution of an ending.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EndingScreened {
    /// d_0^eff \[length\].
    pub amplitude: f64,
    /// κ \[1/length\].
    pub wavenumber: f64,
}

impl From<ProfileFit> for EndingFit {
    fn from(fit: ProfileFit) -> Self {
        let screened = fit.screened.map(|screened| EndingScreened {
            amplitude: screened.amplitude.value,
            wavenumber: screened.wavenumber.value,
        });
        EndingFit { decision: fit.decision, elastic_amplitude: fit.elastic.amplitude.value, screened }
    }
}
