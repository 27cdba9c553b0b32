//! What a reader wants to know of each sample, row by row; the terminal table and the page lay the same rows out.

use crate::certificate::Certificate;
#[cfg(feature = "linear")]
use crate::certificate::Stability;
use crate::contact::LawChoice;
use crate::inflation::Boundary;
use crate::observe::penetration::{Penetration, PenetrationLength, PenetrationSettings};
use crate::observe::pressure_change::pressure_exponent;
use crate::relax::Criterion;
#[cfg(feature = "fit")]
use crate::report::curve;
use crate::report::number::{count, significant};
use crate::run::{Report, RestSummary, SampleOutcome, SampleReport, SampleResult};
use crate::scene::Sample;

/// |⟨d_r⟩| of a ring at ξ \[length\]. Source: the study.
const PENETRATION_THRESHOLD: f64 = 1e-3;

/// Rows under one heading.
pub(crate) struct Section {
    pub title: &'static str,
    pub rows: Vec<Row>,
}

/// One quantity.
pub(crate) struct Row {
    /// What it is, with its unit.
    pub label: String,
    /// One a sample; a dash where a sample has none.
    pub cells: Vec<String>,
}

/// Whether wall times are wanted.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Times {
    Shown,
    #[cfg_attr(not(feature = "plot"), allow(dead_code, reason = "only the page leaves them out"))]
    LeftOut,
}

/// Collects the rows of some samples.
pub(crate) struct Rows<'a> {
    samples: &'a [SampleReport],
    rows: Vec<Row>,
}

impl<'a> Rows<'a> {
    /// No row yet.
    #[cfg(feature = "linear")]
    pub(crate) fn new(samples: &'a [SampleReport]) -> Self {
        Rows { samples, rows: Vec::new() }
    }

    /// Adds a row, unless no sample has the quantity.
    pub(crate) fn add(
        &mut self,
        label: impl Into<String>,
        cell: impl Fn(&SampleResult) -> Option<String>,
    ) -> &mut Self {
        let cells: Vec<Option<String>> = self.samples.iter().map(|sample| done(sample).and_then(&cell)).collect();
        if cells.iter().any(Option::is_some) {
            let cells = cells.into_iter().map(|cell| cell.unwrap_or_else(|| "–".into())).collect();
            self.rows.push(Row { label: label.into(), cells });
        }
        self
    }

    /// Adds a row that also failed samples have.
    fn add_of_sample(&mut self, label: &str, cell: impl Fn(&SampleReport) -> String) {
        self.rows.push(Row { label: label.into(), cells: self.samples.iter().map(cell).collect() });
    }

    pub(crate) fn section(self, title: &'static str) -> Section {
        Section { title, rows: self.rows }
    }
}

/// The result of a sample that came to one.
pub(crate) fn done(sample: &SampleReport) -> Option<&SampleResult> {
    match &sample.result {
        SampleOutcome::Done(result) => Some(result),
        SampleOutcome::Failed(_) => None,
    }
}

/// The samples that came to nothing, with the reason.
pub(crate) fn failures(samples: &[SampleReport]) -> impl Iterator<Item = (&str, &str)> {
    samples.iter().filter_map(|sample| match &sample.result {
        SampleOutcome::Failed(reason) => Some((sample.name.as_str(), reason.as_str())),
        SampleOutcome::Done(_) => None,
    })
}

/// What samples were refused, with the reason: sample, what there is not, why.
#[cfg_attr(
    not(any(feature = "fit", feature = "linear")),
    allow(unused_variables, unused_mut, reason = "nothing is refused")
)]
pub(crate) fn refusals(samples: &[SampleReport]) -> Vec<(&str, &'static str, &str)> {
    let mut refused = Vec::new();
    #[cfg(any(feature = "fit", feature = "linear"))]
    for (sample, result) in samples.iter().filter_map(|sample| Some((sample, done(sample)?))) {
        #[cfg(feature = "fit")]
        if let Some(crate::run::FitResult::Refused(reason)) = &result.profile_fit {
            refused.push((sample.name.as_str(), "no fit", reason.as_str()));
        }
        #[cfg(feature = "linear")]
        if let Some(crate::run::PlasticResult::Refused(reason)) = &result.plastic_part {
            refused.push((sample.name.as_str(), "no linear response", reason.as_str()));
        }
        #[cfg(feature = "linear")]
        if let Some(crate::run::ProtocolResult::Refused(reason)) = &result.protocol {
            refused.push((sample.name.as_str(), "no protocols compared", reason.as_str()));
        }
    }
    refused
}

