//! [`PhaseDecision`]: unjammed, plastic or quasielastic, by four types of evidence.
//!
//! | evidence | plastic | quasielastic | no decision |
//! |---|---|---|---|
//! | radial profile | screened, κ ≠ 0 | elastic, and any κ at or above κ_1 excluded (95 %) | neither, or κ_1 not excluded |
//! | Δp | below 0 | above 0 | 0 |
//! | angular spectrum | a crossover f†, or flat | a power law describes it as well, and falls as f^(−1.5) or faster | both do, or a flatter power law |
//! | contacts changed | more than 2 % | fewer than 0.5 % | between |
//!
//! How often each type of evidence gives which phase at which pressure: chapter *Response*,
//! [`Calibration`](crate::response::Calibration).
//!
//! The sign of Δp is reversed if the disk shrinks, d_0 < 0, and gives no decision if d_0 = 0.
//!
//! States that are not at rest have no phase: [`PhaseDecision::from_evidence`] takes the [`VerdictPermit`] of a
//! [`RestVerdict`](crate::verdict::RestVerdict). Without a backbone, before or after, the packing is unjammed, whatever
//! the evidence. If two types of evidence disagree, or none decides, the phase is undecided. The evidence is that of
//! one sample. Near the transition samples at the same pressure differ, so locating the transition takes many samples.
//!
//! # Source
//! The study (Fu, Jin, Pan, Procaccia, *Long-range angular correlations of particle displacements at a
//! plastic-to-elastic transition in jammed amorphous solids*): the fitted κ and Δp against the pressure (its second
//! figure); the angular spectrum, a power law at p_c and a Lorentzian below. The limits for the changed contacts come
//! from our ensembles.

use serde::{Deserialize, Serialize};

use crate::response::contacts::ContactChangeCounts;
use crate::verdict::VerdictPermit;

/// A phase above jamming.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Plastic events screen the response.
    Plastic,
    /// The response is that of an elastic medium, up to its moduli.
    Quasielastic,
}

/// The phase of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PhaseOutcome {
    /// No backbone before or after.
    Unjammed,
    /// All evidence that decides is plastic.
    Plastic,
    /// All evidence that decides is quasielastic.
    Quasielastic,
    /// Evidence that disagrees, or no decision.
    #[default]
    Undecided,
    /// A state is not at rest: there is no phase.
    NotAtRest,
}

/// The phase of a sample and the evidence for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct PhaseDecision {
    /// The phase.
    pub outcome: PhaseOutcome,
    /// By the fit of the radial profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_profile: Option<Phase>,
    /// By the sign of Δp.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_pressure_change: Option<Phase>,
    /// By the angular spectrum.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_spectrum: Option<Phase>,
    /// By the contacts made and broken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by_contact_changes: Option<Phase>,
}

/// The phase by each type of evidence; none if it does not decide.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Evidence {
    /// The fit of the radial profile.
    pub profile: Option<Phase>,
    /// The sign of Δp.
    pub pressure_change: Option<Phase>,
    /// The angular spectrum.
    pub spectrum: Option<Phase>,
    /// The contacts made and broken.
    pub contact_changes: Option<Phase>,
}

/// Share of contacts made or broken by the inflation above which the response is plastic. Source: ensembles of 5548 and
/// 22184 disks, d_0 = 0.1, by damped dynamics: the median crosses 1 % where κ and Δp change.
const PLASTIC_CHANGES: f64 = 0.02;

/// The share below which the response is quasielastic. Source: the same ensembles.
const QUASIELASTIC_CHANGES: f64 = 0.005;

impl PhaseDecision {
    /// No phase, for states that are not at rest.
    pub fn not_at_rest() -> Self {
        PhaseDecision { outcome: PhaseOutcome::NotAtRest, ..PhaseDecision::default() }
    }

    /// The phase of a jammed packing.
    pub fn from_evidence(_permit: VerdictPermit, evidence: Evidence) -> Self {
        let Evidence { profile, pressure_change, spectrum, contact_changes } = evidence;
        let mut voices = [profile, pressure_change, spectrum, contact_changes].into_iter().flatten();
        let outcome = match voices.next() {
            Some(first) if voices.all(|voice| voice == first) => match first {
                Phase::Plastic => PhaseOutcome::Plastic,
                Phase::Quasielastic => PhaseOutcome::Quasielastic,
            },
            _ => PhaseOutcome::Undecided,
        };
        PhaseDecision {
            outcome,
            by_profile: profile,
            by_pressure_change: pressure_change,
            by_spectrum: spectrum,
            by_contact_changes: contact_changes,
        }
    }
}

