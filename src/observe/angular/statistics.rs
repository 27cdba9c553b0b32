//! Means and standard errors over samples: [`correlation_statistics`], [`spectrum_statistics`].
//!
//! G is averaged with each sample normalised to G(0) = 1; samples without G are left out. S is averaged over samples
//! scaled to equal variance and then normalised to S(1) = 1. The mean of S(f)/S(1) itself does not exist, because
//! 1/S(1) of a random field has no mean.

use serde::Serialize;

use crate::observe::angular::correlation::{AngularCorrelation, CorrelationOutcome};
use crate::observe::angular::crossing::CrossingOutcome;
use crate::observe::angular::error::AngularError;
use crate::observe::angular::power_spectrum::PowerSpectrum;

/// A mean over samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Mean {
    /// The mean \[unit of the number\].
    pub value: f64,
    /// Its standard error \[unit of the number\]; none for one sample.
    pub standard_error: Option<f64>,
}

impl Mean {
    fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let value = values.iter().sum::<f64>() / count;
        let square: f64 = values.iter().map(|x| (x - value) * (x - value)).sum();
        let standard_error = (values.len() > 1).then(|| (square / (count - 1.0) / count).sqrt());
        Mean { value, standard_error }
    }
}

/// The correlation functions of several samples.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CorrelationStatistics {
    /// Number of samples.
    pub sample_count: usize,
    /// Number of samples left out because they have no G.
    pub left_out_count: usize,
    /// θ \[rad\].
    pub angles: Vec<f64>,
    /// G(θ) \[1\].
    pub values: Vec<Mean>,
    /// G* \[1\].
    pub anticorrelation: Mean,
    /// θ* at every threshold.
    pub crossings: Vec<CrossingStatistics>,
}

/// θ* at one threshold over samples.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CrossingStatistics {
    /// G_th \[1\].
    pub threshold: f64,
    /// θ* of the mean G, by linear interpolation.
    pub of_mean: CrossingOutcome,
    /// Mean θ* of the samples with a θ* \[rad\].
    pub angle: Option<Mean>,
    /// Their lower quartile, median and upper quartile \[rad\].
    pub quartiles: Option<[f64; 3]>,
    /// Number of samples whose G never falls to the threshold.
    pub never_count: usize,
}

/// The spectra of several samples.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpectrumStatistics {
    /// Number of samples.
    pub sample_count: usize,
    /// S(f) at its index f, S(1) = 1. The errors are those of the mean power; S(1) is treated as exact \[1\].
    pub spectrum: Vec<Mean>,
}

/// Means over samples.
///
/// # Errors
/// No sample; samples whose angles or thresholds differ from those of the first.
pub fn correlation_statistics(samples: &[AngularCorrelation]) -> Result<CorrelationStatistics, AngularError> {
    let first = first_if_consistent(samples, |a, b| {
        if a.angles != b.angles {
            return Some("angles");
        }
        let thresholds = |sample: &AngularCorrelation| sample.crossings.iter().map(|c| c.threshold).collect::<Vec<_>>();
        (thresholds(a) != thresholds(b)).then_some("thresholds")
    })?;
    let found = |sample: &&AngularCorrelation| sample.outcome == CorrelationOutcome::Found;
    let kept: Vec<&AngularCorrelation> = samples.iter().filter(found).collect();
    let over =
        |of: &dyn Fn(&AngularCorrelation) -> f64| Mean::of(&kept.iter().map(|sample| of(sample)).collect::<Vec<_>>());
    let values: Vec<Mean> = (0..first.angles.len()).map(|i| over(&|sample| sample.values[i])).collect();
    let curve: Vec<f64> = values.iter().map(|mean| mean.value).collect();
    let crossings = first.crossings.iter().enumerate().map(|(i, crossing)| {
        let outcomes = || samples.iter().map(move |sample| sample.crossings[i].outcome);
        let mut angles: Vec<f64> = outcomes().filter_map(CrossingOutcome::angle).collect();
        angles.sort_unstable_by(f64::total_cmp);
        CrossingStatistics {
            threshold: crossing.threshold,
            of_mean: CrossingOutcome::in_table(&first.angles, &curve, crossing.threshold),
            angle: (!angles.is_empty()).then(|| Mean::of(&angles)),
            quartiles: (!angles.is_empty()).then(|| [0.25, 0.5, 0.75].map(|share| quantile(&angles, share))),
            never_count: outcomes().filter(|outcome| matches!(outcome, CrossingOutcome::Never { .. })).count(),
        }
    });
    Ok(CorrelationStatistics {
        sample_count: samples.len(),
        left_out_count: samples.len() - kept.len(),
        angles: first.angles.clone(),
        anticorrelation: over(&|sample| sample.anticorrelation),
        crossings: crossings.collect(),
        values,
    })
}

/// Means over samples, each divided by its variance.
///
/// # Errors
/// No sample; samples with other frequencies than the first, or without variance; a mean power at f = 1 that is not
/// positive.
pub fn spectrum_statistics(samples: &[PowerSpectrum]) -> Result<SpectrumStatistics, AngularError> {
    let first = first_if_consistent(samples, |a, b| {
        if a.power.len() != b.power.len() {
            return Some("frequencies");
        }
        (b.variance.is_nan() || b.variance <= 0.0).then_some("its variance is zero")
    })?;
    let mut spectrum: Vec<Mean> = (0..first.power.len())
        .map(|f| Mean::of(&samples.iter().map(|sample| sample.power[f] / sample.variance).collect::<Vec<_>>()))
        .collect();
    let scale = spectrum[1].value;
    if scale.is_nan() || scale <= 0.0 {
        let reason = "the mean power at f = 1 is not positive";
        return Err(AngularError::SamplesDiffer { sample: 0, sample_count: samples.len(), reason });
    }
    for mean in &mut spectrum {
        mean.value /= scale;
        mean.standard_error = mean.standard_error.map(|error| error / scale);
    }
    Ok(SpectrumStatistics { sample_count: samples.len(), spectrum })
}

/// The first sample; an error if there is none or another one differs from it.
fn first_if_consistent<T>(
    samples: &[T],
    difference: impl Fn(&T, &T) -> Option<&'static str>,
) -> Result<&T, AngularError> {
    let sample_count = samples.len();
    let none = AngularError::SamplesDiffer { sample: 0, sample_count, reason: "there is none" };
    let first = samples.first().ok_or(none)?;
    for (sample, other) in samples.iter().enumerate() {
        if let Some(reason) = difference(first, other) {
            return Err(AngularError::SamplesDiffer { sample, sample_count, reason });
        }
    }
    Ok(first)
}

/// Quantile by linear interpolation between the order statistics; at least one value.
pub(crate) fn quantile(ascending: &[f64], share: f64) -> f64 {
    let at = share * (ascending.len() - 1) as f64;
    let (below, rest) = (at.floor() as usize, at - at.floor());
    let above = (below + 1).min(ascending.len() - 1);
    ascending[below] + rest * (ascending[above] - ascending[below])
}
