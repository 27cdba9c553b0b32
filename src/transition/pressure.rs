//! [`TransitionPressure`]: p̂_c of a series, by several methods.
//!
//! | method | p̂_c is where | evidence |
//! |---|---|---|
//! | κ | half of the samples have κ_fit ≥ κ_1/2 | logistic regression in ln p̂ |
//! | Δp | half of the samples have Δp < 0 | the same |
//! | G* | the mean passes 1 − 2^(−1/2) = 0.293, its value for S ∝ f^(−1.5) | linear in ln p̂ between cells, after falling neighbours are pooled |
//! | θ* | the mean passes 0.303 π, likewise | the same |
//! | S(f), least squares | the slope of the mean spectrum by least squares in logarithms passes 1.5 | the same |
//! | S(f), likelihood | the same slope by maximum likelihood | the same |
//! | f† | f† of the mean spectrum falls below 0.1: from f = 1 on a power law within 3 % | the same |
//!
//! A cell counts with at least 8 samples. By κ and Δp two such cells and 20 samples lie on either side of a crossing. A bound needs an end
//! cell that is clear of one half, or of the level, at 95 %, and two cells on its side. Below that a method
//! [cannot tell](TransitionPressure::Uninformative).
//!
//! κ_1 R = 3.8317, the first zero of J_1: κ_fit of single samples is near 0 or from κ_1 on (the study, fig. 2).

use serde::Serialize;

use crate::fit::ensemble::BootstrapInterval;
use crate::study::CellSamples;
use crate::transition::crossing::{by_halves, by_level};
use crate::transition::evidence::{CannotTell, LEAST_SAMPLES};
use crate::transition::series::{ANGLE, ANTICORRELATION, SeriesPoint};
use crate::transition::spectra::{crossover_of, likelihood_slope_of, slope_of};

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
    /// The slope of S(f) by least squares in logarithms.
    Spectrum,
    /// The slope of S(f) by maximum likelihood.
    SpectrumLikelihood,
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
            Method::Spectrum => "slope of S(f), least squares",
            Method::SpectrumLikelihood => "slope of S(f), likelihood",
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
    /// Lowest and highest p̂ of the cells that count; none where fewer than two do \[force / length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<[f64; 2]>,
    /// Samples of the cell with the fewest, of those that count; of all where fewer than two count.
    pub sample_count: usize,
}

impl MethodEstimate {
    /// What the slope of the spectrum gives, by least squares.
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
    /// Between the p̂ of two cells: up to the one all samples are plastic, from the other on none.
    Between([f64; 2]),
    /// Beyond the highest p̂ of the series: all its cells are plastic.
    Above(f64),
    /// Below the lowest p̂ of the series: all its cells are quasielastic.
    Below(f64),
    /// Cells are clearly plastic and clearly quasielastic, but not in this order.
    Unordered,
    /// The study cannot tell.
    Uninformative {
        /// Why.
        reason: CannotTell,
    },
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

/// One method, of all cells that have its observable: p̂, samples, what the method asks of them. None of fewer than two cells.
fn estimate<T>(
    method: Method,
    mut cells: Vec<(f64, usize, T)>,
    find: impl Fn(&[f64], &[usize], &[T]) -> TransitionPressure,
) -> Option<MethodEstimate> {
    if cells.len() < 2 {
        return None;
    }
    let fewest = |cells: &[(f64, usize, T)]| cells.iter().map(|(_, count, _)| *count).min().unwrap_or(0);
    let of_all = fewest(&cells);
    cells.retain(|(_, count, _)| *count >= LEAST_SAMPLES);
    if cells.len() < 2 {
        let pressure = TransitionPressure::Uninformative { reason: CannotTell::FewSamples };
        return Some(MethodEstimate { method, pressure, measured: None, sample_count: of_all });
    }
    let sample_count = fewest(&cells);
    let at: Vec<f64> = cells.iter().map(|(at, ..)| *at).collect();
    let sizes: Vec<usize> = cells.iter().map(|(_, count, _)| *count).collect();
    let all: Vec<T> = cells.into_iter().map(|(.., own)| own).collect();
    let measured = Some([at[0], at[at.len() - 1]]);
    Some(MethodEstimate { method, pressure: find(&at, &sizes, &all), measured, sample_count })
}

/// p̂, samples that have a number, and the cell with their values.
type NumberCell<'a> = (f64, usize, (&'a CellSamples, &'a [f64]));

/// Every cell that has a number.
fn numbers<'a>(points: &[SeriesPoint], samples: &[&'a CellSamples], name: &str) -> Vec<NumberCell<'a>> {
    let mut all = Vec::new();
    for (point, &samples) in points.iter().zip(samples) {
        if let Some(values) = samples.numbers.get(name) {
            all.push((point.reduced_pressure, values.len(), (samples, values.as_slice())));
        }
    }
    all
}

