//! A dipole and white noise.

use std::f64::consts::PI;

use jamscope::observe::angular::synthetic::{AngleLayout, SyntheticSettings, gaussian_rings};
use jamscope::observe::angular::{
    AngularCorrelation, CorrelationEstimator, CorrelationSettings, CrossingOutcome, FrequencyLimit, Leakage,
    PowerSpectrum, SpectrumSettings, Weights, correlation_statistics, fourier_sums, spectrum_statistics,
};

use super::{all_estimators, direct, even_angles, random_angles, ring};

#[test]
fn a_dipole_at_even_angles_is_exact_in_every_spectral_estimator() {
    let dipole = ring(&even_angles(64), |angle| 0.3 + 0.02 * (angle - 0.7).cos());
    for estimator in all_estimators() {
        let settings = CorrelationSettings {
            estimator: CorrelationEstimator::Spectral(SpectrumSettings {
                estimator,
                frequency_limit: FrequencyLimit::Fixed(8),
            }),
            ..CorrelationSettings::default()
        };
        let found = AngularCorrelation::of(&dipole, &settings).expect("in range");
        for (angle, value) in found.angles.iter().zip(&found.values) {
            // Rounding of the values, 0.3·2⁻⁵³, against an amplitude of 0.02, squared over 8 frequencies.
            assert!((value - angle.cos()).abs() < 1e-13, "{estimator:?} θ = {angle}: {value}");
        }
        assert!((found.anticorrelation - 1.0).abs() < 1e-13);
        for crossing in &found.crossings {
            let expected = crossing.threshold.acos();
            let CrossingOutcome::At { angle } = crossing.outcome else { panic!("{crossing:?}") };
            assert!((angle - expected).abs() < 1e-13, "{estimator:?}: {angle} for {expected}");
        }
        assert_eq!(found.crossing(0.1), found.crossings[0].outcome.angle());
    }
}

#[test]
fn a_dipole_at_irregular_angles_is_off_by_the_window_alone() {
    let angles = random_angles(1000, 8);
    let dipole = ring(&angles, |angle| (angle - 0.7).cos());
    for weights in [Weights::Equal, Weights::Gaps] {
        let settings = CorrelationSettings {
            estimator: CorrelationEstimator::Spectral(SpectrumSettings {
                estimator: direct(weights, Leakage::Kept),
                frequency_limit: FrequencyLimit::Fixed(8),
            }),
            ..CorrelationSettings::default()
        };
        let found = AngularCorrelation::of(&dipole, &settings).expect("in range");
        // |c_f| ≤ (|W(f−1) − W(f) W̄(1)| + |W(f+1) − W(f) W(1)|)/2; |c_1| is at least 1/2 less as much of its second term.
        let window = fourier_sums(dipole.angles(), &dipole.weights(weights), 9);
        let w = |h: usize| window[h].conj();
        let part = |f: usize| (w(f - 1) - w(f) * w(1).conj()).norm() + (w(f + 1) - w(f) * w(1)).norm();
        let others: f64 = (2..=8).map(|f| 0.5 * part(f).powi(2)).sum();
        let own = 0.5 * (1.0 - w(1).norm_sqr() - (w(2) - w(1) * w(1)).norm()).powi(2);
        // G − cos θ = Σ_(f>1) P_f (cos fθ − cos θ)/Σ P.
        let bound = 2.0 * others / own;
        assert!(bound < 0.1, "the bound says something: {bound}");
        for (angle, value) in found.angles.iter().zip(&found.values) {
            assert!((value - angle.cos()).abs() < bound, "{weights:?} θ = {angle}: {value}, bound {bound}");
        }
        let angle = found.crossing(0.1).expect("a dipole crosses");
        assert!((angle - 0.1f64.acos()).abs() < 1.1 * bound);
    }
}

#[test]
fn pairs_of_a_dipole_are_the_cosine_within_a_bin() {
    const BINS: usize = 90;
    let dipole = ring(&even_angles(721), |angle| (angle - 0.7).cos());
    let estimator = CorrelationEstimator::Pairs { bin_count: BINS };
    let found = AngularCorrelation::of(&dipole, &CorrelationSettings { estimator, ..Default::default() }).expect("ok");
    for (angle, value) in found.angles.iter().zip(&found.values).skip(1) {
        // About four differences a bin, none on an edge (180 and 721 share no factor), so none further than half a bin.
        assert!((value - angle.cos()).abs() < 0.5 * PI / BINS as f64, "θ = {angle}: {value}");
    }
    // The last bin: 1 − ⟨θ²⟩/2 over half a bin's angles next to π.
    assert!((found.anticorrelation - 1.0).abs() < 0.5 * (PI / BINS as f64).powi(2));
}

#[test]
fn white_noise_has_no_correlation_and_a_flat_spectrum() {
    const RINGS: usize = 200;
    for layout in [AngleLayout::Random, AngleLayout::Jittered(0.8)] {
        let settings = SyntheticSettings { disk_count: 400, layout, noise: 0.1, seed: 9, ..Default::default() };
        let rings = gaussian_rings(&settings, RINGS, |_| 0.0).expect("enough disks");
        let correlations: Vec<AngularCorrelation> = rings
            .iter()
            .map(|ring| AngularCorrelation::of(&ring.ring, &CorrelationSettings::default()).expect("in range"))
            .collect();
        let statistics = correlation_statistics(&correlations).expect("alike");
        let error = statistics.anticorrelation.standard_error.expect("200 samples");
        // Three standard errors: 0.3 % of seeds fall out.
        assert!(statistics.anticorrelation.value.abs() < 3.0 * error, "{:?}", statistics.anticorrelation);
        assert!(error < 0.01);
        for leakage in [Leakage::Kept, Leakage::Removed] {
            let estimator = direct(Weights::Equal, leakage);
            let settings = SpectrumSettings { estimator, frequency_limit: FrequencyLimit::Fixed(50) };
            let spectra: Vec<PowerSpectrum> =
                rings.iter().map(|ring| PowerSpectrum::of(&ring.ring, &settings).expect("in range")).collect();
            let mean = |f: usize| spectra.iter().map(|s| s.power[f] / s.variance).sum::<f64>() / RINGS as f64;
            // An exponential variate of mean 2/400, 200 of them; the largest of 50 deviates by less than four errors.
            let expected = if leakage == Leakage::Kept { 2.0 / 400.0 } else { 0.0 };
            let error = 2.0 / 400.0 / (RINGS as f64).sqrt();
            for f in 1..=50 {
                assert!((mean(f) - expected).abs() < 4.0 * error, "{layout:?} {leakage:?} f = {f}: {}", mean(f));
            }
            let low = (1..=25).map(mean).sum::<f64>() - (26..=50).map(mean).sum::<f64>();
            assert!(low.abs() < 3.0 * error * 50f64.sqrt(), "{layout:?} {leakage:?}: a slope of {low}");
            if leakage == Leakage::Kept {
                let spectrum = spectrum_statistics(&spectra).expect("alike").spectrum;
                assert!(spectrum[1].value == 1.0 && (spectrum[30].value - 1.0).abs() < 6.0 / (RINGS as f64).sqrt());
            } else {
                let unresolved = spectra.iter().map(|s| s.unresolved / s.variance).sum::<f64>() / RINGS as f64;
                assert!((unresolved - 1.0).abs() < 3.0 * error * 50f64.sqrt(), "{unresolved}");
            }
        }
    }
}
