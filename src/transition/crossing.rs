//! The transition of a series from plastic to quasielastic: where half of the samples are plastic, or where a mean
//! crosses a level.
//!
//! Cells are in ascending order of p̂, and all of them have the minimum number of samples. Further conditions for a
//! crossing and a bound are in [`evidence`](super::evidence).

use crate::fit::ensemble::{
    BootstrapInterval, HalfCrossing, HitCount, Trend, bootstrap, half_crossing, half_crossing_interval,
};
use crate::transition::evidence::{CannotTell, LEAST_CELLS_OF_SIDE, LEAST_SAMPLES_OF_SIDE, RESAMPLINGS, excludes_half};
use crate::transition::pressure::TransitionPressure;

/// The side of the transition of a cell, and whether it is significant at 95 %.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Place {
    plastic: bool,
    clear: bool,
}

fn cannot_tell(reason: CannotTell) -> TransitionPressure {
    TransitionPressure::Uninformative { reason }
}

/// The crossing where half of the samples are plastic, from (ln p̂, plastic or not) by cell.
pub(super) fn by_halves(groups: &[(f64, Vec<bool>)]) -> TransitionPressure {
    let counts: Vec<HitCount> = groups
        .iter()
        .map(|(x, hits)| HitCount {
            x: *x,
            hits: hits.iter().filter(|&&hit| hit).count() as f64,
            count: hits.len() as f64,
        })
        .collect();
    let place = |group: &HitCount| Place {
        plastic: 2.0 * group.hits >= group.count,
        clear: excludes_half(group.hits, group.count),
    };
    let at: Vec<f64> = counts.iter().map(|group| libm::exp(group.x)).collect();
    let bound = || bound(&at, &counts.iter().map(place).collect::<Vec<_>>());
    // A crossing outside the measured cells is an extrapolation, so it is reported as a bound.
    let found = match half_crossing(&counts, Trend::Falling) {
        Ok(HalfCrossing::Separated { between, middle }) => {
            Some((middle, TransitionPressure::Between(between.map(libm::exp))))
        }
        Ok(HalfCrossing::Found { crossing, extrapolated: false, .. }) => {
            let found = half_crossing_interval(groups, Trend::Falling, RESAMPLINGS).ok().flatten();
            found.map(|found| (crossing.value, TransitionPressure::Found(exponential(found))))
        }
        _ => None,
    };
    match found {
        Some((crossing, found)) if enough_on_both_sides(&counts, crossing) => found,
        // Few hits in the first cell and none in the others also separate the sides there: that is a bound.
        Some(_) => match bound() {
            TransitionPressure::Unordered => cannot_tell(CannotTell::OneSide),
            bound => bound,
        },
        None => bound(),
    }
}

fn enough_on_both_sides(counts: &[HitCount], crossing: f64) -> bool {
    let enough = |keep: fn(f64, f64) -> bool| {
        let own: Vec<f64> = counts.iter().filter(|group| keep(group.x, crossing)).map(|group| group.count).collect();
        own.len() >= LEAST_CELLS_OF_SIDE && own.iter().sum::<f64>() >= LEAST_SAMPLES_OF_SIDE
    };
    enough(|x, crossing| x < crossing) && enough(|x, crossing| x > crossing)
}

/// The bound given by cells without a crossing between them.
fn bound(at: &[f64], places: &[Place]) -> TransitionPressure {
    let clear = |plastic: bool| places.contains(&Place { plastic, clear: true });
    // The plastic side ends at the last cell; the elastic side begins at the first.
    let (plastic, end) = match (clear(true), clear(false)) {
        (true, true) => return TransitionPressure::Unordered,
        (true, false) => (true, places.len() - 1),
        (false, true) => (false, 0),
        (false, false) => return cannot_tell(CannotTell::EndUndecided),
    };
    if places[end] != (Place { plastic, clear: true }) {
        return cannot_tell(CannotTell::EndUndecided);
    }
    if places.iter().filter(|place| place.plastic == plastic).count() < LEAST_CELLS_OF_SIDE {
        return cannot_tell(CannotTell::FewCells);
    }
    if plastic { TransitionPressure::Above(at[end]) } else { TransitionPressure::Below(at[end]) }
}

