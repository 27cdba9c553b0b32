use jamscope::fit::ensemble::{
    CollapseOutcome, CollapseSettings, Curve, EnsembleFitError, MeasuredPoint, bootstrap_all, collapse,
    collapse_quality,
};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::normal;

/// a and b of x N^a d_0^(−b).
const TRUTH: [f64; 2] = [1.5, 0.75];

/// Six curves y = tanh(u) about u = ln(x N^a d_0^(−b)) = 0, `count` points each over |u| < 2.5, without noise.
fn curves(count: i32, error: f64) -> Vec<Curve<2>> {
    let mut all = Vec::new();
    for size in [512.0, 1024.0, 4096.0f64] {
        for inflation in [0.05, 0.2f64] {
            let scales = [size.ln(), -inflation.ln()];
            let shift = TRUTH[0] * scales[0] + TRUTH[1] * scales[1];
            let point = |i: i32| {
                // Every curve has its points elsewhere.
                let u = 5.0 * (f64::from(i) + 0.1 * all.len() as f64) / f64::from(count) - 2.5;
                MeasuredPoint { x: (u - shift).exp(), y: u.tanh(), error }
            };
            let points = (0..count).map(point).collect();
            all.push(Curve { scales, points });
        }
    }
    all
}

fn noisy(mut curves: Vec<Curve<2>>, random: &mut Pcg64) -> Vec<Curve<2>> {
    for point in curves.iter_mut().flat_map(|curve| &mut curve.points) {
        point.y += point.error * normal(random);
    }
    curves
}

/// 0 to 3 each: the truth is not on the grid of 26 points.
fn settings() -> CollapseSettings<2> {
    CollapseSettings { ranges: [[0.0, 3.0], [0.0, 2.0]], grid_points: 26, least_share: 0.5 }
}

fn exponents(curves: &[Curve<2>]) -> [f64; 2] {
    let outcome = collapse(curves, &settings()).expect("usable");
    outcome.exponents().unwrap_or_else(|| panic!("{outcome:?}"))
}

#[test]
fn curves_without_noise_give_their_exponents() {
    // A line between points 0.0625 apart errs by h²/8 |tanh''| < 4e-4, of which shifts of one sign take a small share; the least
    // difference in shift between curves is 0.69 a and 1.39 b.
    let found = exponents(&curves(80, 0.01));
    assert!((found[0] - TRUTH[0]).abs() < 1e-3 && (found[1] - TRUTH[1]).abs() < 1e-3, "{found:?}");
}

#[test]
fn one_exponent_alone_is_found() {
    // d_0 taken out beforehand.
    let one: Vec<Curve<1>> = curves(80, 0.01)
        .into_iter()
        .map(|curve| {
            let factor = (TRUTH[1] * curve.scales[1]).exp();
            let points = curve.points.iter().map(|p| MeasuredPoint { x: p.x * factor, ..*p }).collect();
            Curve { scales: [curve.scales[0]], points }
        })
        .collect();
    let outcome = collapse(&one, &CollapseSettings::default()).expect("usable");
    let CollapseOutcome::Found(found) = outcome else { panic!("{outcome:?}") };
    assert!((found.exponents[0] - TRUTH[0]).abs() < 1e-3 && found.quality.quality < 0.01, "{found:?}");
    let [Some(low), Some(high)] = found.rough[0] else { panic!("{found:?}") };
    // At the ends S is 1 above the least: that is what they are.
    for end in [low, high] {
        let there = collapse_quality(&one, [end]).expect("usable").expect("overlap").quality;
        assert!((there - found.quality.quality - 1.0).abs() < 0.1, "{there} at {end}: {found:?}");
    }
    assert!(low < TRUTH[0] && TRUTH[0] < high);
}

#[test]
fn honest_noise_has_a_quality_of_one() {
    // (y − Y)²/(dy² + dY²) has mean 1 where the line errs by much less than dy: h²/8 = 0.002 of 0.05. Of about 230 terms, each
    // together with about 11 others by shared points, the mean of 200 draws scatters by √(2·12/230/200) = 0.023 at the most.
    let mut random = Pcg64::seed_from_u64(2);
    let draws = (0..200).map(|_| {
        let drawn = noisy(curves(40, 0.05), &mut random);
        collapse_quality(&drawn, TRUTH).expect("usable").expect("overlap").quality
    });
    let mean = draws.sum::<f64>() / 200.0;
    assert!((mean - 1.0).abs() < 0.069, "{mean}");
    // Exponents that are wrong are seen to be.
    let wrong = collapse_quality(&noisy(curves(40, 0.05), &mut random), [1.3, 0.75]).expect("usable").expect("overlap");
    assert!(wrong.quality > 3.0, "{wrong:?}");
}