/// All rows of these samples of a report; sections without rows are left out.
pub(crate) fn sections(report: &Report, samples: &[SampleReport], times: Times) -> Vec<Section> {
    let all = [
        packing(report, samples),
        preparation(report, samples, times),
        inflation(report, samples, times),
        certificate(samples),
        #[cfg(feature = "fit")]
        fit(samples),
        #[cfg(feature = "linear")]
        plastic(samples),
        #[cfg(feature = "linear")]
        crate::report::protocol::section(samples),
    ];
    all.into_iter().filter(|section| !section.rows.is_empty()).collect()
}

fn packing(report: &Report, samples: &[SampleReport]) -> Section {
    let mut rows = Rows { samples, rows: Vec::new() };
    let (inside, radius) = match report.scene.inflation.boundary {
        Boundary::HeldRim { .. } => ("disks in the circle, N", "radius of the circle, R [length]"),
        Boundary::Periodic => ("mobile disks, N", "half the shortest side, R [length]"),
    };
    rows.add_of_sample("seed", |sample| sample.seed.to_string());
    rows.add("disks in the box", |it| Some(count(it.packing.disk_count)))
        .add(inside, |it| Some(count(it.inflation.mobile_count)))
        .add(radius, |it| Some(significant(it.inflation.outer_radius, 5)))
        .add("packing fraction, φ", |it| Some(significant(it.packing.packing_fraction, 5)))
        .add("packing fraction at the quench", |it| {
            it.packing.quench_packing_fraction.map(|value| significant(value, 5))
        })
        .add("pressure, p [force/length]", |it| Some(significant(it.packing.pressure, 5)))
        .add("coordination of the backbone, Z", |it| {
            let backbone = it.packing.rattler_count < it.packing.disk_count;
            backbone.then(|| significant(it.packing.coordination, 4))
        })
        .add("rattlers in the box", |it| Some(count(it.packing.rattler_count)));
    rows.section("Packing")
}

fn preparation(report: &Report, samples: &[SampleReport], times: Times) -> Section {
    let mut rows = Rows { samples, rows: Vec::new() };
    rows.add("relaxer", |_| Some(report.scene.preparation.relaxer.name().into()))
        .add("relaxations", |it| Some(count(it.packing.relaxation_count)))
        .add("at rest by", |it| Some(criterion(&it.packing.rest).into()))
        .add("residual / rounding floor", |it| Some(residual(&it.packing.rest)))
        .add("force evaluations", |it| Some(count(it.packing.rest.cost.force_evaluation_count)))
        .add("factorisations", |it| factorisations(&it.packing.rest));
    if times == Times::Shown {
        rows.add("wall time [s]", |it| Some(significant(it.packing.rest.cost.seconds, 3)));
    }
    rows.section("Preparation")
}

