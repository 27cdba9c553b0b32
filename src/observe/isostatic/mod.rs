//! [`IsostaticLength`]: the distance beyond which the fluctuations of bond stretching are those of a continuum, ℓ_iso.
//!
//! ```text
//! x = r ΔZ, or r √ΔZ        y = (h_∥(r)/h_0) xⁿ        ℓ_iso: the smallest r at which y rises to a threshold        C: x at ℓ_iso
//! ```
//!
//! n is the power of the [`Tail`] that makes y constant beyond ℓ_iso. In an elastic medium of D dimensions a growing
//! disk causes a strain 1/r^D. In the study that disk is also held at its position. The force that holds it causes a
//! strain 1/r^(D−1) ([`PointForce`](crate::reference::angular_modes::point_force::PointForce) for D = 2), which
//! dominates beyond any ℓ_iso; see the book. So h_∥ r^(D−1) ΔZ^(D−1) is level far away in the geometry of the study,
//! and h_∥ r^D ΔZ^D around a free disk. h_0 makes h_∥ dimensionless, see [`Normalisation`]. The threshold is a given value or a share of the
//! plateau, see [`IsostaticRule`]; for x see [`Scale`]. Between two rings y is interpolated linearly.
//!
//! # Source
//! Ellenbroek, Somfai, van Hecke, van Saarloos (2006), Phys. Rev. Lett. 97, 258001; the study, threshold 1.3, C ≈ 6.

mod isostatic_point;
mod settings;

use serde::{Deserialize, Serialize};

pub use isostatic_point::IsostaticPoint;
pub use settings::{IsostaticError, IsostaticRule, IsostaticSettings, Normalisation, Scale, Tail};

use crate::inflation::Inflated;
use crate::law::pair_law::PairLaw;
use crate::observe::bond_changes::BondChanges;
use crate::observe::excess_coordination::ExcessCoordination;
use crate::observe::fluctuations::{FluctuationRing, Fluctuations};
use crate::observe::state::State;
use crate::vector::larger;

/// Where y reaches the threshold.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IsostaticOutcome {
    /// At ℓ_iso, between two rings.
    Reached {
        /// ℓ_iso \[length\].
        length: f64,
        /// C = ℓ_iso ΔZ or ℓ_iso √ΔZ \[1\].
        product: f64,
        /// Radii of the rings on either side \[length\].
        between: [f64; 2],
    },
    /// The innermost ring is already at or above the threshold: ℓ_iso is at most its radius.
    AboveFromTheStart {
        /// Its radius \[length\].
        innermost: f64,
    },
    /// No ring reaches the threshold.
    NeverReached {
        /// The largest y \[1\].
        largest: f64,
    },
    /// ΔZ is not positive, so there is no ℓ_iso.
    NoExcess {
        /// ΔZ \[1\].
        excess: f64,
    },
    /// There is no backbone.
    NoBackbone,
    /// Fewer than two rings have a fluctuation.
    TooFewRings,
    /// No ring lies in the range of the plateau.
    NoPlateau,
    /// h_0 is 0, or a value of a ring is NaN.
    NoScale,
}

/// ℓ_iso, and the curve from which it is read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IsostaticLength {
    /// ΔZ of the backbone before; absent without one \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excess: Option<f64>,
    /// h_0, if there is a curve \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<f64>,
    /// n: 1, 2 or 3.
    #[serde(default)]
    pub tail: Tail,
    /// The factor in x.
    #[serde(default)]
    pub scale: Scale,
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
    /// Invalid settings; a packing with undefined forces.
    pub fn of_inflation<const D: usize>(
        inflated: &Inflated<D>,
        law: &dyn PairLaw,
        settings: &IsostaticSettings,
    ) -> Result<Self, IsostaticError> {
        let before = State::new(inflated.before.packing.get(), law)?;
        let after = State::new(inflated.after.packing.get(), law)?;
        Self::between(&before, &after, inflated.centre, inflated.outer_radius, settings)
    }

    /// ℓ_iso from one state to another of the same disks; distances are from disk `centre`, which grew.
    ///
    /// # Errors
    /// Invalid settings.
    ///
    /// # Panics
    /// If the packings differ in their number of disks.
    pub fn between<const D: usize>(
        before: &State<D>,
        after: &State<D>,
        centre: usize,
        outer_radius: f64,
        settings: &IsostaticSettings,
    ) -> Result<Self, IsostaticError> {
        settings.check()?;
        let changes = BondChanges::between(before, after, centre, settings.bonds);
        let fluctuations = Fluctuations::of_bonds(&changes, settings.measure, outer_radius, settings.ring_width);
        let excess = ExcessCoordination::of(&before.network).map(|excess| excess.value);
        let increase = after.packing.radii()[centre] - before.packing.radii()[centre];
        Self::of(&fluctuations, excess, increase, outer_radius, settings)
    }

    /// ℓ_iso of a fluctuation against r. It may be a mean over samples, or h_r as a control that should not collapse.
    ///
    /// `excess` is ΔZ, none without a backbone; `increase` is d_0 and `outer_radius` R \[length\].
    ///
    /// # Errors
    /// Invalid settings.
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
            tail: settings.tail,
            scale: settings.scale,
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
        let per_length = settings.scale.of(excess);
        found.curve = rings.iter().map(|ring| IsostaticPoint::of(ring, per_length, unit, settings.tail)).collect();
        let Some(threshold) = settings.rule.threshold(&found.curve, outer_radius) else {
            found.outcome = IsostaticOutcome::NoPlateau;
            return Ok(found);
        };
        found.threshold = Some(threshold);
        found.outcome = outcome(&found.curve, threshold, per_length);
        Ok(found)
    }
}

fn outcome(curve: &[IsostaticPoint], threshold: f64, per_length: f64) -> IsostaticOutcome {
    match curve.iter().position(|point| point.scaled_fluctuation >= threshold) {
        None => {
            let largest =
                curve.iter().map(|point| point.scaled_fluctuation).fold(0.0, |most, value| larger(value, most));
            IsostaticOutcome::NeverReached { largest }
        }
        Some(0) => IsostaticOutcome::AboveFromTheStart { innermost: curve[0].radius },
        Some(first) => {
            let (below, above) = (&curve[first - 1], &curve[first]);
            let share = (threshold - below.scaled_fluctuation) / (above.scaled_fluctuation - below.scaled_fluctuation);
            let length = below.radius + share * (above.radius - below.radius);
            IsostaticOutcome::Reached { length, product: length * per_length, between: [below.radius, above.radius] }
        }
    }
}

impl IsostaticPoint {
    fn of(ring: &FluctuationRing, per_length: f64, unit: f64, tail: Tail) -> Self {
        let scaled_radius = ring.radius * per_length;
        let factor = scaled_radius.powi(tail.power());
        IsostaticPoint {
            radius: ring.radius,
            scaled_radius,
            scaled_fluctuation: ring.fluctuation / unit * factor,
            standard_error: ring.standard_error / unit * factor,
        }
    }
}
