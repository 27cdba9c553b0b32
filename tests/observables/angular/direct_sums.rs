//! S(f) against sums over disks by its definition, and G(θ) against sums over pairs in real space, which know nothing of S.

use std::f64::consts::{PI, TAU};

use jamscope::observe::angular::{
    AngularCorrelation, CorrelationEstimator, CorrelationOutcome, CorrelationSettings, FrequencyLimit, Leakage,
    PowerSpectrum, RingSample, SpectrumEstimator, SpectrumSettings, Weights,
};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::direct;
use crate::seeds::config;

const ROUNDING: f64 = f64::EPSILON;

/// A ring of disks at random angles, some of them crowded, with a mean, a few modes and independent parts.
fn random_ring(seed: u64, count: usize) -> RingSample {
    let mut random = Pcg64::seed_from_u64(seed);
    let crowded = random.random::<f64>();
    let (mean, amplitude, frequency) = (random.random::<f64>() - 0.5, 2.0 * random.random::<f64>(), 1 + seed % 5);
    let disks: (Vec<f64>, Vec<f64>) = (0..count)
        .map(|_| {
            let place = 2.0 * random.random::<f64>() - 1.0;
            // Up to twice as many disks per angle near 0 as elsewhere, and a gap opposite.
            let angle = PI * place * (1.0 - 0.5 * crowded * (1.0 - place.abs()));
            let value = mean + amplitude * (frequency as f64 * angle + 0.4).cos() + random.random::<f64>();
            (angle, value)
        })
        .unzip();
    RingSample::new(&disks.0, &disks.1).expect("finite")
}

fn rings(counts: std::ops::Range<usize>) -> impl Strategy<Value = RingSample> {
    (any::<u64>(), counts).prop_map(|(seed, count)| random_ring(seed, count))
}

/// Weights by their definition: 1/n, or for each disk half the arc between its neighbours, over 2π.
fn weights_of(ring: &RingSample, weights: Weights) -> Vec<f64> {
    let (angles, count) = (ring.angles(), ring.disk_count());
    let arc = |disk: usize| {
        let after = if disk + 1 < count { angles[disk + 1] } else { angles[0] + TAU };
        let before = if disk > 0 { angles[disk - 1] } else { angles[count - 1] - TAU };
        (after - before) / (2.0 * TAU)
    };
    (0..count).map(|disk| if weights == Weights::Equal { 1.0 / count as f64 } else { arc(disk) }).collect()
}

/// Strengths w (x − m), m, and Σ w (x − m)².
fn strengths(ring: &RingSample, weights: &[f64]) -> (Vec<f64>, f64, f64) {
    let mean: f64 = weights.iter().zip(ring.values()).map(|(w, x)| w * x).sum();
    let strengths = weights.iter().zip(ring.values()).map(|(w, x)| w * (x - mean)).collect();
    (strengths, mean, weights.iter().zip(ring.values()).map(|(w, x)| w * (x - mean) * (x - mean)).sum())
}

/// Σ_k a_k e^(ifθ_k), one term after the other.
fn plain_sum(angles: &[f64], strengths: &[f64], frequency: usize) -> [f64; 2] {
    let phase = |angle: &f64| frequency as f64 * angle;
    let along = angles.iter().zip(strengths).map(|(angle, a)| a * phase(angle).cos()).sum();
    [along, angles.iter().zip(strengths).map(|(angle, a)| a * phase(angle).sin()).sum()]
}

/// Error of one Fourier sum per Σ|a|: phases up to πf are rounded here and there, rotations, and the fast method (`fourier_sums_by`).
/// Strengths of n disks have a mean of n terms.
fn sum_error(frequency: usize, count: usize) -> f64 {
    (TAU * frequency as f64 + 128.0 + count as f64) * ROUNDING + 5e-14
}