fn inflation(report: &Report, samples: &[SampleReport], times: Times) -> Section {
    let mut rows = Rows { samples, rows: Vec::new() };
    let relaxer = |it: &SampleResult| {
        // The result stands in the report under the name of its sample.
        let sample = samples.iter().find(|sample| done(sample).is_some_and(|other| std::ptr::eq(other, it)))?;
        settings(report, &sample.name).map(|sample| sample.relaxer.name().into())
    };
    let exponent = pressure_exponent(report.scene.law.exponent());
    let coupling = report.scene.inflation.on_site_coupling;
    rows.add("on-site coupling, Γ [force/length]", |_| coupling.map(|value| significant(value, 5)));
    rows.add("relaxer", relaxer)
        .add("at rest by", |it| Some(criterion(&it.inflation.after.rest).into()))
        .add("residual / rounding floor before", |it| Some(residual(&it.inflation.before.rest)))
        .add("residual / rounding floor after", |it| Some(residual(&it.inflation.after.rest)))
        .add("residual / rounding floor deflated", |it| {
            it.inflation.deflated.as_ref().map(|state| residual(&state.rest))
        })
        .add("force evaluations before", |it| Some(count(it.inflation.before.rest.cost.force_evaluation_count)))
        .add("force evaluations after", |it| Some(count(it.inflation.after.rest.cost.force_evaluation_count)))
        .add("force evaluations deflated", |it| {
            it.inflation.deflated.as_ref().map(|state| count(state.rest.cost.force_evaluation_count))
        })
        .add("factorisations before", |it| factorisations(&it.inflation.before.rest))
        .add("factorisations after", |it| factorisations(&it.inflation.after.rest))
        .add("factorisations deflated", |it| factorisations(&it.inflation.deflated.as_ref()?.rest));
    if times == Times::Shown {
        rows.add("wall time [s]", |it| Some(significant(inflation_seconds(it), 3)));
    }
    rows.add("rattlers before, after", |it| {
        Some(format!("{}, {}", count(it.inflation.before.rattler_count), count(it.inflation.after.rattler_count)))
    })
    .add("pressure before, p [force/length]", |it| Some(significant(it.inflation.before.pressure, 5)))
    .add("pressure change, Δp [force/length]", |it| Some(significant(it.inflation.pressure_change, 4)))
    .add(scaled_label(exponent), |it| it.inflation.scaled_pressure_change.map(|value| significant(value, 4)))
    .add("Δp left, deflated [force/length]", |it| {
        let deflated = it.inflation.deflated.as_ref()?;
        Some(significant(deflated.pressure - it.inflation.before.pressure, 4))
    })
    .add("largest |d| left, deflated [length]", |it| {
        let left = it.cycle_field.as_ref()?.counted().map(|disk| crate::vector::norm(disk.displacement));
        Some(significant(left.fold(0.0, crate::vector::larger), 3))
    })
    .add("penetration ξ, |⟨d_r⟩| = 10⁻³ [length]", penetration);
    rows.section("Inflation")
}

fn certificate(samples: &[SampleReport]) -> Section {
    let mut rows = Rows { samples, rows: Vec::new() };
    let excess = |certificate: &Certificate| certificate.contacts.map(|contacts| format!("{:+}", contacts.excess));
    let virial = |certificate: &Certificate| Some(significant(certificate.virial?.relative_difference.abs(), 1));
    let packing = |it: &SampleResult| it.packing.certificate.clone();
    let (before, after) = (
        |it: &SampleResult| it.inflation.before.certificate.clone(),
        |it: &SampleResult| it.inflation.after.certificate.clone(),
    );
    rows.add("contacts − isostatic, box", |it| excess(&packing(it)))
        .add("contacts − isostatic, before", |it| excess(&before(it)))
        .add("contacts − isostatic, after", |it| excess(&after(it)));
    #[cfg(feature = "linear")]
    rows.add("negative eigenvalues, box", |it| negative(&packing(it)))
        .add("negative eigenvalues, before", |it| negative(&before(it)))
        .add("negative eigenvalues, after", |it| negative(&after(it)));
    rows.add("bucklers box, before, after", |it| {
        packing(it).contacts?;
        let counts = [packing(it), before(it), after(it)].map(|certificate| count(certificate.buckler_count));
        Some(counts.join(", "))
    })
    .add("Σ Fr against −dE/d ln L, box, rel.", |it| virial(&packing(it)))
    .add("Σ Fr against −dE/d ln L, after, rel.", |it| virial(&after(it)));
    rows.section("Certificate")
}

/// Number of negative eigenvalues of the Hessian, or why there is none.
#[cfg(feature = "linear")]
fn negative(certificate: &Certificate) -> Option<String> {
    match &certificate.stability {
        Stability::Counted { negative_eigenvalue_count, .. } => Some(count(*negative_eigenvalue_count)),
        Stability::Singular { .. } => Some("singular".into()),
        Stability::Unknown(_) => Some("unknown".into()),
        Stability::NoBackbone => None,
    }
}

