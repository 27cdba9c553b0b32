use jamscope::observe::angular::Leakage;
use jamscope::observe::shell::{
    DegreeLimit, MOST_DEGREES, ShellAnalysis, ShellError, ShellSample, ShellSettings, ShellSpectrum,
    ShellSpectrumSettings, ShellWindow,
};
use jamscope::vector::{dot, larger};

use super::{clustered_directions, field, legendre, random_directions, rotated, shell, up_to};

/// Values without any order.
fn rough(k: usize) -> f64 {
    (k as f64 * 1.7).sin() + 0.3 * (k as f64 * 0.31).cos()
}

#[test]
fn powers_are_the_sums_over_all_pairs() {
    let directions = clustered_directions(150, 3);
    let values: Vec<f64> = (0..150).map(rough).collect();
    let sample = ShellSample::new(&directions, &values).expect("sound");
    let spectrum = ShellSpectrum::of(&sample, &up_to(11, Leakage::Kept)).expect("enough spheres");
    let (n, delta) = (sample.directions(), sample.fluctuations());
    let mut sums = [0.0; 12];
    for i in 0..150 {
        for j in 0..150 {
            for (sum, value) in sums.iter_mut().zip(legendre(dot(n[i], n[j]), 11)) {
                *sum += delta[i] * delta[j] * value / 22500.0;
            }
        }
    }
    // Sums of 22500 products of at most 2.3²/22500, each wrong by some ℓ² = 121 roundings: 5.3 · 121 · 10⁻¹⁶ = 7·10⁻¹⁴.
    for degree in 1..=11 {
        assert!((spectrum.power[degree] - sums[degree]).abs() < 7e-14, "{degree}");
    }
}

#[test]
fn the_window_is_the_mean_over_amplitudes() {
    // ⟨δ_i δ_j⟩ of a field with the correlation C_ij is C_ij − b_i − b_j + B, b_i = n⁻¹ Σ_j C_ij: summed directly, for
    // single degrees inside and above the range, and for single spheres, C_ij = 1 for i = j.
    let (count, limit) = (90, 6);
    let directions = clustered_directions(count, 8);
    let sample = shell(&directions, |n| n[0]);
    let window = ShellWindow::new(&sample, limit, 15).expect("few degrees");
    let n = sample.directions();
    let of = |correlation: &dyn Fn(usize, usize) -> f64, degree: usize| {
        let mean = |i: usize| (0..count).map(|j| correlation(i, j)).sum::<f64>() / count as f64;
        let means: Vec<f64> = (0..count).map(mean).collect();
        let all = means.iter().sum::<f64>() / count as f64;
        let mut sum = 0.0;
        for i in 0..count {
            for j in 0..count {
                let covariance = correlation(i, j) - means[i] - means[j] + all;
                sum += covariance * legendre(dot(n[i], n[j]), degree)[degree];
            }
        }
        sum / (count * count) as f64
    };
    for degree in 1..=limit {
        for source in [1, 2, 5, 6, 11, 15] {
            let correlation = |i: usize, j: usize| (2 * source + 1) as f64 * legendre(dot(n[i], n[j]), source)[source];
            let error = window.coupling(degree, source) - of(&correlation, degree);
            // Numbers of at most 31 · 4, with some 15² roundings each.
            assert!(error.abs() < 3e-12, "K {degree} {source}: {error}");
        }
        let single = |i: usize, j: usize| f64::from(u8::from(i == j));
        assert!((window.white(degree) - of(&single, degree)).abs() < 1e-13, "N {degree}");
    }
}

#[test]
fn one_harmonic_at_even_directions_has_one_power() {
    // 2000 directions of a Fibonacci lattice: the sum of a harmonic of degree ℓ ≤ 44 over them is not zero but of order
    // 1/n away from the poles; with leakage removed, ℓ = 3 keeps its power whatever the order.
    let count = 2000;
    let even: Vec<_> = (0..count)
        .map(|k| {
            let (z, angle) = (1.0 - (2 * k + 1) as f64 / f64::from(count), 2.399963229728653 * f64::from(k));
            let across = (1.0 - z * z).sqrt();
            [across * angle.cos(), across * angle.sin(), z]
        })
        .collect();
    // √15/2 z (x² − y²), R_32 = √(15)/2: its mean square is 1/7.
    let sample = shell(&even, |n| 0.5 * 15f64.sqrt() * n[2] * (n[0] * n[0] - n[1] * n[1]));
    for leakage in [Leakage::Kept, Leakage::Removed] {
        let spectrum = ShellSpectrum::of(&sample, &up_to(20, leakage)).expect("enough spheres");
        // Σ (2ℓ+1) P = V = 1/7, so P_3 = 1/49. Riemann sums over n points of this lattice are wrong by some ℓ²/n = 0.01.
        assert!((spectrum.power[3] * 49.0 - 1.0).abs() < 0.01, "{}", spectrum.power[3] * 49.0);
        let others = (1..=20).filter(|&degree| degree != 3);
        assert!(others.map(|degree| spectrum.power[degree].abs()).fold(0.0, larger) < 0.01 / 49.0);
        // G(γ) = P_3(cos γ), thus −1 at γ = π, and zero at cos γ = √(3/5).
        let at = |angle: f64| spectrum.correlation(angle).expect("power");
        let exact = |angle: f64| legendre(angle.cos(), 3)[3];
        for angle in [0.4, 1.0, 2.0, std::f64::consts::PI] {
            assert!((at(angle) - exact(angle)).abs() < 0.03, "{angle}: {} {}", at(angle), exact(angle));
        }
    }
}

