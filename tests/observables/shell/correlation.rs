use std::f64::consts::PI;

use jamscope::observe::angular::{CrossingOutcome, Leakage};
use jamscope::observe::shell::synthetic::{DirectionLayout, SyntheticSettings, gaussian_shells};
use jamscope::observe::shell::{
    MOST_PAIRED, ShellCorrelation, ShellCorrelationSettings, ShellError, ShellSpectrum, ShellSpectrumSettings,
};
use jamscope::vector::dot;

use super::{clustered_directions, legendre, random_directions, shell, up_to};

fn correlation(sample: &jamscope::observe::shell::ShellSample, bin_count: usize) -> ShellCorrelation {
    let settings = ShellCorrelationSettings { bin_count, ..ShellCorrelationSettings::default() };
    ShellCorrelation::of(sample, &settings).expect("sound settings")
}

#[test]
fn bins_hold_the_products_of_their_pairs() {
    let sample = shell(&clustered_directions(60, 1), |n| n[0] + 2.0 * n[1] * n[2]);
    let found = correlation(&sample, 18);
    let (n, delta) = (sample.directions(), sample.fluctuations());
    let (mut sums, mut counts) = ([0.0; 18], [0usize; 18]);
    for i in 0..60 {
        for j in 0..i {
            let bin = ((dot(n[i], n[j]).acos() / PI * 18.0) as usize).min(17);
            sums[bin] += delta[i] * delta[j];
            counts[bin] += 1;
        }
    }
    assert_eq!((found.values[0], found.pair_counts[0], found.standard_errors[0]), (1.0, 0, 0.0));
    for bin in 0..18 {
        assert_eq!(found.pair_counts[bin + 1], counts[bin]);
        let exact = sums[bin] / counts[bin] as f64 / sample.variance();
        // Sums of at most 1770 terms below 10.
        assert!((found.values[bin + 1] - exact).abs() < 1e-12);
    }
    // Σ_i δ_i = 0, so all pairs together have −n/2 of the variance.
    let all: f64 = found.values.iter().zip(&found.pair_counts).map(|(g, &count)| g * count as f64).sum();
    assert!((all + 30.0).abs() < 1e-11);
}

#[test]
fn bins_and_powers_are_a_legendre_transform_of_each_other() {
    // P_ℓ/V = 1/n + (2/n²) Σ_b n_b G_b P_ℓ(cos γ_b), exact but for the width of a bin: |dP_ℓ/dγ| ≤ ℓ (Bernstein).
    let (count, bins) = (400, 2000);
    let sample = shell(&clustered_directions(count, 2), |n| n[0] + 4.0 * n[0] * n[1] + (9.0 * n[2]).sin());
    let found = correlation(&sample, bins);
    let spectrum = ShellSpectrum::of(&sample, &up_to(10, Leakage::Kept)).expect("enough spheres");
    let n = count as f64;
    for degree in 1..=10 {
        let pairs = found.angles.iter().zip(&found.values).zip(&found.pair_counts);
        let sum: f64 = pairs.map(|((a, g), &pairs)| g * pairs as f64 * legendre(a.cos(), degree)[degree]).sum();
        let transform = 1.0 / n + 2.0 * sum / (n * n);
        let error = transform - spectrum.power[degree] / spectrum.variance;
        assert!(error.abs() < degree as f64 * PI / bins as f64, "{degree}: {error}");
    }
}

#[test]
fn spectral_correlation_and_spectrum_are_a_pair() {
    let sample = shell(&random_directions(500, 3), |n| n[0] + 2.0 * n[1] * n[2] + (9.0 * n[2]).sin());
    let spectrum = ShellSpectrum::of(&sample, &ShellSpectrumSettings::default()).expect("enough spheres");
    let total = (1..).zip(&spectrum.power[1..]).map(|(l, p): (usize, _)| (2 * l + 1) as f64 * p).sum::<f64>()
        + spectrum.unresolved.max(0.0);
    let steps = 20_000;
    for degree in 1..=spectrum.degree_limit() {
        // ½ ∫ G P_ℓ sin γ dγ by the midpoint rule: wrong by (π/steps)²/24 times a second derivative below (2 · 11)² · π.
        let term = |k: usize| {
            let angle = PI * (k as f64 + 0.5) / steps as f64;
            spectrum.correlation(angle).expect("power") * legendre(angle.cos(), degree)[degree] * angle.sin()
        };
        let transform = 0.5 * (0..steps).map(term).sum::<f64>() * PI / steps as f64;
        assert!((transform - spectrum.power[degree] / total).abs() < 1e-6, "{degree}");
    }
}

