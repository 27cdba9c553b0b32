use jamscope::fit::ensemble::{EnsembleFitError, HalfCrossing, HitCount, Trend, half_crossing, half_crossing_interval};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::expected;

fn probability(x: f64, crossing: f64, width: f64) -> f64 {
    1.0 / (1.0 + ((x - crossing) / width).exp())
}

fn counts(groups: &[[f64; 3]]) -> Vec<HitCount> {
    groups.iter().map(|&[x, hits, count]| HitCount { x, hits, count }).collect()
}

fn falling(groups: &[[f64; 3]]) -> HalfCrossing {
    half_crossing(&counts(groups), Trend::Falling).expect("usable")
}

#[test]
fn expected_counts_give_back_crossing_and_width() {
    // The gradient of ln L vanishes at the truth; Newton ends where ln L is within 1e-15 of its maximum, quadratically closer.
    for (crossing, width) in [(0.0, 1.0), (0.7, 0.2), (-2.3, 1.5), (1.9, 0.1)] {
        for (shift, scale) in [(0.0, 1.0), (300.0, 1.0), (-0.4, 1e-3), (0.0, 1e6)] {
            for trend in [Trend::Falling, Trend::Rising] {
                let groups: Vec<HitCount> = (-6..=6)
                    .map(|i| {
                        let (z, count) = (0.5 * f64::from(i), f64::from(10 + i));
                        let fall = probability(z, crossing, width);
                        let share = if trend == Trend::Falling { fall } else { probability(-z, -crossing, width) };
                        HitCount { x: shift + scale * z, hits: count * share, count }
                    })
                    .collect();
                let found = half_crossing(&groups, trend).expect("usable");
                let HalfCrossing::Found { crossing: at, width: w, extrapolated, .. } = found else {
                    panic!("{found:?}")
                };
                // 300 + z itself is rounded by 300·2⁻⁵³/width.
                assert!((at.value - shift - scale * crossing).abs() < 1e-9 * scale, "{crossing} {width}: {found:?}");
                assert!((w / (scale * width) - 1.0).abs() < 1e-8 && !extrapolated, "{crossing} {width}: {found:?}");
            }
        }
    }
}

#[test]
fn both_intervals_cover_the_crossing() {
    // 8 groups of 20. Two standard errors: 95.4 %; the bootstrap, with 1/20 less variance and what the fit is biased by: 93 to 96 %.
    let (crossing, width, ensembles) = (0.13, 0.4, 400);
    let mut random = Pcg64::seed_from_u64(3);
    let (mut by_information, mut by_bootstrap) = (0, 0);
    for _ in 0..ensembles {
        let groups: Vec<(f64, Vec<bool>)> = (0..8)
            .map(|i| {
                let x = -1.75 + 0.5 * f64::from(i);
                (x, (0..20).map(|_| random.random::<f64>() < probability(x, crossing, width)).collect())
            })
            .collect();
        let of = |hits: &[bool]| hits.iter().filter(|&&hit| hit).count() as f64;
        let seen: Vec<[f64; 3]> = groups.iter().map(|(x, hits)| [*x, of(hits), 20.0]).collect();
        let HalfCrossing::Found { crossing: at, .. } = falling(&seen) else { panic!("{seen:?}") };
        by_information += usize::from((at.value - crossing).abs() <= 2.0 * at.standard_error);
        let interval = half_crossing_interval(&groups, Trend::Falling, 300).expect("usable").expect("a crossing");
        assert_eq!(interval.best, at.value);
        by_bootstrap += usize::from(interval.holds(crossing));
    }
    println!("{by_information} and {by_bootstrap} of {ensembles}");
    assert!(expected(ensembles, [0.94, 0.96]).contains(&by_information), "{by_information}");
    assert!(expected(ensembles, [0.93, 0.96]).contains(&by_bootstrap), "{by_bootstrap}");
}

