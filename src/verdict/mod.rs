//! [`RestVerdict`]: whether states are at rest, so that a phase and fits are meaningful; otherwise the likely causes.
//!
//! ```text
//! at rest   max |f_i| ≤ ε ⟨F⟩  on the backbone,   max |f_i| ≤ √ε ⟨F⟩  off it        ε = 10⁻³, a setting
//! ```
//!
//! Observables can be computed for a state far from equilibrium, but they do not describe the response: disks then move
//! because of unbalanced forces, not because a disk grew. A phase and every fit of a
//! [`Response`](crate::response::Response) take a [`VerdictPermit`], and only a verdict gives one. The relaxers have
//! the same rule for disks off the backbone.

mod cause;
mod coordinate_digits;
mod diagnosis;
mod force_balance;

use serde::{Deserialize, Serialize};

pub use cause::{Cause, OtherLaw};
pub use coordinate_digits::Digits;
pub use force_balance::{Balance, StateBalance};

use crate::law::choice::LawChoice;
use crate::law::pair_law::PairLaw;
use crate::observe::state::State;

/// No limit of a relaxer or of a verdict may be above this residual \[1\].
pub const LARGEST_RESIDUAL: f64 = 1e-2;

/// When a phase and fits are reported.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct VerdictSettings {
    /// ε, the largest net force on the backbone over the mean contact force at rest, at most [`LARGEST_RESIDUAL`]
    /// \[1\].
    pub residual_limit: f64,
    /// What to do with states above the limit.
    pub above_limit: AboveLimit,
}

impl Default for VerdictSettings {
    /// 10⁻³: relaxers reach residuals five decades below; coordinates with six digits leave residuals a decade or more
    /// above.
    fn default() -> Self {
        VerdictSettings { residual_limit: 1e-3, above_limit: AboveLimit::default() }
    }
}

/// What to do with states above the limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AboveLimit {
    /// No phase and no fit.
    #[default]
    Refused,
    /// Both are reported, with a note that the states are not at rest.
    Given,
}

/// Permission to report a phase and fits: the states are at rest, or the settings require both in any case. Only
/// [`RestVerdict::permit`] makes one.
#[derive(Debug, Clone, Copy)]
pub struct VerdictPermit(());

/// The geometry of an experiment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Index of the inflated disk.
    pub centre: usize,
    /// R, beyond which disks are held; absent if nothing is held \[length\].
    pub outer_radius: Option<f64>,
}

/// The decision of a verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Decision {
    /// All states are at rest.
    AtRest,
    /// A state is not at rest; no phase and no fit are reported.
    NotAtRest,
    /// A state is not at rest, but the settings require a phase and fits.
    NotAtRestButGiven,
}

/// Whether states are at rest, by their residuals; otherwise the likely causes.
///
/// # Example
/// ```
/// use jamscope::law::{Hookean, LawChoice};
/// use jamscope::io::read_packing;
/// use jamscope::observe::state::State;
/// use jamscope::verdict::{Cause, RestVerdict, VerdictSettings};
///
/// // Hertzian disks under the Hookean law.
/// let packing = read_packing::<2>("fixtures/packings/hertz_N1000_p100.xyz")?;
/// let law = Hookean::default();
/// let state = State::new(&packing, &law)?;
/// let verdict = RestVerdict::of(&[("packing", &state)], &law, &LawChoice::Hookean(law), None, &VerdictSettings::default());
/// assert!(verdict.permit().is_none());
/// assert!(matches!(verdict.likely()[0], Cause::Law { law: LawChoice::Hertzian(_), .. }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RestVerdict {
    decision: Decision,
    residual_limit: f64,
    states: Vec<StateBalance>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    likely: Vec<Cause>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    other_laws: Vec<OtherLaw>,
}

