//! [`RingSample`]: the disks of one ring, their angles and their values.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::displacement::DisplacementField;
use crate::observe::angular::error::{AngularError, LEAST_DISK_COUNT};
use crate::observe::angular_profile::{AngularProfile, RING_HALF_WIDTH};

/// Values beyond this have no square.
const LARGEST_VALUE: f64 = 1e150;

/// Where the ring lies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RingSettings {
    /// Middle of the ring, r̂ = r/R \[1\].
    pub relative_radius: f64,
    /// Half of its width over R, δr̂ \[1\].
    pub half_width: f64,
}

impl Default for RingSettings {
    /// Source: the study, r̂ = 0.5, δr̂ = 0.03.
    fn default() -> Self {
        RingSettings { relative_radius: 0.5, half_width: RING_HALF_WIDTH }
    }
}

/// Angles and values of the disks of a ring, ascending in the angle; disks at one angle ascending in the value.
///
/// The order of the disks given makes no difference, to the bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RingSample {
    angles: Vec<f64>,
    values: Vec<f64>,
}

/// How much a disk counts; the weights of a ring add up to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Weights {
    /// 1/n.
    Equal,
    /// Half of the gaps to both neighbours over 2π: the trapezoidal rule.
    Gaps,
}

impl RingSample {
    /// Disks at these angles, any finite numbers, with these values.
    ///
    /// # Errors
    /// Lengths that differ, too few disks, numbers that are not finite or values beyond 10¹⁵⁰.
    pub fn new(angles: &[f64], values: &[f64]) -> Result<Self, AngularError> {
        if angles.len() != values.len() {
            return Err(AngularError::LengthsDiffer { angle_count: angles.len(), value_count: values.len() });
        }
        if angles.len() < LEAST_DISK_COUNT {
            return Err(AngularError::TooFewDisks { disk_count: angles.len() });
        }
        let mut disks: Vec<(f64, f64)> = angles.iter().copied().zip(values.iter().copied()).collect();
        let unusable = |&(angle, value): &(f64, f64)| !(angle.is_finite() && value.abs() <= LARGEST_VALUE);
        if let Some(disk) = disks.iter().position(unusable) {
            return Err(AngularError::NotFinite { disk, angle: angles[disk], value: values[disk] });
        }
        for disk in &mut disks {
            // Zeros have one sign, so that total_cmp sees one number.
            *disk = (folded(disk.0) + 0.0, disk.1 + 0.0);
        }
        disks.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        Ok(RingSample {
            angles: disks.iter().map(|disk| disk.0).collect(),
            values: disks.iter().map(|disk| disk.1).collect(),
        })
    }

    /// d_r of the disks of a field that count and lie in the ring.
    ///
    /// # Errors
    /// Settings out of range; as [`new`](Self::new).
    pub fn of_field(field: &DisplacementField<2>, settings: &RingSettings) -> Result<Self, AngularError> {
        let RingSettings { relative_radius, half_width } = *settings;
        let usable = |number: f64| number > 0.0 && number.is_finite();
        if !(usable(relative_radius) && usable(half_width)) {
            return Err(AngularError::RingOutOfRange { relative_radius, half_width });
        }
        Self::of_profile(&AngularProfile::within(field, relative_radius, half_width))
    }

    /// The disks of an angular profile.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_profile(profile: &AngularProfile) -> Result<Self, AngularError> {
        Self::new(&profile.angles, &profile.radial)
    }

    /// Number of disks.
    pub fn disk_count(&self) -> usize {
        self.angles.len()
    }

    /// Angles in \[−π, π\], ascending.
    pub fn angles(&self) -> &[f64] {
        &self.angles
    }

    /// Values, in the order of the angles \[length, of a displacement\].
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// What each disk counts.
    pub fn weights(&self, weights: Weights) -> Vec<f64> {
        match weights {
            Weights::Equal => vec![1.0 / self.disk_count() as f64; self.disk_count()],
            Weights::Gaps => gap_weights(&self.angles),
        }
    }

    /// Values less their weighted mean, the mean, and the weighted variance.
    pub(super) fn centred(&self, weights: &[f64]) -> Centred {
        let mean: f64 = weights.iter().zip(&self.values).map(|(w, x)| w * x).sum();
        Centred::of(mean, &self.values, |values| weights.iter().zip(values).map(|(w, x)| w * x * x).sum())
    }
}

/// A standard deviation below this share of the mean is rounding: values without variance.
const LEAST_SPREAD: f64 = 8.0 * f64::EPSILON;

/// Values about their mean.
pub(super) struct Centred {
    pub mean: f64,
    pub values: Vec<f64>,
    pub variance: f64,
}

impl Centred {
    /// Values about a mean; all zero if what is left is rounding.
    pub(super) fn of(mean: f64, values: &[f64], variance: impl Fn(&[f64]) -> f64) -> Self {
        let mut values: Vec<f64> = values.iter().map(|x| x - mean).collect();
        let mut found = variance(&values);
        if found.sqrt() <= LEAST_SPREAD * mean.abs() {
            values.fill(0.0);
            found = 0.0;
        }
        Centred { mean, values, variance: found }
    }
}

/// Half of both gaps of every angle over 2π.
fn gap_weights(angles: &[f64]) -> Vec<f64> {
    let gaps = gaps(angles);
    let before = |k: usize| gaps[(k + gaps.len() - 1) % gaps.len()];
    (0..angles.len()).map(|k| (before(k) + gaps[k]) / (4.0 * PI)).collect()
}

/// From every angle to the next.
pub(super) fn gaps(angles: &[f64]) -> Vec<f64> {
    let count = angles.len();
    let mut gaps: Vec<f64> = angles.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.push((angles[0] - angles[count - 1]) + 2.0 * PI);
    gaps
}

/// The angle in [−π, π], the bits kept where it lies there.
fn folded(angle: f64) -> f64 {
    if angle.abs() <= PI { angle } else { libm::remainder(angle, 2.0 * PI) }
}
