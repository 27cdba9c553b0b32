//! The rows of states: packing, preparation, inflation, certificate, plastic part.

use crate::certificate::Certificate;
#[cfg(feature = "linear")]
use crate::certificate::Stability;
use crate::inflation::Boundary;
use crate::observe::pressure_change::pressure_exponent;
use crate::relax::Criterion;
use crate::report::number::{count, pressure_unit, significant};
use crate::report::rows::section::{Rows, Section, done};
use crate::report::rows::{Times, inflation_seconds, settings};
use crate::run::{Report, RestSummary, SampleReport, SampleResult};

pub(super) fn packing(report: &Report, samples: &[SampleReport]) -> Section {
    let mut rows = Rows::of_samples(samples);
    let unit = pressure_unit(report.scene.dimension);
    let (inside, radius) = match report.scene.inflation.boundary {
        Boundary::HeldRim { .. } if report.scene.dimension == 3 => {
            ("spheres within the shell, N", "radius of the shell, R [length]")
        }
        Boundary::HeldRim { .. } => ("disks in the circle, N", "radius of the circle, R [length]"),
        Boundary::Periodic => ("mobile disks, N", "half the shortest side, R [length]"),
        Boundary::HeldWalls { .. } => ("mobile disks, N", "distance of the walls, H [length]"),
    };
    rows.add_cells("seed", samples.iter().map(|sample| sample.seed.to_string()));
    rows.add("disks in the box", |it| Some(count(it.packing.disk_count)))
        .add(inside, |it| Some(count(it.inflation.mobile_count)))
        .add(radius, |it| Some(significant(it.inflation.outer_radius, 5)))
        .add("packing fraction, φ", |it| Some(significant(it.packing.packing_fraction, 5)))
        .add("packing fraction at the quench", |it| {
            it.packing.quench_packing_fraction.map(|value| significant(value, 5))
        })
        .add(format!("pressure, p [{unit}]"), |it| Some(significant(it.packing.pressure, 5)))
        .add("coordination of the backbone, Z", |it| {
            let backbone = it.packing.rattler_count < it.packing.disk_count;
            backbone.then(|| significant(it.packing.coordination, 4))
        })
        .add("rattlers in the box", |it| Some(count(it.packing.rattler_count)));
    rows.section("Packing")
}

pub(super) fn preparation(report: &Report, samples: &[SampleReport], times: Times) -> Section {
    let mut rows = Rows::of_samples(samples);
    rows.add("relaxer", |_| Some(report.scene.preparation.relaxer.name().into()))
        .add("relaxations", |it| Some(count(it.packing.relaxation_count)))
        .add("residual as read", |it| {
            let read = it.packing.as_read.as_ref()?.states().first()?.relative_residual;
            Some(significant(read, 2))
        })
        .add("at rest by", |it| Some(criterion(&it.packing.rest).into()))
        .add("residual / rounding floor", |it| Some(residual(&it.packing.rest)))
        .add("force evaluations", |it| Some(count(it.packing.rest.cost.force_evaluation_count)))
        .add("factorisations", |it| factorisations(&it.packing.rest));
    if times == Times::Shown {
        rows.add("wall time [s]", |it| Some(significant(it.packing.rest.cost.seconds, 3)));
    }
    rows.section("Preparation")
}

pub(super) fn inflation(report: &Report, samples: &[SampleReport], times: Times) -> Section {
    let mut rows = Rows::of_samples(samples);
    let relaxer = |it: &SampleResult| {
        // A result is found in the report by its address, to get the name of its sample.
        let sample = samples.iter().find(|sample| done(sample).is_some_and(|other| std::ptr::eq(other, it)))?;
        settings(report, &sample.name).map(|sample| sample.relaxer.name().into())
    };
    let exponent = pressure_exponent(report.scene.law.exponent());
    let (coupling, unit) = (report.scene.inflation.on_site_coupling, pressure_unit(report.scene.dimension));
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
    .add(format!("pressure before, p [{unit}]"), |it| Some(significant(it.inflation.before.pressure, 5)))
    .add(format!("pressure change, Δp [{unit}]"), |it| Some(significant(it.inflation.pressure_change, 4)))
    .add(scaled_label(exponent, unit), |it| it.inflation.scaled_pressure_change.map(|value| significant(value, 4)))
    .add(format!("Δp after deflation [{unit}]"), |it| {
        let deflated = it.inflation.deflated.as_ref()?;
        Some(significant(deflated.pressure - it.inflation.before.pressure, 4))
    })
    .add("largest |d| after deflation [length]", |it| {
        it.states.largest_cycle_displacement().map(|left| significant(left, 3))
    });
    rows.section("Inflation")
}

pub(super) fn certificate(samples: &[SampleReport]) -> Section {
    let mut rows = Rows::of_samples(samples);
    let excess = |certificate: &Certificate| {
        certificate.contacts.map(|contacts| format!("{:+}", contacts.excess).replace('-', "−"))
    };
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

/// Number of negative eigenvalues of the Hessian, or why it is unknown.
#[cfg(feature = "linear")]
fn negative(certificate: &Certificate) -> Option<String> {
    match &certificate.stability {
        Stability::Counted { negative_eigenvalue_count, .. } => Some(count(*negative_eigenvalue_count)),
        Stability::Singular { .. } => Some("singular".into()),
        Stability::Unknown(_) => Some("unknown".into()),
        Stability::NoBackbone => None,
    }
}

#[cfg(feature = "linear")]
pub(super) fn plastic(report: &Report, samples: &[SampleReport]) -> Section {
    use crate::response::Measurement;
    use crate::run::PlasticSummary;

    fn measured(it: &SampleResult) -> Option<&PlasticSummary> {
        it.plastic_part.as_ref()?.measured()
    }
    let opening = match report.scene.inflation.drive.is_inflation() {
        true => "linear: contact opens at d_0 [length]",
        false => "linear: contact opens at share of drive",
    };
    let mut rows = Rows::of_samples(samples);
    rows.add("linear response", |it| match it.plastic_part.as_ref()? {
        Measurement::Measured(plastic) => Some(match plastic.negative_eigenvalue_count {
            0 => "at a minimum".into(),
            negative => format!("saddle of index {negative}"),
        }),
        Measurement::Refused(_) => Some("none".into()),
    })
    .add(opening, |it| measured(it)?.first_opening.map(|at| significant(at, 3)))
    .add(format!("linear: Δp [{}]", pressure_unit(report.scene.dimension)), |it| {
        Some(significant(measured(it)?.linear_pressure_change, 4))
    })
    .add("plastic share, |d − d_0 u|/|d|", |it| measured(it).map(|plastic| significant(plastic.share, 3)))
    .add("plastic participation ratio", |it| measured(it).map(|plastic| significant(plastic.participation_ratio, 3)));
    rows.section("Plastic part")
}

fn scaled_label(exponent: f64, unit: &str) -> String {
    if exponent == 1.0 / 3.0 {
        format!("Δp/p^(1/3) [({unit})^(2/3)]")
    } else {
        format!("Δp/p^{0} [({unit})^{1}]", significant(exponent, 3), significant(1.0 - exponent, 3))
    }
}

/// Number of factorisations, if the relaxer made any.
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

/// The relative residual with the rounding floor; without contact forces the net force itself.
fn residual(rest: &RestSummary) -> String {
    if rest.criterion == Criterion::Unjammed {
        return format!("{} [force]", significant(rest.largest_net_force, 2));
    }
    format!("{} / {}", significant(rest.relative_residual, 2), significant(rest.rounding_floor, 1))
}