impl RestVerdict {
    /// Judges states whose contacts are those of `law`, which `choice` names. The names of the states appear in
    /// reports.
    ///
    /// # Cost
    /// One pass over the contacts. If a state is not at rest: a contact network per state for each of about four other
    /// laws.
    pub fn of<const D: usize>(
        states: &[(&'static str, &State<'_, D>)],
        law: &dyn PairLaw,
        choice: &LawChoice,
        place: Option<Place>,
        settings: &VerdictSettings,
    ) -> Self {
        let limit = settings.residual_limit;
        let weigh = |&(name, state): &(&'static str, &State<'_, D>)| {
            StateBalance::new(name, Balance::of(state.packing, &state.network, law), limit)
        };
        let balances: Vec<StateBalance> = states.iter().map(weigh).collect();
        let mut verdict = RestVerdict {
            decision: Decision::AtRest,
            residual_limit: limit,
            states: balances,
            likely: Vec::new(),
            other_laws: Vec::new(),
        };
        if verdict.states.iter().all(|state| state.at_rest) {
            return verdict;
        }
        verdict.decision = match settings.above_limit {
            AboveLimit::Refused => Decision::NotAtRest,
            AboveLimit::Given => Decision::NotAtRestButGiven,
        };
        verdict.other_laws = diagnosis::other_laws(states, choice);
        verdict.likely = diagnosis::causes(states, law, place, &verdict);
        verdict
    }

    /// This verdict combined with an earlier one on the states from which these come.
    #[must_use]
    pub fn after(self, earlier: &RestVerdict) -> Self {
        // The more restrictive of two decisions is kept.
        let weight = |decision| match decision {
            Decision::AtRest => 0,
            Decision::NotAtRestButGiven => 1,
            Decision::NotAtRest => 2,
        };
        let decision = if weight(earlier.decision) > weight(self.decision) { earlier.decision } else { self.decision };
        RestVerdict {
            decision,
            residual_limit: self.residual_limit,
            states: [earlier.states.clone(), self.states].concat(),
            likely: [earlier.likely.clone(), self.likely].concat(),
            other_laws: if earlier.other_laws.is_empty() { self.other_laws } else { earlier.other_laws.clone() },
        }
    }

    /// Permission to report a phase and fits, if they may be reported.
    pub fn permit(&self) -> Option<VerdictPermit> {
        (self.decision != Decision::NotAtRest).then_some(VerdictPermit(()))
    }

    /// The decision.
    pub fn decision(&self) -> Decision {
        self.decision
    }

    /// ε \[1\].
    pub fn residual_limit(&self) -> f64 {
        self.residual_limit
    }

    /// The residuals of all states.
    pub fn states(&self) -> &[StateBalance] {
        &self.states
    }

    /// Likely causes, the most likely first; at least one if a state is not at rest.
    pub fn likely(&self) -> &[Cause] {
        &self.likely
    }

    /// Largest residual of the states under other laws; empty if they are at rest.
    pub fn other_laws(&self) -> &[OtherLaw] {
        &self.other_laws
    }

    /// A sentence on why there is no fit; none if a fit may be reported.
    pub fn refusal(&self) -> Option<String> {
        (self.decision == Decision::NotAtRest).then(|| self.residuals())
    }

    /// Warnings for the reader of a report, one per paragraph; empty if all states are at rest.
    pub fn paragraphs(&self) -> Vec<String> {
        let consequence = match self.decision {
            Decision::AtRest => return Vec::new(),
            Decision::NotAtRest => "no phase and no fit",
            Decision::NotAtRestButGiven => "phase and fits are given only on request",
        };
        let mut all = vec![format!("NOT AT REST: {consequence}. {}", self.residuals())];
        all.extend(self.likely.iter().map(|cause| format!("Likely: {cause}")));
        if !self.other_laws.is_empty() {
            let others: Vec<String> = self.other_laws.iter().map(OtherLaw::to_string).collect();
            all.push(format!(
                "Residual under other laws: {}. The stiffness scales all contact forces alike and does not change these residuals.",
                others.join(", ")
            ));
        }
        all
    }

    /// The residuals of the states that are not at rest, against the limit.
    fn residuals(&self) -> String {
        let restless: Vec<String> = self
            .states
            .iter()
            .filter(|state| !state.at_rest)
            .map(|state| state.sentence(self.residual_limit))
            .collect();
        format!(
            "Largest net force over mean contact force: {}; at rest it is at most {:e}.",
            restless.join(", "),
            self.residual_limit
        )
    }
}
