//! [`PenetrationLength`]: the largest distance from the inflated disk with a displacement, ξ.
//!
//! ```text
//! |⟨d_r⟩(r)| < d_th for all r > ξ        |⟨d_r⟩(ξ)| = d_th
//! ```
//!
//! Between the last ring at or above the threshold, k, and the next one, |⟨d_r⟩| is interpolated exponentially:
//!
//! ```text
//! ξ = r_k + (r_(k+1) − r_k) ln(m_k/d_th)/ln(m_k/m_(k+1))        m = |⟨d_r⟩|
//! ```
//!
//! so ξ = r_k if the next ring does not move at all. Means over rings are used because single disks near the rim move
//! as far in any loose packing.

use serde::{Deserialize, Serialize};

use crate::observe::radial_profile::RadialProfile;
use crate::vector::larger;

/// The thresholds for penetration lengths.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PenetrationSettings {
    /// d_th, each positive \[length\].
    pub thresholds: Vec<f64>,
}

impl Default for PenetrationSettings {
    /// Source: the study, d_th = 10⁻³ and, for comparison, down to 10⁻⁶.
    fn default() -> Self {
        PenetrationSettings { thresholds: vec![1e-3, 1e-4, 1e-5, 1e-6] }
    }
}

/// Why there are no penetration lengths.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PenetrationError {
    /// A threshold must be positive.
    #[error("threshold {index} is {threshold}, not a positive number")]
    ThresholdNotPositive {
        /// Index of the threshold, from 0.
        index: usize,
        /// The value given \[length\].
        threshold: f64,
    },
    /// The mean or the radius of a ring is not finite.
    #[error("ring {ring} at radius {radius} has a mean displacement of {mean}: both must be finite")]
    RingNotFinite {
        /// Index of the ring, from 0.
        ring: usize,
        /// Its radius \[length\].
        radius: f64,
        /// Its mean radial displacement \[length\].
        mean: f64,
    },
}

/// Where a profile falls below a threshold and stays below.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Penetration {
    /// At ξ, between two rings.
    FallsAt {
        /// ξ \[length\].
        radius: f64,
        /// The last ring at or above the threshold \[length\].
        last_above: f64,
        /// The first ring of those that are all below \[length\].
        first_below: f64,
    },
    /// No ring is at or above the threshold.
    NeverAbove {
        /// The largest |⟨d_r⟩| of a ring; absent without rings \[length\].
        #[serde(skip_serializing_if = "Option::is_none")]
        largest: Option<f64>,
    },
    /// The outermost ring is still at or above the threshold: ξ is at least its radius.
    ReachesRim {
        /// Radius of the outermost ring \[length\].
        outermost: f64,
    },
}

impl Penetration {
    /// ξ, if there is one \[length\].
    pub fn radius(&self) -> Option<f64> {
        match *self {
            Penetration::FallsAt { radius, .. } => Some(radius),
            Penetration::NeverAbove { .. } | Penetration::ReachesRim { .. } => None,
        }
    }
}

/// ξ at one threshold.
///
/// # Example
/// ```
/// use jamscope::observe::{RadialProfile, Ring};
/// use jamscope::observe::penetration_length::{Penetration, PenetrationLength, PenetrationSettings};
///
/// // d_r = exp(−r): 10⁻³ is reached at r = ln 1000.
/// let ring = |r: f64| Ring { radius: r, disk_count: 1, mean: (-r).exp(), spread: 0.0, standard_error: 0.0 };
/// let profile = RadialProfile { rings: (1..20).map(|r| ring(r as f64)).collect() };
/// let lengths = PenetrationLength::of(&profile, &PenetrationSettings::default())?;
/// let length = lengths[0].penetration.radius().expect("it falls below");
/// assert!((length - 1000f64.ln()).abs() < 1e-14);
/// # Ok::<(), jamscope::observe::penetration_length::PenetrationError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PenetrationLength {
    /// d_th \[length\].
    pub threshold: f64,
    /// The result.
    pub penetration: Penetration,
}

impl PenetrationLength {
    /// ξ of a profile at every threshold, in the same order.
    ///
    /// # Errors
    /// A threshold that is not positive; a ring without a finite mean.
    pub fn of(profile: &RadialProfile, settings: &PenetrationSettings) -> Result<Vec<Self>, PenetrationError> {
        for (index, &threshold) in settings.thresholds.iter().enumerate() {
            if !(threshold > 0.0 && threshold.is_finite()) {
                return Err(PenetrationError::ThresholdNotPositive { index, threshold });
            }
        }
        for (ring, &found) in profile.rings.iter().enumerate() {
            if !(found.radius.is_finite() && found.mean.is_finite()) {
                return Err(PenetrationError::RingNotFinite { ring, radius: found.radius, mean: found.mean });
            }
        }
        let at = |&threshold: &f64| PenetrationLength { threshold, penetration: penetration(profile, threshold) };
        Ok(settings.thresholds.iter().map(at).collect())
    }
}

fn penetration(profile: &RadialProfile, threshold: f64) -> Penetration {
    let rings = &profile.rings;
    let Some(last) = rings.iter().rposition(|ring| ring.mean.abs() >= threshold) else {
        let largest = rings.iter().map(|ring| ring.mean.abs()).reduce(|most, mean| larger(mean, most));
        return Penetration::NeverAbove { largest };
    };
    let Some(next) = rings.get(last + 1) else {
        return Penetration::ReachesRim { outermost: rings[last].radius };
    };
    let (ring, above, below) = (&rings[last], rings[last].mean.abs(), next.mean.abs());
    // above ≥ threshold > below ≥ 0, so the share is in [0, 1); ln ∞ for below = 0 gives 0.
    let share = libm::log(above / threshold) / libm::log(above / below);
    let radius = ring.radius + (next.radius - ring.radius) * share;
    Penetration::FallsAt { radius, last_above: ring.radius, first_below: next.radius }
}
