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
mod compared;
mod descend;
mod ending;
#[cfg(feature = "fit")]
mod ending_fit;
mod ending_response;
mod ensemble;
mod measure;
mod settings;
mod spread;

use crate::inflation::{Inflated, Inflation};
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError, ball_volume};
use crate::relax::Trace;

pub use compared::{Compared, ProtocolSensitivity};
pub use descend::Protocol;
pub use ending::Ending;
#[cfg(feature = "fit")]
pub use ending_fit::{EndingFit, EndingScreened};
pub use ending_response::EndingResponse;
pub use ensemble::{ProtocolSummary, chosen};
pub use settings::ProtocolSettings;
pub use spread::{Spread, Spreads};

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
