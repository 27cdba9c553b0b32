//! [`ProtocolSensitivity`]: one start, several ways to come to rest, and what of the result depends on the way.
//!
//! ```text
//! |r_i − r'_i| ≤ ε ⟨δ⟩ for every disk of both backbones:  the same minimum        ⟨δ⟩ the mean overlap, ε = 10⁻⁴
//! ```
//!
//! Every relaxer sets out from the same inflated packing and is finished by Newton's method to a residual of 10⁻¹⁰, so that
//! what is left between two endings is not their force limits. Endings are then sorted into minima; an ending belongs to the
//! first minimum whose first ending is that near. ε is far below 1: on a way shorter than the overlaps no stiffness changes by
//! much, and between two minima it must turn negative. [`ProtocolSensitivity::farthest_within`] and
//! [`ProtocolSensitivity::nearest_between`] tell how clear the gap around ε was.
//!
//! Rattlers end anywhere and are left out of distances. An ending without any contact force lies in a valley that is flat: it
//! is in no minimum. Where nothing is held, distances are those left after the mean displacement is taken off.
//!
//! The standard deviation of a quantity over the endings is its error bar for "which minimum".

mod compare;
mod descend;
#[cfg(feature = "fit")]
mod ending_fit;
mod ending_response;
mod ensemble;
mod spread;

use serde::{Deserialize, Serialize};

use crate::inflation::{Inflated, Inflation, Rest};
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError, ball_volume};
use crate::relax::{Cost, Stop, Trace};

pub use descend::Protocol;
#[cfg(feature = "fit")]
pub use ending_fit::{EndingFit, EndingScreened};
pub use ending_response::EndingResponse;
pub use ensemble::{ProtocolSummary, chosen};
pub use spread::{Spread, Spreads};

/// How protocols are compared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ProtocolSettings {
    /// Share of the samples of a scene it is done to, at least one of them \[1\].
    pub fraction: f64,
    /// ε: farthest disks of two states in one minimum, over the mean overlap \[1\].
    pub same_minimum: f64,
    /// Distance over the mean overlap beyond which a disk is named as one that differs \[1\].
    pub differing: f64,
    /// Relative residual to which Newton's method brings every ending \[1\]; four times the rounding floor where that is more.
    pub residual: f64,
}

impl Default for ProtocolSettings {
    /// All samples; ε = 10⁻⁴; a tenth of an overlap; 10⁻¹⁰.
    fn default() -> Self {
        ProtocolSettings { fraction: 1.0, same_minimum: 1e-4, differing: 0.1, residual: 1e-10 }
    }
}

/// Where one protocol ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ending {
    /// The relaxer, with its damping law if it has one.
    pub relaxer: String,
    /// Why the relaxer itself stopped.
    pub stop: Stop,
    /// Why Newton's method after it stopped; absent where it was not called (not at rest, or no contacts).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finish: Option<Stop>,
    /// What the relaxer cost, Newton's method after it left out.
    pub cost: Cost,
    /// Largest way of a disk of the backbone during the finish \[length\]; 0 where there was none.
    pub finish_way: f64,
    /// Relative residual in the end \[1\].
    pub relative_residual: f64,
    /// Number of the minimum, from 1, in the order in which they were found; absent if not at rest or without contacts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub minimum: Option<usize>,
    /// Largest distance of a disk of both backbones from where it is in the reference \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<f64>,
    /// Labels of the disks farther away than [`ProtocolSettings::differing`] mean overlaps, farthest first.
    pub differing: Vec<u64>,
    /// Contacts between disks of the backbone that the reference has and this has not, or the other way about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_difference_count: Option<usize>,
    /// Number of contacts.
    pub contact_count: usize,
    /// Elastic energy, with that of sites \[energy\].
    pub energy: f64,
    /// Pressure \[force / length^(D−1)\].
    pub pressure: f64,
    /// Δp \[force / length^(D−1)\]; absent if not at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_change: Option<f64>,
    /// Its angular correlation and contact changes, where they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub response: Option<EndingResponse>,
    /// What was fitted to its radial profile.
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fit: Option<EndingFit>,
}

impl Ending {
    /// Whether it came to rest, contacts or not.
    pub fn at_rest(&self) -> bool {
        self.pressure_change.is_some()
    }
}

/// The endings of several protocols from one start.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProtocolSensitivity {
    /// One entry a protocol, in the order given.
    pub endings: Vec<Ending>,
    /// Which of them is the reference of distances: the first at rest with contacts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference: Option<usize>,
    /// Mean overlap of the contacts of its backbone, ⟨δ⟩ \[length\].
    pub mean_overlap: f64,
    /// Number of minima found.
    pub minimum_count: usize,
    /// Largest distance from the reference \[length\].
    pub largest_distance: f64,
    /// Largest distance of an ending from the first one in its minimum, over ⟨δ⟩ \[1\].
    pub farthest_within: f64,
    /// Smallest distance between the first endings of two minima, over ⟨δ⟩ \[1\]; absent if there is but one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest_between: Option<f64>,
    /// Means and standard deviations over the endings at rest.
    pub spreads: Spreads,
}

/// A comparison with the states compared.
#[derive(Debug, Clone)]
pub struct Compared<const D: usize> {
    /// The comparison.
    pub sensitivity: ProtocolSensitivity,
    /// The states in the order of the endings; none where a protocol did not come to rest.
    pub states: Vec<Option<Rest<D>>>,
}

impl<const D: usize> Compared<D> {
    /// Relaxes `start` by every protocol and compares where they end.
    ///
    /// `pressure_before` is what Δp is counted from; `pressure` gives that of a state from its contacts.
    ///
    /// # Errors
    /// Only what makes forces undefined. A protocol that does not come to rest is an ending that says so.
    ///
    /// # Cost
    /// That of all protocols, one after the other, and Newton's method after each.
    pub fn of_start<L: PairLaw>(
        start: &Packing<D>,
        law: &L,
        protocols: &[Protocol],
        settings: &ProtocolSettings,
        pressure_before: f64,
        pressure: impl Fn(&crate::network::ContactNetwork<D>) -> f64,
        trace: &mut impl Trace,
    ) -> Result<Self, PackingError> {
        let mut landings = Vec::with_capacity(protocols.len());
        for protocol in protocols {
            landings.push(descend::descend(start, law, protocol, settings, &pressure, trace)?);
        }
        let floating = !law.has_sites() && !start.held().contains(&true);
        Ok(compare::compare(landings, settings, pressure_before, floating))
    }

    /// The protocols from the state before with its disk inflated, as an inflation relaxed it.
    ///
    /// The law is the plain one; sites are those of `inflation`.
    ///
    /// # Errors
    /// As [`Compared::of_start`].
    pub fn of_inflation<L: PairLaw>(
        inflated: &Inflated<D>,
        inflation: &Inflation,
        law: &L,
        protocols: &[Protocol],
        settings: &ProtocolSettings,
        trace: &mut impl Trace,
    ) -> Result<Self, PackingError> {
        let centre = inflated.centre;
        let radius = inflated.after.packing.get().radii()[centre];
        let start = inflated.before.packing.get().clone().with_radius(centre, radius)?;
        let before = inflated.before.pressure;
        let domain = *start.domain();
        let pressure = |network: &crate::network::ContactNetwork<D>| match domain.volume() {
            Some(volume) => network.pressure(volume),
            None => network.cluster_pressure(ball_volume::<D>(inflated.outer_radius), |disk| disk > centre),
        };
        let law = inflation.law_with_sites(law);
        Self::of_start(&start, &law, protocols, settings, before, pressure, trace)
    }
}