#[test]
fn a_dipole_has_the_cosine_and_its_angles() {
    let settings =
        SyntheticSettings { disk_count: 1500, layout: DirectionLayout::Even, highest_degree: 1, ..Default::default() };
    let made = gaussian_shells(&settings, 1, |_| 1.0).expect("sound").remove(0);
    let found = correlation(&made.shell, 36);
    // Pairs at one angle average over directions to 1/√(number of spheres) at worst; bins are 5° wide, with curvature
    // (0.087)²/24. Neighbours of this lattice are 5° apart, so that the first bin has pairs near the poles only.
    for (angle, value) in found.angles.iter().zip(&found.values).skip(2) {
        assert!((value - angle.cos()).abs() < 0.03, "{angle}: {value}");
    }
    assert!((found.anticorrelation.expect("pairs").value - 1.0).abs() < 0.01);
    for crossing in &found.crossings {
        let angle = crossing.outcome.angle().expect("it falls to −1");
        assert!((angle - crossing.threshold.acos()).abs() < 0.03, "{crossing:?}");
    }
    assert_eq!(found.crossing(0.1), found.crossings[0].outcome.angle());
    let settings = ShellCorrelationSettings { thresholds: vec![-1.5], ..Default::default() };
    let never = ShellCorrelation::of(&made.shell, &settings).expect("sound").crossings[0];
    assert!(matches!(never.outcome, CrossingOutcome::Never { lowest } if lowest < -0.95));
    assert_eq!(never.standard_error, None);
}

#[test]
fn the_mean_over_fields_is_the_correlation_of_the_spectrum() {
    let spectrum = |l: f64| 1.0 / (1.0 + (l / 4.0).powf(1.5));
    let (count, highest) = (300, 24);
    let settings =
        SyntheticSettings { disk_count: count, highest_degree: highest, noise: 2.0, seed: 21, ..Default::default() };
    let made = gaussian_shells(&settings, 300, spectrum).expect("sound");
    let found: Vec<ShellCorrelation> = made.iter().map(|made| correlation(&made.shell, 36)).collect();
    let weights: Vec<f64> = (0..=highest).map(|l| (2 * l + 1) as f64 * spectrum(l as f64)).collect();
    let field = |angle: f64| {
        let values = legendre(angle.cos(), highest);
        (1..=highest).map(|l| weights[l] * values[l]).sum::<f64>()
    };
    let single = field(0.0) + 4.0;
    let n = f64::from(count as u32);
    for bin in 0..36 {
        // The mean of C over a bin, weighted by the solid angle.
        let points = (0..50).map(|k| PI * (bin as f64 + (f64::from(k) + 0.5) / 50.0) / 36.0);
        let (sum, weight) = points.fold((0.0, 0.0), |(sum, weight), a| (sum + field(a) * a.sin(), weight + a.sin()));
        let c = sum / weight;
        // ⟨δ_i δ_j⟩ = C − b_i − b_j + B, and at random directions b = (C(0) + C)/n, B = C(0)/n + 2C/n² on average.
        let exact = c - 2.0 * (single + c) / n + single / n + 2.0 * c / (n * n);
        let products: Vec<f64> =
            found.iter().zip(&made).map(|(found, made)| found.values[bin + 1] * made.shell.variance()).collect();
        let samples = products.len() as f64;
        let mean = products.iter().sum::<f64>() / samples;
        let square: f64 = products.iter().map(|x| (x - mean).powi(2)).sum();
        // Four standard errors: 36 numbers, one of 400 seeds fails by chance.
        let error = (square / (samples - 1.0) / samples).sqrt();
        assert!((mean - exact).abs() < 4.0 * error, "{bin}: {mean} ± {error}, {exact}");
    }
}

#[test]
fn the_cap_tells_g_at_pi_better_than_the_last_bin() {
    let settings = SyntheticSettings { disk_count: 300, highest_degree: 5, noise: 3.0, seed: 31, ..Default::default() };
    let made = gaussian_shells(&settings, 200, |l| l.powf(-2.0)).expect("sound");
    let square = |error: &dyn Fn(&ShellCorrelation) -> f64| -> f64 {
        made.iter()
            .map(|made| {
                let truth: f64 = (1..=5).map(|l| -(-1f64).powi(l) * (2 * l + 1) as f64 * made.power[l as usize]).sum();
                let total: f64 = (1..=5).map(|l| (2 * l + 1) as f64 * made.power[l]).sum::<f64>() + 9.0;
                (error(&correlation(&made.shell, 36)) - truth / total).powi(2)
            })
            .sum()
    };
    let cap = square(&|found| found.anticorrelation.expect("pairs").value);
    let last = square(&|found| -found.values[36]);
    // The last bin has 85 pairs; the line over 1350 pairs has the error of 340. Fields alone differ by the same in both.
    assert!(cap < 0.6 * last, "{cap} {last}");
}

