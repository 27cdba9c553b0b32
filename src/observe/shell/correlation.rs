//! [`ShellCorrelation`]: G(γ) of the radial displacement in a shell, G* and γ*.
//!
//! ```text
//! G(γ) = ⟨δ_i δ_j⟩/⟨δ²⟩ over pairs at the great-circle angle γ, δ = d_r − ⟨d_r⟩        G(0) = 1        G* = −G(π)
//! ```
//!
//! From all pairs, in equal bins of γ. Few pairs are near γ = π: their number falls as sin γ. G is a function of cos γ
//! and so even about π. G* therefore comes from a straight line in 1 + cos γ over a cap of 20°, three per cent of the
//! pairs, and not from the last bin. A correlation lies in \[−1, 1\]; an estimate from few pairs may not.
//!
//! # Errors of one shell
//! A jackknife over twelve blocks of directions, σ² = (B − 1)/B Σ_b (G_(−b) − Ḡ)². G_(−b) leaves out all pairs with a
//! sphere in block b. It measures the scatter between parts of the shell, not that of the amplitudes of ℓ = 1, 2, …, of
//! which one shell has one set. So errors of long correlations and of G* come from samples.
//! Source: Künsch (1989), Ann. Stat. 17, 1217 (the jackknife of blocks).

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::observe::angular::CrossingOutcome;
use crate::observe::shell::error::ShellError;
use crate::observe::shell::limits::{MOST_BINS, MOST_PAIRED, at_most};
use crate::observe::shell::pairs::{AllPairs, middles};
use crate::observe::shell::sample::ShellSample;

/// How a correlation function is computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ShellCorrelationSettings {
    /// Number of equal bins of \[0, π\].
    pub bin_count: usize,
    /// Thresholds of G, each below 1 \[1\].
    pub thresholds: Vec<f64>,
    /// Angle of the cap around γ = π from which G* is read \[rad\].
    pub cap: f64,
}

impl Default for ShellCorrelationSettings {
    /// Bins of 5°; the thresholds of the study, its usual one first; a cap of 20°.
    fn default() -> Self {
        ShellCorrelationSettings { bin_count: 36, thresholds: vec![0.1, 0.02, 0.05, 0.2], cap: PI / 9.0 }
    }
}

impl ShellCorrelationSettings {
    /// Checks the settings, independently of a shell.
    pub(crate) fn check(&self) -> Result<(), ShellError> {
        if self.bin_count == 0 {
            return Err(ShellError::NotPositive { setting: "bins", value: 0.0 });
        }
        at_most(MOST_BINS).check("bin_count", self.bin_count, 256.0)?;
        if !(self.cap > 0.0 && self.cap.is_finite()) {
            return Err(ShellError::NotPositive { setting: "cap", value: self.cap });
        }
        match self.thresholds.iter().find(|&&threshold| threshold.is_nan() || threshold >= 1.0) {
            Some(&threshold) => Err(ShellError::ThresholdNotBelowOne { threshold }),
            None => Ok(()),
        }
    }
}

/// G(γ), normalised to G(0) = 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShellCorrelation {
    /// Number of spheres.
    pub disk_count: usize,
    /// γ \[rad\]: 0, then the mean angle of a uniform distribution in every bin.
    pub angles: Vec<f64>,
    /// G(γ) \[1\]; a bin without pairs has the value of the bin before it.
    pub values: Vec<f64>,
    /// Standard errors of G by the jackknife \[1\]; 0 at γ = 0.
    pub standard_errors: Vec<f64>,
    /// Number of pairs in every bin; 0 at γ = 0, where G is 1 by definition.
    pub pair_counts: Vec<usize>,
    /// G*, absent without pairs in the cap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anticorrelation: Option<Anticorrelation>,
    /// γ* at every threshold.
    pub crossings: Vec<ShellCrossing>,
}

