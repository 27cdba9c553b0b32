//! The expected power at irregular angles, and its removal, both exact averages over phases.

use std::f64::consts::{FRAC_PI_2, SQRT_2};

use jamscope::observe::angular::{
    FrequencyLimit, Leakage, PowerSpectrum, RingSample, SpectralWindow, SpectrumSettings, Weights, dependence,
    fourier_sums,
};

use super::{direct, random_angles, ring};

const DISKS: usize = 40;
const LIMIT: usize = 9;

fn spectrum(ring: &RingSample, weights: Weights, leakage: Leakage) -> PowerSpectrum {
    let estimator = direct(weights, leakage);
    PowerSpectrum::of(ring, &SpectrumSettings { estimator, frequency_limit: FrequencyLimit::Fixed(LIMIT) })
        .expect("in range")
}

/// Power and unresolved variance of a mode of unit variance, averaged over its phase: P is a constant and a cosine of twice the
/// phase, so two phases a quarter turn apart give the mean.
fn of_mode(angles: &[f64], frequency: usize, weights: Weights, leakage: Leakage) -> (Vec<f64>, f64) {
    let parts = [0.3, 0.3 + FRAC_PI_2].map(|phase| {
        spectrum(&ring(angles, |angle| SQRT_2 * (frequency as f64 * angle + phase).cos()), weights, leakage)
    });
    let power = (1..=LIMIT).map(|f| 0.5 * (parts[0].power[f] + parts[1].power[f])).collect();
    (power, 0.5 * (parts[0].unresolved + parts[1].unresolved))
}

/// The same of independent values of unit variance: the sum over disks of what each leaves alone.
fn of_noise(angles: &[f64], weights: Weights, leakage: Leakage) -> (Vec<f64>, f64) {
    let mut total = (vec![0.0; LIMIT], 0.0);
    for disk in 0..angles.len() {
        let mut values = vec![0.0; angles.len()];
        values[disk] = 1.0;
        let found = spectrum(&RingSample::new(angles, &values).expect("finite"), weights, leakage);
        total.0.iter_mut().zip(&found.power[1..]).for_each(|(sum, power)| *sum += power);
        total.1 += found.unresolved;
    }
    total
}

#[test]
fn expected_power_is_the_mean_over_phases() {
    let angles = random_angles(DISKS, 5);
    for weights in [Weights::Equal, Weights::Gaps] {
        let window = SpectralWindow::new(&ring(&angles, |_| 0.0), weights, LIMIT, 11);
        // LIMIT + LIMIT/4 = 11 sources stand for themselves.
        for mode in 1..=11 {
            let expected = window.expected(|g| if g == mode as f64 { 1.0 } else { 0.0 }, 11);
            for (found, expected) in of_mode(&angles, mode, weights, Leakage::Kept).0.iter().zip(expected) {
                // Sums of 40 numbers of size 1/40, squared.
                assert!((found - expected).abs() < 1e-13, "{weights:?} g = {mode}: {found} for {expected}");
            }
        }
        for (found, expected) in of_noise(&angles, weights, Leakage::Kept).0.iter().zip(window.white()) {
            assert!((found - expected).abs() < 1e-13, "{weights:?} noise: {found} for {expected}");
        }
    }
}

#[test]
fn removing_leakage_leaves_every_mode_where_it_was() {
    let angles = random_angles(DISKS, 6);
    for weights in [Weights::Equal, Weights::Gaps] {
        // The equations of 40 random angles and 9 frequencies have a condition below 100.
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        for mode in 1..=LIMIT {
            let (power, unresolved) = of_mode(&angles, mode, weights, Leakage::Removed);
            for (f, power) in (1..).zip(power) {
                assert!(near(power, if f == mode { 1.0 } else { 0.0 }), "{weights:?} {mode} at {f}: {power}");
            }
            assert!(near(unresolved, 0.0), "{weights:?} {mode}: {unresolved}");
        }
        let (power, unresolved) = of_noise(&angles, weights, Leakage::Removed);
        assert!(power.iter().all(|&power| near(power, 0.0)), "{weights:?}: {power:?}");
        assert!(near(unresolved, 1.0), "{weights:?}: {unresolved}");
    }
}

