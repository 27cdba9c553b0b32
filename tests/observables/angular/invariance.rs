//! Rotation and relabelling.

use std::f64::consts::PI;

use jamscope::observe::angular::synthetic::{SyntheticSettings, gaussian_rings};
use jamscope::observe::angular::{
    AngularCorrelation, CorrelationEstimator, CorrelationSettings, FrequencyLimit, PowerSpectrum, RingSample,
    SpectrumSettings,
};

use super::all_estimators;

fn sample(disk_count: usize) -> RingSample {
    let settings = SyntheticSettings { disk_count, seed: 12, ..SyntheticSettings::default() };
    gaussian_rings(&settings, 1, |f| f.powf(-1.5)).expect("enough disks").remove(0).ring
}

fn correlations(ring: &RingSample) -> Vec<AngularCorrelation> {
    let spectral = all_estimators().map(|estimator| {
        CorrelationEstimator::Spectral(SpectrumSettings { estimator, frequency_limit: FrequencyLimit::PerDisk(0.125) })
    });
    let all = spectral.into_iter().chain([CorrelationEstimator::Pairs { bin_count: 45 }]);
    all.map(|estimator| {
        AngularCorrelation::of(ring, &CorrelationSettings { estimator, ..Default::default() }).expect("in range")
    })
    .collect()
}

#[test]
fn rotation_changes_nothing_beyond_rounding() {
    for disk_count in [60, 1000] {
        let ring = sample(disk_count);
        let limit = disk_count / 8;
        for turn in [0.1, 1.0, -2.0, 5.0] {
            let angles: Vec<f64> = ring.angles().iter().map(|angle| angle + turn).collect();
            let turned = RingSample::new(&angles, ring.values()).expect("finite");
            // Every angle is rounded by 4·2⁻⁵² at most; a phase by f times that, a gap of random disks down to 10⁻⁶ of the even
            // one by 10⁻⁷ of itself, which weighs nothing. Unmixing has a condition below 100.
            let tolerance = 100.0 * 4.0 * f64::EPSILON * disk_count as f64;
            for estimator in all_estimators() {
                let settings = SpectrumSettings { estimator, frequency_limit: FrequencyLimit::Fixed(limit) };
                let [a, b] = [&ring, &turned].map(|ring| PowerSpectrum::of(ring, &settings).expect("in range"));
                for f in 0..=limit {
                    let error = (a.power[f] - b.power[f]).abs() / a.variance;
                    assert!(error < tolerance, "{estimator:?} n = {disk_count}, turn {turn}, f = {f}: {error:e}");
                }
            }
            for (a, b) in correlations(&ring).iter().zip(correlations(&turned)) {
                for (a, b) in a.values.iter().zip(&b.values) {
                    assert!((a - b).abs() < tolerance, "n = {disk_count}, turn {turn}: {a} and {b}");
                }
            }
        }
    }
}

#[test]
fn relabelling_changes_no_bit() {
    let ring = sample(300);
    let (mut angles, mut values) = (ring.angles().to_vec(), ring.values().to_vec());
    // Two disks at one angle, and one on either side of the cut.
    angles[10] = angles[11];
    (angles[0], angles[299]) = (-PI, PI);
    let ring = RingSample::new(&angles, &values).expect("finite");
    angles.reverse();
    values.reverse();
    angles.rotate_left(77);
    values.rotate_left(77);
    let relabelled = RingSample::new(&angles, &values).expect("finite");
    assert_eq!(ring, relabelled);
    assert_eq!(correlations(&ring), correlations(&relabelled));
}