#[cfg(feature = "fit")]
fn fit(samples: &[SampleReport]) -> Section {
    use crate::report::number::with_error;
    use crate::run::FitResult;

    let mut rows = Rows { samples, rows: Vec::new() };
    // A κ known to nothing is the elastic solution again.
    let screened = |it: &SampleResult| {
        curve::fit_of(it)?.screened.filter(|fit| fit.wavenumber.standard_error < 10.0 * fit.wavenumber.value)
    };
    let first_pole = |it: &SampleResult| {
        let annulus = crate::reference::Annulus::new(it.inflation.inner_radius, it.inflation.outer_radius).ok()?;
        Some(crate::reference::poles::pole::<2>(annulus, 1))
    };
    let rms = |chi_squared: f64, rings: usize| significant((chi_squared / rings as f64).sqrt(), 3);
    rows.add("described by", |it| match it.profile_fit.as_ref()? {
        FitResult::Fitted(fit) => Some(decision_name(fit.decision).into()),
        FitResult::Refused(_) => Some("fit refused".into()),
    })
    .add("rings fitted", |it| curve::fit_of(it).map(|fit| count(fit.ring_count)))
    .add("elastic: d_0^eff [length]", |it| {
        curve::fit_of(it).map(|fit| with_error(fit.elastic.amplitude.value, fit.elastic.amplitude.standard_error))
    })
    .add("elastic: κ below (95 %) [1/length]", |it| {
        let bound = curve::fit_of(it)?.elastic.wavenumber_bound;
        Some(bound.map_or_else(|| "no bound".into(), |bound| significant(bound, 2)))
    })
    .add("elastic: κ/κ_1 below (95 %)", |it| {
        Some(significant(curve::fit_of(it)?.elastic.wavenumber_bound? / first_pole(it)?, 2))
    })
    .add("elastic: share described", |it| curve::fit_of(it).map(|fit| significant(fit.elastic.share_described, 3)))
    .add("elastic: rms residual / ring error", |it| {
        curve::fit_of(it).map(|fit| rms(fit.elastic.chi_squared, fit.ring_count))
    })
    .add("screened: d_0^eff [length]", |it| {
        screened(it).map(|fit| with_error(fit.amplitude.value, fit.amplitude.standard_error))
    })
    .add("screened: κ [1/length]", |it| {
        screened(it).map(|fit| with_error(fit.wavenumber.value, fit.wavenumber.standard_error))
    })
    .add("screened: κ/κ_1", |it| {
        let (kappa, first) = (screened(it)?.wavenumber, first_pole(it)?);
        Some(with_error(kappa.value / first, kappa.standard_error / first))
    })
    .add("screened: share described", |it| screened(it).map(|fit| significant(fit.share_described, 3)))
    .add("screened: rms residual / ring error", |it| {
        Some(rms(screened(it)?.chi_squared, curve::fit_of(it)?.ring_count))
    })
    .add("chance of such a gain if κ = 0", |it| screened(it).map(|fit| significant(fit.chance_of_elastic, 2)));
    rows.section("Fit of the radial profile")
}

#[cfg(feature = "linear")]
fn plastic(samples: &[SampleReport]) -> Section {
    use crate::run::{PlasticResult, PlasticSummary};

    fn measured(it: &SampleResult) -> Option<&PlasticSummary> {
        match it.plastic_part.as_ref()? {
            PlasticResult::Measured(plastic) => Some(plastic),
            PlasticResult::Refused(_) => None,
        }
    }
    let mut rows = Rows { samples, rows: Vec::new() };
    rows.add("linear response", |it| match it.plastic_part.as_ref()? {
        PlasticResult::Measured(plastic) => Some(match plastic.negative_eigenvalue_count {
            0 => "at a minimum".into(),
            negative => format!("at a saddle, {negative} down"),
        }),
        PlasticResult::Refused(_) => Some("none".into()),
    })
    .add("linear: contact opens at d_0 [length]", |it| measured(it)?.first_opening.map(|at| significant(at, 3)))
    .add("linear: Δp [force/length]", |it| Some(significant(measured(it)?.linear_pressure_change, 4)))
    .add("plastic share, |d − d_0 u|/|d|", |it| measured(it).map(|plastic| significant(plastic.share, 3)))
    .add("plastic participation ratio", |it| measured(it).map(|plastic| significant(plastic.participation_ratio, 3)));
    rows.section("Plastic part")
}