#[test]
fn exponents_of_noisy_curves_are_within_bootstrap_errors() {
    // 16 samples of every curve, of noise 0.2 each: means of error 0.05. The bootstrap draws samples, makes means and errors anew.
    let mut random = Pcg64::seed_from_u64(6);
    let samples: Vec<Vec<Curve<2>>> = (0..16).map(|_| noisy(curves(20, 0.2), &mut random)).collect();
    let sizes = [16; 6];
    let narrow = CollapseSettings { ranges: [[1.0, 2.0], [0.25, 1.25]], grid_points: 11, least_share: 0.5 };
    let found = bootstrap_all(&sizes, 60, |groups| {
        let means: Vec<Curve<2>> = groups
            .iter()
            .enumerate()
            .map(|(index, drawn)| {
                let points = (0..20).map(|i| {
                    let values: Vec<f64> = drawn.iter().map(|&s| samples[s][index].points[i].y).collect();
                    let y = values.iter().sum::<f64>() / 16.0;
                    let error = (values.iter().map(|v| (v - y) * (v - y)).sum::<f64>() / 15.0 / 16.0).sqrt();
                    MeasuredPoint { y, error, ..samples[0][index].points[i] }
                });
                Curve { scales: samples[0][index].scales, points: points.collect() }
            })
            .collect();
        collapse(&means, &narrow).ok()?.exponents().map(|exponents| exponents.to_vec())
    });
    let found = found.expect("a collapse");
    for (interval, truth) in found.iter().zip(TRUTH) {
        let error = interval.standard_error.expect("few fail");
        // Of order 0.05/√(20·5)/slope/(range of ln N): a few hundredths. Three standard errors: fails once in 370 seeds.
        assert!((interval.best - truth).abs() < 3.0 * error && error < 0.05 && error > 1e-3, "{truth}: {interval:?}");
    }
}

#[test]
fn curves_torn_apart_are_no_collapse() {
    // Humps: where only their tails are held against each other, S is less than at the truth, where lines err at the top.
    let humps = [1.0, 2.0, 3.0].map(|scale: f64| {
        let point = |i: i32| {
            let u = 0.1 * (f64::from(i) + 0.3 * scale);
            MeasuredPoint { x: (u - 0.5 * scale).exp(), y: u.cosh().recip(), error: 0.05 }
        };
        Curve { scales: [scale], points: (-60..=60).map(point).collect() }
    });
    let wide = CollapseSettings { ranges: [[-15.0, 16.5]], grid_points: 201, ..CollapseSettings::default() };
    let found = collapse(&humps, &wide).expect("usable").exponents();
    assert!(found.is_some_and(|[a]| (a - 0.5).abs() < 1e-3), "{found:?}");
    let torn = collapse(&humps, &CollapseSettings { least_share: 0.01, ..wide }).expect("usable").exponents();
    assert!(torn.is_some_and(|[a]| (a - 0.5).abs() > 5.0), "{torn:?}");
}

#[test]
fn order_and_units_do_not_matter() {
    let plain = noisy(curves(20, 0.05), &mut Pcg64::seed_from_u64(4));
    let best = exponents(&plain);
    let mut turned: Vec<Curve<2>> = plain.iter().rev().cloned().collect();
    turned.iter_mut().for_each(|curve| curve.points.reverse());
    let scaled: Vec<Curve<2>> = plain
        .iter()
        .map(|curve| {
            let points = curve.points.iter();
            let points = points.map(|p| MeasuredPoint { x: 1e3 * p.x, y: -7.0 * p.y, error: 7.0 * p.error }).collect();
            Curve { points, ..curve.clone() }
        })
        .collect();
    let at = |curves: &[Curve<2>]| collapse_quality(curves, [1.45, 0.8]).expect("usable").expect("overlap");
    for other in [turned, scaled] {
        // Sums of a few hundred terms in another order: 1e-12; the search ends at 1e-7 of a range, S flat to 1e-13 there.
        let (ours, theirs) = (at(&plain), at(&other));
        assert!((ours.quality / theirs.quality - 1.0).abs() < 1e-11 && ours.point_count == theirs.point_count);
        let found = exponents(&other);
        assert!((found[0] - best[0]).abs() < 1e-5 && (found[1] - best[1]).abs() < 1e-5, "{found:?} {best:?}");
    }
}

