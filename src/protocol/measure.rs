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
use crate::observe::shell::{SHELL_HALF_WIDTH, SHELL_RADIUS, ShellCorrelation, ShellCorrelationSettings, ShellSample};
use crate::packing::PackingError;
#[cfg(feature = "fit")]
use crate::protocol::ending_fit::EndingFit;
use crate::protocol::ending_response::EndingResponse;
use crate::protocol::sensitivity::Compared;
use crate::protocol::spread::Spreads;
#[cfg(feature = "fit")]
use crate::reference::Annulus;

#[cfg(feature = "fit")]
impl<const D: usize> Compared<D> {
    /// Fits the response of every ending at rest, relative to the state before the inflation, and adds the spreads.
    ///
    /// An ending whose profile cannot be fitted has no fit.
    pub fn fit(&mut self, inflated: &Inflated<D>, ring_width: f64, settings: &ProfileFitSettings) {
        let Ok(annulus) = Annulus::new(inflated.inner_radius, inflated.outer_radius) else { return };
        for (ending, state) in self.sensitivity.endings.iter_mut().zip(&self.states) {
            let Some(after) = state else { continue };
            let response = Inflated { after: after.clone(), deflated: None, ..inflated.clone() };
            let field = DisplacementField::of_inflation(&response);
            let profile = RadialProfile::of(&field, ring_width);
            let fit = match field.spreading_dimension() {
                1 => fit_radial_profile::<1>(&profile, annulus, settings),
                _ => fit_radial_profile::<D>(&profile, annulus, settings),
            };
            ending.fit = fit.ok().map(EndingFit::from);
        }
        self.sensitivity.spreads = Spreads::of(&self.sensitivity.endings);
    }
}

/// The threshold of θ* in the study \[1\].
const THRESHOLD: f64 = 0.1;

impl<const D: usize> Compared<D> {
    /// Measures the response of every ending at rest, relative to the state before the inflation, and adds the spreads.
    ///
    /// # Errors
    /// Only conditions that make forces undefined.
    pub fn measure_responses(&mut self, inflated: &Inflated<D>, law: &dyn PairLaw) -> Result<(), PackingError> {
        for (ending, state) in self.sensitivity.endings.iter_mut().zip(&self.states) {
            let Some(after) = state else { continue };
            let response = Inflated { after: after.clone(), deflated: None, ..inflated.clone() };
            let field = DisplacementField::of_inflation(&response);
            let on_ring = field.in_plane().and_then(on_ring);
            let [anticorrelation, correlation_angle] =
                on_ring.or_else(|| field.in_space().and_then(on_shell)).unwrap_or_default();
            let changes = ContactChanges::of_inflation(&response, law)?;
            ending.response = Some(EndingResponse {
                anticorrelation,
                correlation_angle,
                made_count: changes.made.len(),
                broken_count: changes.broken.len(),
            });
        }
        self.sensitivity.spreads = Spreads::of(&self.sensitivity.endings);
        Ok(())
    }
}

/// G* and θ* of the ring r̂ = 0.5 ± 0.03, if it has enough disks.
fn on_ring(field: &DisplacementField<2>) -> Option<[Option<f64>; 2]> {
    let settings = CorrelationSettings { thresholds: vec![THRESHOLD], ..CorrelationSettings::default() };
    let ring = RingSample::of_field(field, &RingSettings::default()).ok()?;
    let correlation = AngularCorrelation::of(&ring, &settings).ok()?;
    // A ring without variance gives NaN.
    let anticorrelation = Some(correlation.anticorrelation).filter(|value| value.is_finite());
    Some([anticorrelation, correlation.crossing(THRESHOLD)])
}

/// G* and γ* of the shell r̂ = 0.5 ± 0.03, if it has enough spheres.
fn on_shell(field: &DisplacementField<3>) -> Option<[Option<f64>; 2]> {
    let settings = ShellCorrelationSettings { thresholds: vec![THRESHOLD], ..ShellCorrelationSettings::default() };
    let shell = ShellSample::of_field(field, SHELL_RADIUS, SHELL_HALF_WIDTH).ok()?;
    let correlation = ShellCorrelation::of(&shell, &settings).ok()?;
    Some([correlation.anticorrelation.map(|it| it.value), correlation.crossing(THRESHOLD)])
}