/// G* = −G(π).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Anticorrelation {
    /// G* \[1\].
    pub value: f64,
    /// Its standard error by the jackknife; absent if a block holds all pairs of the cap \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standard_error: Option<f64>,
    /// Number of pairs in the cap.
    pub pair_count: usize,
}

/// A threshold of G and where G first falls to it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ShellCrossing {
    /// G_th \[1\].
    pub threshold: f64,
    /// γ*, by linear interpolation between bins, or why there is none.
    pub outcome: CrossingOutcome,
    /// Standard error of γ* by the jackknife; absent if G without some block never falls to the threshold \[rad\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standard_error: Option<f64>,
}

impl ShellCorrelation {
    /// The correlation function of a shell.
    ///
    /// # Errors
    /// Settings out of range; more than [`MOST_PAIRED`] spheres.
    ///
    /// # Cost
    /// n²/2 pairs: 0.5 s at 5000 spheres.
    pub fn of(shell: &ShellSample, settings: &ShellCorrelationSettings) -> Result<Self, ShellError> {
        settings.check()?;
        let disk_count = shell.disk_count();
        at_most(MOST_PAIRED).check("disk_count", disk_count, 48.0)?;
        let pairs = AllPairs::of(shell, settings.bin_count, settings.cap);
        let total: f64 = pairs.squares.iter().map(|square| square[0]).sum();
        // Each block with spheres, left out: the other pairs, and the variance of the other spheres.
        let blocks = pairs.blocks.iter().zip(&pairs.squares).filter(|(_, square)| square[1] > 0.0);
        let without = blocks.filter_map(|(block, square)| {
            let variance = (total - square[0]) / (disk_count as f64 - square[1]);
            (variance > 0.0).then(|| (pairs.all.without(block), variance))
        });
        let without: Vec<_> = without.collect();

        let angles: Vec<f64> = std::iter::once(0.0).chain(middles(settings.bin_count)).collect();
        let curve = |bins: Vec<f64>| -> Vec<f64> { std::iter::once(1.0).chain(bins).collect() };
        let values = curve(pairs.all.correlation(shell.variance()));
        let replicas: Vec<Vec<f64>> =
            without.iter().map(|(sums, variance)| curve(sums.correlation(*variance))).collect();
        let error = |at: usize| jackknife(replicas.iter().map(|values| Some(values[at]))).unwrap_or(f64::INFINITY);
        let standard_errors = (0..values.len()).map(error).collect();
        let crossings = settings.thresholds.iter().map(|&threshold| {
            let of = |values: &[f64]| CrossingOutcome::in_table(&angles, values, threshold);
            let outcome = of(&values);
            let standard_error =
                outcome.angle().and_then(|_| jackknife(replicas.iter().map(|values| of(values).angle())));
            ShellCrossing { threshold, outcome, standard_error }
        });
        let crossings = crossings.collect();
        let anticorrelation = pairs.all.opposite(shell.variance()).map(|opposite| Anticorrelation {
            value: -opposite,
            standard_error: jackknife(without.iter().map(|(sums, variance)| sums.opposite(*variance))),
            pair_count: pairs.all.cap[0] as usize,
        });
        let pair_counts = std::iter::once(0).chain(pairs.all.counts.iter().map(|&count| count as usize)).collect();
        Ok(ShellCorrelation { disk_count, angles, values, standard_errors, pair_counts, anticorrelation, crossings })
    }

    /// γ* at a threshold \[rad\], if the settings contain it and G reaches it.
    pub fn crossing(&self, threshold: f64) -> Option<f64> {
        self.crossings.iter().find(|crossing| crossing.threshold == threshold)?.outcome.angle()
    }
}

/// √((B − 1)/B Σ (x − x̄)²); none if a value is missing or there are fewer than two.
fn jackknife(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let values = values.collect::<Option<Vec<f64>>>()?;
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    (values.len() > 1).then(|| ((count - 1.0) / count * square).sqrt())
}