#[test]
fn removing_leakage_leaves_every_degree_where_it_was() {
    // The expected power of a field of one degree at clustered directions, mixed by the window, is that degree alone
    // again: the mean over all orders of a degree is the expected power. 2ℓ+1 rotations of one zonal harmonic do not
    // average exactly, so the powers are those of the window, and what is tested is that P is linear in them: see
    // `fields` for the mean over fields.
    let directions = clustered_directions(400, 5);
    let sample = shell(&directions, |n| n[2]);
    let kept = ShellSpectrum::of(&sample, &up_to(9, Leakage::Kept)).expect("enough spheres");
    let removed = ShellSpectrum::of(&sample, &up_to(9, Leakage::Removed)).expect("enough spheres");
    let window = ShellWindow::new(&sample, 9, 9).expect("few degrees");
    // K P + ρ N gives back the measured powers, and the variance: rounding times a condition below 10³.
    let mixed = window.expected(&removed.power[1..], removed.unresolved);
    for degree in 1..=9 {
        assert!((mixed[degree - 1] - kept.power[degree]).abs() < 1e-12 * kept.variance);
    }
    let modes = (1..=9).map(|l| (2 * l + 1) as f64 * removed.power[l] * window.variance_share(l)).sum::<f64>();
    let variance = modes + removed.unresolved * (1.0 - 1.0 / 400.0);
    assert!((variance / kept.variance - 1.0).abs() < 1e-12);
    assert_eq!(removed.negative_count, removed.power.iter().filter(|&&power| power < 0.0).count());
}

#[test]
fn rotation_changes_nothing_beyond_rounding_and_order_no_bit() {
    let directions = clustered_directions(300, 4);
    let values: Vec<f64> = (0..300).map(rough).collect();
    let settings = ShellSpectrumSettings::default();
    let spectrum = |directions: &[_], values: &[f64]| {
        ShellSpectrum::of(&ShellSample::new(directions, values).expect("sound"), &settings).expect("sound")
    };
    let here = spectrum(&directions, &values);
    let turned: Vec<_> = directions.iter().map(|&n| rotated(1.234, n)).collect();
    let there = spectrum(&turned, &values);
    // A rotation rounds cosines by 4·10⁻¹⁶, P_ℓ' ≤ ℓ²: 10⁻¹⁴ of the variance, times the condition of the removal, below 10³.
    for (a, b) in here.power.iter().zip(&there.power) {
        assert!((a - b).abs() < 1e-11 * here.variance);
    }
    let reversed: Vec<_> = directions.iter().rev().copied().collect();
    let backward: Vec<f64> = values.iter().rev().copied().collect();
    assert_eq!(here, spectrum(&reversed, &backward));
}

#[test]
fn the_default_has_four_spheres_for_each_harmonic() {
    for (count, degree) in [(16, 2), (100, 5), (400, 10), (5000, 35)] {
        let sample = shell(&random_directions(count, 1), |n| n[0] + n[1] * n[2]);
        let spectrum = ShellSpectrum::of(&sample, &ShellSpectrumSettings::default()).expect("sound");
        assert_eq!(spectrum.degree_limit(), degree);
    }
}

