//! Observables of every ending: [`Compared::measure_responses`], [`Compared::fit`].

use crate::displacement::DisplacementField;
#[cfg(feature = "fit")]
use crate::fit::profile::{ProfileFitSettings, fit_radial_profile};
use crate::inflation::Inflated;
use crate::law::pair_law::PairLaw;
use crate::observe::ContactChanges;
#[cfg(feature = "fit")]
use crate::observe::RadialProfile;
use crate::observe::angular::{AngularCorrelation, CorrelationSettings, RingSample, RingSettings};
use crate::packing::PackingError;
#[cfg(feature = "fit")]
use crate::protocol::ending_fit::EndingFit;
use crate::protocol::ending_response::EndingResponse;
use crate::protocol::sensitivity::Compared;
use crate::protocol::spread::Spreads;
#[cfg(feature = "fit")]
use crate::reference::Annulus;

#[cfg(feature = "fit")]
impl Compared<2> {
    /// Fits the response of every ending at rest, relative to the state before the inflation, and adds the spreads.
    ///
    /// An ending whose profile cannot be fitted has no fit.
    pub fn fit(&mut self, inflated: &Inflated<2>, ring_width: f64, settings: &ProfileFitSettings) {
        let Ok(annulus) = Annulus::new(inflated.inner_radius, inflated.outer_radius) else { return };
        for (ending, state) in self.sensitivity.endings.iter_mut().zip(&self.states) {
            let Some(after) = state else { continue };
            let response = Inflated { after: after.clone(), deflated: None, ..inflated.clone() };
            let profile = RadialProfile::of(&DisplacementField::of_inflation(&response), ring_width);
            ending.fit = fit_radial_profile::<2>(&profile, annulus, settings).ok().map(EndingFit::from);
        }
        self.sensitivity.spreads = Spreads::of(&self.sensitivity.endings);
    }
}

/// The threshold of θ* in the study \[1\].
const THRESHOLD: f64 = 0.1;

impl Compared<2> {
    /// Measures the response of every ending at rest, relative to the state before the inflation, and adds the spreads.
    ///
    /// # Errors
    /// Only conditions that make forces undefined.
    pub fn measure_responses(&mut self, inflated: &Inflated<2>, law: &dyn PairLaw) -> Result<(), PackingError> {
        let settings = CorrelationSettings { thresholds: vec![THRESHOLD], ..CorrelationSettings::default() };
        for (ending, state) in self.sensitivity.endings.iter_mut().zip(&self.states) {
            let Some(after) = state else { continue };
            let response = Inflated { after: after.clone(), deflated: None, ..inflated.clone() };
            let field = DisplacementField::of_inflation(&response);
            let ring = RingSample::of_field(&field, &RingSettings::default());
            let correlation = ring.and_then(|ring| AngularCorrelation::of(&ring, &settings)).ok();
            let changes = ContactChanges::of_inflation(&response, law)?;
            ending.response = Some(EndingResponse {
                // A ring without variance gives NaN.
                anticorrelation: correlation.as_ref().map(|it| it.anticorrelation).filter(|value| value.is_finite()),
                correlation_angle: correlation.as_ref().and_then(|it| it.crossing(THRESHOLD)),
                made_count: changes.made.len(),
                broken_count: changes.broken.len(),
            });
        }
        self.sensitivity.spreads = Spreads::of(&self.sensitivity.endings);
        Ok(())
    }
}
