//! The choice of the samples that are compared, and a summary of the comparisons.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use serde::Serialize;

use crate::protocol::sensitivity::ProtocolSensitivity;
use crate::protocol::spread::Spread;
use crate::vector::larger;

/// Chooses samples for the comparison by name and seed. Their number is `fraction` times the number of samples,
/// rounded, at least one.
///
/// The choice is random but depends only on names and seeds, not on the order or on threads. A larger fraction contains
/// all samples of a smaller one.
pub fn chosen(samples: &[(&str, u64)], fraction: f64) -> Vec<bool> {
    let count = ((fraction * samples.len() as f64).round() as usize).clamp(1, samples.len().max(1));
    let keys: Vec<(u64, &str)> = samples.iter().map(|&(name, seed)| (random_key(name, seed), name)).collect();
    keys.iter().map(|key| keys.iter().filter(|other| *other < key).count() < count).collect()
}

/// Random key of a sample. Source of the hash of the name: FNV-1a, 64 bits.
fn random_key(name: &str, seed: u64) -> u64 {
    let hash = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    let name = name.bytes().fold(0xcbf2_9ce4_8422_2325, hash);
    Pcg64::seed_from_u64(seed ^ name).next_u64()
}

/// Summary of the comparisons of an ensemble.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ProtocolSummary {
    /// Number of samples of the scene.
    pub sample_count: usize,
    /// Number of samples compared.
    pub compared_count: usize,
    /// Number of compared samples with more than one minimum.
    pub several_minima_count: usize,
    /// Mean number of minima of a sample.
    pub mean_minimum_count: f64,
    /// Largest distance of all \[length\].
    pub largest_distance: f64,
    /// Root mean square over the samples of the standard deviation of Δp \[force / length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_change: Option<f64>,
    /// Root mean square of the standard deviation of G* \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anticorrelation: Option<f64>,
    /// Root mean square of the standard deviation of θ* \[rad\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlation_angle: Option<f64>,
    /// Root mean square of the standard deviation of the number of contacts made and broken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_change_count: Option<f64>,
    /// Root mean square of the standard deviation of d_0^eff of the elastic solution \[length\].
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elastic_amplitude: Option<f64>,
    /// Root mean square of the standard deviation of d_0^eff of the screened solution \[length\].
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub screened_amplitude: Option<f64>,
    /// Root mean square of the standard deviation of κ \[1/length\].
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wavenumber: Option<f64>,
}

impl ProtocolSummary {
    /// The summary of these comparisons, of a scene with `sample_count` samples; none without comparisons.
    pub fn of(sample_count: usize, compared: &[&ProtocolSensitivity]) -> Option<Self> {
        if compared.is_empty() {
            return None;
        }
        let rms = |spread: &dyn Fn(&ProtocolSensitivity) -> Option<Spread>| {
            // A single ending has no spread.
            let spreads = compared.iter().filter_map(|it| spread(it)).filter(|spread| spread.count > 1);
            Spread::of(spreads.map(|spread| spread.standard_deviation.powi(2))).map(|squares| squares.mean.sqrt())
        };
        let minima: usize = compared.iter().map(|it| it.minimum_count).sum();
        Some(ProtocolSummary {
            sample_count,
            compared_count: compared.len(),
            several_minima_count: compared.iter().filter(|it| it.minimum_count > 1).count(),
            mean_minimum_count: minima as f64 / compared.len() as f64,
            largest_distance: compared.iter().map(|it| it.largest_distance).fold(0.0, larger),
            pressure_change: rms(&|it| it.spreads.pressure_change),
            anticorrelation: rms(&|it| it.spreads.anticorrelation),
            correlation_angle: rms(&|it| it.spreads.correlation_angle),
            contact_change_count: rms(&|it| it.spreads.contact_change_count),
            #[cfg(feature = "fit")]
            elastic_amplitude: rms(&|it| it.spreads.elastic_amplitude),
            #[cfg(feature = "fit")]
            screened_amplitude: rms(&|it| it.spreads.screened_amplitude),
            #[cfg(feature = "fit")]
            wavenumber: rms(&|it| it.spreads.wavenumber),
        })
    }
}
