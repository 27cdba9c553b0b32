//! Estimators of the angular spectrum and correlation, on the ring in the middle of the first reference.

use std::time::Instant;

use crate::displacement::DisplacementField;
use crate::observe::angular::{
    AngularCorrelation, CorrelationEstimator, CorrelationSettings, FrequencyLimit, Leakage, PowerSpectrum, RingSample,
    RingSettings, SpectrumEstimator, SpectrumSettings, Weights,
};
use crate::precision::numerical_choices::{ChoiceRow, ChoiceTable};

/// Threshold of θ* \[1\].
const THRESHOLD: f64 = 0.1;

/// Every estimator, the default first. None if the ring has too few disks.
pub(super) fn estimators(field: &DisplacementField<2>) -> Option<ChoiceTable> {
    let ring = RingSample::of_field(field, &RingSettings::default()).ok()?;
    let direct = |weights, leakage| SpectrumEstimator::Direct { weights, leakage };
    let spectral = [
        ("direct, gaps, leakage removed", direct(Weights::Gaps, Leakage::Removed), 0.125),
        ("direct, gaps", direct(Weights::Gaps, Leakage::Kept), 0.25),
        ("direct, equal weights", direct(Weights::Equal, Leakage::Kept), 0.25),
        ("interpolated", SpectrumEstimator::Interpolated { points_per_disk: 4.0 }, 0.25),
        ("binned", SpectrumEstimator::Binned { bins_per_disk: 0.5 }, 0.25),
    ];
    let mut rows: Vec<ChoiceRow> = spectral
        .into_iter()
        .map(|(name, estimator, share)| {
            let spectrum = SpectrumSettings { estimator, frequency_limit: FrequencyLimit::PerDisk(share) };
            row(name, &ring, CorrelationEstimator::Spectral(spectrum))
        })
        .collect();
    rows.push(row("pairs, 60 bins", &ring, CorrelationEstimator::Pairs { bin_count: 60 }));
    Some(ChoiceTable {
        name: "angular_estimator",
        title: "Estimators of the angular spectrum and correlation, ring r̂ = 0.5 ± 0.03",
        columns: vec!["estimator", "S(2)/S(1) (1)", "S(4)/S(1) (1)", "G* (1)", "θ* (rad)", "seconds"],
        rows,
    })
}

fn row(name: &str, ring: &RingSample, estimator: CorrelationEstimator) -> ChoiceRow {
    let settings = CorrelationSettings { estimator, thresholds: vec![THRESHOLD], ..CorrelationSettings::default() };
    let start = Instant::now();
    let correlation = AngularCorrelation::of(ring, &settings).ok();
    let seconds = start.elapsed().as_secs_f64();
    let spectrum = match estimator {
        CorrelationEstimator::Spectral(spectrum) => PowerSpectrum::of(ring, &spectrum).ok(),
        CorrelationEstimator::Pairs { .. } => None,
    };
    let powers = spectrum.and_then(|spectrum| spectrum.normalised());
    let power = |frequency: usize| powers.as_ref().and_then(|powers| powers.get(frequency).copied());
    let values = vec![
        power(2),
        power(4),
        correlation.as_ref().map(|it| it.anticorrelation).filter(|value| value.is_finite()),
        correlation.as_ref().and_then(|it| it.crossing(THRESHOLD)),
        Some(seconds),
    ];
    ChoiceRow { setting: name.into(), values }
}
