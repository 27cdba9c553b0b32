//! Means over samples, blocks of one ring, and the synthetic rings themselves.

use jamscope::observe::angular::synthetic::{AngleLayout, SyntheticSettings, gaussian_rings};
use jamscope::observe::angular::{
    AngularCorrelation, CorrelationEstimator, CorrelationSettings, FrequencyLimit, PowerSpectrum, SpectrumSettings,
    block_errors, correlation_statistics, spectrum_statistics,
};

use super::{even_angles, ring};

#[test]
fn synthetic_rings_have_the_power_they_say() {
    // Even angles and all frequencies below n/2: nothing leaks, nothing is folded.
    let settings =
        SyntheticSettings { disk_count: 64, layout: AngleLayout::Even, frequencies_per_disk: 1, ..Default::default() };
    let power = |f: f64| if f < 32.0 { 1.0 / f } else { 0.0 };
    let rings = gaussian_rings(&settings, 401, power).expect("enough disks");
    assert_eq!(rings.len(), 401);
    let mut mean = vec![0.0; 32];
    for synthetic in &rings {
        let limit = SpectrumSettings { frequency_limit: FrequencyLimit::Fixed(31), ..Default::default() };
        let found = PowerSpectrum::of(&synthetic.ring, &limit).expect("in range");
        for f in 1..32 {
            assert!((found.power[f] - synthetic.power[f]).abs() < 1e-13, "f = {f}");
            mean[f] += synthetic.power[f] / 401.0;
        }
    }
    for f in 1..32 {
        // 401 exponential variates; the largest of 31 deviates by less than four standard errors.
        assert!((mean[f] * f as f64 - 1.0).abs() < 4.0 / 401f64.sqrt(), "f = {f}: {}", mean[f]);
    }
    // Both parts of one transform are independent.
    let product = |f: usize| -> f64 {
        rings
            .chunks_exact(2)
            .map(|pair| (pair[0].power[f] * f as f64 - 1.0) * (pair[1].power[f] * f as f64 - 1.0))
            .sum::<f64>()
            / 200.0
    };
    assert!((1..32).map(product).sum::<f64>().abs() < 4.0 * (31.0f64 / 200.0).sqrt());
}

#[test]
fn means_over_samples_are_those_of_their_numbers() {
    let rings = [1.0, 2.0].map(|f| ring(&even_angles(64), |angle| 3.0 * (f * angle).cos() + (3.0 * angle).cos()));
    let settings = CorrelationSettings { thresholds: vec![0.1, -0.99], ..Default::default() };
    let samples = rings.each_ref().map(|ring| AngularCorrelation::of(ring, &settings).expect("in range"));
    let found = correlation_statistics(&samples).expect("alike");
    let [a, b] = samples.each_ref().map(|sample| sample.anticorrelation);
    assert!((a - 1.0).abs() < 1e-13 && (b + 0.8).abs() < 1e-13);
    assert!((found.anticorrelation.value - 0.1).abs() < 1e-13);
    assert!((found.anticorrelation.standard_error.expect("two") - 0.9).abs() < 1e-13);
    let angles = samples.each_ref().map(|sample| sample.crossing(0.1).expect("both cross"));
    let crossing = &found.crossings[0];
    assert!((crossing.angle.expect("both").value - 0.5 * (angles[0] + angles[1])).abs() < 1e-15);
    assert!((crossing.quartiles.expect("both")[1] - 0.5 * (angles[0] + angles[1])).abs() < 1e-15);
    assert_eq!((crossing.never_count, found.crossings[1].never_count), (0, 1));
    let spectra = rings.each_ref().map(|ring| PowerSpectrum::of(ring, &SpectrumSettings::default()).expect("in range"));
    let found = spectrum_statistics(&spectra).expect("alike");
    // Shares 0.9 and 0.1: S = 1 at f = 1 and f = 2, 2/9 at f = 3.
    assert!((found.spectrum[2].value - 1.0).abs() < 1e-13 && (found.spectrum[3].value - 2.0 / 9.0).abs() < 1e-13);
}

/// The jackknife's error of G over the true scatter between rings, at a short angle and at the last bin.
fn jackknife_over_scatter(spectrum: impl Fn(f64) -> f64, noise: f64) -> [f64; 2] {
    const RINGS: usize = 100;
    let settings =
        SyntheticSettings { disk_count: 400, noise, seed: 21, frequencies_per_disk: 4, ..Default::default() };
    let rings = gaussian_rings(&settings, RINGS, spectrum).expect("enough disks");
    let errors: Vec<_> = rings.iter().map(|ring| block_errors(&ring.ring, 18, 20).expect("in range")).collect();
    let estimator = CorrelationEstimator::Pairs { bin_count: 18 };
    let pairs = AngularCorrelation::of(&rings[0].ring, &CorrelationSettings { estimator, ..Default::default() });
    assert_eq!(errors[0].values, pairs.expect("in range").values[1..]);
    [1, 17].map(|bin| {
        let mean = errors.iter().map(|e| e.values[bin]).sum::<f64>() / RINGS as f64;
        let scatter = errors.iter().map(|e| (e.values[bin] - mean).powi(2)).sum::<f64>() / (RINGS as f64 - 1.0);
        let claimed = errors.iter().map(|e| e.standard_errors[bin].powi(2)).sum::<f64>() / RINGS as f64;
        (claimed / scatter).sqrt()
    })
}

#[test]
fn blocks_of_a_ring_tell_the_error_of_short_correlations_only() {
    // Without correlation: pairs of blocks are left out twice, so that the jackknife may claim up to √2 of the scatter, which
    // itself is known to 1/√(2·99) = 7 %.
    let white = jackknife_over_scatter(|_| 0.0, 1.0);
    assert!(white.iter().all(|ratio| (0.85..1.65).contains(ratio)), "{white:?}");
    // Scale-free: the amplitude of f = 1 is one number a ring, and blocks do not show its scatter.
    let scale_free = jackknife_over_scatter(|f| f.powf(-1.5), 0.0);
    println!("white {white:?}, scale-free {scale_free:?}");
    assert!(scale_free[1] < 0.8, "{scale_free:?}");
}