#[test]
fn every_outcome_has_its_data() {
    let separated = falling(&[[1.0, 5.0, 5.0], [2.0, 3.0, 3.0], [4.0, 0.0, 6.0]]);
    assert_eq!(separated, HalfCrossing::Separated { between: [2.0, 4.0], middle: 3.0 });
    let at_one = falling(&[[1.0, 5.0, 5.0], [2.0, 2.0, 3.0], [4.0, 0.0, 6.0]]);
    assert_eq!(at_one, HalfCrossing::Separated { between: [2.0, 2.0], middle: 2.0 });
    assert_eq!(falling(&[[1.0, 5.0, 5.0], [2.0, 3.0, 3.0]]), HalfCrossing::AllHit);
    assert_eq!(falling(&[[1.0, 0.0, 5.0], [2.0, 0.0, 3.0]]), HalfCrossing::NoneHit);
    assert_eq!(falling(&[[1.0, 2.0, 5.0]]), HalfCrossing::Flat { flat_rise: 0.0 });
    // Equal shares: flat; 6 : 4 and 4 : 6 of ten: a rise of 0.8.
    assert!(
        matches!(falling(&[[1.0, 2.0, 5.0], [2.0, 4.0, 10.0]]), HalfCrossing::Flat { flat_rise } if flat_rise < 1e-12)
    );
    let weak = falling(&[[1.0, 6.0, 10.0], [2.0, 4.0, 10.0]]);
    let rise = 40.0 * (0.6 * 1.2f64.ln() + 0.4 * 0.8f64.ln());
    assert!(matches!(weak, HalfCrossing::Flat { flat_rise } if (flat_rise - rise).abs() < 1e-9), "{weak:?} {rise}");
    assert!(matches!(falling(&[[1.0, 2.0, 20.0], [2.0, 18.0, 20.0]]), HalfCrossing::WrongSign { .. }));
    assert_eq!(falling(&[[1.0, 0.0, 2.0], [2.0, 2.0, 2.0]]), HalfCrossing::WrongSign { flat_rise: f64::INFINITY });
    // 99 % and 75 % at x = 1, 2: ln 99 = (x_c − 1)/w and ln 3 = (x_c − 2)/w.
    let beyond = falling(&[[1.0, 99.0, 100.0], [2.0, 75.0, 100.0]]);
    let HalfCrossing::Found { crossing, extrapolated: true, .. } = beyond else { panic!("{beyond:?}") };
    assert!((crossing.value - (1.0 + 99f64.ln() / 33f64.ln())).abs() < 1e-9);
    // Groups without samples say nothing.
    let groups = [[1.0, 18.0, 20.0], [2.0, 5.0, 20.0], [3.0, 1.0, 20.0]];
    assert_eq!(falling(&groups), falling(&[groups[0], [1.5, 0.0, 0.0], groups[1], groups[2]]));
}

#[test]
fn what_cannot_be_used_is_refused() {
    let of = |groups: &[[f64; 3]]| half_crossing(&counts(groups), Trend::Falling);
    assert_eq!(of(&[]), Err(EnsembleFitError::NoSample));
    assert_eq!(of(&[[1.0, 0.0, 0.0]]), Err(EnsembleFitError::NoSample));
    for bad in [[f64::NAN, 1.0, 2.0], [1.0, 3.0, 2.0], [1.0, -1.0, 2.0], [1.0, 1.0, f64::INFINITY]] {
        assert!(matches!(of(&[[0.0, 1.0, 2.0], bad]), Err(EnsembleFitError::GroupUnusable { group: 1, .. })));
    }
    assert_eq!(half_crossing_interval(&[], Trend::Rising, 10), Err(EnsembleFitError::NoSample));
    let one_sided = [(0.0, vec![true, true]), (1.0, vec![true])];
    assert_eq!(half_crossing_interval(&one_sided, Trend::Falling, 10), Ok(None));
}
