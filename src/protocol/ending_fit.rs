//! [`EndingFit`]: what is fitted to the radial profile of an ending.

use serde::Serialize;

use crate::displacement::DisplacementField;
use crate::fit::profile::{Decision, ProfileFit, ProfileFitSettings, fit_radial_profile};
use crate::inflation::Inflated;
use crate::observe::RadialProfile;
use crate::protocol::{Compared, Spreads};
use crate::reference::Annulus;

/// A fit in the numbers that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EndingFit {
    /// What describes the profile.
    pub decision: Decision,
    /// d_0^eff of the elastic solution \[length\].
    pub elastic_amplitude: f64,
    /// The screened solution, where there is one.
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

impl Compared<2> {
    /// Fits the response of every ending at rest, counted from the state before, and adds the spreads.
    ///
    /// An ending whose profile cannot be fitted has no fit.
    pub fn fit(&mut self, inflated: &Inflated<2>, ring_width: f64, settings: &ProfileFitSettings) {
        let Ok(annulus) = Annulus::new(inflated.inner_radius, inflated.outer_radius) else { return };
        for (ending, state) in self.sensitivity.endings.iter_mut().zip(&self.states) {
            let Some(after) = state else { continue };
            let response = Inflated { after: after.clone(), deflated: None, ..inflated.clone() };
            let profile = RadialProfile::of(&DisplacementField::of_inflation(&response), ring_width);
            ending.fit = fit_radial_profile(&profile, annulus, settings).ok().map(EndingFit::from);
        }
        self.sensitivity.spreads = Spreads::of(&self.sensitivity.endings);
    }
}
