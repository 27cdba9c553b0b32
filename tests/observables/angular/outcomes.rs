//! Refusals and named outcomes.

use jamscope::displacement::{DisplacementField, MeasuredOn, Moved, Shape};
use jamscope::observe::angular::{
    AngularCorrelation, AngularError, CorrelationEstimator, CorrelationOutcome, CorrelationSettings, CrossingOutcome,
    FrequencyLimit, PowerSpectrum, RadialDependenceSettings, RingOutcome, RingSample, RingSettings, SpectrumEstimator,
    SpectrumSettings, block_errors, correlation_statistics, radial_dependence, spectrum_statistics,
};

use super::{even_angles, ring};

#[test]
fn rings_that_cannot_be_used_are_refused_with_numbers() {
    assert_eq!(
        RingSample::new(&[0.0; 5], &[0.0; 4]),
        Err(AngularError::LengthsDiffer { angle_count: 5, value_count: 4 })
    );
    assert_eq!(RingSample::new(&[0.0; 3], &[0.0; 3]), Err(AngularError::TooFewDisks { disk_count: 3 }));
    for (angle, value) in [(f64::NAN, 0.0), (f64::INFINITY, 0.0), (0.0, f64::NAN), (0.0, 1e151)] {
        let refused = RingSample::new(&[0.0, 1.0, angle, 2.0], &[0.0, 1.0, value, 2.0]);
        assert!(matches!(refused, Err(AngularError::NotFinite { disk: 2, .. })), "{refused:?}");
    }
    let ring = ring(&even_angles(40), f64::cos);
    let limit = |estimator, frequency_limit| {
        PowerSpectrum::of(&ring, &SpectrumSettings { estimator, frequency_limit }).map(|_| ())
    };
    let direct = SpectrumEstimator::default();
    assert!(matches!(
        limit(direct, FrequencyLimit::Fixed(0)),
        Err(AngularError::FrequencyLimitOutOfRange { frequency_limit: 0, .. })
    ));
    assert_eq!(
        limit(direct, FrequencyLimit::Fixed(21)),
        Err(AngularError::FrequencyLimitOutOfRange { frequency_limit: 21, highest: 20 })
    );
    assert!(matches!(limit(direct, FrequencyLimit::PerDisk(f64::NAN)), Err(AngularError::NotPositive { .. })));
    let coarse = SpectrumEstimator::Binned { bins_per_disk: 0.25 };
    assert_eq!(
        limit(coarse, FrequencyLimit::Fixed(6)),
        Err(AngularError::FrequencyLimitOutOfRange { frequency_limit: 6, highest: 5 })
    );
    for setting in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
        let grid = SpectrumEstimator::Interpolated { points_per_disk: setting };
        assert!(matches!(limit(grid, FrequencyLimit::Fixed(4)), Err(AngularError::NotPositive { .. })));
    }
    let refused = AngularCorrelation::of(&ring, &CorrelationSettings { thresholds: vec![1.0], ..Default::default() });
    assert_eq!(refused, Err(AngularError::ThresholdNotBelowOne { threshold: 1.0 }));
    let none = CorrelationSettings { estimator: CorrelationEstimator::Pairs { bin_count: 0 }, ..Default::default() };
    assert!(matches!(AngularCorrelation::of(&ring, &none), Err(AngularError::NotPositive { .. })));
    for blocks in [3, 11] {
        assert!(matches!(block_errors(&ring, 10, blocks), Err(AngularError::BlockCountOutOfRange { .. })));
    }
    assert!(matches!(correlation_statistics(&[]), Err(AngularError::SamplesDiffer { sample_count: 0, .. })));
    assert!(matches!(spectrum_statistics(&[]), Err(AngularError::SamplesDiffer { sample_count: 0, .. })));
}

#[test]
fn a_threshold_below_the_lowest_value_is_never_met() {
    let quadrupole = ring(&even_angles(64), |angle| (2.0 * angle).cos() + (4.0 * angle).cos());
    let settings = CorrelationSettings { thresholds: vec![0.1, -0.9], ..CorrelationSettings::default() };
    let found = AngularCorrelation::of(&quadrupole, &settings).expect("in range");
    // G = (cos 2θ + cos 4θ)/2 is lowest where cos 2θ = −1/4: (−1/4 − 7/8)/2.
    let CrossingOutcome::Never { lowest } = found.crossings[1].outcome else { panic!("{found:?}") };
    // On a grid of half a degree: curvature 17/2·(π/720)².
    assert!((lowest + 0.5625).abs() < 1e-4, "{lowest}");
    assert!(found.crossing(0.1).is_some() && found.crossing(-0.9).is_none() && found.crossing(0.3).is_none());
}

#[test]
fn values_without_variance_have_no_correlation() {
    // A mean of 40 times 0.3 is not 0.3 to the bit: rounding is no variance.
    for value in [0.0, 0.3] {
        let still = ring(&super::random_angles(40, 2), |_| value);
        for estimator in super::all_estimators() {
            let settings = SpectrumSettings { estimator, ..SpectrumSettings::default() };
            assert_eq!(PowerSpectrum::of(&still, &settings).expect("in range").normalised(), None);
        }
        for estimator in [CorrelationEstimator::default(), CorrelationEstimator::Pairs { bin_count: 20 }] {
            let settings = CorrelationSettings { estimator, ..Default::default() };
            let found = AngularCorrelation::of(&still, &settings).expect("in range");
            assert!(found.anticorrelation.is_nan() && found.values.iter().all(|value| value.is_nan()));
            assert!(found.crossings.iter().all(|crossing| crossing.outcome == CrossingOutcome::NoCorrelation));
        }
    }
}

