//! [`ProtocolSensitivity`]: how much a result depends on the relaxation method, from one start.
//!
//! ```text
//! |r_i − r'_i| ≤ ε ⟨δ⟩ for every disk of both backbones:  the same minimum        ⟨δ⟩ the mean overlap, ε = 10⁻⁴
//! ```
//!
//! Every relaxer starts from the same inflated packing. Newton's method then reduces the residual to 10⁻¹⁰, so the
//! force limits of the relaxers do not contribute to the distances. The endings are grouped into minima: an ending
//! belongs to the first minimum whose first ending is within the tolerance. ε is far below 1, because stiffnesses
//! change little over displacements below the overlaps, but become negative between two minima.
//! [`ProtocolSensitivity::farthest_within`] and [`ProtocolSensitivity::nearest_between`] show the gap around ε.
//!
//! Positions of rattlers are arbitrary, so distances exclude them. An ending without contact forces lies in a flat
//! valley and belongs to no minimum. If nothing is held, the mean displacement is subtracted from the distances.
//!
//! The standard deviation of a quantity over the endings is its error bar for the choice of the minimum.

mod compare;
mod ending;
#[cfg(feature = "fit")]
mod ending_fit;
mod ending_response;
mod ensemble;
mod measure;
mod run_protocol;
mod sensitivity;
mod settings;
mod spread;

use crate::inflation::{Inflated, Inflation, Shape, strip};
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError, ball_volume};
use crate::relax::Trace;

pub use ending::Ending;
#[cfg(feature = "fit")]
pub use ending_fit::{EndingFit, EndingScreened};
pub use ending_response::EndingResponse;
pub use ensemble::{ProtocolSummary, chosen};
pub use run_protocol::Protocol;
pub use sensitivity::{Compared, ProtocolSensitivity};
pub use settings::ProtocolSettings;
pub use spread::{Spread, Spreads};

impl<const D: usize> Compared<D> {
    /// Relaxes `start` by every protocol and compares the end states.
    ///
    /// Δp is relative to `pressure_before`; `pressure` computes the pressure of a state from its contacts.
    ///
    /// # Errors
    /// Only conditions that make forces undefined. A protocol that does not come to rest is an ending with that stop.
    ///
    /// # Cost
    /// The sum over all protocols, and Newton's method after each.
    pub fn of_start(
        start: &Packing<D>,
        law: &dyn PairLaw,
        protocols: &[Protocol],
        settings: &ProtocolSettings,
        pressure_before: f64,
        pressure: impl Fn(&crate::network::ContactNetwork<D>) -> f64,
        trace: &mut dyn Trace,
    ) -> Result<Self, PackingError> {
        let mut end_states = Vec::with_capacity(protocols.len());
        for protocol in protocols {
            end_states.push(run_protocol::descend(start, law, protocol, settings, &pressure, trace)?);
        }
        let floating = !law.has_sites() && !start.held().contains(&true);
        Ok(compare::compare(end_states, settings, pressure_before, floating))
    }

    /// Like [`Compared::of_start`], from the state before an inflation with its disk inflated.
    ///
    /// `law` is the law without sites; the sites are those of `inflation`.
    ///
    /// # Errors
    /// See [`Compared::of_start`].
    pub fn of_inflation(
        inflated: &Inflated<D>,
        inflation: &Inflation,
        law: &dyn PairLaw,
        protocols: &[Protocol],
        settings: &ProtocolSettings,
        trace: &mut dyn Trace,
    ) -> Result<Self, PackingError> {
        let centre = inflated.centre;
        let start = &inflated.start;
        let before = inflated.before.pressure;
        let (domain, held) = (*start.domain(), start.held().to_vec());
        let is_row = |disk: usize| inflated.grown.binary_search(&disk).is_ok();
        let pressure = |network: &crate::network::ContactNetwork<D>| match (inflated.shape, domain.volume()) {
            (Shape::Strip { .. }, _) => network
                .cluster_pressure(strip::area(&domain, inflated.outer_radius), |disk| held[disk] && !is_row(disk)),
            (Shape::Round, Some(volume)) => network.pressure(volume),
            (Shape::Round, None) => {
                let volume = ball_volume::<D>(inflated.outer_radius) * inflated.drive.strain::<D>().volume_ratio::<D>();
                network.cluster_pressure(volume, |disk| disk > centre)
            }
        };
        let law = inflation.law_with_sites(law);
        Self::of_start(start, law.as_ref(), protocols, settings, before, pressure, trace)
    }
}
