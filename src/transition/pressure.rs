//! [`TransitionPressure`]: p̂_c of a series, by several methods.
//!
//! | method | p̂_c is where | evidence |
//! |---|---|---|
//! | κ | half of the samples have κ_fit ≥ κ_1/2 | logistic regression in ln p̂ |
//! | Δp | half of the samples have Δp < 0 | the same |
//! | G* | the mean passes 1 − 2^(−1/2) = 0.293, its value for S ∝ f^(−1.5) | linear in ln p̂ between cells, after falling neighbours are pooled |
//! | θ* | the mean passes 0.303 π, likewise | the same |
//! | S(f) | the slope of the mean spectrum passes 1.5 | the same |
//! | f† | f† of the mean spectrum falls below 0.1: from f = 1 on a power law within 3 % | the same |
//!
//! κ_1 R = 3.8317, the first zero of J_1: κ_fit of single samples is near 0 or from κ_1 on (the study, fig. 2).

use serde::Serialize;

use crate::fit::ensemble::{
    BootstrapInterval, HalfCrossing, HitCount, Trend, bootstrap, half_crossing, half_crossing_interval,
};
use crate::study::CellSamples;
use crate::transition::RESAMPLINGS;
use crate::transition::series::{ANGLE, ANTICORRELATION, SeriesPoint};
use crate::transition::spectra::{crossover_of, slope_of};

/// First zero of J_1.
pub(crate) const FIRST_ZERO: f64 = 3.831_705_970_207_512;

/// G* of S ∝ f^(−1.5). Source: design §5, 1 − 2^(−1/2).
pub(crate) const SCALE_FREE_ANTICORRELATION: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// θ* of the same, threshold 0.1 \[rad\]. Source: design §5.
pub(crate) const SCALE_FREE_ANGLE: f64 = 0.303_004 * std::f64::consts::PI;

/// Its slope.
pub(crate) const SCALE_FREE_SLOPE: f64 = 1.5;

/// f† below which S ∼ f^(−1.5) from f = 1 on, within 0.1^1.5 = 3 %.
const VANISHED: f64 = 0.1;

/// How p̂_c is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// κ_fit.
    Wavenumber,
    /// The sign of Δp.
    PressureChange,
    /// G*.
    Anticorrelation,
    /// θ*.
    Angle,
    /// The slope of S(f).
    Spectrum,
    /// f†.
    Crossover,
}

impl Method {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Method::Wavenumber => "κ",
            Method::PressureChange => "Δp",
            Method::Anticorrelation => "G*",
            Method::Angle => "θ*",
            Method::Spectrum => "slope of S(f)",
            Method::Crossover => "f†",
        }
    }
}

/// One method's p̂_c.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MethodEstimate {
    /// The method.
    pub method: Method,
    /// What it gives.
    pub pressure: TransitionPressure,
}

impl MethodEstimate {
    /// What the slope of the spectrum gives.
    pub(super) fn by_spectrum(&self) -> Option<TransitionPressure> {
        (self.method == Method::Spectrum).then_some(self.pressure)
    }
}

/// Where the transition lies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TransitionPressure {
    /// At this p̂, with its interval.
    Found(BootstrapInterval),
    /// Between the p̂ of two cells: no sample of a cell differs from the others.
    Between([f64; 2]),
    /// Beyond the highest p̂ of the series: all its cells are plastic.
    Above(f64),
    /// Below the lowest p̂ of the series: all its cells are quasielastic.
    Below(f64),
    /// The observable does not change from one to the other along the series.
    Unordered,
}

impl TransitionPressure {
    /// The best value of p̂_c \[force / length\].
    pub fn best(self) -> Option<f64> {
        match self {
            TransitionPressure::Found(found) => Some(found.best),
            TransitionPressure::Between([low, high]) => Some((low * high).sqrt()),
            _ => None,
        }
    }

    /// Its interval \[force / length\], as far as there is one.
    pub fn interval(self) -> Option<[f64; 2]> {
        match self {
            TransitionPressure::Found(found) => found.interval,
            TransitionPressure::Between(between) => Some(between),
            _ => None,
        }
    }
}

