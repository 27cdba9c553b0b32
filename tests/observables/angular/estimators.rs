//! Estimators against fields that are known: what they err by is what is said of them.

use jamscope::observe::angular::synthetic::{SyntheticRing, SyntheticSettings, gaussian_rings};
use jamscope::observe::angular::{
    AngularCorrelation, CorrelationEstimator, CorrelationSettings, FrequencyLimit, Leakage, PowerSpectrum,
    SpectrumEstimator, SpectrumSettings, Weights,
};

use super::direct;

const RINGS: usize = 40;

fn rings() -> Vec<SyntheticRing> {
    let settings = SyntheticSettings { seed: 31, frequencies_per_disk: 8, ..SyntheticSettings::default() };
    gaussian_rings(&settings, RINGS, |f| f.powf(-1.5)).expect("enough disks")
}

/// Relative bias of the power in a band, and its standard error.
fn bias(rings: &[SyntheticRing], estimator: SpectrumEstimator, band: std::ops::RangeInclusive<usize>) -> [f64; 2] {
    let settings = SpectrumSettings { estimator, frequency_limit: FrequencyLimit::Fixed(125) };
    let sum = |power: &[f64]| band.clone().map(|f| power[f]).sum::<f64>();
    let real = rings.iter().map(|ring| sum(&ring.power)).sum::<f64>() / RINGS as f64;
    let found = |ring: &SyntheticRing| sum(&PowerSpectrum::of(&ring.ring, &settings).expect("in range").power);
    let errors: Vec<f64> = rings.iter().map(|ring| (found(ring) - sum(&ring.power)) / real).collect();
    let mean = errors.iter().sum::<f64>() / RINGS as f64;
    let square = errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>();
    [mean, (square / (RINGS * (RINGS - 1)) as f64).sqrt()]
}

#[test]
fn leakage_removed_leaves_a_few_per_cent_of_bias() {
    let rings = rings();
    // What lies above n/8 = 125 is taken for white, but leaks more to frequencies next to it: per cent, more at the end.
    for (band, most) in [(32..=62, 0.05), (63..=125, 0.1)] {
        let [value, error] = bias(&rings, direct(Weights::Gaps, Leakage::Removed), band);
        println!("removed: {value} ± {error}");
        assert!(value.abs() < most + 3.0 * error, "{value} ± {error}");
    }
    // The direct sum leaves S(f) + 2 Σ_(g ≠ f) S(g)/n: at f = 63 to 125 n/2-fold tails of 2.6/500 against f^(−1.5) = 1.1·10⁻³.
    let [equal, _] = bias(&rings, direct(Weights::Equal, Leakage::Kept), 63..=125);
    assert!((3.0..6.5).contains(&equal), "{equal}");
    for (estimator, range) in [
        (direct(Weights::Gaps, Leakage::Kept), 0.5..3.0),
        (SpectrumEstimator::Interpolated { points_per_disk: 4.0 }, -0.1..0.2),
        (SpectrumEstimator::Binned { bins_per_disk: 0.5 }, 0.02..0.3),
    ] {
        let [value, error] = bias(&rings, estimator, 63..=125);
        println!("{estimator:?}: {value} ± {error}");
        assert!(range.contains(&value), "{estimator:?}: {value} ± {error}");
    }
}

#[test]
fn the_default_correlation_is_nearer_to_the_truth_than_pairs() {
    let rings = rings();
    let error = |estimator: CorrelationEstimator| {
        let settings = CorrelationSettings { estimator, step_count: 30, ..Default::default() };
        let mut square = 0.0;
        for ring in &rings {
            let found = AngularCorrelation::of(&ring.ring, &settings).expect("in range");
            let total: f64 = ring.power.iter().sum();
            for (angle, value) in found.angles.iter().zip(&found.values).skip(1) {
                let truth: f64 = (0..).zip(&ring.power).map(|(f, p)| p * (f64::from(f) * angle).cos()).sum();
                square += (value - truth / total).powi(2);
            }
        }
        (square / (30 * RINGS) as f64).sqrt()
    };
    let default = error(CorrelationEstimator::default());
    let pairs = error(CorrelationEstimator::Pairs { bin_count: 30 });
    println!("default {default}, pairs {pairs}");
    assert!(default < 0.02 && pairs > 1.5 * default, "default {default}, pairs {pairs}");
}