#[test]
fn stated_errors_are_the_scatter_of_short_correlations() {
    // Independent values: G_b scatters as 1/√pairs, and the jackknife over blocks tells that.
    let settings = SyntheticSettings { disk_count: 400, highest_degree: 1, noise: 1.0, seed: 41, ..Default::default() };
    let found: Vec<ShellCorrelation> = gaussian_shells(&settings, 60, |_| 0.0)
        .expect("sound")
        .iter()
        .map(|made| correlation(&made.shell, 18))
        .collect();
    for bin in 1..=18 {
        let count = found.len() as f64;
        let scatter = (found.iter().map(|sample| sample.values[bin].powi(2)).sum::<f64>() / count).sqrt();
        let stated = (found.iter().map(|sample| sample.standard_errors[bin].powi(2)).sum::<f64>() / count).sqrt();
        let pairs = 1.0 / (found[0].pair_counts[bin] as f64).sqrt();
        // 60 samples tell a scatter to 9 %, four times that is 37 %. A block left out takes its pairs with others
        // twice, which raises the stated error up to √2.
        assert!((0.63..1.37).contains(&(scatter / pairs)), "{bin}: {scatter} {pairs}");
        assert!((0.63 * pairs..1.8 * pairs).contains(&stated), "{bin}: {stated} {pairs}");
    }
}

#[test]
fn rotation_keeps_pairs_and_bad_settings_are_refused() {
    let directions = random_directions(200, 5);
    let value = |n: [f64; 3]| n[0] * n[1] + n[2];
    let sample = shell(&directions, value);
    let turned: Vec<_> = directions.iter().map(|&n| super::rotated(0.77, n)).collect();
    let values: Vec<f64> = directions.iter().map(|&n| value(n)).collect();
    let other = jamscope::observe::shell::ShellSample::new(&turned, &values).expect("sound");
    let (here, there) = (correlation(&sample, 36), correlation(&other, 36));
    // No pair of this seed is within rounding of an edge.
    assert_eq!(here.pair_counts, there.pair_counts);
    assert!(here.values.iter().zip(&there.values).all(|(a, b)| (a - b).abs() < 1e-12));

    let refused = |settings: ShellCorrelationSettings| ShellCorrelation::of(&sample, &settings).expect_err("no sense");
    let usual = ShellCorrelationSettings::default();
    assert_eq!(
        refused(ShellCorrelationSettings { bin_count: 0, ..usual.clone() }),
        ShellError::NotPositive { setting: "bins", value: 0.0 }
    );
    assert_eq!(
        refused(ShellCorrelationSettings { cap: -1.0, ..usual.clone() }),
        ShellError::NotPositive { setting: "cap", value: -1.0 }
    );
    assert_eq!(
        refused(ShellCorrelationSettings { thresholds: vec![1.0], ..usual.clone() }),
        ShellError::ThresholdNotBelowOne { threshold: 1.0 }
    );
    assert!(matches!(refused(ShellCorrelationSettings { bin_count: 1 << 20, ..usual }), ShellError::TooLarge(_)));
}

/// Pairs of a shell as a plain list: cosine, product of the fluctuations, and the blocks of both spheres.
struct Pair {
    cosine: f64,
    product: f64,
    blocks: [usize; 2],
}

/// G in every bin, at π, and where it falls to the thresholds.
struct Replica {
    curve: Vec<f64>,
    opposite: f64,
    crossings: Vec<f64>,
}

/// The nearest of the twelve vertices of an icosahedron.
fn block(n: [f64; 3]) -> usize {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let mut vertices = Vec::new();
    for (one, other) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        vertices.extend([[0.0, one, other], [other, 0.0, one], [one, other, 0.0]]);
    }
    let nearest = (0..12).max_by(|&a, &b| dot(n, vertices[a]).total_cmp(&dot(n, vertices[b])));
    nearest.expect("twelve")
}

