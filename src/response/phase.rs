//! [`PhaseDecision`]: unjammed, plastic or quasielastic, by three kinds of evidence.
//!
//! | evidence | plastic | quasielastic | says nothing |
//! |---|---|---|---|
//! | radial profile | screened, κ ≠ 0 | elastic, and any κ at or above κ_1 excluded (95 %) | neither, or κ_1 not excluded |
//! | Δp | below 0 | above 0 | 0 |
//! | angular spectrum | a crossover f†, or flat | a power law describes it as well | both do |
//!
//! The sign of Δp is read the other way round where the disk shrinks, d_0 < 0, and says nothing where d_0 = 0.
//!
//! States that are not at rest have no phase: [`PhaseDecision::from_evidence`] takes the [`VerdictPermit`] of a
//! [`RestVerdict`](crate::verdict::RestVerdict). Without a backbone, before or after, the packing is unjammed, and nothing else is asked. Where two disagree the phase is
//! undecided; so it is where none speaks. The evidence is that of one sample: near the transition samples of one pressure
//! differ, and where the transition lies is a statement about many of them.
//!
//! # Source
//! The study: κ_fit and Δp (its second figure), the spectrum that is scale-free at p_c and a Lorentzian below.

use serde::{Deserialize, Serialize};

use crate::displacement::MeasuredOn;
#[cfg(feature = "fit")]
use crate::fit::angular::CrossoverOutcome;
#[cfg(feature = "fit")]
use crate::fit::profile::Decision;
#[cfg(feature = "fit")]
use crate::reference::{Annulus, poles::pole};
use crate::response::Response;
use crate::verdict::VerdictPermit;

/// A phase above jamming.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Plastic events screen the response.
    Plastic,
    /// The response is that of an elastic medium, but for its moduli.
    Quasielastic,
}

/// What a sample shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PhaseOutcome {
    /// No backbone before or after.
    Unjammed,
    /// All evidence there is says plastic.
    Plastic,
    /// All evidence there is says quasielastic.
    Quasielastic,
    /// Evidence that disagrees, or none.
    #[default]
    Undecided,
    /// A state is not at rest: there is no phase.
    NotAtRest,
}

/// The phase of a sample and what speaks for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct PhaseDecision {
    /// What the sample shows.
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
}

impl PhaseDecision {
    /// What the measurements of a response say, `increase` being d_0.
    pub(super) fn of(response: &Response, pressure_change: f64, increase: f64) -> Self {
        let Some(permit) = response.verdict.permit() else { return Self::not_at_rest() };
        if response.measured_on == MeasuredOn::AllDisks {
            return PhaseDecision { outcome: PhaseOutcome::Unjammed, ..PhaseDecision::default() };
        }
        let by_pressure_change = by_pressure_change(pressure_change, increase);
        Self::from_evidence(permit, by_profile(response), by_pressure_change, by_spectrum(response))
    }

    /// No phase, for states that are not at rest.
    pub fn not_at_rest() -> Self {
        PhaseDecision { outcome: PhaseOutcome::NotAtRest, ..PhaseDecision::default() }
    }

    /// The phase of a jammed packing by what each kind of evidence says, none where it says nothing.
    pub fn from_evidence(
        _permit: VerdictPermit,
        by_profile: Option<Phase>,
        by_pressure_change: Option<Phase>,
        by_spectrum: Option<Phase>,
    ) -> Self {
        let mut voices = [by_profile, by_pressure_change, by_spectrum].into_iter().flatten();
        let outcome = match voices.next() {
            Some(first) if voices.all(|voice| voice == first) => match first {
                Phase::Plastic => PhaseOutcome::Plastic,
                Phase::Quasielastic => PhaseOutcome::Quasielastic,
            },
            _ => PhaseOutcome::Undecided,
        };
        PhaseDecision { outcome, by_profile, by_pressure_change, by_spectrum }
    }
}

/// The sign of Δp against that of d_0.
fn by_pressure_change(change: f64, increase: f64) -> Option<Phase> {
    let change = if increase == 0.0 { 0.0 } else { change * increase.signum() };
    if change < 0.0 {
        Some(Phase::Plastic)
    } else if change > 0.0 {
        Some(Phase::Quasielastic)
    } else {
        None
    }
}

#[cfg(feature = "fit")]
fn by_profile(response: &Response) -> Option<Phase> {
    let fit = response.profile_fit.as_ref()?.measured()?;
    match fit.decision {
        Decision::Screened => Some(Phase::Plastic),
        Decision::Elastic => {
            let annulus = Annulus::new(response.field.inner_radius, response.field.outer_radius).ok()?;
            let bound = fit.elastic.wavenumber_bound?;
            (bound < pole::<2>(annulus, 1)).then_some(Phase::Quasielastic)
        }
        Decision::Neither => None,
    }
}

#[cfg(feature = "fit")]
fn by_spectrum(response: &Response) -> Option<Phase> {
    let ring = response.angular_correlation.as_ref()?.measured()?;
    match ring.crossover.as_ref()?.measured()?.outcome {
        CrossoverOutcome::Found { .. } | CrossoverOutcome::White { .. } => Some(Phase::Plastic),
        CrossoverOutcome::ScaleFree { .. } => Some(Phase::Quasielastic),
        CrossoverOutcome::Undetermined => None,
    }
}

/// Without the feature `fit` nothing is fitted.
#[cfg(not(feature = "fit"))]
fn by_profile(_response: &Response) -> Option<Phase> {
    None
}

/// Without the feature `fit` nothing is fitted.
#[cfg(not(feature = "fit"))]
fn by_spectrum(_response: &Response) -> Option<Phase> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Hertzian, LawChoice};
    use crate::observe::state::State;
    use crate::packing::{Domain, Packing};
    use crate::verdict::{RestVerdict, VerdictSettings};

    /// Leave for two disks that do not touch.
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
        let outcome = |a, b, c| PhaseDecision::from_evidence(permit(), a, b, c).outcome;
        assert_eq!(outcome(None, plastic, None), PhaseOutcome::Plastic);
        assert_eq!(outcome(elastic, elastic, None), PhaseOutcome::Quasielastic);
        assert_eq!(outcome(elastic, elastic, plastic), PhaseOutcome::Undecided);
        assert_eq!(outcome(None, None, None), PhaseOutcome::Undecided);
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
