//! [`SpectrumWindowSettings`]: the powers used in a fit, and the model of their noise.

use serde::{Deserialize, Serialize};

use crate::fit::angular::error::SpectrumFitError;

/// The powers used in a fit, and the model of their noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SpectrumWindowSettings {
    /// Lowest f, f_1 \[1\].
    pub lowest: usize,
    /// Highest f, f_2.
    pub highest: HighestFrequency,
    /// Noise of single disks.
    pub noise: SingleDiskNoise,
    /// Highest frequency of the field over the number of disks \[1\]; the model ends there.
    pub frequencies_per_disk: f64,
}

impl Default for SpectrumWindowSettings {
    /// From f = 1; no noise of single disks; a field with up to 16 frequencies per disk.
    fn default() -> Self {
        SpectrumWindowSettings {
            lowest: 1,
            highest: HighestFrequency::default(),
            noise: SingleDiskNoise::None,
            frequencies_per_disk: 16.0,
        }
    }
}

impl SpectrumWindowSettings {
    /// Checks the settings, independently of the rings.
    pub(crate) fn check(&self) -> Result<(), SpectrumFitError> {
        let value = self.frequencies_per_disk;
        if (1.0..=1e3).contains(&value) {
            Ok(())
        } else {
            Err(SpectrumFitError::SettingOutOfRange { setting: "frequencies_per_disk", value })
        }
    }
}

/// The highest frequency fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HighestFrequency {
    /// n/16, or, if that is larger, the smaller of n/4 and 15. Above n/16 leakage correlates the powers, and the errors
    /// would be too small (`fits::powers_above_a_sixteenth_claim_too_much`).
    #[default]
    Resolved,
    /// This frequency, at most n/2.
    Fixed(usize),
}

/// Independent values of single disks added to the field: white noise of variance ρ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SingleDiskNoise {
    /// No noise.
    #[default]
    None,
    /// ρ of every ring is fitted.
    Fitted,
}
