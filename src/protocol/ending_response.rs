//! [`EndingResponse`]: angular correlation and contact changes of an ending, counted from the state before the inflation.

use serde::Serialize;

use crate::displacement::DisplacementField;
use crate::inflation::Inflated;
use crate::law::pair_law::PairLaw;
use crate::observe::ContactChanges;
use crate::observe::angular::{AngularCorrelation, CorrelationSettings, RingSample, RingSettings};
use crate::packing::PackingError;
use crate::protocol::{Compared, Spreads};

/// The response of an ending in the numbers that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EndingResponse {
    /// G* = −G(π) of d_r in the ring r̂ = 0.5 ± 0.03 \[1\]; absent where the ring has too few disks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anticorrelation: Option<f64>,
    /// θ*, where G falls to 0.1 \[rad\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlation_angle: Option<f64>,
    /// Contacts of the backbone made by the inflation.
    pub made_count: usize,
    /// Contacts of the backbone broken by it.
    pub broken_count: usize,
}

/// The threshold of θ*, the usual one of the study \[1\].
const THRESHOLD: f64 = 0.1;

impl Compared<2> {
    /// Measures the response of every ending at rest, counted from the state before, and adds the spreads.
    ///
    /// # Errors
    /// Only what makes forces undefined.
    pub fn measure_responses<L: PairLaw>(&mut self, inflated: &Inflated<2>, law: &L) -> Result<(), PackingError> {
        let settings = CorrelationSettings { thresholds: vec![THRESHOLD], ..CorrelationSettings::default() };
        for (ending, state) in self.sensitivity.endings.iter_mut().zip(&self.states) {
            let Some(after) = state else { continue };
            let response = Inflated { after: after.clone(), deflated: None, ..inflated.clone() };
            let field = DisplacementField::of_inflation(&response);
            let ring = RingSample::of_field(&field, &RingSettings::default());
            let correlation = ring.and_then(|ring| AngularCorrelation::of(&ring, &settings)).ok();
            let changes = ContactChanges::of_inflation(&response, law)?;
            ending.response = Some(EndingResponse {
                // NaN of a ring without variance.
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
