//! The rows of another drive than an inflation, beside the exact solution of its continuum.

use crate::report::number::significant;
use crate::report::rows::section::{Rows, Section};
use crate::run::{DriveSummary, SampleReport, SampleResult};

/// Distance from which the modes of the continuum are compared, in radii of the circle \[1\].
const FROM: f64 = 0.25;

pub(super) fn section(samples: &[SampleReport]) -> Section {
    fn measured(it: &SampleResult) -> Option<&DriveSummary> {
        it.drive.as_ref()?.measured()
    }
    let mut rows = Rows::of_samples(samples);
    rows.add("force F on the disk [force]", |it| measured(it).map(|drive| significant(drive.force, 4)))
        .add("dipole, F s [force·length]", |it| measured(it)?.moment.map(|value| significant(value, 4)))
        .add("displacement of the disk [length]", |it| measured(it)?.distance.map(|value| significant(value, 4)))
        .add("direction, θ_0 [rad]", |it| measured(it).map(|drive| significant(drive.angle, 4)))
        .add("shear modulus, μ [force/length]", |it| measured(it).map(|drive| significant(drive.shear_modulus, 4)))
        .add("Poisson's ratio from the moduli, ν", |it| measured(it).map(|drive| significant(drive.poisson_ratio, 4)))
        .add("modes off the continuum, r > R/4, rel.", |it| {
            let from = FROM * it.inflation.outer_radius;
            measured(it)?.deviation(from).map(|share| significant(share, 3))
        });
    rows.section("Drive")
}