/// The crossing where a quantity that rises with p̂ reaches a level. `value` computes it for some samples of a cell.
pub(super) fn by_level(
    at: &[f64],
    sizes: &[usize],
    level: f64,
    value: impl Fn(usize, &[usize]) -> Option<f64>,
) -> TransitionPressure {
    let weights: Vec<f64> = sizes.iter().map(|&size| size as f64).collect();
    let values = |groups: &[Vec<usize>]| -> Option<Vec<f64>> {
        groups.iter().enumerate().map(|(cell, chosen)| value(cell, chosen)).collect()
    };
    let rising = |groups: &[Vec<usize>]| Some(ascending(&values(groups)?, &weights));
    let all: Vec<Vec<usize>> = sizes.iter().map(|&size| (0..size).collect()).collect();
    let Some(whole) = rising(&all) else { return cannot_tell(CannotTell::NoValue) };
    if crossing(at, &whole, level).is_some() {
        let found = bootstrap(sizes, RESAMPLINGS, |groups| crossing(at, &rising(groups)?, level));
        return found.map_or(cannot_tell(CannotTell::NoValue), |found| TransitionPressure::Found(exponential(found)));
    }
    let place = |(cell, &size): (usize, &usize)| {
        let found = bootstrap(&[size], RESAMPLINGS, |groups| value(cell, &groups[0]))?;
        let clear = found.interval.is_some_and(|[low, high]| high < level || low > level);
        Some(Place { plastic: found.best < level, clear })
    };
    let places: Option<Vec<Place>> = sizes.iter().enumerate().map(place).collect();
    places.map_or(cannot_tell(CannotTell::NoValue), |places| bound(at, &places))
}

/// ln p̂ where ascending values cross the level.
fn crossing(at: &[f64], values: &[f64], level: f64) -> Option<f64> {
    let below = values.iter().rposition(|&value| value < level)?;
    let (low, high) = (values[below], *values.get(below + 1)?);
    let share = (level - low) / (high - low);
    Some((1.0 - share) * libm::log(at[below]) + share * libm::log(at[below + 1]))
}

/// Isotonic regression: the nearest non-decreasing values, by weighted least squares.
///
/// Source: Ayer, Brunk, Ewing, Reid, Silverman (1955), Ann. Math. Stat. 26, 641 (pool adjacent violators).
fn ascending(values: &[f64], weights: &[f64]) -> Vec<f64> {
    // Mean, weight and number of members of every pool.
    let mut pools: Vec<(f64, f64, usize)> = Vec::new();
    for (&value, &weight) in values.iter().zip(weights) {
        let mut last = (value, weight, 1);
        while let Some(&(mean, of_pool, count)) = pools.last()
            && mean > last.0
        {
            let both = of_pool + last.1;
            last = ((mean * of_pool + last.0 * last.1) / both, both, count + last.2);
            pools.pop();
        }
        pools.push(last);
    }
    pools.into_iter().flat_map(|(mean, _, count)| std::iter::repeat_n(mean, count)).collect()
}

