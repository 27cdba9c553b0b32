//! [`bootstrap`]: standard error and interval of any number computed from samples, by resampling.
//!
//! Every group of samples (a cell of a study) is resampled with replacement within itself. The measured parameters and
//! their numbers of samples stay the same. Percentile method.
//!
//! Source: Efron (1979), Ann. Stat. 7, 1; Davison, Hinkley (1997), Bootstrap Methods and their Application, §3.2
//! (strata), §5.3.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use crate::observe::angular::quantile;

/// If more than one in this many resamplings gives no number, the others are a biased selection.
const FAILURES_ONE_IN: usize = 10;

/// A number and its scatter over resamplings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BootstrapInterval {
    /// The number for the original data.
    pub best: f64,
    /// Standard deviation over the resamplings; none if more than a tenth of them, or all but one, give no number.
    pub standard_error: Option<f64>,
    /// From 2.5 % to 97.5 % of the resamplings; none if `standard_error` is none.
    pub interval: Option<[f64; 2]>,
    /// Number of resamplings.
    pub resampling_count: usize,
    /// Number of resamplings without the number.
    pub failed_count: usize,
}

impl BootstrapInterval {
    /// Whether there is an interval that contains a number.
    pub fn holds(&self, value: f64) -> bool {
        self.interval.is_some_and(|[low, high]| low <= value && value <= high)
    }

    fn of(best: f64, mut found: Vec<f64>, resampling_count: usize) -> Self {
        let failed_count = resampling_count - found.len();
        let (mut standard_error, mut interval) = (None, None);
        if failed_count * FAILURES_ONE_IN <= resampling_count && found.len() > 1 {
            found.sort_unstable_by(f64::total_cmp);
            let count = found.len() as f64;
            let mean = found.iter().sum::<f64>() / count;
            let square: f64 = found.iter().map(|x| (x - mean) * (x - mean)).sum();
            standard_error = Some((square / (count - 1.0)).sqrt());
            interval = Some([0.025, 0.975].map(|share| quantile(&found, share)));
        }
        BootstrapInterval { best, standard_error, interval, resampling_count, failed_count }
    }
}

/// Resamples a number. None if the original data do not give it.
///
/// `estimate` takes the indices of the samples of every group: first each once, in order, then those resampled. Values
/// that are not finite count as missing. The resampling depends only on the sizes, so it is reproducible.
///
/// # Accuracy
/// In groups of n the standard error of a mean is too small by a factor √((n − 1)/n); a group of one sample has no
/// scatter at all. For normal numbers the ends themselves scatter by √(0.025·0.975/1000)/0.058 = 0.085 standard errors
/// at 1000 resamplings.
///
/// # Cost
/// One call of `estimate`, plus one per resampling.
///
/// # Example
/// ```
/// use jamscope::fit::ensemble::bootstrap;
/// let lengths = [3.0, 4.0, 5.0, 4.5, 3.5, 4.0];
/// let mean = |groups: &[Vec<usize>]| {
///     Some(groups[0].iter().map(|&i| lengths[i]).sum::<f64>() / groups[0].len() as f64)
/// };
/// let found = bootstrap(&[6], 1000, mean).expect("six lengths have a mean");
/// assert_eq!((found.best, found.failed_count), (4.0, 0));
/// // The mean of a resampling has the variance Σ (x − 4)²/6² = 2.5/36.
/// let error = found.standard_error.expect("none failed");
/// assert!((error / (2.5f64 / 36.0).sqrt() - 1.0).abs() < 0.1);
/// ```
pub fn bootstrap(
    group_sizes: &[usize],
    resamplings: usize,
    estimate: impl Fn(&[Vec<usize>]) -> Option<f64>,
) -> Option<BootstrapInterval> {
    bootstrap_all(group_sizes, resamplings, |groups| estimate(groups).map(|value| vec![value]))?.pop()
}

/// Resamples several numbers together.
///
/// If a single number is not finite, only that number has failed. If `estimate` returns none or a different number of
/// values than for the original data, all have failed. None if the original data give none, or a value that is not
/// finite.
///
/// # Cost
/// See [`bootstrap`]; all numbers of all resamplings are in memory.
pub fn bootstrap_all(
    group_sizes: &[usize],
    resamplings: usize,
    estimate: impl Fn(&[Vec<usize>]) -> Option<Vec<f64>>,
) -> Option<Vec<BootstrapInterval>> {
    let mut groups: Vec<Vec<usize>> = group_sizes.iter().map(|&size| (0..size).collect()).collect();
    let best = estimate(&groups).filter(|values| values.iter().all(|value| value.is_finite()))?;
    let mut found = vec![Vec::with_capacity(resamplings); best.len()];
    let mut generator = Pcg64::seed_from_u64(seed(group_sizes));
    for _ in 0..resamplings {
        for group in &mut groups {
            let size = group.len();
            group.iter_mut().for_each(|place| *place = generator.random_range(0..size));
        }
        let Some(values) = estimate(&groups).filter(|values| values.len() == best.len()) else { continue };
        for (all, value) in found.iter_mut().zip(values).filter(|(_, value)| value.is_finite()) {
            all.push(value);
        }
    }
    Some(best.into_iter().zip(found).map(|(best, found)| BootstrapInterval::of(best, found, resamplings)).collect())
}

/// A seed from the sizes and their order: the hash FNV-1a of Fowler, Noll and Vo, with sizes in place of bytes.
fn seed(group_sizes: &[usize]) -> u64 {
    group_sizes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &size| (hash ^ size as u64).wrapping_mul(0x0100_0000_01b3))
}
