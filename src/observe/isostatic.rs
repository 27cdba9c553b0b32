//! [`IsostaticLength`]: from where on the stretching of bonds varies around a ring as in a continuum, ℓ_iso.
//!
//! ```text
//! x = r ΔZ        y = (h_∥(r)/h_0) x        ℓ_iso: the smallest r at which y rises to a threshold        C = ℓ_iso ΔZ
//! ```
//!
//! Beyond ℓ_iso h_∥ falls as 1/r, so y stays on a plateau until the held rim bends it down. h_0 makes h_∥ a number,
//! [`Normalisation`]; the threshold is one given or a share of the plateau, [`IsostaticRule`]. Between two rings y is taken as a straight line.
//!
//! # Source
//! Ellenbroek, Somfai, van Hecke, van Saarloos (2006), Phys. Rev. Lett. 97, 258001; the study, threshold 1.3, C ≈ 6.

use serde::{Deserialize, Serialize};

use crate::contact::PairLaw;
use crate::inflation::Inflated;
use crate::observe::ExcessCoordination;
use crate::observe::bond_changes::{BondChanges, BondSet};
use crate::observe::fluctuations::{BondMeasure, FluctuationRing, Fluctuations};
use crate::observe::state::State;
use crate::packing::PackingError;

/// What h_∥ is divided by, h_0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Normalisation {
    /// h_∥ of the ring whose radius is nearest to this \[length\].
    NearCentre {
        /// That radius.
        radius: f64,
    },
    /// |d_0|, by which the disk grew.
    Increase,
    /// One length: h_∥ as it is.
    Length,
}

/// The y that ends the disordered region.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum IsostaticRule {
    /// This value \[1\].
    Threshold(f64),
    /// A share of the plateau, which is the median of y over the rings between two radii.
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
    /// Which contacts are bonds.
    pub bonds: BondSet,
    /// Which number of a bond.
    pub measure: BondMeasure,
    /// Width of a ring \[length\].
    pub ring_width: f64,
    /// Radius from which on rings count \[length\]: nearer are the contacts of the inflated disk, which it pushes itself.
    pub from: f64,
    /// h_0.
    pub normalisation: Normalisation,
    /// The threshold.
    pub rule: IsostaticRule,
}

impl Default for IsostaticSettings {
    /// Source: the study for the threshold, 1.3. It does not say what h_∥ is divided by; of the three only `NearCentre`
    /// brings y near the threshold (the chapter has the numbers), so that is our reading.
    fn default() -> Self {
        IsostaticSettings {
            bonds: BondSet::default(),
            measure: BondMeasure::default(),
            ring_width: 1.0,
            from: 1.0,
            normalisation: Normalisation::NearCentre { radius: 1.5 },
            rule: IsostaticRule::Threshold(1.3),
        }
    }
}

/// Why ℓ_iso could not be looked for.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IsostaticError {
    /// The disks themselves are at fault.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// A ring has a width.
    #[error("ring_width is {ring_width}, not a positive number")]
    RingWidthNotPositive {
        /// The value given \[length\].
        ring_width: f64,
    },
    /// Rings begin at the centre or beyond.
    #[error("from is {from}, not a number from 0 on")]
    FromNegative {
        /// The value given \[length\].
        from: f64,
    },
    /// The radius of the normalisation is one.
    #[error("the radius of the normalisation is {radius}, not a positive number")]
    RadiusNotPositive {
        /// The value given \[length\].
        radius: f64,
    },
    /// A threshold, or share of the plateau, is positive.
    #[error("the threshold or share is {value}, not a positive number")]
    ThresholdNotPositive {
        /// The value given \[1\].
        value: f64,
    },
    /// The plateau lies within the circle.
    #[error("the plateau goes from {from} to {to} of the outer radius: not 0 ≤ from < to ≤ 1")]
    PlateauOutOfRange {
        /// The smaller radius given \[1\].
        from: f64,
        /// The larger radius given \[1\].
        to: f64,
    },
}

/// One ring, scaled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct IsostaticPoint {
    /// r \[length\].
    pub radius: f64,
    /// x = r ΔZ \[1\].
    pub scaled_radius: f64,
    /// y = (h_∥/h_0) r ΔZ \[1\].
    pub scaled_fluctuation: f64,
    /// Standard error of y from that of h_∥, h_0 taken as exact \[1\].
    pub standard_error: f64,
}

/// Where y reaches the threshold.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IsostaticOutcome {
    /// At ℓ_iso, between two rings.
    Reached {
        /// ℓ_iso \[length\].
        length: f64,
        /// C = ℓ_iso ΔZ \[1\].
        product: f64,
        /// Radii of the rings on either side \[length\].
        between: [f64; 2],
    },
    /// The innermost ring is at or above it already: ℓ_iso is at most its radius.
    AboveFromTheStart {
        /// That radius \[length\].
        innermost: f64,
    },
    /// No ring reaches it.
    NeverReached {
        /// The largest y \[1\].
        largest: f64,
    },
    /// ΔZ is not positive: there is no length.
    NoExcess {
        /// ΔZ \[1\].
        excess: f64,
    },
    /// Nothing is rigid.
    NoBackbone,
    /// Fewer than two rings have a fluctuation.
    TooFewRings,
    /// No ring where the plateau should be.
    NoPlateau,
    /// h_0 is 0 or a ring is not a number.
    NoScale,
}