proptest! {
    #![proptest_config(config(48, 20))]

    #[test]
    fn powers_at_irregular_angles_are_the_squares_of_plain_fourier_sums(ring in rings(20..500), share in 0.02..0.5f64) {
        let count = ring.disk_count();
        let limit = ((share * count as f64) as usize).max(1);
        for kind in [Weights::Equal, Weights::Gaps] {
            let settings = SpectrumSettings { estimator: direct(kind, Leakage::Kept), frequency_limit: FrequencyLimit::Fixed(limit) };
            let found = PowerSpectrum::of(&ring, &settings).expect("in range");
            let weights = weights_of(&ring, kind);
            let (a, mean, variance) = strengths(&ring, &weights);
            let total: f64 = a.iter().map(|a| a.abs()).sum();
            let size = ring.values().iter().fold(1.0f64, |most, x| most.max(x.abs()));
            // Weights of 500 disks are differences of angles up to 2π over 2π.
            let rounding = 4.0 * count as f64 * ROUNDING * size * size;
            prop_assert_eq!(found.power.len(), limit + 1);
            prop_assert!((found.power[0] - mean * mean).abs() <= rounding && (found.variance - variance).abs() <= rounding);
            let squares: f64 = weights.iter().map(|w| w * w).sum();
            prop_assert!((found.white_floor - 2.0 * squares * variance).abs() <= rounding);
            prop_assert_eq!(found.unresolved, 0.0);
            for f in 1..=limit {
                let [re, im] = plain_sum(ring.angles(), &a, f);
                let length = re.hypot(im);
                let error = sum_error(f, count) * total.max(size);
                let allowed = 2.0 * error * (2.0 * length + error);
                let power = 2.0 * length * length;
                prop_assert!((found.power[f] - power).abs() <= allowed, "{kind:?}, f = {f}: {} and {power}", found.power[f]);
            }
        }
    }

    /// G of the direct sums in real space: with K(x) = Σ_(f=1)^F cos fx = (sin((F + 1/2) x)/sin(x/2) − 1)/2,
    ///
    /// Σ_f P_f cos fθ = Σ_jk a_j a_k [K(θ_j − θ_k + θ) + K(θ_j − θ_k − θ)]: an autocorrelation over all pairs, smoothed to the resolution F.
    #[test]
    fn correlations_at_irregular_angles_are_autocorrelations_over_all_pairs(ring in rings(20..300), share in 0.02..0.5f64) {
        let count = ring.disk_count();
        let limit = ((share * count as f64) as usize).max(1);
        for kind in [Weights::Equal, Weights::Gaps] {
            let spectrum = SpectrumSettings { estimator: direct(kind, Leakage::Kept), frequency_limit: FrequencyLimit::Fixed(limit) };
            let settings = CorrelationSettings {
                estimator: CorrelationEstimator::Spectral(spectrum), step_count: 12, ..CorrelationSettings::default()
            };
            let found = AngularCorrelation::of(&ring, &settings).expect("in range");
            prop_assert_eq!(found.outcome, CorrelationOutcome::Found);
            let (a, ..) = strengths(&ring, &weights_of(&ring, kind));
            let kernel = |x: f64| {
                let half = (0.5 * x).sin();
                // Near x = 0 the quotient is known to ε/|x| of itself; its limit errs by (F x)²/6 of F: both below 10⁻⁹ at 10⁻⁷.
                if half.abs() * (limit as f64) < 1e-7 { limit as f64 } else { 0.5 * (((limit as f64 + 0.5) * x).sin() / half - 1.0) }
            };
            let total: f64 = a.iter().map(|a| a.abs()).sum();
            let autocorrelation = |lag: f64| -> f64 {
                let pairs = (0..count).flat_map(|j| (0..count).map(move |k| (j, k)));
                pairs
                    .map(|(j, k)| {
                        let apart = ring.angles()[j] - ring.angles()[k];
                        a[j] * a[k] * (kernel(apart + lag) + kernel(apart - lag))
                    })
                    .sum()
            };
            let square = autocorrelation(0.0);
            // K is at most F, its error 10⁻⁹ of that next to a peak and (F x) roundings elsewhere; P_f cos fθ errs by the Fourier sums.
            let error = 2.0 * limit as f64 * total * total * (1e-9 / (limit as f64) + sum_error(limit, count) * count as f64);
            for (&lag, &value) in found.angles.iter().zip(&found.values).skip(1) {
                let expected = autocorrelation(lag) / square;
                prop_assert!((value - expected).abs() <= 2.0 * error / square, "{kind:?}, θ = {lag}: {value} and {expected}");
            }
            // The bound says something: G is known to 10⁻⁶ at least.
            prop_assert!(2.0 * error / square < 1e-6, "{}", 2.0 * error / square);
        }
    }

    /// Values of an even grid have a real-space autocorrelation at every lag, the mean of x_j x_(j+l) over the grid.
    #[test]
    fn correlations_of_grids_are_circular_autocorrelations_of_their_values(ring in rings(20..500), per_disk in 0.3..2.5f64, bins in any::<bool>()) {
        let count = ring.disk_count();
        let grid_count = 2 * ((0.5 * per_disk * count as f64).round() as usize).max(2);
        let (estimator, values) = if bins {
            (SpectrumEstimator::Binned { bins_per_disk: per_disk }, bin_means(&ring, grid_count))
        } else {
            (SpectrumEstimator::Interpolated { points_per_disk: per_disk }, interpolant(&ring, grid_count))
        };
        let spectrum = SpectrumSettings { estimator, frequency_limit: FrequencyLimit::Fixed(grid_count / 2) };
        let settings = CorrelationSettings {
            estimator: CorrelationEstimator::Spectral(spectrum), step_count: grid_count / 2, ..CorrelationSettings::default()
        };
        let found = AngularCorrelation::of(&ring, &settings).expect("in range");
        let mean = values.iter().sum::<f64>() / grid_count as f64;
        let product = |lag: usize| -> f64 {
            (0..grid_count).map(|j| (values[j] - mean) * (values[(j + lag) % grid_count] - mean)).sum()
        };
        let variance = product(0);
        // Sums of n values of size 2 at most, each rounded, of a transform, then of n/2 powers with phases up to πn/2.
        let size: f64 = values.iter().map(|x| x * x).sum();
        let allowed = 16.0 * grid_count as f64 * ROUNDING * size / variance;
        for lag in (0..=grid_count / 2).step_by(1 + grid_count / 60) {
            let expected = product(lag) / variance;
            prop_assert!((found.values[lag] - expected).abs() <= allowed, "{estimator:?}, lag {lag}: {} and {expected}", found.values[lag]);
        }
    }

    /// The bins of pairs, over ordered pairs and with differences of angles from sines and cosines. A difference within 10⁻¹⁵ of the edge
    /// of a bin would be counted elsewhere: 1 in 10⁷ rings.
    #[test]
    fn pair_correlations_are_means_over_all_pairs_in_a_bin(ring in rings(20..500), bin_count in 2usize..60) {
        let settings = CorrelationSettings { estimator: CorrelationEstimator::Pairs { bin_count }, ..CorrelationSettings::default() };
        let found = AngularCorrelation::of(&ring, &settings).expect("in range");
        let count = ring.disk_count();
        let mean = ring.values().iter().sum::<f64>() / count as f64;
        let x: Vec<f64> = ring.values().iter().map(|x| x - mean).collect();
        let variance = x.iter().map(|x| x * x).sum::<f64>() / count as f64;
        let mut bins = vec![(0.0, 0.0, 0.0); bin_count];
        for j in 0..count {
            for k in (0..count).filter(|&k| k != j) {
                let (sine, cosine) = (ring.angles()[j] - ring.angles()[k]).sin_cos();
                let bin = ((sine.abs().atan2(cosine) / PI * bin_count as f64) as usize).min(bin_count - 1);
                let term = x[j] * x[k];
                bins[bin] = (bins[bin].0 + term, bins[bin].1 + 1.0, bins[bin].2 + f64::abs(term));
            }
        }
        let means: Vec<f64> = bins.iter().scan(1.0, |last, bin| {
            if bin.1 > 0.0 { *last = bin.0 / bin.1 / variance }
            Some(*last)
        }).collect();
        // The estimate of a bin with few pairs may leave [−1, 1]; there is then no correlation function.
        if let Some(farthest) = means.iter().copied().filter(|mean| mean.abs() > 1.0 + 1e-9).max_by(|a, b| a.abs().total_cmp(&b.abs())) {
            let CorrelationOutcome::OutOfRange { value, .. } = found.outcome else { panic!("{:?}, {farthest}", found.outcome) };
            prop_assert!((value / farthest - 1.0).abs() < 1e-9);
            return Ok(());
        }
        // θ* on the line through the two points of the table on either side of the threshold.
        for crossing in &found.crossings {
            let next = found.values.iter().position(|&value| value <= crossing.threshold);
            let expected = next.map(|next| {
                let [(a, x), (b, y)] = [next - 1, next].map(|at| (found.values[at], found.angles[at]));
                x + (a - crossing.threshold) * (y - x) / (a - b)
            });
            match (expected, crossing.outcome.angle()) {
                (Some(expected), Some(angle)) => prop_assert!((angle - expected).abs() <= 16.0 * ROUNDING * PI, "{angle} {expected}"),
                (expected, angle) => prop_assert_eq!(expected, angle),
            }
        }
        for (bin, expected) in means.iter().enumerate() {
            prop_assert!((found.angles[bin + 1] - PI * (bin as f64 + 0.5) / bin_count as f64).abs() <= 8.0 * ROUNDING);
            // Sums over the pairs of a bin, and n roundings of the mean in every value.
            let pairs = bins[bin].1.max(1.0);
            let allowed = (pairs + 8.0 * count as f64) * ROUNDING * (bins[bin].2 / pairs / variance + 4.0);
            prop_assert!((found.values[bin + 1] - expected).abs() <= allowed, "bin {bin}: {} and {expected}", found.values[bin + 1]);
        }
    }
}

