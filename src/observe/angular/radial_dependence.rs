//! [`radial_dependence`]: S(f), G(θ), G* and θ* in rings from the inflated disk to the rim.

use serde::{Deserialize, Serialize};

use crate::displacement::DisplacementField;
use crate::observe::angular::correlation::{AngularCorrelation, CorrelationSettings};
use crate::observe::angular::error::AngularError;
use crate::observe::angular::power_spectrum::{PowerSpectrum, SpectrumSettings};
use crate::observe::angular::ring::{RingSample, RingSettings};
use crate::observe::angular_profile::RING_HALF_WIDTH;

/// The rings and their analysis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RadialDependenceSettings {
    /// Midpoints of the rings, r̂ = r/R \[1\].
    pub relative_radii: Vec<f64>,
    /// Half width of a ring over R \[1\].
    pub half_width: f64,
    /// The spectrum.
    pub spectrum: SpectrumSettings,
    /// The correlation function.
    pub correlation: CorrelationSettings,
}

impl Default for RadialDependenceSettings {
    /// r̂ = 0.1, 0.2, …, 0.9 (the study's supplement, S5).
    fn default() -> Self {
        RadialDependenceSettings {
            relative_radii: (1..10).map(|tenth| f64::from(tenth) / 10.0).collect(),
            half_width: RING_HALF_WIDTH,
            spectrum: SpectrumSettings::default(),
            correlation: CorrelationSettings::default(),
        }
    }
}

/// One ring.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RingAnalysis {
    /// r̂ \[1\].
    pub relative_radius: f64,
    /// The result.
    pub outcome: RingOutcome,
}

/// The result of a ring.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RingOutcome {
    /// Spectrum and correlation function.
    Measured {
        /// S(f).
        spectrum: PowerSpectrum,
        /// G(θ), G*, θ*.
        correlation: AngularCorrelation,
    },
    /// Too few disks, as may happen near the inflated disk.
    TooFewDisks {
        /// Disks in the ring.
        disk_count: usize,
    },
    /// The fixed highest frequency is too high for the disks of this ring.
    FrequencyLimitOutOfRange {
        /// The highest frequency requested.
        frequency_limit: usize,
        /// The highest frequency available.
        highest: usize,
    },
}

/// Spectrum and correlation function of d_r in every ring of the settings.
///
/// # Errors
/// Settings out of range; values that are not finite. Too few disks in a ring is an outcome of that ring, not an error.
pub fn radial_dependence(
    field: &DisplacementField<2>,
    settings: &RadialDependenceSettings,
) -> Result<Vec<RingAnalysis>, AngularError> {
    let analyse = |&relative_radius: &f64| {
        let ring = RingSettings { relative_radius, half_width: settings.half_width };
        let measured = RingSample::of_field(field, &ring).and_then(|sample| {
            let spectrum = PowerSpectrum::of(&sample, &settings.spectrum)?;
            let correlation = AngularCorrelation::of(&sample, &settings.correlation)?;
            Ok(RingOutcome::Measured { spectrum, correlation })
        });
        let outcome = match measured {
            Err(AngularError::TooFewDisks { disk_count }) => RingOutcome::TooFewDisks { disk_count },
            Err(AngularError::FrequencyLimitOutOfRange { frequency_limit, highest }) if frequency_limit > 0 => {
                RingOutcome::FrequencyLimitOutOfRange { frequency_limit, highest }
            }
            other => other?,
        };
        Ok(RingAnalysis { relative_radius, outcome })
    };
    settings.relative_radii.iter().map(analyse).collect()
}
