//! [`Scaling`]: the exponents of N and d_0 that collapse the curves of a law; [`PressureLaw`]: how p_c depends on both.
//!
//! ```text
//! G*, θ* = F(p N^a d_0^(−b))        a = β/2, b = β/4, β = 2(α − 1): 3/2 and 3/4 for Hertzian disks, 1 and 1/2 for
//! Hookean ones
//! N^β p_c = C (N² d_0)^c            c = β/4
//! ```
//!
//! Series relaxed by different methods do not collapse: each relaxer has its own exponents.
//!
//! Source: the study, appendix D.

use serde::Serialize;

use crate::fit::ensemble::{
    BootstrapInterval, CollapseOutcome, CollapseQuality, CollapseSettings, Curve, MeasuredPoint, PowerLaw,
    bootstrap_all, collapse, collapse_quality, fit_power_law,
};
use crate::law::choice::LawChoice;
use crate::relax::RelaxerChoice;
use crate::study::Merged;
use crate::transition::pressure::{Method, TransitionPressure};
use crate::transition::series::Series;
use crate::transition::series_point::ANTICORRELATION;

/// Number of bootstrap resamplings of a collapse; each is a separate minimisation.
const RESAMPLINGS: usize = 100;

/// Minimum number of samples of a point of a curve; with fewer the error of its mean is unreliable.
const LEAST_SAMPLES: usize = 4;

/// Collapsed observables: G*, and θ* for every threshold of the study.
const OBSERVABLES: [&str; 5] = [
    ANTICORRELATION,
    "correlation_angle_at_0.1",
    "correlation_angle_at_0.02",
    "correlation_angle_at_0.05",
    "correlation_angle_at_0.2",
];

/// The collapse of the curves of one observable, for one law and relaxer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scaling {
    /// The law.
    pub law: LawChoice,
    /// Relaxer after the inflation.
    pub relaxer: RelaxerChoice,
    /// The observable, by its name in records.
    pub observable: &'static str,
    /// Number of curves: series with several pressures.
    pub curve_count: usize,
    /// Smallest number of samples of a cell on the curves.
    pub sample_count: usize,
    /// a of N^a; absent if all sizes are equal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size_exponent: Option<ExponentOutcome>,
    /// b of d_0^(−b); absent if all inflations are equal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inflation_exponent: Option<ExponentOutcome>,
    /// S at the best exponents: 1 if curves agree within their errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quality: Option<CollapseQuality>,
    /// S at the exponents of the theory: those published for disks; for spheres that of p̂.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub published_quality: Option<CollapseQuality>,
}

/// The result for an exponent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExponentOutcome {
    /// The exponent with its interval.
    Found(BootstrapInterval),
    /// The best collapse is at the end of the search range, −1 to 4.
    AtEdge(f64),
    /// The curves do not overlap at any exponent.
    NoOverlap,
}

/// N^β p_c as a power law of N² d_0.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PressureLaw {
    /// The law.
    pub law: LawChoice,
    /// Relaxer after the inflation.
    pub relaxer: RelaxerChoice,
    /// Method to determine p_c.
    pub method: Method,
    /// Smallest number of samples of a cell behind p_c.
    pub sample_count: usize,
    /// (N² d_0, N^β p_c, its standard error).
    pub points: Vec<MeasuredPoint>,
    /// The fit; absent for fewer than three points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fit: Option<PowerLaw>,
}

/// β = 2(α − 1).
pub(crate) fn beta(law: &LawChoice) -> f64 {
    2.0 * (law.exponent() - 1.0)
}

/// β/D, the exponent of N in p̂. Source: the study for D = 2; the chapter on spheres.
fn size_exponent(series: &Series) -> f64 {
    beta(&series.cell.law) / series.cell.dimension as f64
}

/// Laws with their relaxers, in the order of the series.
pub(crate) fn laws_and_relaxers(series: &[Series]) -> Vec<(LawChoice, RelaxerChoice)> {
    let mut all = Vec::new();
    for one in series {
        let own = (one.cell.law, one.cell.relaxer);
        if !all.contains(&own) {
            all.push(own);
        }
    }
    all
}

/// One cell of a curve: p, and the values of its samples.
type Values<'a> = Vec<(f64, &'a [f64])>;

impl Scaling {
    pub(super) fn all(merged: &Merged, series: &[Series]) -> Vec<Scaling> {
        let of_group = |(law, relaxer): (LawChoice, RelaxerChoice)| {
            let is_own = |it: &&Series| (it.cell.law, it.cell.relaxer) == (law, relaxer) && it.points.len() > 1;
            let own: Vec<&Series> = series.iter().filter(is_own).collect();
            let of = |observable: &&'static str| Self::of(merged, (law, relaxer), &own, observable);
            OBSERVABLES.iter().filter_map(of).collect::<Vec<_>>()
        };
        laws_and_relaxers(series).into_iter().flat_map(of_group).collect()
    }