proptest! {
    #![proptest_config(config(24, 20))]

    /// Leakage that was removed, put back: with S and ρ found, ⟨P_f⟩ and the variance of their definitions are those measured. K is
    /// summed term by term from W(h) = Σ w e^(ihθ).
    #[test]
    fn spectra_with_leakage_removed_lead_back_to_the_plain_sums(ring in rings(20..200), share in 0.02..0.2f64) {
        let count = ring.disk_count();
        let limit = ((share * count as f64) as usize).max(1);
        for kind in [Weights::Equal, Weights::Gaps] {
            let of = |leakage| {
                let settings = SpectrumSettings { estimator: direct(kind, leakage), frequency_limit: FrequencyLimit::Fixed(limit) };
                PowerSpectrum::of(&ring, &settings).expect("in range")
            };
            let (kept, removed) = (of(Leakage::Kept), of(Leakage::Removed));
            let weights = weights_of(&ring, kind);
            let squares: Vec<f64> = weights.iter().map(|w| w * w).collect();
            let window = |h: usize| plain_sum(ring.angles(), &weights, h);
            let conjugate = |[re, im]: [f64; 2]| [re, -im];
            let times = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * c - b * d, a * d + b * c];
            let distance = |[a, b]: [f64; 2], [c, d]: [f64; 2]| (a - c) * (a - c) + (b - d) * (b - d);
            let total: f64 = squares.iter().sum();
            let strength = removed.power[1..].iter().map(|power| power.abs()).sum::<f64>() + removed.unresolved.abs();
            // Elimination is stable: what it leaves is the rounding of each of its rows, beside that of the couplings.
            let allowed = 8.0 * (sum_error(2 * limit, count) + 16.0 * limit as f64 * ROUNDING) * (strength + kept.variance);
            let mut variance = removed.unresolved * (1.0 - total);
            for f in 1..=limit {
                let at = window(f);
                let own = plain_sum(ring.angles(), &squares, f);
                let white = 2.0 * (total * (1.0 + distance(at, [0.0; 2])) - 2.0 * times(at, conjugate(own))[0]);
                let mut power = removed.unresolved * white;
                for g in 1..=limit {
                    let other = window(g);
                    let below = if f >= g { window(f - g) } else { conjugate(window(g - f)) };
                    let coupling = distance(below, times(at, conjugate(other))) + distance(window(f + g), times(at, other));
                    power += coupling * removed.power[g];
                }
                prop_assert!((power - kept.power[f]).abs() <= allowed, "{kind:?}, f = {f}: {power} and {}", kept.power[f]);
                variance += removed.power[f] * (1.0 - distance(at, [0.0; 2]));
            }
            prop_assert!((variance - kept.variance).abs() <= allowed, "{kind:?}: {variance} and {}", kept.variance);
        }
    }
}