#[test]
fn stated_errors_are_those_of_blocks_left_out_one_after_the_other() {
    let (count, bins, cap) = (150, 12, PI / 6.0);
    let sample = shell(&clustered_directions(count, 12), |n| n[0] + 2.0 * n[1] * n[2] + 0.4 * (9.0 * n[2]).sin());
    let settings = ShellCorrelationSettings { bin_count: bins, thresholds: vec![0.1, 0.3], cap };
    let found = ShellCorrelation::of(&sample, &settings).expect("sound settings");
    let (n, delta) = (sample.directions(), sample.fluctuations());
    let blocks: Vec<usize> = n.iter().map(|&n| block(n)).collect();
    let mut pairs = Vec::new();
    for i in 0..count {
        for j in 0..i {
            let (cosine, product) = (dot(n[i], n[j]), delta[i] * delta[j]);
            pairs.push(Pair { cosine, product, blocks: [blocks[i], blocks[j]] });
        }
    }
    // Everything without one block, or with all for the block 12.
    let without = |left_out: usize| -> Replica {
        let others: Vec<&Pair> = pairs.iter().filter(|pair| !pair.blocks.contains(&left_out)).collect();
        let rest: Vec<f64> = (0..count).filter(|&i| blocks[i] != left_out).map(|i| delta[i] * delta[i]).collect();
        let variance = rest.iter().sum::<f64>() / rest.len() as f64;
        let mean = |chosen: &dyn Fn(&Pair) -> bool, value: &dyn Fn(&Pair) -> f64| -> f64 {
            let chosen: Vec<f64> = others.iter().filter(|pair| chosen(pair)).map(|pair| value(pair)).collect();
            chosen.iter().sum::<f64>() / chosen.len() as f64
        };
        let bin = |pair: &Pair| ((pair.cosine.acos() / PI * bins as f64) as usize).min(bins - 1);
        let mut curve: Vec<f64> = vec![1.0];
        curve.extend((0..bins).map(|k| mean(&|pair| bin(pair) == k, &|pair| pair.product) / variance));
        // The straight line through the cap, by means and covariances.
        let inside = |pair: &Pair| pair.cosine.acos() >= PI - cap;
        let [u, p] = [mean(&inside, &|pair| 1.0 + pair.cosine), mean(&inside, &|pair| pair.product)];
        let slope = mean(&inside, &|pair| (1.0 + pair.cosine - u) * (pair.product - p))
            / mean(&inside, &|pair| (1.0 + pair.cosine - u).powi(2));
        let crossings = settings.thresholds.iter().map(|threshold| {
            let k = (1..=bins).find(|&k| curve[k] <= *threshold).expect("it falls below");
            let share = (curve[k - 1] - threshold) / (curve[k - 1] - curve[k]);
            found.angles[k - 1] + share * (found.angles[k] - found.angles[k - 1])
        });
        let crossings = crossings.collect();
        Replica { curve, opposite: (p - slope * u) / variance, crossings }
    };
    let all = without(12);
    let replicas: Vec<Replica> = (0..12).map(without).collect();
    let scatter = |value: &dyn Fn(&Replica) -> f64| {
        let mean = replicas.iter().map(value).sum::<f64>() / 12.0;
        (11.0 / 12.0 * replicas.iter().map(|replica| (value(replica) - mean).powi(2)).sum::<f64>()).sqrt()
    };
    // Sums of up to 11175 products of order 1, whose differences keep nine digits and more.
    let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
    for bin in 1..=bins {
        assert!(close(found.values[bin], all.curve[bin]), "{bin}");
        let error = scatter(&|replica| replica.curve[bin]);
        assert!(close(found.standard_errors[bin], error), "{bin}: {} {error}", found.standard_errors[bin]);
    }
    let anticorrelation = found.anticorrelation.expect("pairs in the cap");
    assert_eq!(anticorrelation.pair_count, pairs.iter().filter(|pair| pair.cosine.acos() >= PI - cap).count());
    assert!(close(anticorrelation.value, -all.opposite), "{anticorrelation:?} {}", all.opposite);
    let error = scatter(&|replica| replica.opposite);
    assert!(close(anticorrelation.standard_error.expect("twelve blocks"), error), "{anticorrelation:?} {error}");
    for (k, crossing) in found.crossings.iter().enumerate() {
        assert!(close(crossing.outcome.angle().expect("it falls"), all.crossings[k]), "{crossing:?}");
        let error = scatter(&|replica| replica.crossings[k]);
        assert!(close(crossing.standard_error.expect("every replica falls"), error), "{crossing:?} {error}");
    }
}

#[test]
fn a_bin_is_at_the_mean_angle_of_uniform_directions() {
    let found = correlation(&shell(&random_directions(40, 3), |n| n[0]), 9);
    for bin in 0..9 {
        // ∫ γ sin γ = sin γ − γ cos γ, ∫ sin γ = −cos γ.
        let [low, high] = [bin, bin + 1].map(|edge| PI * f64::from(edge) / 9.0);
        let integral = (high.sin() - high * high.cos()) - (low.sin() - low * low.cos());
        let exact = integral / (low.cos() - high.cos());
        // Differences of numbers up to π, over 0.06.
        assert!((found.angles[bin as usize + 1] - exact).abs() < 1e-13, "{bin}");
    }
}

#[test]
fn more_spheres_than_can_be_paired_are_refused_at_once() {
    let count = MOST_PAIRED + 1;
    let sample = shell(&random_directions(count, 1), |n| n[0]);
    let refused = ShellCorrelation::of(&sample, &ShellCorrelationSettings::default()).expect_err("some minutes");
    let ShellError::TooLarge(refused) = refused else { panic!("{refused}") };
    assert_eq!((refused.value, refused.limit), (count, MOST_PAIRED as u64));
}
