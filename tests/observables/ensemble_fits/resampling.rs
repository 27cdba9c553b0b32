use jamscope::fit::ensemble::{bootstrap, bootstrap_all};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::expected;

fn mean(values: &[f64], indices: &[usize]) -> f64 {
    indices.iter().map(|&i| values[i]).sum::<f64>() / indices.len() as f64
}

#[test]
fn the_mean_of_zero_and_one_scatters_as_two_tosses_do() {
    // 0, 1/2, 1 with probabilities 1/4, 1/2, 1/4: variance 1/8. Of 4000 resamplings the variance has a relative standard deviation of
    // √(Var (x − ½)²)/(1/8)/√4000 = 1.6 %, its root half of that; three of them.
    let found = bootstrap(&[2], 4000, |groups| Some(mean(&[0.0, 1.0], &groups[0]))).expect("a mean");
    assert_eq!((found.best, found.failed_count, found.interval), (0.5, 0, Some([0.0, 1.0])));
    assert!((found.standard_error.expect("none failed") / 0.125f64.sqrt() - 1.0).abs() < 0.024);
}

#[test]
fn every_group_is_drawn_within_itself() {
    let sizes = [3, 0, 7, 1];
    let found = bootstrap(&sizes, 200, |groups| {
        let same = groups.len() == sizes.len() && groups.iter().zip(sizes).all(|(group, size)| group.len() == size);
        assert!(same && groups.iter().zip(sizes).all(|(group, size)| group.iter().all(|&i| i < size)));
        Some(groups[3][0] as f64)
    });
    // One sample does not scatter.
    assert_eq!(found.map(|found| (found.best, found.standard_error)), Some((0.0, Some(0.0))));
}

#[test]
fn the_difference_of_two_groups_is_covered() {
    // Groups of 30 and 50: the interval is too narrow by about 1/60, percentile for Student: about 94 % expected, 93 to 95.
    let mut random = Pcg64::seed_from_u64(11);
    let held = (0..500).filter(|_| {
        let low: Vec<f64> = (0..30).map(|_| random.random()).collect();
        let high: Vec<f64> = (0..50).map(|_| 2.0 + 3.0 * random.random::<f64>()).collect();
        let of = |groups: &[Vec<usize>]| Some(mean(&high, &groups[1]) - mean(&low, &groups[0]));
        bootstrap(&[30, 50], 400, of).expect("means").holds(3.0)
    });
    let (held, range) = (held.count(), expected(500, [0.93, 0.95]));
    assert!(range.contains(&held), "{held} of 500, expected {range:?}");
}

#[test]
fn more_failures_than_a_tenth_leave_no_interval() {
    // The first index is 0 in one of 20 and in one of 5 resamplings.
    let failing = |groups: &[Vec<usize>]| (groups[0][0] != 0 || groups[0][1] == 1).then_some(groups[0][1] as f64);
    let rare = bootstrap(&[20], 1000, failing).expect("0, 1, … is in order");
    assert!(rare.interval.is_some() && expected(1000, [0.0475, 0.0475]).contains(&rare.failed_count), "{rare:?}");
    let frequent = bootstrap(&[5], 1000, failing).expect("0, 1, … is in order");
    assert!(expected(1000, [0.16, 0.16]).contains(&frequent.failed_count), "{frequent:?}");
    assert_eq!((frequent.interval, frequent.standard_error, frequent.best), (None, None, 1.0));
    assert!(!frequent.holds(1.0));
    // Nothing of the data, nothing at all; no resampling, no interval.
    assert_eq!(bootstrap(&[5], 10, |_| None), None);
    assert_eq!(bootstrap(&[5], 10, |_| Some(f64::NAN)), None);
    assert_eq!(bootstrap(&[5], 0, |_| Some(1.0)).map(|found| found.interval), Some(None));
}

#[test]
fn several_numbers_share_their_resamplings_and_fail_alone() {
    let values: Vec<f64> = (0..12).map(|i| f64::from(i * i)).collect();
    let both = bootstrap_all(&[12], 500, |groups| {
        let second = if groups[0][0] == 0 && groups[0][1] != 1 { f64::NAN } else { 2.0 * mean(&values, &groups[0]) };
        Some(vec![mean(&values, &groups[0]), second])
    });
    let both = both.expect("means");
    let alone = bootstrap(&[12], 500, |groups| Some(mean(&values, &groups[0])));
    assert_eq!(Some(both[0]), alone, "same sizes, same bits");
    assert!(both[0].failed_count == 0 && both[1].failed_count > 0 && both[1].best == 2.0 * both[0].best);
    assert_ne!(bootstrap(&[12, 3], 500, |groups| Some(mean(&values, &groups[0]))), alone, "other sizes, other draws");
}