/// What describes a profile, in a word.
#[cfg(feature = "fit")]
pub(crate) fn decision_name(decision: crate::fit::profile::Decision) -> &'static str {
    use crate::fit::profile::Decision;
    match decision {
        Decision::Elastic => "elastic",
        Decision::Screened => "screened",
        Decision::Neither => "neither",
    }
}

/// κ with its error, or the bound on it.
#[cfg(all(feature = "fit", feature = "plot"))]
pub(crate) fn wavenumber(fit: &crate::fit::profile::ProfileFit) -> Option<String> {
    use crate::fit::profile::Decision;
    use crate::report::number::with_error;
    match fit.decision {
        Decision::Elastic => Some(match fit.elastic.wavenumber_bound {
            Some(bound) => format!("< {} (95 %)", significant(bound, 2)),
            None => "no bound found".into(),
        }),
        Decision::Screened => fit.screened.map(|fit| with_error(fit.wavenumber.value, fit.wavenumber.standard_error)),
        Decision::Neither => None,
    }
}

/// The entry of a sample in the scene.
pub(crate) fn settings<'a>(report: &'a Report, name: &str) -> Option<&'a Sample> {
    report.scene.sample.iter().find(|sample| sample.name == name)
}

/// ξ of a packing that was unjammed, or how far out of its rings \[length\].
fn penetration(result: &SampleResult) -> Option<String> {
    let profile = result.radial_profile.as_ref()?;
    if result.inflation.before.rest.criterion != Criterion::Unjammed {
        return None;
    }
    let settings = PenetrationSettings { thresholds: vec![PENETRATION_THRESHOLD] };
    let lengths = PenetrationLength::of(profile, &settings).ok()?;
    Some(match lengths.first()?.penetration {
        Penetration::FallsAt { radius, .. } => significant(radius, 4),
        Penetration::NeverAbove { .. } => "nowhere".into(),
        Penetration::ReachesRim { .. } => "to the rim".into(),
    })
}

/// Wall time of all relaxations of an inflation \[s\].
pub(crate) fn inflation_seconds(result: &SampleResult) -> f64 {
    let states = [Some(&result.inflation.before), Some(&result.inflation.after), result.inflation.deflated.as_ref()];
    states.into_iter().flatten().map(|state| state.rest.cost.seconds).sum()
}

fn scaled_label(exponent: f64) -> String {
    if exponent == 1.0 / 3.0 {
        "Δp/p^(1/3) [(force/length)^(2/3)]".into()
    } else {
        format!("Δp/p^{0} [(force/length)^{1}]", significant(exponent, 3), significant(1.0 - exponent, 3))
    }
}

/// Factorisations, where the relaxer made any.
fn factorisations(rest: &RestSummary) -> Option<String> {
    let made = rest.cost.factorisation_count;
    (made > 0).then(|| count(made))
}

fn criterion(rest: &RestSummary) -> &'static str {
    match rest.criterion {
        Criterion::RelativeForce => "relative force",
        Criterion::AbsoluteForce => "absolute force",
        Criterion::Unjammed => "no contacts",
    }
}

/// The relative residual beside the rounding floor; the net force itself where there is no contact force to relate it to.
fn residual(rest: &RestSummary) -> String {
    if rest.criterion == Criterion::Unjammed {
        return format!("{} [force]", significant(rest.largest_net_force, 2));
    }
    format!("{} / {}", significant(rest.relative_residual, 2), significant(rest.rounding_floor, 1))
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