/// All methods that have their observable.
pub(super) fn estimates(points: &[SeriesPoint], samples: &[&CellSamples]) -> Vec<MethodEstimate> {
    let plastic = |method, name: &str, is_plastic: &dyn Fn(&CellSamples, f64) -> bool| {
        let groups: Vec<(f64, Vec<bool>)> = points
            .iter()
            .zip(samples)
            .filter_map(|(point, samples)| {
                let values = samples.numbers.get(name)?;
                Some((
                    libm::log(point.reduced_pressure),
                    values.iter().map(|&value| is_plastic(samples, value)).collect(),
                ))
            })
            .collect();
        (groups.len() > 1).then(|| MethodEstimate { method, pressure: by_halves(&groups) })
    };
    let radius = |samples: &CellSamples| {
        let radii = samples.numbers.get("outer_radius")?;
        Some(radii.iter().sum::<f64>() / radii.len() as f64)
    };
    let screened = |samples: &CellSamples, wavenumber: f64| {
        radius(samples).is_some_and(|radius| wavenumber * radius >= 0.5 * FIRST_ZERO)
    };
    let mean = |method, name: &str, level: f64| {
        let usable: Vec<(f64, &Vec<f64>)> = points
            .iter()
            .zip(samples)
            .filter_map(|(point, samples)| Some((point.reduced_pressure, samples.numbers.get(name)?)))
            .collect();
        let sizes: Vec<usize> = usable.iter().map(|(_, values)| values.len()).collect();
        let at: Vec<f64> = usable.iter().map(|(at, _)| *at).collect();
        let means = |groups: &[Vec<usize>]| -> Option<Vec<f64>> {
            let mean = |(chosen, (_, values)): (&Vec<usize>, &(f64, &Vec<f64>))| {
                chosen.iter().map(|&i| values[i]).sum::<f64>() / chosen.len() as f64
            };
            Some(groups.iter().zip(&usable).map(mean).collect())
        };
        (at.len() > 1).then(|| MethodEstimate { method, pressure: by_level(&at, &sizes, level, means) })
    };
    let with_powers: Vec<(f64, &[Vec<f64>])> = points
        .iter()
        .zip(samples)
        .filter(|(_, samples)| !samples.powers.is_empty())
        .map(|(point, samples)| (point.reduced_pressure, samples.powers.as_slice()))
        .collect();
    let spectrum = |method, level: f64, of: fn(&[Vec<f64>], &[usize]) -> Option<f64>| {
        let sizes: Vec<usize> = with_powers.iter().map(|(_, powers)| powers.len()).collect();
        let at: Vec<f64> = with_powers.iter().map(|(at, _)| *at).collect();
        let values = |groups: &[Vec<usize>]| -> Option<Vec<f64>> {
            groups.iter().zip(&with_powers).map(|(chosen, (_, powers))| of(powers, chosen)).collect()
        };
        (at.len() > 1).then(|| MethodEstimate { method, pressure: by_level(&at, &sizes, level, values) })
    };
    [
        plastic(Method::Wavenumber, "wavenumber", &screened),
        plastic(Method::PressureChange, "pressure_change", &|_, change| change < 0.0),
        mean(Method::Anticorrelation, ANTICORRELATION, SCALE_FREE_ANTICORRELATION),
        mean(Method::Angle, ANGLE, SCALE_FREE_ANGLE),
        spectrum(Method::Spectrum, SCALE_FREE_SLOPE, slope_of),
        // What falls below a level rises above its opposite.
        spectrum(Method::Crossover, -VANISHED, |powers, chosen| Some(-crossover_of(powers, chosen)?)),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Where half of the samples are plastic, (ln p̂, plastic or not) by cell.
fn by_halves(groups: &[(f64, Vec<bool>)]) -> TransitionPressure {
    let counts: Vec<HitCount> = groups
        .iter()
        .map(|(x, hits)| HitCount {
            x: *x,
            hits: hits.iter().filter(|&&hit| hit).count() as f64,
            count: hits.len() as f64,
        })
        .collect();
    let (lowest, highest) = (libm::exp(counts[0].x), libm::exp(counts[counts.len() - 1].x));
    let majority = |group: &HitCount| 2.0 * group.hits >= group.count;
    // A crossing beyond the cells that were measured is a guess: it is told as a bound.
    let bound = match (majority(&counts[0]), majority(&counts[counts.len() - 1])) {
        (true, true) => TransitionPressure::Above(highest),
        (false, false) => TransitionPressure::Below(lowest),
        _ => TransitionPressure::Unordered,
    };
    match half_crossing(&counts, Trend::Falling) {
        Ok(HalfCrossing::Separated { between, .. }) => TransitionPressure::Between(between.map(libm::exp)),
        Ok(HalfCrossing::Found { extrapolated: false, .. }) => {
            let found = half_crossing_interval(groups, Trend::Falling, RESAMPLINGS);
            found.ok().flatten().map_or(bound, |found| TransitionPressure::Found(exponential(found)))
        }
        _ => bound,
    }
}

/// Where what rises with p̂ passes a level.
fn by_level(
    at: &[f64],
    sizes: &[usize],
    level: f64,
    values: impl Fn(&[Vec<usize>]) -> Option<Vec<f64>>,
) -> TransitionPressure {
    let weights: Vec<f64> = sizes.iter().map(|&size| size as f64).collect();
    let rising = |groups: &[Vec<usize>]| Some(ascending(&values(groups)?, &weights));
    let all: Vec<Vec<usize>> = sizes.iter().map(|&size| (0..size).collect()).collect();
    let Some(whole) = rising(&all) else { return TransitionPressure::Unordered };
    match crossing(at, &whole, level) {
        Some(_) => {
            let found = bootstrap(sizes, RESAMPLINGS, |groups| crossing(at, &rising(groups)?, level));
            found.map_or(TransitionPressure::Unordered, |found| TransitionPressure::Found(exponential(found)))
        }
        None if whole.iter().all(|&value| value < level) => TransitionPressure::Above(at[at.len() - 1]),
        None if whole.iter().all(|&value| value >= level) => TransitionPressure::Below(at[0]),
        None => TransitionPressure::Unordered,
    }
}

/// ln p̂ where ascending values pass the level.
fn crossing(at: &[f64], values: &[f64], level: f64) -> Option<f64> {
    let below = values.iter().rposition(|&value| value < level)?;
    let (low, high) = (values[below], *values.get(below + 1)?);
    let share = (level - low) / (high - low);
    Some((1.0 - share) * libm::log(at[below]) + share * libm::log(at[below + 1]))
}

/// The nearest values that nowhere fall, by weighted least squares: neighbours that do are pooled.
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

/// The interval of e^x; the standard error to first order.
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
        // 4 has three times the weight of 2: (3·4 + 2)/4 = 3.5. A last low one pools all.
        assert_eq!(ascending(&[1.0, 4.0, 2.0, 5.0], &[1.0, 3.0, 1.0, 1.0]), [1.0, 3.5, 3.5, 5.0]);
        assert_eq!(ascending(&[3.0, 2.0, 1.0], &[1.0; 3]), [2.0; 3]);
    }

    #[test]
    fn all_plastic_or_all_elastic_is_a_bound() {
        let groups = |hits: [bool; 2]| hits.map(|hit| (1.0, vec![hit; 5])).to_vec();
        assert_eq!(by_halves(&groups([true, true])), TransitionPressure::Above(libm::exp(1.0)));
        assert_eq!(by_halves(&groups([false, false])), TransitionPressure::Below(libm::exp(1.0)));
        let changing = [(0.0, vec![true; 5]), (2.0, vec![false; 5])];
        assert_eq!(by_halves(&changing), TransitionPressure::Between([1.0, libm::exp(2.0)]));
    }
}