/// Angles from the disk after the widest gap on, in [0, 2π), with their values.
fn from_the_widest_gap(ring: &RingSample) -> Vec<(f64, f64)> {
    let (angles, count) = (ring.angles(), ring.disk_count());
    let gap =
        |disk: usize| if disk + 1 < count { angles[disk + 1] - angles[disk] } else { angles[0] + TAU - angles[disk] };
    let widest = (0..count).max_by(|&a, &b| gap(a).total_cmp(&gap(b))).expect("disks");
    let first = angles[(widest + 1) % count];
    let mut disks: Vec<(f64, f64)> = angles
        .iter()
        .zip(ring.values())
        .map(|(&angle, &value)| (if angle < first { angle - first + TAU } else { angle - first }, value))
        .collect();
    disks.sort_by(|a, b| a.0.total_cmp(&b.0));
    disks
}

/// The line between the two disks on either side of every grid angle.
fn interpolant(ring: &RingSample, count: usize) -> Vec<f64> {
    let disks = from_the_widest_gap(ring);
    let value = |at: f64| {
        let before = disks.iter().rfind(|disk| disk.0 <= at).expect("the first is at 0");
        let after = disks.iter().find(|disk| disk.0 > at).copied().unwrap_or((TAU, disks[0].1));
        before.1 + (at - before.0) / (after.0 - before.0) * (after.1 - before.1)
    };
    (0..count).map(|j| value(TAU * j as f64 / count as f64)).collect()
}

