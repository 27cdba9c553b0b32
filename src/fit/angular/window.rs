//! [`SpectrumWindowSettings`]: which powers are fitted, and what may be in them.

use serde::{Deserialize, Serialize};

use crate::fit::angular::error::SpectrumFitError;

/// Which powers are fitted, and what may be in them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SpectrumWindowSettings {
    /// Lowest f, f_1 \[1\].
    pub lowest: usize,
    /// Highest f, f_2.
    pub highest: HighestFrequency,
    /// Values of single disks.
    pub noise: SingleDiskNoise,
    /// Highest frequency of the field itself over the number of disks \[1\]: the model ends there.
    pub frequencies_per_disk: f64,
}

impl Default for SpectrumWindowSettings {
    /// From f = 1; no noise of single disks; a field up to 16 frequencies a disk.
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
    /// Whether every number makes sense, whatever the rings.
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
    /// n/16, but n/4 or 15, whichever is less, where that is more. Above n/16 leakage makes powers depend on each other, and
    /// the errors come out too small (`fits::powers_above_a_sixteenth_claim_too_much`).
    #[default]
    Resolved,
    /// This one, at most n/2.
    Fixed(usize),
}

/// Values of single disks on top of the field: white noise of variance ρ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SingleDiskNoise {
    /// There is none.
    #[default]
    None,
    /// ρ of every ring is fitted with the rest.
    Fitted,
}