#[test]
fn what_has_no_shell_says_why() {
    let directions = random_directions(40, 2);
    let values: Vec<f64> = (0..40).map(rough).collect();
    let error = |result: Result<ShellSample, ShellError>| result.expect_err("no sense");
    assert_eq!(
        error(ShellSample::new(&directions[1..], &values)),
        ShellError::LengthsDiffer { direction_count: 39, value_count: 40 }
    );
    assert_eq!(error(ShellSample::new(&directions[..15], &values[..15])), ShellError::TooFewDisks { disk_count: 15 });
    assert_eq!(
        error(ShellSample::new(&directions, &[0.1; 40])),
        ShellError::NoFluctuation { disk_count: 40, mean: values.iter().map(|_| 0.1).sum::<f64>() / 40.0 }
    );
    let mut broken = directions.clone();
    broken[7] = [0.0; 3];
    assert!(matches!(error(ShellSample::new(&broken, &values)), ShellError::NotFinite { disk: 7, .. }));
    broken[7] = [f64::NAN, 0.0, 1.0];
    assert!(matches!(error(ShellSample::new(&broken, &values)), ShellError::NotFinite { disk: 7, .. }));

    let sample = ShellSample::new(&directions, &values).expect("sound");
    let limit = |degree_limit| {
        ShellSpectrum::of(&sample, &ShellSpectrumSettings { degree_limit, leakage: Leakage::Removed }).map(drop)
    };
    let out = |degree_limit| Err(ShellError::DegreeLimitOutOfRange { degree_limit, disk_count: 40, highest: 5 });
    assert_eq!(limit(DegreeLimit::Fixed(0)), out(0));
    assert_eq!(limit(DegreeLimit::Fixed(6)), out(6));
    assert!(matches!(limit(DegreeLimit::PerRoot(f64::NAN)), Err(ShellError::NotPositive { .. })));
    // Twenty directions twice: their 16 harmonics up to ℓ = 3 can be separated, those of two directions cannot.
    let two: Vec<_> = (0..40).map(|k| directions[k % 2]).collect();
    let poor = ShellSample::new(&two, &values).expect("sound");
    let found = ShellSpectrum::of(&poor, &up_to(5, Leakage::Removed));
    assert_eq!(found, Err(ShellError::NotSeparable { disk_count: 40, degree_limit: 5 }));
}

#[test]
fn the_shell_of_a_field_holds_the_spheres_of_its_radii_that_count() {
    // 100 directions at each of five distances; R = 20, so the shell 0.5 ± 0.03 goes from 9.4 to 10.6.
    let directions = random_directions(100, 6);
    let distances = [9.3, 9.5, 10.0, 10.5, 10.7];
    let positions: Vec<_> = distances.iter().flat_map(|r| directions.iter().map(move |n| n.map(|x| r * x))).collect();
    let mut field = field(&positions, 20.0, |x| 1e-3 * x[2] / dot(x, x).sqrt());
    for disk in &mut field.disks {
        // Every tenth sphere is a rattler; one of them moved far.
        disk.counted = disk.disk % 10 != 0;
        if disk.disk == 200 {
            disk.radial = 5.0;
        }
    }
    let settings = ShellSettings::default();
    let found = ShellAnalysis::of(&field, 0.5, 0.03, &settings).expect("270 spheres");
    assert_eq!((found.disk_count, found.spectrum.degree_limit()), (270, 8));
    // A dipole: all power at ℓ = 1, with leakage removed to the error of a few hundred directions, √(2/3)/√n.
    let relative = found.spectrum.normalised().expect("power");
    assert!(relative[2..].iter().all(|power| power.abs() < 0.05), "{relative:?}");
    // z² scatters by 0.9 of its mean, and some 200 spheres have an opposite one in the cap.
    assert!((found.correlation.anticorrelation.expect("pairs").value - 1.0).abs() < 0.2);
    let text = serde_json::to_string(&found).expect("plain data");
    assert_eq!(serde_json::from_str::<ShellAnalysis>(&text).expect("the same"), found);
    assert_eq!(
        ShellAnalysis::of(&field, 0.5, 0.0, &settings),
        Err(ShellError::ShellOutOfRange { relative_radius: 0.5, half_width: 0.0 })
    );
    assert_eq!(ShellAnalysis::of(&field, 0.9, 0.03, &settings), Err(ShellError::TooFewDisks { disk_count: 0 }));
    let written = serde_json::to_string(&settings).expect("plain data");
    assert_eq!(serde_json::from_str::<ShellSettings>(&written).expect("the same"), settings);
    settings.check().expect("sound settings");
}

/// The inverse of a matrix, by elimination with pivots.
fn inverse(mut rows: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = rows.len();
    for (k, row) in rows.iter_mut().enumerate() {
        row.extend((0..n).map(|j| if j == k { 1.0 } else { 0.0 }));
    }
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs())).expect("rows left");
        rows.swap(k, pivot);
        let top = rows[k].iter().map(|x| x / rows[k][k]).collect::<Vec<f64>>();
        for (_, row) in rows.iter_mut().enumerate().filter(|&(j, _)| j != k) {
            let factor = row[k];
            row.iter_mut().zip(&top).for_each(|(x, y)| *x -= factor * y);
        }
        rows[k] = top;
    }
    rows.into_iter().map(|row| row[n..].to_vec()).collect()
}

