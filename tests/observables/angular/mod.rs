//! Angular spectra and correlation functions against what is exactly known of them.

mod direct_sums;
mod estimators;
mod exact;
#[cfg(feature = "fit")]
mod fits;
mod fourier;
mod invariance;
mod outcomes;
mod samples;
mod wiener_khinchin;
mod window;

use std::f64::consts::PI;

use jamscope::observe::angular::{Leakage, RingSample, SpectrumEstimator, Weights};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Angles anywhere, by the seed.
fn random_angles(count: usize, seed: u64) -> Vec<f64> {
    let mut random = Pcg64::seed_from_u64(seed);
    (0..count).map(|_| PI * (2.0 * random.random::<f64>() - 1.0)).collect()
}

fn even_angles(count: usize) -> Vec<f64> {
    (0..count).map(|k| 2.0 * PI * k as f64 / count as f64).collect()
}

/// The values of a function at angles.
fn ring(angles: &[f64], value: impl Fn(f64) -> f64) -> RingSample {
    let values: Vec<f64> = angles.iter().map(|&angle| value(angle)).collect();
    RingSample::new(angles, &values).expect("finite angles and values")
}

fn direct(weights: Weights, leakage: Leakage) -> SpectrumEstimator {
    SpectrumEstimator::Direct { weights, leakage }
}

/// Every estimator of the spectrum.
fn all_estimators() -> [SpectrumEstimator; 6] {
    [
        direct(Weights::Equal, Leakage::Kept),
        direct(Weights::Equal, Leakage::Removed),
        direct(Weights::Gaps, Leakage::Kept),
        direct(Weights::Gaps, Leakage::Removed),
        SpectrumEstimator::Interpolated { points_per_disk: 4.0 },
        SpectrumEstimator::Binned { bins_per_disk: 1.0 },
    ]
}
