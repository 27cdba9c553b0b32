//! The numbers of each sample, row by row, for the terminal table and for the page.

pub(crate) mod analysis;
#[cfg(feature = "linear")]
mod drive;
pub(crate) mod estimators;
mod phase_frequency;
pub(crate) mod response;
pub(crate) mod section;
mod states;

use crate::law::choice::LawChoice;
use crate::report::rows::section::{Section, done};
use crate::response::Measurement;
use crate::run::{Report, SampleOutcome, SampleReport, SampleResult};
use crate::scene::Sample;
use crate::verdict::RestVerdict;

/// Whether to include wall times.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Times {
    Shown,
    #[cfg_attr(not(feature = "plot"), allow(dead_code, reason = "only the page leaves them out"))]
    LeftOut,
}

/// The samples without a result, with the reason.
pub(crate) fn failures(samples: &[SampleReport]) -> impl Iterator<Item = (&str, &str)> {
    samples.iter().filter_map(|sample| match &sample.result {
        SampleOutcome::Failed(reason) => Some((sample.name.as_str(), reason.as_str())),
        SampleOutcome::Done(_) => None,
    })
}

/// Verdicts on the states of samples with a result.
pub(crate) fn verdicts(samples: &[SampleReport]) -> impl Iterator<Item = (&str, &RestVerdict)> {
    samples.iter().filter_map(|sample| Some((sample.name.as_str(), &done(sample)?.response.verdict)))
}

/// Refused quantities of samples: sample, quantity, reason.
pub(crate) fn refusals(samples: &[SampleReport]) -> Vec<(&str, &'static str, &str)> {
    let mut refused = Vec::new();
    for (sample, result) in samples.iter().filter_map(|sample| Some((sample, done(sample)?))) {
        let name = sample.name.as_str();
        refused.extend(response::refusals(&result.response).into_iter().map(|(what, reason)| (name, what, reason)));
        #[cfg(feature = "linear")]
        refused.extend(refused_of(&result.plastic_part).map(|reason| (name, "no linear response", reason)));
        #[cfg(feature = "linear")]
        refused.extend(refused_of(&result.drive).map(|reason| (name, "no continuum beside the drive", reason)));
        #[cfg(feature = "linear")]
        refused.extend(refused_of(&result.protocol).map(|reason| (name, "no protocols compared", reason)));
    }
    refused
}

/// Why a requested quantity was refused.
pub(crate) fn refused_of<T>(measurement: &Option<Measurement<T>>) -> Option<&str> {
    measurement.as_ref().and_then(Measurement::refused)
}

/// All rows of these samples; sections without rows are left out.
pub(crate) fn sections(report: &Report, samples: &[SampleReport], times: Times) -> Vec<Section> {
    let mut all = vec![
        states::packing(report, samples),
        states::preparation(report, samples, times),
        states::inflation(report, samples, times),
        states::certificate(samples),
    ];
    let responses = samples.iter().map(|sample| done(sample).map(|result| &result.response)).collect();
    all.extend(response::sections(responses));
    all.push(phase_frequency::section(samples));
    #[cfg(feature = "linear")]
    all.extend([
        drive::section(samples),
        states::plastic(report, samples),
        crate::report::protocol::section(report, samples),
    ]);
    all.retain(|section| !section.rows.is_empty());
    all
}

/// The entry of a sample in the scene.
pub(crate) fn settings<'a>(report: &'a Report, name: &str) -> Option<&'a Sample> {
    report.scene.sample.iter().find(|sample| sample.name == name)
}

/// Wall time of all relaxations of an inflation \[s\].
pub(crate) fn inflation_seconds(result: &SampleResult) -> f64 {
    let states = [Some(&result.inflation.before), Some(&result.inflation.after), result.inflation.deflated.as_ref()];
    states.into_iter().flatten().map(|state| state.rest.cost.seconds).sum()
}

/// A law in words.
pub(crate) fn law(law: &LawChoice) -> String {
    match law {
        LawChoice::Hertzian(law) => format!("Hertzian contacts, stiffness {}", law.stiffness),
        LawChoice::Hookean(law) => format!("Hookean contacts, stiffness {}", law.stiffness),
        LawChoice::PowerLaw(law) => {
            format!("power-law contacts, scale {}, exponent {}", law.energy_scale, law.exponent)
        }
    }
}
