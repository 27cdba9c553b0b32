//! [`Analysis`]: the observables of two states relaxed by another program.
//!
//! ```text
//! before, after  →  disks matched by label, the inflated one identified  →  d_i = r_i(after) − r_i(before)  →
//! Response
//! ```
//!
//! The states are of disks (D = 2, the default) or of spheres (D = 3), inside a circle or a shell.
//!
//! Whether the states are at rest is checked: each has a [`Certificate`] with its residual, and a [`RestVerdict`]
//! decides whether a phase and fits may be reported. The inflated disk is the one whose radius changed, unless it is
//! given. A state is unjammed by the rule of the relaxers: its contact forces are those of rounding. If R is given or
//! the file marks held disks, disks beyond R and the centre are held; otherwise the box is periodic and R is half its
//! shortest side.

mod pair;

use serde::Serialize;

pub use pair::{AnalysisError, Pair, PairSettings};

use crate::certificate::Certificate;
use crate::displacement::{DisplacementField, Shape};
use crate::inflation::drive::DiagonalStrain;
use crate::inflation::region::Region;
use crate::inflation::{Boundary, Drive};
use crate::law::choice::LawChoice;
use crate::law::pair_law::PairLaw;
use crate::observe::PressureChange;
use crate::observe::state::State;
use crate::packing::{PackingError, ball_volume};
use crate::relax::UNJAMMED_FORCE;
use crate::response::{Response, Subject};
use crate::scene::Observables;
use crate::verdict::{Place, RestVerdict, VerdictSettings};

/// Two states and their observables.
#[derive(Debug, Clone, Serialize)]
pub struct Analysis<const D: usize = 2> {
    /// Its name in reports and file names.
    pub name: String,
    /// The contact law.
    pub law: LawChoice,
    /// Label of the inflated disk.
    pub centre_label: u64,
    /// Its radius before, a \[length\].
    pub inner_radius: f64,
    /// Increase of its radius, d_0 \[length\].
    pub increase: f64,
    /// R \[length\].
    pub outer_radius: f64,
    /// Number of mobile disks.
    pub mobile_count: usize,
    /// State before.
    pub before: StateAnalysis,
    /// State after.
    pub after: StateAnalysis,
    /// State after the deflation, if it was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deflated: Option<StateAnalysis>,
    /// Δp = p_after − p_before \[force / length\].
    pub pressure_change: f64,
    /// Δp / p^((α−2)/(α−1)) \[(force / length)^(1/(α−1))\], absent for an unjammed packing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scaled_pressure_change: Option<f64>,
    /// The observables requested, with their settings.
    pub settings: Observables,
    /// The observables.
    #[serde(flatten)]
    pub response: Response,
    /// The matched states.
    #[serde(skip)]
    pub pair: Pair<D>,
}

/// Summary of one state.
#[derive(Debug, Clone, Serialize)]
pub struct StateAnalysis {
    /// Pressure of the circle or the box, 0 for an unjammed packing \[force / length\].
    pub pressure: f64,
    /// Elastic energy \[energy\].
    pub energy: f64,
    /// Number of contacts, without those between held disks.
    pub contact_count: usize,
    /// Number of mobile disks that are rattlers.
    pub rattler_count: usize,
    /// Its certificate, which includes the residual.
    pub certificate: Certificate,
}

impl<const D: usize> Analysis<D> {
    /// Measures a pair of states. A phase and fits are included if the states are at rest by `verdict`, or if its
    /// settings require them in any case.
    ///
    /// # Errors
    /// Two disks with the same centre. The settings must have been [checked](Observables::check).
    pub fn of(
        name: &str,
        pair: Pair<D>,
        law: &LawChoice,
        observables: &Observables,
        verdict: &VerdictSettings,
    ) -> Result<Self, PackingError> {
        let (centre, outer_radius) = (pair.centre, pair.outer_radius);
        let labels = pair.before.labels();
        let state = |packing| State::new(packing, law).map_err(|error| error.with_labels(labels));
        let (before, after) = (state(&pair.before)?, state(&pair.after)?);
        let deflated = pair.deflated.as_ref().map(state).transpose()?;
        let known = |state: &State<'_, D>| StateAnalysis::of(state, &pair, law);
        let [first, second] = [known(&before)?, known(&after)?];
        let third = deflated.as_ref().map(known).transpose()?;
        let pressure = PressureChange::between(first.pressure, second.pressure, law.exponent());
        let inner_radius = pair.before.radii()[centre];
        let unjammed = [&before, &after].iter().any(|state| is_unjammed(state, law));
        let states = [(before.packing, before.network.backbone.as_slice()), (after.packing, &after.network.backbone)];
        let region = Region {
            centre,
            grown: &[centre],
            inner_radius,
            outer_radius,
            shape: Shape::Round,
            strain: DiagonalStrain::default(),
        };
        let field = DisplacementField::of_states(states, unjammed, region);
        let held = matches!(pair.boundary, Boundary::HeldRim { .. });
        let place = Place { centre, outer_radius: held.then_some(outer_radius) };
        let mut named = vec![("before", &before), ("after", &after)];
        named.extend(deflated.as_ref().map(|state| ("after the deflation", state)));
        let verdict = RestVerdict::of(&named, law, law, Some(place), verdict);
        let subject = Subject {
            verdict,
            field,
            before,
            after,
            deflated,
            centre,
            drive: Drive::Inflation,
            pressure_change: pressure.change,
        };
        let response = Response::of(subject, observables);
        Ok(Analysis {
            name: name.into(),
            law: *law,
            centre_label: pair.before.labels()[centre],
            inner_radius,
            increase: pair.after.radii()[centre] - inner_radius,
            outer_radius,
            mobile_count: pair.before.held().iter().filter(|&&held| !held).count(),
            before: first,
            after: second,
            deflated: third,
            pressure_change: pressure.change,
            scaled_pressure_change: pressure.scaled,
            settings: observables.clone(),
            response,
            pair,
        })
    }

    /// The boundary.
    pub fn boundary(&self) -> Boundary {
        self.pair.boundary
    }
}

impl StateAnalysis {
    fn of<const D: usize>(state: &State<'_, D>, pair: &Pair<D>, law: &dyn PairLaw) -> Result<Self, PackingError> {
        let (packing, network) = (state.packing, &state.network);
        let pressure = match (pair.boundary, packing.domain().volume()) {
            _ if is_unjammed(state, law) => 0.0,
            (Boundary::Periodic, Some(volume)) => network.pressure(volume),
            _ => {
                let rim = |disk: usize| packing.held()[disk] && disk != pair.centre;
                network.cluster_pressure(ball_volume::<D>(pair.outer_radius), rim)
            }
        };
        Ok(StateAnalysis {
            pressure,
            energy: network.energy(),
            contact_count: network.contacts.len(),
            rattler_count: network.rattlers().filter(|&disk| !packing.held()[disk]).count(),
            certificate: Certificate::of(packing, law, None)?,
        })
    }
}

/// Whether a state is unjammed: without a backbone, or with contact forces that count as zero in the sense of
/// [`UNJAMMED_FORCE`]. Rounding may leave overlaps in an unjammed packing that resemble a backbone.
fn is_unjammed<const D: usize>(state: &State<'_, D>, law: &dyn PairLaw) -> bool {
    let network = &state.network;
    let radius = state.packing.radii().iter().copied().fold(f64::INFINITY, f64::min);
    let total: f64 = network.contacts.iter().map(|contact| contact.force).sum();
    let mean = total / network.contacts.len().max(1) as f64;
    network.backbone_count() == 0 || mean <= UNJAMMED_FORCE * law.force_scale(radius)
}