#[test]
fn an_estimate_beyond_one_is_no_correlation() {
    let even = ring(&even_angles(64), |angle| angle.cos() + (2.0 * angle).cos());
    let mut spectrum = PowerSpectrum::of(&even, &SpectrumSettings::default()).expect("in range");
    let settings = CorrelationSettings::default();
    let found = AngularCorrelation::of_spectrum(&spectrum, &settings).expect("in range");
    assert_eq!(found.outcome, CorrelationOutcome::Found);
    // Unmixing may leave negative powers: G(π) = (−1 − 0.8)/(1 − 0.8).
    spectrum.power = vec![0.0, 1.0, -0.8];
    spectrum.unresolved = 0.0;
    let beyond = AngularCorrelation::of_spectrum(&spectrum, &settings).expect("in range");
    let CorrelationOutcome::OutOfRange { angle, value } = beyond.outcome else { panic!("{beyond:?}") };
    // A division by 0.2 of numbers rounded at 1.
    assert!((value + 9.0).abs() < 1e-14 && angle == std::f64::consts::PI, "{value} at {angle}");
    assert!(beyond.anticorrelation.is_nan() && beyond.values.iter().all(|value| value.is_nan()));
    let of_crossing = CrossingOutcome::OutOfRange { farthest: value };
    assert!(beyond.crossings.iter().all(|crossing| crossing.outcome == of_crossing));
    // A slightly negative ρ is noise, and 0: G begins at 1. One of a third of the powers is not.
    (spectrum.power, spectrum.unresolved) = (vec![0.0, 1.0, 0.5], -0.03);
    let noisy = AngularCorrelation::of_spectrum(&spectrum, &settings).expect("in range");
    assert_eq!(noisy.outcome, CorrelationOutcome::Found);
    assert!((noisy.anticorrelation - 0.5 / 1.5).abs() < 1e-15);
    spectrum.unresolved = -0.5;
    let negative = AngularCorrelation::of_spectrum(&spectrum, &settings).expect("in range");
    assert!(matches!(negative.outcome, CorrelationOutcome::OutOfRange { value, .. } if value > 1.4));
    // A bin with one pair, of two disks with 3 times the variance: (10 − 2.5)²/18.75.
    let angles = [0.0, 0.01, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let two = RingSample::new(&angles, &[10.0, 10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).expect("finite");
    let pairs = CorrelationSettings { estimator: CorrelationEstimator::Pairs { bin_count: 60 }, ..settings };
    let few = AngularCorrelation::of(&two, &pairs).expect("in range");
    assert!(
        matches!(few.outcome, CorrelationOutcome::OutOfRange { value, .. } if (value - 3.0).abs() < 1e-14),
        "{few:?}"
    );
    // Means are those of the samples that have one.
    let statistics = correlation_statistics(&[found.clone(), beyond]).expect("alike");
    assert_eq!((statistics.sample_count, statistics.left_out_count), (2, 1));
    assert_eq!(statistics.anticorrelation.value, found.anticorrelation);
}

#[test]
fn rings_of_a_field_are_cut_where_asked_on_the_backbone() {
    // Four disks to a unit of area on rings a quarter apart, R = 20; d_r a dipole outside of r = 10 and a quadrupole inside.
    let mut disks = Vec::new();
    for layer in 4..80 {
        let distance = 0.25 * f64::from(layer);
        for angle in even_angles((2.0 * std::f64::consts::PI * distance * 1.0).round() as usize) {
            let radial = if distance > 10.0 { angle.cos() } else { (2.0 * angle).cos() };
            let position = [distance * angle.cos(), distance * angle.sin()];
            disks.push(Moved { disk: disks.len(), position, distance, displacement: [0.0; 2], radial, counted: true });
            // A rattler beside it that must not count.
            disks.push(Moved {
                disk: disks.len(),
                position,
                distance,
                displacement: [0.0; 2],
                radial: 1e9,
                counted: false,
            });
        }
    }
    let field = DisplacementField {
        disks,
        inner_radius: 0.5,
        outer_radius: 20.0,
        shape: Shape::Round,
        measured_on: MeasuredOn::Backbone,
    };
    let found = radial_dependence(&field, &RadialDependenceSettings::default()).expect("settings in range");
    assert_eq!(found.len(), 9);
    for ring in &found {
        let expected = if ring.relative_radius > 0.55 { 1 } else { 2 };
        match &ring.outcome {
            // 0.5 ± 0.03 holds r from 9.4 to 10.6: both.
            RingOutcome::Measured { .. } if ring.relative_radius == 0.5 => {}
            RingOutcome::Measured { spectrum, correlation } => {
                let strongest =
                    (1..spectrum.power.len()).max_by(|&a, &b| spectrum.power[a].total_cmp(&spectrum.power[b]));
                assert_eq!(strongest, Some(expected), "r̂ = {}", ring.relative_radius);
                let sign = if expected == 1 { 1.0 } else { -1.0 };
                // Disks a layer are even, the layers are not: leakage of some per cent.
                assert!((correlation.anticorrelation - sign).abs() < 0.1, "{}", correlation.anticorrelation);
            }
            other => panic!("r̂ = {}: {other:?}", ring.relative_radius),
        }
    }
    let near = RadialDependenceSettings { relative_radii: vec![0.01], ..Default::default() };
    let found = radial_dependence(&field, &near).expect("settings in range");
    assert_eq!(found[0].outcome, RingOutcome::TooFewDisks { disk_count: 0 });
    for settings in [
        RingSettings { relative_radius: 0.0, half_width: 0.03 },
        RingSettings { relative_radius: 0.5, half_width: f64::NAN },
    ] {
        assert!(matches!(RingSample::of_field(&field, &settings), Err(AngularError::RingOutOfRange { .. })));
    }
}
