//! Settings of ℓ_iso, and their errors.

use serde::{Deserialize, Serialize};

use crate::observe::bond_changes::BondSet;
use crate::observe::fluctuations::{BondMeasure, FluctuationRing};
use crate::observe::isostatic::isostatic_point::IsostaticPoint;
use crate::packing::PackingError;

/// The divisor h_0 of h_∥.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Normalisation {
    /// h_∥ of the ring whose radius is nearest to this \[length\].
    NearCentre {
        /// That radius.
        radius: f64,
    },
    /// |d_0|, the increase of the radius.
    Increase,
    /// The unit of length: h_∥ itself.
    Length,
}

/// How h_∥ falls beyond ℓ_iso, in a continuum of D dimensions.
///
/// A growing disk that is free is a force dipole: u ∼ r^(1−D), strain ∼ r^(−D). The force that holds a disk at its
/// position is a point force: u ∼ r^(2−D) (ln r for D = 2), strain ∼ r^(1−D), which dominates far away.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tail {
    /// As 1/r: in two dimensions the inflated disk is held at its position by a force.
    #[default]
    InverseDistance,
    /// As 1/r²: in two dimensions the inflated disk is free, as in the periodic box, and its contact forces add up to
    /// zero; in three dimensions it is held.
    InverseSquare,
    /// As 1/r³: in three dimensions the inflated sphere is free.
    InverseCube,
}

impl Tail {
    /// The tail around a disk held at its position in D = 2 or 3 dimensions, r^(1−D).
    pub fn of_held<const D: usize>() -> Self {
        if D == 2 { Tail::InverseDistance } else { Tail::InverseSquare }
    }

    /// The tail around a free disk in D = 2 or 3 dimensions, r^(−D).
    pub fn of_free<const D: usize>() -> Self {
        if D == 2 { Tail::InverseSquare } else { Tail::InverseCube }
    }

    /// The power of 1/r.
    pub fn power(self) -> i32 {
        match self {
            Tail::InverseDistance => 1,
            Tail::InverseSquare => 2,
            Tail::InverseCube => 3,
        }
    }
}

/// The factor that makes a distance from the centre dimensionless, x.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// x = r ΔZ, as in the study.
    #[default]
    Excess,
    /// x = r √ΔZ. Source of the power: Lerner, DeGiuli, Düring, Wyart (2014), Soft Matter 10, 5085, for responses to a
    /// force dipole.
    RootExcess,
}

impl Scale {
    /// x/r of a packing with this ΔZ \[1 / length\].
    pub fn of(self, excess: f64) -> f64 {
        match self {
            Scale::Excess => excess,
            Scale::RootExcess => excess.sqrt(),
        }
    }
}

/// The value of y that defines ℓ_iso.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum IsostaticRule {
    /// This value \[1\].
    Threshold(f64),
    /// A share of the plateau, the median of y over the rings between two radii.
    Plateau {
        /// The smaller radius over R \[1\].
        from: f64,
        /// The larger radius over R \[1\].
        to: f64,
        /// Share of the median \[1\].
        share: f64,
    },
}

/// How ℓ_iso is measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct IsostaticSettings {
    /// The contacts included.
    pub bonds: BondSet,
    /// The quantity of a bond.
    pub measure: BondMeasure,
    /// Width of a ring \[length\].
    pub ring_width: f64,
    /// Smallest radius of a ring \[length\]. Excludes the contacts of the inflated disk, which it pushes directly.
    pub from: f64,
    /// h_0.
    pub normalisation: Normalisation,
    /// The tail that makes y constant.
    pub tail: Tail,
    /// The factor that makes a distance dimensionless.
    pub scale: Scale,
    /// The threshold.
    pub rule: IsostaticRule,
}

impl Default for IsostaticSettings {
    /// Source: the study for the threshold, 1.3. It does not define the divisor of h_∥. Of the three, only `NearCentre`
    /// brings y near the threshold (numbers in the book), so we use it. Its tail is 1/r.
    fn default() -> Self {
        IsostaticSettings {
            bonds: BondSet::default(),
            measure: BondMeasure::default(),
            ring_width: 1.0,
            from: 1.0,
            normalisation: Normalisation::NearCentre { radius: 1.5 },
            tail: Tail::default(),
            scale: Scale::default(),
            rule: IsostaticRule::Threshold(1.3),
        }
    }
}