/// Means of the disks nearest to every grid angle; between bins that have some, on the line through them.
fn bin_means(ring: &RingSample, count: usize) -> Vec<f64> {
    let disks = from_the_widest_gap(ring);
    let mean = |bin: usize| {
        let middle = TAU * bin as f64 / count as f64;
        let near = |angle: f64| {
            let apart = (angle - middle).abs();
            apart.min(TAU - apart) < PI / count as f64
        };
        let members: Vec<f64> = disks.iter().filter(|disk| near(disk.0)).map(|disk| disk.1).collect();
        (!members.is_empty()).then(|| members.iter().sum::<f64>() / members.len() as f64)
    };
    let means: Vec<Option<f64>> = (0..count).map(mean).collect();
    let value = |bin: usize| {
        if let Some(mean) = means[bin] {
            return mean;
        }
        let down = (1..count).find(|&steps| means[(bin + count - steps) % count].is_some()).expect("bin 0 has a disk");
        let up = (1..count).find(|&steps| means[(bin + steps) % count].is_some()).expect("bin 0 has a disk");
        let (low, high) = (means[(bin + count - down) % count], means[(bin + up) % count]);
        let (low, high) = (low.expect("found"), high.expect("found"));
        low + down as f64 / (down + up) as f64 * (high - low)
    };
    (0..count).map(value).collect()
}

/// Eight even angles have pairs at multiples of π/4 only, in 4 of 10 bins. A bin without pairs takes the value of the bin before it.
#[test]
fn bins_without_pairs_take_the_value_before() {
    let dipole = super::ring(&super::even_angles(8), f64::cos);
    let settings = CorrelationSettings {
        estimator: CorrelationEstimator::Pairs { bin_count: 10 },
        ..CorrelationSettings::default()
    };
    let found = AngularCorrelation::of(&dipole, &settings).expect("in range");
    for (bin, steps) in [0, 0, 1, 1, 1, 2, 2, 3, 3, 4].into_iter().enumerate() {
        let expected = (0.25 * PI * f64::from(steps)).cos();
        // Means of eight products of a few roundings.
        assert!(
            (found.values[bin + 1] - expected).abs() < 1e-14,
            "bin {bin}: {} and {expected}",
            found.values[bin + 1]
        );
    }
}