/// The sign of Δp against that of d_0.
pub(super) fn by_pressure_change(change: f64, increase: f64) -> Option<Phase> {
    let change = if increase == 0.0 { 0.0 } else { change * increase.signum() };
    if change < 0.0 {
        Some(Phase::Plastic)
    } else if change > 0.0 {
        Some(Phase::Quasielastic)
    } else {
        None
    }
}

/// The phase by the share of contacts changed by the inflation.
pub(super) fn by_contact_changes(changes: ContactChangeCounts) -> Option<Phase> {
    let changed = (changes.made_count + changes.broken_count) as f64;
    let share = changed / (changes.kept_count + changes.broken_count) as f64;
    if share > PLASTIC_CHANGES {
        Some(Phase::Plastic)
    } else if share < QUASIELASTIC_CHANGES {
        Some(Phase::Quasielastic)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::choice::LawChoice;
    use crate::law::power_laws::Hertzian;
    use crate::observe::state::State;
    use crate::packing::{Domain, Packing};
    use crate::verdict::{RestVerdict, VerdictSettings};

    /// A permit, from two disks that do not touch.
    fn permit() -> VerdictPermit {
        let packing = Packing::new(Domain::Open, vec![[0.0, 0.0], [2.0, 0.0]], vec![0.5; 2]).expect("valid");
        let law = Hertzian::default();
        let state = State::new(&packing, &law).expect("two places");
        let settings = VerdictSettings::default();
        let verdict = RestVerdict::of(&[("", &state)], &law, &LawChoice::Hertzian(law), None, &settings);
        verdict.permit().expect("at rest")
    }

    #[test]
    fn one_voice_decides_and_two_that_differ_do_not() {
        let (plastic, elastic) = (Some(Phase::Plastic), Some(Phase::Quasielastic));
        let outcome = |profile, pressure_change, spectrum| {
            let evidence = Evidence { profile, pressure_change, spectrum, contact_changes: None };
            PhaseDecision::from_evidence(permit(), evidence).outcome
        };
        assert_eq!(outcome(None, plastic, None), PhaseOutcome::Plastic);
        assert_eq!(outcome(elastic, elastic, None), PhaseOutcome::Quasielastic);
        assert_eq!(outcome(elastic, elastic, plastic), PhaseOutcome::Undecided);
        assert_eq!(outcome(None, None, None), PhaseOutcome::Undecided);
    }

    #[test]
    fn contacts_speak_where_many_or_few_change() {
        // Of 1000 contacts.
        let changed = |made_count, broken_count| {
            by_contact_changes(ContactChangeCounts {
                kept_count: 1000 - broken_count,
                made_count,
                broken_count,
                ..Default::default()
            })
        };
        assert_eq!(changed(11, 10), Some(Phase::Plastic));
        assert_eq!((changed(10, 10), changed(3, 2)), (None, None));
        assert_eq!((changed(2, 2), changed(0, 0)), (Some(Phase::Quasielastic), Some(Phase::Quasielastic)));
        // Without contacts there is no share.
        assert_eq!(by_contact_changes(ContactChangeCounts::default()), None);
        let evidence = Evidence { contact_changes: Some(Phase::Plastic), ..Evidence::default() };
        let decision = PhaseDecision::from_evidence(permit(), evidence);
        assert_eq!((decision.outcome, decision.by_contact_changes), (PhaseOutcome::Plastic, Some(Phase::Plastic)));
    }

    #[test]
    fn pressure_speaks_by_its_sign_against_that_of_the_increase() {
        for (increase, rises, falls) in [
            (0.1, Some(Phase::Quasielastic), Some(Phase::Plastic)),
            (-0.1, Some(Phase::Plastic), Some(Phase::Quasielastic)),
            (0.0, None, None),
        ] {
            assert_eq!(by_pressure_change(1e-9, increase), rises, "{increase}");
            assert_eq!(by_pressure_change(-1e-9, increase), falls, "{increase}");
            assert_eq!(by_pressure_change(0.0, increase), None);
            assert_eq!(by_pressure_change(f64::NAN, increase), None);
        }
    }
}