impl IsostaticSettings {
    /// The settings for a disk held at its position in D = 2 or 3 dimensions; for D = 2 the default.
    ///
    /// y = (h_∥/h_0)(r ΔZ)^(D−1). The threshold 1.3 of the study is that of D = 2. None is known for D = 3, where y has
    /// another factor r ΔZ. There ℓ_iso is read at a share 0.8 of the plateau between 0.4 and 0.7 R.
    pub fn of_held<const D: usize>() -> Self {
        let plateau = IsostaticRule::Plateau { from: 0.4, to: 0.7, share: 0.8 };
        let settings = IsostaticSettings { tail: Tail::of_held::<D>(), ..IsostaticSettings::default() };
        if D == 2 { settings } else { IsostaticSettings { rule: plateau, ..settings } }
    }
}

/// Why ℓ_iso could not be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IsostaticError {
    /// The disks themselves are invalid.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// The width of a ring must be positive.
    #[error("ring_width is {ring_width}, not a positive number")]
    RingWidthNotPositive {
        /// The value given \[length\].
        ring_width: f64,
    },
    /// The smallest radius must not be negative.
    #[error("from is {from}: must be a finite number, not negative")]
    FromNegative {
        /// The value given \[length\].
        from: f64,
    },
    /// The radius of the normalisation must be positive.
    #[error("the radius of the normalisation is {radius}, not a positive number")]
    RadiusNotPositive {
        /// The value given \[length\].
        radius: f64,
    },
    /// The threshold or share must be positive.
    #[error("the threshold or share is {value}, not a positive number")]
    ThresholdNotPositive {
        /// The value given \[1\].
        value: f64,
    },
    /// The plateau must lie within the circle.
    #[error("the plateau goes from {from} to {to} of the outer radius: must satisfy 0 ≤ from < to ≤ 1")]
    PlateauOutOfRange {
        /// The smaller radius given \[1\].
        from: f64,
        /// The larger radius given \[1\].
        to: f64,
    },
}

impl Normalisation {
    /// h_0; there is at least one ring.
    pub(super) fn unit(&self, rings: &[FluctuationRing], increase: f64) -> f64 {
        match *self {
            Normalisation::NearCentre { radius } => {
                let away = |ring: &&FluctuationRing| (ring.radius - radius).abs();
                rings.iter().min_by(|a, b| away(a).total_cmp(&away(b))).map_or(f64::NAN, |ring| ring.fluctuation)
            }
            Normalisation::Increase => increase.abs(),
            Normalisation::Length => 1.0,
        }
    }
}

impl IsostaticRule {
    pub(super) fn threshold(&self, curve: &[IsostaticPoint], outer_radius: f64) -> Option<f64> {
        match *self {
            IsostaticRule::Threshold(value) => Some(value),
            IsostaticRule::Plateau { from, to, share } => {
                let there = |point: &&IsostaticPoint| (from..=to).contains(&(point.radius / outer_radius));
                let mut values: Vec<f64> = curve.iter().filter(there).map(|point| point.scaled_fluctuation).collect();
                values.sort_by(f64::total_cmp);
                let middle = values.len() / 2;
                let upper = *values.get(middle)?;
                Some(share * if values.len().is_multiple_of(2) { 0.5 * (values[middle - 1] + upper) } else { upper })
            }
        }
    }
}

impl IsostaticSettings {
    /// Checks the settings.
    pub(crate) fn check(&self) -> Result<(), IsostaticError> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        if !positive(self.ring_width) {
            return Err(IsostaticError::RingWidthNotPositive { ring_width: self.ring_width });
        }
        if !(self.from >= 0.0 && self.from.is_finite()) {
            return Err(IsostaticError::FromNegative { from: self.from });
        }
        match self.normalisation {
            Normalisation::NearCentre { radius } if !positive(radius) => {
                return Err(IsostaticError::RadiusNotPositive { radius });
            }
            _ => {}
        }
        match self.rule {
            IsostaticRule::Threshold(value) | IsostaticRule::Plateau { share: value, .. } if !positive(value) => {
                Err(IsostaticError::ThresholdNotPositive { value })
            }
            IsostaticRule::Plateau { from, to, .. } if !(0.0 <= from && from < to && to <= 1.0) => {
                Err(IsostaticError::PlateauOutOfRange { from, to })
            }
            _ => Ok(()),
        }
    }
}
