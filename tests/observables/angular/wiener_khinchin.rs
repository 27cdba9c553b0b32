//! G and S of one estimator as a Fourier pair.

use std::f64::consts::PI;

use jamscope::observe::angular::{
    AngularCorrelation, CorrelationEstimator, CorrelationOutcome, CorrelationSettings, FrequencyLimit, Leakage,
    PowerSpectrum, RingSample, SpectrumEstimator, SpectrumSettings, Weights,
};
use jamscope::vector::larger;
use proptest::prelude::*;

use super::{all_estimators, direct, even_angles};
use crate::seeds::config;

/// (2/π) ∫_0^π G cos fθ dθ by the trapezoidal rule, exact for G of fewer frequencies than steps.
fn cosine_coefficient(angles: &[f64], values: &[f64], frequency: usize) -> f64 {
    let steps = angles.len() - 1;
    let term = |j: usize| {
        let weight = if j == 0 || j == steps { 0.5 } else { 1.0 };
        weight * values[j] * (frequency as f64 * angles[j]).cos()
    };
    2.0 / steps as f64 * (0..=steps).map(term).sum::<f64>()
}

fn rings() -> impl Strategy<Value = RingSample> {
    prop::collection::vec((-PI..PI, -1.0..1.0f64), 16..120).prop_filter_map("distinct values", |disks| {
        let (angles, values): (Vec<f64>, Vec<f64>) = disks.into_iter().unzip();
        RingSample::new(&angles, &values).ok()
    })
}

proptest! {
    #![proptest_config(config(64, 20))]

    #[test]
    fn spectral_correlation_and_spectrum_are_a_pair(ring in rings()) {
        for estimator in all_estimators() {
            let settings = SpectrumSettings { estimator, frequency_limit: FrequencyLimit::PerDisk(0.125) };
            let spectrum = PowerSpectrum::of(&ring, &settings).expect("in range");
            let settings = CorrelationSettings { estimator: CorrelationEstimator::Spectral(settings), ..Default::default() };
            let found = AngularCorrelation::of(&ring, &settings).expect("in range");
            let resolved: f64 = spectrum.power[1..].iter().sum();
            // A slightly negative one is noise, and counts as 0.
            let noise = spectrum.unresolved < 0.0 && -spectrum.unresolved <= 0.05 * resolved;
            let unresolved = if noise { 0.0 } else { spectrum.unresolved };
            let total = resolved + unresolved;
            prop_assume!(total > 0.0);
            // Unmixing may leave large powers of both signs: all is relative to the largest.
            let scale = spectrum.power[1..].iter().fold(1.0, |a: f64, p| a.max(p.abs() / total));
            let steps = (found.angles.len() - 1) as f64;
            if let CorrelationOutcome::OutOfRange { angle, value } = found.outcome {
                let sum: f64 = spectrum.power.iter().enumerate().skip(1).map(|(f, p)| p * (f as f64 * angle).cos()).sum();
                prop_assert!(value.abs() > 1.0 && (value - sum / total).abs() < 1e-12 * scale, "{estimator:?}: {value}");
                prop_assert!(found.anticorrelation.is_nan() && found.values.iter().all(|value| value.is_nan()));
                continue;
            }
            for (f, power) in spectrum.power.iter().enumerate().skip(1) {
                // The peak at θ = 0 is spread over all frequencies: 1/steps of it each.
                let peak = unresolved / total / steps;
                let coefficient = cosine_coefficient(&found.angles, &found.values, f) - peak;
                // 361 terms, phases up to 15π.
                prop_assert!((coefficient - power / total).abs() < 1e-12 * scale, "{estimator:?} f = {f}");
            }
        }
    }
}

#[test]
fn bins_have_the_correlation_of_their_means() {
    // A bin a disk: the circular autocorrelation of the values themselves, at every difference.
    const DISKS: usize = 48;
    let values: Vec<f64> = (0..DISKS).map(|k| ((k * k) % 17) as f64).collect();
    let ring = RingSample::new(&even_angles(DISKS), &values).expect("finite");
    let settings = SpectrumSettings {
        estimator: SpectrumEstimator::Binned { bins_per_disk: 1.0 },
        frequency_limit: FrequencyLimit::Fixed(DISKS / 2),
    };
    let estimator = CorrelationEstimator::Spectral(settings);
    let settings = CorrelationSettings { estimator, step_count: DISKS / 2, ..Default::default() };
    let found = AngularCorrelation::of(&ring, &settings).expect("in range");
    // Angles beyond π are folded: the order of the sorted ring does not matter to a circular autocorrelation.
    let mean = values.iter().sum::<f64>() / DISKS as f64;
    let product =
        |lag: usize| -> f64 { (0..DISKS).map(|k| (values[k] - mean) * (values[(k + lag) % DISKS] - mean)).sum() };
    for (lag, value) in found.values.iter().enumerate() {
        assert!((value - product(lag) / product(0)).abs() < 1e-13, "lag {lag}: {value}");
    }
}

#[test]
fn pairs_violate_it_by_a_measured_size() {
    // One ring of 1000 disks at random angles, S ∝ f^(−1.5): the coefficients of the pairs' G against the direct spectrum with
    // equal weights over the variance, which has the same pairs, and the disks with themselves, 2/n, on top.
    let settings = jamscope::observe::angular::synthetic::SyntheticSettings { seed: 3, ..Default::default() };
    let ring = jamscope::observe::angular::synthetic::gaussian_rings(&settings, 1, |f| f.powf(-1.5))
        .expect("enough disks")
        .remove(0)
        .ring;
    let spectrum = SpectrumSettings {
        estimator: direct(Weights::Equal, Leakage::Kept),
        frequency_limit: FrequencyLimit::Fixed(20),
    };
    let spectrum = PowerSpectrum::of(&ring, &spectrum).expect("in range");
    let estimator = CorrelationEstimator::Pairs { bin_count: 180 };
    let found = AngularCorrelation::of(&ring, &CorrelationSettings { estimator, ..Default::default() }).expect("ok");
    let (middles, values) = (&found.angles[1..], &found.values[1..]);
    let coefficient = |f: usize| -> f64 {
        2.0 / 180.0 * middles.iter().zip(values).map(|(angle, value)| value * (f as f64 * angle).cos()).sum::<f64>()
    };
    let violation = (1..=20)
        .map(|f| (coefficient(f) - (spectrum.power[f] / spectrum.variance - 2.0 / 1000.0)).abs())
        .fold(0.0, larger);
    println!("largest violation {violation}");
    assert!(violation > 1e-3 && violation < 0.1, "{violation}");
}
