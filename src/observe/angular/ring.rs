//! [`RingSample`]: the disks of one ring, their angles and their values.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::displacement::DisplacementField;
use crate::observe::angular::error::{AngularError, LEAST_DISK_COUNT};
use crate::observe::angular_profile::{AngularProfile, RING_HALF_WIDTH};

/// The squares of larger values overflow.
const LARGEST_VALUE: f64 = 1e150;

/// Position and width of a ring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RingSettings {
    /// Middle of the ring, r̂ = r/R \[1\].
    pub relative_radius: f64,
    /// Half width over R, δr̂ \[1\].
    pub half_width: f64,
}

impl Default for RingSettings {
    /// Source: the study, r̂ = 0.5, δr̂ = 0.03.
    fn default() -> Self {
        RingSettings { relative_radius: 0.5, half_width: RING_HALF_WIDTH }
    }
}

/// Angles and values of the disks of a ring, in ascending order of angles; at equal angles, of values.
///
/// The result does not depend on the order of the disks given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RingSample {
    angles: Vec<f64>,
    values: Vec<f64>,
}

/// The weight of a disk; the weights of a ring add up to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Weights {
    /// 1/n.
    Equal,
    /// Half the sum of the gaps to both neighbours over 2π: the trapezoidal rule.
    Gaps,
}

impl RingSample {
    /// A ring from angles, any finite numbers, and values.
    ///
    /// # Errors
    /// Different lengths, too few disks, numbers that are not finite or values above 10¹⁵⁰.
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
            // Zeros get one sign, so that total_cmp treats them as equal.
            *disk = (folded(disk.0) + 0.0, disk.1 + 0.0);
        }
        disks.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        Ok(RingSample {
            angles: disks.iter().map(|disk| disk.0).collect(),
            values: disks.iter().map(|disk| disk.1).collect(),
        })
    }

    /// d_r of the disks of a field that count and are in the ring.
    ///
    /// # Errors
    /// Settings out of range; see [`new`](Self::new).
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
    /// See [`new`](Self::new).
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

    /// The weight of each disk.
    pub fn weights(&self, weights: Weights) -> Vec<f64> {
        match weights {
            Weights::Equal => vec![1.0 / self.disk_count() as f64; self.disk_count()],
            Weights::Gaps => gap_weights(&self.angles),
        }
    }

    /// Values minus their weighted mean, the mean, and the weighted variance.
    pub(super) fn centred(&self, weights: &[f64]) -> Centred {
        let mean: f64 = weights.iter().zip(&self.values).map(|(w, x)| w * x).sum();
        Centred::of(mean, &self.values, |values| weights.iter().zip(values).map(|(w, x)| w * x * x).sum())
    }
}

/// A standard deviation below this share of the mean is rounding: the values have no variance.
const LEAST_SPREAD: f64 = 8.0 * f64::EPSILON;

/// Values minus their mean.
pub(super) struct Centred {
    pub mean: f64,
    pub values: Vec<f64>,
    pub variance: f64,
}

impl Centred {
    /// Values minus a mean; all zero if the differences are rounding.
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

/// Half the sum of both gaps of every angle, over 2π.
fn gap_weights(angles: &[f64]) -> Vec<f64> {
    let gaps = gaps(angles);
    let before = |k: usize| gaps[(k + gaps.len() - 1) % gaps.len()];
    (0..angles.len()).map(|k| (before(k) + gaps[k]) / (4.0 * PI)).collect()
}

/// The gap from every angle to the next.
pub(super) fn gaps(angles: &[f64]) -> Vec<f64> {
    let count = angles.len();
    let mut gaps: Vec<f64> = angles.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.push((angles[0] - angles[count - 1]) + 2.0 * PI);
    gaps
}

/// The angle in [−π, π]; unchanged if it already is.
fn folded(angle: f64) -> f64 {
    if angle.abs() <= PI { angle } else { libm::remainder(angle, 2.0 * PI) }
}