#[test]
fn the_quality_of_three_lines_is_that_worked_out_by_hand() {
    // At u = 0 a point y = 2, dy = 1; beside it a pair (−1, 0), (1, 2), dy = 1: Y = 1, dY² = 1/2: (2 − 1)²/(1 + 1/2) = 2/3.
    // The points of the pair lie between none.
    let point = |u: f64, y: f64| MeasuredPoint { x: u.exp(), y, error: 1.0 };
    let one = Curve { scales: [0.0], points: vec![point(0.0, 2.0)] };
    let pair = Curve { scales: [1.0], points: vec![point(-1.0, 0.0), point(1.0, 2.0)] };
    let found = collapse_quality(&[one.clone(), pair.clone()], [0.0]).expect("usable").expect("overlap");
    assert!((found.quality - 2.0 / 3.0).abs() < 1e-14 && (found.point_count, found.of_count) == (1, 3));
    // Two pairs: four points, Y = 1, dY² = 1/4; each point of a pair lies on the other's line at its end: Y = y, and adds 0.
    let found = collapse_quality(&[one, pair.clone(), pair.clone()], [0.0]).expect("usable").expect("overlap");
    assert!((found.quality - 0.8 / 5.0).abs() < 1e-14 && found.point_count == 5, "{found:?}");
    // Shifted by 3 they have nothing in common.
    assert_eq!(collapse_quality(&[pair.clone(), Curve { scales: [4.0], ..pair }], [1.0]), Ok(None));
}

#[test]
fn every_outcome_has_its_data() {
    let all = curves(20, 0.05);
    let outside = CollapseSettings { ranges: [[1.6, 3.0], [0.0, 2.0]], ..settings() };
    let edge = collapse(&all, &outside).expect("usable");
    assert!(matches!(edge, CollapseOutcome::AtEdge { exponent: 0, exponents, .. } if exponents[0] == 1.6), "{edge:?}");
    // Sizes alone, torn apart by factors of 2^20 and more.
    let sizes: Vec<Curve<1>> =
        [0, 2, 4].map(|i| Curve { scales: [all[i].scales[0]], points: all[i].points.clone() }).into();
    let far = CollapseSettings { ranges: [[20.0, 30.0]], ..CollapseSettings::default() };
    assert_eq!(collapse(&sizes, &far), Ok(CollapseOutcome::NoOverlap { largest_share: 0.0 }));
    // The outermost points have nothing beyond them.
    let strict = CollapseSettings { least_share: 1.0, ..settings() };
    let torn = collapse(&all, &strict).expect("usable");
    assert!(matches!(torn, CollapseOutcome::NoOverlap { largest_share } if largest_share > 0.9), "{torn:?}");
}

#[test]
fn what_cannot_be_used_is_refused() {
    let all = curves(5, 0.1);
    for bad in [
        CollapseSettings { ranges: [[1.0, 1.0], [0.0, 1.0]], ..settings() },
        CollapseSettings { ranges: [[0.0, f64::INFINITY], [0.0, 1.0]], ..settings() },
        CollapseSettings { grid_points: 2, ..settings() },
        CollapseSettings { grid_points: 5000, ..settings() },
        CollapseSettings { least_share: 0.0, ..settings() },
    ] {
        assert!(matches!(collapse(&all, &bad), Err(EnsembleFitError::SettingOutOfRange { .. })), "{bad:?}");
    }
    let few = collapse(&all[..1], &settings());
    assert_eq!(few, Err(EnsembleFitError::TooFewCurves { curve_count: 1 }));
    let mut broken = all.clone();
    broken[2].points[3].x = 0.0;
    let refused = collapse(&broken, &settings());
    assert!(matches!(refused, Err(EnsembleFitError::PointUnusable { point: 3, .. })), "{refused:?}");
    broken[1].scales[0] = f64::NEG_INFINITY;
    assert!(matches!(collapse(&broken, &settings()), Err(EnsembleFitError::ScaleUnusable { curve: 1, .. })));
}
