//! The recipes of other drives than a held disk in the plane: spheres, a row of disks, a free disk.

use crate::inflation::Boundary;
use crate::scene::Observables;
use crate::study::recipe::scale::{Scale, common, ensemble_observables, part, reduced};
use crate::study::settings::{Part, Seeds, Study, Target};

/// Sizes from 1000 to 64000 spheres; in a held shell of the default R there are 0.46 of them.
pub(super) fn spheres(scale: Scale) -> Study {
    let part = |disk_count, targets: &[f64], count| Part {
        disk_counts: vec![disk_count],
        targets: reduced(targets),
        seeds: Some(Seeds { first: 1, count }),
        ..Part::default()
    };
    let all = [1e6, 1e5, 1e4, 1e3, 1e2, 1e1];
    let parts = match scale {
        Scale::Small => vec![part(1000, &all[..4], 16), part(4000, &all[..4], 4)],
        Scale::Medium => {
            vec![part(1000, &all, 16), part(4000, &all[..5], 8), part(16_000, &all[..4], 4), part(64_000, &all[..3], 2)]
        }
        Scale::Full => vec![
            part(4000, &all, 400),
            part(16_000, &all, 400),
            part(64_000, &all[..5], 400),
            part(280_000, &all[..4], 400),
        ],
    };
    let mut study = Study { parts, ..common() };
    study.scene.dimension = 3;
    study.scene.observables = ensemble_observables(3);
    study
}

/// Strips of four lengths, and squares of twice and four times the width. At the pressures near the transition of disks
/// the box of 1200 disks has sides of 40.
pub(super) fn line(scale: Scale) -> Study {
    let strip = |squares: usize, width: usize, targets: &[f64], count| Part {
        disk_counts: vec![1200 * squares * width * width],
        targets: targets.iter().map(|&pressure| Target::Pressure(pressure)).collect(),
        seeds: Some(Seeds { first: 1, count }),
        boundary: Some(Boundary::HeldWalls { distance_over_side: 0.45, length_over_side: squares as f64 }),
        ..Part::default()
    };
    let all = [1e3, 1e2, 1e1, 1e0];
    let parts = match scale {
        Scale::Small => vec![
            strip(1, 1, &all, 40),
            strip(2, 1, &all, 20),
            strip(4, 1, &all, 10),
            strip(8, 1, &all, 8),
            strip(1, 2, &all, 10),
        ],
        Scale::Medium => vec![
            strip(1, 4, &all, 16),
            strip(1, 2, &all, 60),
            strip(8, 1, &all, 24),
            strip(4, 1, &all, 48),
            strip(2, 1, &all, 96),
            strip(1, 1, &all, 192),
            strip(1, 8, &all[..3], 4),
        ],
        Scale::Full => vec![
            strip(1, 1, &all, 400),
            strip(2, 1, &all, 400),
            strip(4, 1, &all, 400),
            strip(8, 1, &all, 400),
            strip(1, 2, &all, 400),
            strip(1, 4, &all, 400),
            strip(1, 8, &all, 400),
        ],
    };
    let mut study = Study { parts, increases: vec![0.1, 0.02], ..common() };
    let mut observables = Observables { angular_profiles: None, displacement_field: None, ..Observables::of_strip() };
    if let Some(ring) = &mut observables.angular_correlation {
        // The half-width of G too.
        ring.correlation.thresholds.push(0.5);
    }
    study.scene.inflation.boundary = Boundary::HeldWalls { distance_over_side: 0.45, length_over_side: 1.0 };
    study.scene.observables = observables;
    study
}

pub(super) fn free_centre(scale: Scale) -> Study {
    let parts = match scale {
        Scale::Small => vec![part(0, reduced(&[1e6, 1e7, 1e8]), 24), part(1, reduced(&[1e7, 1e8, 1e9]), 8)],
        Scale::Medium => vec![
            part(0, reduced(&[1e6, 3e6, 1e7, 3e7, 1e8]), 60),
            part(1, reduced(&[1e6, 1e7, 3e7, 1e8, 4e8, 1e9]), 60),
            part(2, reduced(&[1e7, 1e8, 4e8]), 12),
        ],
        Scale::Full => vec![
            part(1, reduced(&[1e6, 1e7, 3e7, 1e8, 4e8, 1e9]), 400),
            part(2, reduced(&[1e6, 1e7, 3e7, 1e8, 4e8, 1e9]), 400),
        ],
    };
    Study { parts, centres_held: vec![true, false], ..common() }
}
