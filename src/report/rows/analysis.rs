//! The rows of analyses.

use crate::analysis::{Analysis, StateAnalysis};
use crate::report::number::{count, pressure_unit, significant};
use crate::report::rows::response;
use crate::report::rows::section::{Rows, Section};

/// All rows; sections without rows are left out.
pub(crate) fn sections<const D: usize>(analyses: &[Analysis<D>]) -> Vec<Section> {
    let mut all = vec![states(analyses)];
    all.extend(response::sections(analyses.iter().map(|analysis| Some(&analysis.response)).collect()));
    all.retain(|section| !section.rows.is_empty());
    all
}

fn states<const D: usize>(analyses: &[Analysis<D>]) -> Section {
    let residual = |state: &StateAnalysis| {
        let certificate = &state.certificate;
        if state.pressure == 0.0 {
            return format!("{} [force]", significant(certificate.largest_net_force, 2));
        }
        format!("{} / {}", significant(certificate.relative_residual, 2), significant(certificate.rounding_floor, 1))
    };
    let radius = if D == 3 { "radius of the shell, R [length]" } else { "radius of the circle, R [length]" };
    let unit = pressure_unit(D);
    let mut rows = Rows::new(analyses.iter().map(Some).collect());
    rows.add("inflated disk", |it| Some(it.centre_label.to_string()))
        .add("radius of this disk, a [length]", |it| Some(significant(it.inner_radius, 5)))
        .add("increase, d_0 [length]", |it| Some(significant(it.increase, 5)))
        .add("mobile disks, N", |it| Some(count(it.mobile_count)))
        .add(radius, |it| Some(significant(it.outer_radius, 5)))
        .add("residual / rounding floor before", |it| Some(residual(&it.before)))
        .add("residual / rounding floor after", |it| Some(residual(&it.after)))
        .add("residual / rounding floor deflated", |it| it.deflated.as_ref().map(residual))
        .add("rattlers before, after", |it| {
            Some(format!("{}, {}", count(it.before.rattler_count), count(it.after.rattler_count)))
        })
        .add("contacts before, after", |it| {
            Some(format!("{}, {}", count(it.before.contact_count), count(it.after.contact_count)))
        })
        .add("energy before [energy]", |it| Some(significant(it.before.energy, 5)))
        .add("energy after [energy]", |it| Some(significant(it.after.energy, 5)))
        .add(format!("pressure before, p [{unit}]"), |it| Some(significant(it.before.pressure, 5)))
        .add(format!("pressure change, Δp [{unit}]"), |it| Some(significant(it.pressure_change, 4)))
        .add("Δp scaled with p", |it| it.scaled_pressure_change.map(|value| significant(value, 4)));
    rows.section("States")
}