    fn of(
        merged: &Merged,
        (law, relaxer): (LawChoice, RelaxerChoice),
        series: &[&Series],
        observable: &'static str,
    ) -> Option<Scaling> {
        let curves: Vec<([f64; 2], Values<'_>)> = series
            .iter()
            .map(|one| {
                let values = one.points.iter().filter_map(|point| {
                    let values = merged.samples[point.cell].numbers.get(observable)?;
                    (values.len() >= LEAST_SAMPLES).then_some((point.pressure, values.as_slice()))
                });
                ([libm::log(one.mobile_count()), -libm::log(one.cell.increase)], values.collect())
            })
            .filter(|(_, values): &(_, Values<'_>)| values.len() > 1)
            .collect();
        let varies = |k: usize| curves.iter().any(|(scales, _)| scales[k] != curves[0].0[k]);
        let published = [size_exponent(series.first()?), 0.25 * beta(&law)];
        let found = match curves.len() {
            0 | 1 => return None,
            _ => match (varies(0), varies(1)) {
                (true, true) => exponents(&curves, [0, 1], published),
                (true, false) => exponents(&curves, [0], [published[0]]),
                (false, true) => exponents(&curves, [1], [published[1]]),
                (false, false) => return None,
            },
        };
        let mut outcomes = found.outcomes.into_iter();
        let counts = curves.iter().flat_map(|(_, values)| values.iter().map(|(_, all)| all.len()));
        Some(Scaling {
            law,
            relaxer,
            observable,
            curve_count: curves.len(),
            sample_count: counts.min().unwrap_or(0),
            size_exponent: if varies(0) { outcomes.next() } else { None },
            inflation_exponent: if varies(1) { outcomes.next() } else { None },
            quality: found.quality,
            published_quality: found.published,
        })
    }
}

struct Exponents {
    outcomes: Vec<ExponentOutcome>,
    quality: Option<CollapseQuality>,
    published: Option<CollapseQuality>,
}

/// The best exponents of the scale factors `which`, with intervals.
fn exponents<const K: usize>(curves: &[([f64; 2], Values<'_>)], which: [usize; K], published: [f64; K]) -> Exponents {
    let settings = CollapseSettings { ranges: [[-1.0, 4.0]; K], ..CollapseSettings::default() };
    let sizes: Vec<usize> = curves.iter().flat_map(|(_, values)| values.iter().map(|(_, all)| all.len())).collect();
    let drawn = |groups: &[Vec<usize>]| -> Option<Vec<Curve<K>>> {
        let mut groups = groups.iter();
        let curve = |(scales, values): &([f64; 2], Values<'_>)| {
            let points: Option<Vec<MeasuredPoint>> =
                values.iter().map(|(x, all)| measured(*x, all, groups.next()?)).collect();
            Some(Curve { scales: which.map(|k| scales[k]), points: points? })
        };
        curves.iter().map(curve).collect()
    };
    let whole: Vec<Vec<usize>> = sizes.iter().map(|&size| (0..size).collect()).collect();
    let Some(all) = drawn(&whole) else {
        return Exponents { outcomes: vec![ExponentOutcome::NoOverlap; K], quality: None, published: None };
    };
    let published = collapse_quality(&all, published).ok().flatten();
    let (outcomes, quality) = match collapse(&all, &settings) {
        Ok(CollapseOutcome::Found(found)) => {
            let intervals = bootstrap_all(&sizes, RESAMPLINGS, |groups| {
                Some(collapse(&drawn(groups)?, &settings).ok()?.exponents()?.to_vec())
            });
            let outcome = |k: usize| {
                let interval = intervals.as_ref().and_then(|all| all.get(k)).copied();
                interval.map_or(ExponentOutcome::AtEdge(found.exponents[k]), ExponentOutcome::Found)
            };
            ((0..K).map(outcome).collect(), Some(found.quality))
        }
        Ok(CollapseOutcome::AtEdge { exponents, quality, .. }) => {
            (exponents.map(ExponentOutcome::AtEdge).to_vec(), Some(quality))
        }
        _ => (vec![ExponentOutcome::NoOverlap; K], None),
    };
    Exponents { outcomes, quality, published }
}

/// Mean and standard error of the resampled samples; none if all are the same sample.
fn measured(x: f64, values: &[f64], chosen: &[usize]) -> Option<MeasuredPoint> {
    let count = chosen.len() as f64;
    let y = chosen.iter().map(|&i| values[i]).sum::<f64>() / count;
    let square: f64 = chosen.iter().map(|&i| (values[i] - y).powi(2)).sum();
    let error = (square / (count - 1.0) / count).sqrt();
    (error > 0.0).then_some(MeasuredPoint { x, y, error })
}

impl PressureLaw {
    pub(super) fn all(series: &[Series]) -> Vec<PressureLaw> {
        let mut all: Vec<PressureLaw> = Vec::new();
        // The argument N² d_0 is of disks.
        for one in series.iter().filter(|one| one.cell.spreading_dimension() == 2) {
            let (law, relaxer, mobile) = (one.cell.law, one.cell.relaxer, one.mobile_count());
            for estimate in &one.estimates {
                let TransitionPressure::Found(found) = estimate.pressure else { continue };
                let Some(error) = found.standard_error.filter(|error| *error > 0.0) else { continue };
                // N^β p = p̂ N^(β/2).
                let scale = libm::pow(mobile, 0.5 * beta(&law));
                let point = MeasuredPoint {
                    x: mobile * mobile * one.cell.increase,
                    y: scale * found.best,
                    error: scale * error,
                };
                let (method, sample_count) = (estimate.method, estimate.sample_count);
                let is_own = |it: &&mut PressureLaw| (it.law, it.relaxer, it.method) == (law, relaxer, estimate.method);
                match all.iter_mut().find(is_own) {
                    Some(own) => {
                        own.points.push(point);
                        own.sample_count = own.sample_count.min(sample_count);
                    }
                    None => {
                        all.push(PressureLaw { law, relaxer, method, sample_count, points: vec![point], fit: None });
                    }
                }
            }
        }
        for one in &mut all {
            one.fit = (one.points.len() > 2).then(|| fit_power_law(&one.points).ok()).flatten();
        }
        all
    }
}