#[test]
fn stated_errors_are_those_of_normal_amplitudes_times_the_response() {
    let (count, limit) = (200, 7);
    let directions = clustered_directions(count, 15);
    let sample = shell(&directions, |n| n[0] + 2.0 * n[1] * n[2] + (9.0 * n[2]).sin());
    let kept = ShellSpectrum::of(&sample, &up_to(limit, Leakage::Kept)).expect("enough spheres");
    let removed = ShellSpectrum::of(&sample, &up_to(limit, Leakage::Removed)).expect("enough spheres");
    let window = ShellWindow::new(&sample, limit, limit).expect("few degrees");
    // K P + ρ N = P measured; Σ (2g+1) (1 − B_g) P_g + ρ (1 − 1/n) = V.
    let mut rows: Vec<Vec<f64>> =
        (1..=limit).map(|l| (1..=limit).map(|g| window.coupling(l, g)).chain([window.white(l)]).collect()).collect();
    let shares = (1..=limit).map(|g| (2 * g + 1) as f64 * window.variance_share(g));
    rows.push(shares.chain([1.0 - 1.0 / count as f64]).collect());
    let inverse = inverse(rows);
    assert_eq!((kept.standard_errors[0], removed.standard_errors[0]), (0.0, 0.0));
    let mut farthest = 0.0;
    for l in 1..=limit {
        // A mean of 2ℓ+1 squares of normal amplitudes.
        let error = (2.0 / (2 * l + 1) as f64).sqrt() * kept.power[l];
        assert!((kept.standard_errors[l] / error - 1.0).abs() < 1e-14, "{l}");
        let response = inverse[l - 1][l - 1].abs();
        farthest = larger(farthest, (response - 1.0).abs());
        assert!((removed.standard_errors[l] / (error * response) - 1.0).abs() < 1e-11, "{l}");
    }
    // At clustered directions the response differs from 1, which this test needs.
    assert!(farthest > 0.02, "{farthest}");
}

#[test]
fn a_slightly_negative_rest_counts_as_none_in_the_correlation() {
    let sample = shell(&random_directions(100, 2), |n| n[0]);
    let mut spectrum = ShellSpectrum::of(&sample, &up_to(2, Leakage::Kept)).expect("enough spheres");
    spectrum.power = vec![0.0, 0.1, 0.02];
    // Σ (2ℓ+1) P = 0.4; a twentieth of it is 0.02.
    for (unresolved, at_zero) in [(0.1, 0.8), (0.0, 1.0), (-0.019, 1.0), (-0.021, 0.4 / 0.379), (-0.2, 2.0)] {
        spectrum.unresolved = unresolved;
        let found = spectrum.correlation(0.0).expect("positive");
        assert!((found - at_zero).abs() < 1e-14, "{unresolved}: {found}");
    }
    spectrum.unresolved = -0.41;
    assert_eq!(spectrum.correlation(0.0), None);
}

#[test]
fn more_degrees_than_the_recursion_takes_are_refused_at_once() {
    let highest = MOST_DEGREES / 2;
    let sample = shell(&random_directions((highest + 2) * (highest + 2), 1), |n| n[0]);
    let refused = ShellSpectrum::of(&sample, &up_to(highest + 1, Leakage::Kept)).expect_err("an overflow");
    let ShellError::TooLarge(refused) = refused else { panic!("{refused}") };
    assert_eq!((refused.value, refused.limit), (highest + 1, highest as u64));
}

#[test]
fn degrees_that_a_small_cap_hardly_separates_are_refused() {
    // In a cap of angle α, 1 − P_1 = α²/2 and 1 − P_2 = 3 α²/2 differ in shape only by terms of α⁴. Both are squared in
    // the window, so the response of a power to another grows as α⁻⁸, by a factor of 256 from one cap to the next.
    let within = |angle: f64| {
        let squeezed = |n: &[f64; 3]| [angle * n[0], angle * n[1], 1.0];
        let directions: Vec<_> = random_directions(60, 9).iter().map(squeezed).collect();
        let values: Vec<f64> = (0..60).map(rough).collect();
        let sample = ShellSample::new(&directions, &values).expect("sound");
        ShellSpectrum::of(&sample, &up_to(2, Leakage::Removed)).map(drop)
    };
    assert_eq!(within(0.2), Ok(()));
    assert_eq!(within(0.1), Err(ShellError::NotSeparable { disk_count: 60, degree_limit: 2 }));
}