/// ℓ_iso, and the curve it was read from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IsostaticLength {
    /// ΔZ of the backbone before; absent without one \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excess: Option<f64>,
    /// h_0, where there is a curve \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<f64>,
    /// The threshold, given or from the plateau \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub threshold: Option<f64>,
    /// y against x, from the inside out.
    pub curve: Vec<IsostaticPoint>,
    /// Where the threshold is reached.
    pub outcome: IsostaticOutcome,
}

impl IsostaticLength {
    /// ℓ_iso of an inflation.
    ///
    /// # Errors
    /// Settings that make no sense; a packing without forces.
    pub fn of_inflation<const D: usize, L: PairLaw>(
        inflated: &Inflated<D>,
        law: &L,
        settings: &IsostaticSettings,
    ) -> Result<Self, IsostaticError> {
        settings.check()?;
        let before = State::new(inflated.before.packing.get(), law)?;
        let after = State::new(inflated.after.packing.get(), law)?;
        let changes = BondChanges::between(&before, &after, inflated.centre, settings.bonds);
        let fluctuations =
            Fluctuations::of_bonds(&changes, settings.measure, inflated.outer_radius, settings.ring_width);
        let excess = ExcessCoordination::of(&before.network).map(|excess| excess.value);
        let increase = after.packing.radii()[inflated.centre] - inflated.inner_radius;
        Self::of(&fluctuations, excess, increase, inflated.outer_radius, settings)
    }

    /// ℓ_iso of a fluctuation against r, which may be a mean over samples, or h_r to see that it does not collapse.
    ///
    /// `excess` is ΔZ, none without a backbone; `increase` d_0 and `outer_radius` R \[length\].
    ///
    /// # Errors
    /// Settings that make no sense.
    pub fn of(
        fluctuations: &Fluctuations,
        excess: Option<f64>,
        increase: f64,
        outer_radius: f64,
        settings: &IsostaticSettings,
    ) -> Result<Self, IsostaticError> {
        settings.check()?;
        let rings = fluctuations.rings.iter().filter(|ring| ring.radius >= settings.from);
        let rings: Vec<FluctuationRing> = rings.copied().collect();
        let mut found = IsostaticLength {
            excess,
            unit: None,
            threshold: None,
            curve: Vec::new(),
            outcome: IsostaticOutcome::NoBackbone,
        };
        let Some(excess) = excess else { return Ok(found) };
        if rings.len() < 2 {
            found.outcome = IsostaticOutcome::TooFewRings;
            return Ok(found);
        }
        if excess.is_nan() || excess <= 0.0 {
            found.outcome = IsostaticOutcome::NoExcess { excess };
            return Ok(found);
        }
        let unit = settings.normalisation.unit(&rings, increase);
        let sound = |ring: &FluctuationRing| (ring.radius * ring.fluctuation * ring.standard_error).is_finite();
        if !(unit > 0.0 && unit.is_finite() && rings.iter().all(sound)) {
            found.outcome = IsostaticOutcome::NoScale;
            return Ok(found);
        }
        found.unit = Some(unit);
        found.curve = rings.iter().map(|ring| IsostaticPoint::of(ring, excess, unit)).collect();
        let Some(threshold) = settings.rule.threshold(&found.curve, outer_radius) else {
            found.outcome = IsostaticOutcome::NoPlateau;
            return Ok(found);
        };
        found.threshold = Some(threshold);
        found.outcome = outcome(&found.curve, threshold, excess);
        Ok(found)
    }
}

fn outcome(curve: &[IsostaticPoint], threshold: f64, excess: f64) -> IsostaticOutcome {
    match curve.iter().position(|point| point.scaled_fluctuation >= threshold) {
        None => {
            let largest = curve.iter().map(|point| point.scaled_fluctuation).fold(0.0, f64::max);
            IsostaticOutcome::NeverReached { largest }
        }
        Some(0) => IsostaticOutcome::AboveFromTheStart { innermost: curve[0].radius },
        Some(first) => {
            let (below, above) = (&curve[first - 1], &curve[first]);
            let share = (threshold - below.scaled_fluctuation) / (above.scaled_fluctuation - below.scaled_fluctuation);
            let length = below.radius + share * (above.radius - below.radius);
            IsostaticOutcome::Reached { length, product: length * excess, between: [below.radius, above.radius] }
        }
    }
}

impl IsostaticPoint {
    fn of(ring: &FluctuationRing, excess: f64, unit: f64) -> Self {
        let scaled_radius = ring.radius * excess;
        IsostaticPoint {
            radius: ring.radius,
            scaled_radius,
            scaled_fluctuation: ring.fluctuation / unit * scaled_radius,
            standard_error: ring.standard_error / unit * scaled_radius,
        }
    }
}

impl Normalisation {
    /// h_0 for at least one ring.
    fn unit(&self, rings: &[FluctuationRing], increase: f64) -> f64 {
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
    fn threshold(&self, curve: &[IsostaticPoint], outer_radius: f64) -> Option<f64> {
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
    fn check(&self) -> Result<(), IsostaticError> {
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