/// All methods that have their observable.
pub(super) fn estimates(points: &[SeriesPoint], samples: &[&CellSamples]) -> Vec<MethodEstimate> {
    let plastic = |method, name: &str, is_plastic: &dyn Fn(&CellSamples, f64) -> bool| {
        estimate(method, numbers(points, samples, name), |at, _, cells| {
            let group = |(at, &(samples, values)): (&f64, &(&CellSamples, &[f64]))| {
                (libm::log(*at), values.iter().map(|&value| is_plastic(samples, value)).collect())
            };
            by_halves(&at.iter().zip(cells).map(group).collect::<Vec<(f64, Vec<bool>)>>())
        })
    };
    let radius = |samples: &CellSamples| {
        let radii = samples.numbers.get("outer_radius")?;
        Some(radii.iter().sum::<f64>() / radii.len() as f64)
    };
    let screened = |samples: &CellSamples, wavenumber: f64| {
        radius(samples).is_some_and(|radius| wavenumber * radius >= 0.5 * FIRST_ZERO)
    };
    let mean = |method, name: &str, level: f64| {
        estimate(method, numbers(points, samples, name), |at, sizes, cells| {
            by_level(at, sizes, level, |cell, chosen| {
                let (_, values) = cells[cell];
                Some(chosen.iter().map(|&i| values[i]).sum::<f64>() / chosen.len() as f64)
            })
        })
    };
    let spectrum = |method, level: f64, of: fn(&[Vec<f64>], &[usize]) -> Option<f64>| {
        let with_powers = points.iter().zip(samples).filter(|(_, samples)| !samples.powers.is_empty());
        let cells: Vec<(f64, usize, &[Vec<f64>])> = with_powers
            .map(|(point, samples)| (point.reduced_pressure, samples.powers.len(), samples.powers.as_slice()))
            .collect();
        estimate(method, cells, |at, sizes, cells| by_level(at, sizes, level, |cell, chosen| of(cells[cell], chosen)))
    };
    [
        plastic(Method::Wavenumber, "wavenumber", &screened),
        plastic(Method::PressureChange, "pressure_change", &|_, change| change < 0.0),
        mean(Method::Anticorrelation, ANTICORRELATION, SCALE_FREE_ANTICORRELATION),
        mean(Method::Angle, ANGLE, SCALE_FREE_ANGLE),
        spectrum(Method::Spectrum, SCALE_FREE_SLOPE, slope_of),
        spectrum(Method::SpectrumLikelihood, SCALE_FREE_SLOPE, likelihood_slope_of),
        // What falls below a level rises above its opposite.
        spectrum(Method::Crossover, -VANISHED, |powers, chosen| Some(-crossover_of(powers, chosen)?)),
    ]
    .into_iter()
    .flatten()
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_fewer_than_eight_samples_do_not_count() {
        let of = |sizes: [usize; 3]| {
            let cells = [1e6, 1e7, 1e8].into_iter().zip(sizes).map(|(at, size)| (at, size, ())).collect();
            let found = estimate(Method::Angle, cells, |at, sizes, _| {
                assert!(sizes.iter().all(|&size| size >= LEAST_SAMPLES));
                TransitionPressure::Above(at[at.len() - 1])
            });
            found.expect("three cells")
        };
        let found = of([8, 30, 7]);
        assert_eq!((found.pressure, found.measured), (TransitionPressure::Above(1e7), Some([1e6, 1e7])));
        assert_eq!(found.sample_count, 8);
        let few = of([7, 30, 7]);
        assert_eq!(few.pressure, TransitionPressure::Uninformative { reason: CannotTell::FewSamples });
        assert_eq!((few.measured, few.sample_count), (None, 7));
    }
}