/// The interval of e^x; the standard error is to first order.
fn exponential(of: BootstrapInterval) -> BootstrapInterval {
    let best = libm::exp(of.best);
    BootstrapInterval {
        best,
        standard_error: of.standard_error.map(|error| best * error),
        interval: of.interval.map(|ends| ends.map(libm::exp)),
        ..of
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_is_passed_between_two_cells_in_the_logarithm() {
        let at = [1e6, 1e7, 1e8, 1e9];
        let passed = crossing(&at, &[0.1, 0.2, 0.4, 0.5], 0.3).expect("between the second and the third");
        assert!((passed.exp() / 10f64.powf(7.5) - 1.0).abs() < 1e-12);
        assert_eq!(crossing(&at, &[0.1, 0.2, 0.25, 0.29], 0.3), None);
        assert_eq!(crossing(&at, &[0.4, 0.5, 0.6, 0.7], 0.3), None);
    }

    #[test]
    fn values_that_fall_are_pooled() {
        assert_eq!(ascending(&[1.0, 2.0, 3.0], &[1.0; 3]), [1.0, 2.0, 3.0]);
        assert_eq!(ascending(&[1.0, 4.0, 2.0, 5.0], &[1.0; 4]), [1.0, 3.0, 3.0, 5.0]);
        // 4 has three times the weight of 2: (3·4 + 2)/4 = 3.5. A low last value pools all.
        assert_eq!(ascending(&[1.0, 4.0, 2.0, 5.0], &[1.0, 3.0, 1.0, 1.0]), [1.0, 3.5, 3.5, 5.0]);
        assert_eq!(ascending(&[3.0, 2.0, 1.0], &[1.0; 3]), [2.0; 3]);
    }

    /// (p̂, hits, samples) of every cell.
    fn halves(cells: &[(f64, usize, usize)]) -> TransitionPressure {
        let groups: Vec<(f64, Vec<bool>)> =
            cells.iter().map(|&(at, hits, count)| (libm::log(at), (0..count).map(|i| i < hits).collect())).collect();
        by_halves(&groups)
    }

    fn reason(found: TransitionPressure) -> CannotTell {
        let TransitionPressure::Uninformative { reason } = found else { panic!("{found:?}") };
        reason
    }

    /// Whether two pressures agree to rounding.
    fn about(found: f64, expected: f64) -> bool {
        (found / expected - 1.0).abs() < 1e-12
    }

    #[test]
    fn all_plastic_or_all_elastic_is_a_bound() {
        let TransitionPressure::Above(highest) = halves(&[(1e6, 12, 12), (1e7, 12, 12)]) else { panic!("all plastic") };
        let TransitionPressure::Below(lowest) = halves(&[(1e6, 0, 12), (1e7, 0, 12)]) else { panic!("all elastic") };
        assert!(about(highest, 1e7) && about(lowest, 1e6));
        // Few hits at one end and none in the other cell.
        let TransitionPressure::Below(lowest) = halves(&[(1e6, 3, 20), (1e7, 0, 20)]) else { panic!("few plastic") };
        assert!(about(lowest, 1e6));
    }

    #[test]
    fn a_bound_needs_an_end_cell_that_excludes_one_half() {
        // 14 of 20 does not exclude one half on either side; 15 does.
        assert_eq!(reason(halves(&[(1e6, 20, 20), (1e7, 14, 20)])), CannotTell::EndUndecided);
        assert!(matches!(halves(&[(1e6, 20, 20), (1e7, 15, 20)]), TransitionPressure::Above(_)));
        assert_eq!(reason(halves(&[(1e6, 6, 20), (1e7, 1, 20)])), CannotTell::EndUndecided);
        assert_eq!(reason(halves(&[(1e6, 10, 20), (1e7, 11, 20)])), CannotTell::EndUndecided);
    }

    #[test]
    fn a_bound_needs_two_cells_on_its_side() {
        // 9 of 20 is on the other side, but one half is not excluded.
        assert_eq!(reason(halves(&[(1e6, 9, 20), (1e7, 16, 20)])), CannotTell::FewCells);
        assert!(matches!(halves(&[(1e6, 10, 20), (1e7, 16, 20)]), TransitionPressure::Above(_)));
    }

    #[test]
    fn a_crossing_by_halves_needs_two_cells_and_twenty_samples_on_each_side() {
        let between = halves(&[(1e6, 10, 10), (1e7, 10, 10), (1e8, 0, 10), (1e9, 0, 10)]);
        let TransitionPressure::Between([low, high]) = between else { panic!("{between:?}") };
        assert!(about(low, 1e7) && about(high, 1e8));
        // One cell above; 18 samples below.
        assert_eq!(reason(halves(&[(1e6, 20, 20), (1e7, 20, 20), (1e8, 0, 40)])), CannotTell::OneSide);
        let few = [(1e6, 9, 9), (1e7, 9, 9), (1e8, 0, 10), (1e9, 0, 10)];
        assert_eq!(reason(halves(&few)), CannotTell::OneSide);
        let found = [(1e6, 19, 20), (1e7, 15, 20), (1e8, 4, 20), (1e9, 1, 20)];
        assert!(matches!(halves(&found), TransitionPressure::Found(_)));
        assert_eq!(reason(halves(&found[1..])), CannotTell::OneSide);
        assert_eq!(reason(halves(&found[..3])), CannotTell::OneSide);
    }

    #[test]
    fn sides_that_are_clear_and_in_the_wrong_order_are_unordered() {
        assert_eq!(halves(&[(1e6, 1, 20), (1e7, 10, 20), (1e8, 19, 20)]), TransitionPressure::Unordered);
        let twice = [(1e6, 20, 20), (1e7, 2, 20), (1e8, 18, 20), (1e9, 20, 20)];
        assert_eq!(halves(&twice), TransitionPressure::Unordered);
    }

    /// Cells with these means, of ten samples each: alternately 0.1 above and below.
    fn level(means: &[f64]) -> TransitionPressure {
        let at: Vec<f64> = (6..).map(|power| libm::pow(10.0, f64::from(power))).take(means.len()).collect();
        let value = |cell: usize, chosen: &[usize]| {
            let of = |&i: &usize| means[cell] + if i.is_multiple_of(2) { 0.1 } else { -0.1 };
            Some(chosen.iter().map(of).sum::<f64>() / chosen.len() as f64)
        };
        by_level(&at, &vec![10; means.len()], 0.3, value)
    }

    #[test]
    fn a_mean_bounds_where_its_end_cell_is_clear_of_the_level() {
        // The mean of ten scatters by 0.1/√10 = 0.032, so the ends are about 0.06 away.
        assert_eq!(level(&[0.0, 0.1, 0.2]), TransitionPressure::Above(1e8));
        assert_eq!(reason(level(&[0.0, 0.1, 0.26])), CannotTell::EndUndecided);
        assert_eq!(level(&[0.4, 0.5]), TransitionPressure::Below(1e6));
        assert_eq!(reason(level(&[0.34, 0.5])), CannotTell::EndUndecided);
        assert!(matches!(level(&[0.1, 0.5]), TransitionPressure::Found(_)));
        // Falling means are pooled to one; without the check of single cells they would be a bound.
        assert_eq!(level(&[0.5, 0.05]), TransitionPressure::Unordered);
        let none = by_level(&[1e6, 1e7], &[10, 10], 0.3, |cell, _| (cell == 0).then_some(0.1));
        assert_eq!(reason(none), CannotTell::NoValue);
    }
}