#[test]
fn even_angles_do_not_leak() {
    let window = SpectralWindow::new(&ring(&super::even_angles(40), |_| 0.0), Weights::Gaps, LIMIT, 19);
    for (f, power) in (1..).zip(window.expected(|g| if g == 4.0 { 1.0 } else { 0.0 }, 19)) {
        assert!((power - if f == 4 { 1.0 } else { 0.0 }).abs() < 1e-14, "f = {f}: {power}");
    }
    // 2/n of the variance at every f.
    assert!(window.white().iter().all(|white| (white - 0.05).abs() < 1e-15));
}

#[test]
fn bands_of_sources_stand_for_their_frequencies() {
    // Against every source one by one: the spectrum changes by 3 % over a band, what is left is its curvature, 1e-4, and the
    // scatter of K within a band times half the change.
    let angles = random_angles(200, 7);
    let ring = ring(&angles, |_| 0.0);
    let power = |g: f64| g.powf(-1.5);
    let banded = SpectralWindow::new(&ring, Weights::Gaps, 20, 400).expected(power, 400);
    // A limit of 320 keeps every source up to 400 by itself.
    let single = SpectralWindow::new(&ring, Weights::Gaps, 320, 400).expected(power, 400);
    for (f, (banded, single)) in (1..).zip(banded.iter().zip(&single)) {
        assert!((banded / single - 1.0).abs() < 1e-3, "f = {f}: {banded} for {single}");
    }
}

/// D by real parts: the sums u + iv of fields that are added up with independent normal amplitudes,
/// cov(P_f, P_f') = 8 Σ cov², over the four pairs of u, v with u', v'.
fn dependence_by_real_parts(angles: &[f64], fields: &[Vec<f64>]) -> f64 {
    let ring = ring(angles, |_| 0.0);
    let weights = ring.weights(Weights::Gaps);
    let sums: Vec<Vec<[f64; 2]>> = fields
        .iter()
        .map(|field| {
            let mean: f64 = weights.iter().zip(field).map(|(w, x)| w * x).sum();
            let strengths: Vec<f64> = weights.iter().zip(field).map(|(w, x)| w * (x - mean)).collect();
            fourier_sums(ring.angles(), &strengths, LIMIT)[1..].iter().map(|sum| [sum.re, sum.im]).collect()
        })
        .collect();
    let covariance =
        |f: usize, a: usize, other: usize, b: usize| -> f64 { sums.iter().map(|sum| sum[f][a] * sum[other][b]).sum() };
    let mean = |f: usize| 2.0 * (covariance(f, 0, f, 0) + covariance(f, 1, f, 1));
    let mut total = 0.0;
    for f in 0..LIMIT {
        for other in 0..LIMIT {
            let squares = (0..4).map(|pair| covariance(f, pair / 2, other, pair % 2).powi(2)).sum::<f64>();
            total += 8.0 * squares / (mean(f) * mean(other));
        }
    }
    total / LIMIT as f64
}

#[test]
fn powers_depend_on_each_other_as_the_covariances_of_their_sums_say() {
    let mut angles = random_angles(DISKS, 9);
    angles.sort_by(f64::total_cmp);
    let ring = ring(&angles, |_| 0.0);
    // A cosine and a sine for every frequency; sums of 160 fields, then squares: 10⁻¹³.
    let wave = |g: usize, phase: f64| -> Vec<f64> {
        angles.iter().map(|angle| (g as f64).powf(-0.75) * (g as f64 * angle + phase).cos()).collect()
    };
    let fields: Vec<Vec<f64>> = (1..=80).flat_map(|g| [wave(g, 0.0), wave(g, FRAC_PI_2)]).collect();
    let expected = dependence_by_real_parts(&angles, &fields);
    let found = dependence(&ring, Weights::Gaps, LIMIT, |g| g.powf(-1.5), 80);
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} for {expected}");
    assert!(found > 1.05, "angles anywhere: {found}");
    // Beyond twice the disks a frequency counts as values of single disks.
    let single = |disk: usize| (0..DISKS).map(|other| if other == disk { 1.0 } else { 0.0 }).collect();
    let expected = dependence_by_real_parts(&angles, &(0..DISKS).map(single).collect::<Vec<_>>());
    let found = dependence(&ring, Weights::Gaps, LIMIT, |g| if g > 80.0 { 1.0 } else { 0.0 }, 81);
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} for {expected}");
    // Even angles and nothing that folds back: independent.
    let even = super::ring(&super::even_angles(40), |_| 0.0);
    let found = dependence(&even, Weights::Gaps, LIMIT, |g| g.powf(-1.5), 19);
    assert!((found - 1.0).abs() < 1e-13, "{found}");
}
