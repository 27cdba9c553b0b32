//! [`Series`]: the cells of a study that differ only in the pressure.

use serde::Serialize;

use crate::fit::ensemble::bootstrap;
use crate::study::{Cell, CellSamples, Merged, NumberStatistics, Target};
use crate::transition::estimates::estimates;
use crate::transition::evidence::{RESAMPLINGS, Sampled};
use crate::transition::lengths::{Lengths, matching};
use crate::transition::pressure::{MethodEstimate, TransitionPressure};
use crate::transition::series_point::{ANGLE, ANTICORRELATION, SeriesPoint};
use crate::transition::spectra::{AngleDivergence, CellSpectrum, likelihood_slope_of, slope_of};

/// Cells that differ only in the pressure, in ascending order.
#[derive(Debug, Clone, Serialize)]
pub struct Series {
    /// The cell with the lowest pressure; its target does not apply to the others.
    pub cell: Cell,
    /// The cells.
    pub points: Vec<SeriesPoint>,
    /// S(f) of every cell with a spectrum.
    pub spectra: Vec<CellSpectrum>,
    /// θ†(p̂) below the transition.
    pub divergence: AngleDivergence,
    /// p̂_c by every method whose observable was measured.
    pub estimates: Vec<MethodEstimate>,
    /// G* and θ* at p̂_c by the slope of the spectrum (least squares), if that p̂_c exists.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_transition: Option<AtPressure>,
    /// G*, θ* and slope at the p̂_c published for Hertzian disks, 10⁸, if the series spans it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_published: Option<AtPressure>,
    /// ℓ_s and ℓ_iso of every cell.
    pub lengths: Vec<Lengths>,
    /// p where ℓ_iso equals R/3.83 = 1/κ_1, the longest screening length, by linear interpolation in logarithms. Its
    /// interval is from resampling all cells \[force / length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub matching: Option<Sampled>,
    /// Δp/p^((α−2)/(α−1)) of every cell with this number.
    pub pressure_changes: Vec<Option<NumberStatistics>>,
}

/// Values at one p̂, by linear interpolation in ln p̂ between two cells.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AtPressure {
    /// p̂ = p N^(α−1) \[force / length, as p\].
    pub reduced_pressure: f64,
    /// G*.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anticorrelation: Option<Sampled>,
    /// θ* \[rad\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<Sampled>,
    /// s of S ∝ f^(−s), by least squares in logarithms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slope: Option<Sampled>,
    /// s by maximum likelihood.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub likelihood_slope: Option<Sampled>,
}

/// p̂_c for Hertzian disks by the spectrum. Source: the study.
pub(crate) const PUBLISHED: f64 = 1e8;

impl Series {
    /// All series of a study.
    pub(super) fn all(merged: &Merged) -> Vec<Series> {
        let mut grouped: Vec<(Cell, Vec<SeriesPoint>)> = Vec::new();
        for (index, samples) in merged.samples.iter().enumerate() {
            let jammed = !matches!(samples.cell.target, Target::PackingFraction(_));
            let mean = |name: &str| {
                samples.numbers.get(name).filter(|_| jammed).map(|values| NumberStatistics::of(values).mean)
            };
            let (Some(pressure), Some(reduced_pressure)) = (mean("pressure"), mean("reduced_pressure")) else {
                continue;
            };
            let point = SeriesPoint { cell: index, pressure, reduced_pressure, sample_count: samples.done_count };
            let place = grouped.iter_mut().find(|(cell, _)| cell.differs_in_target_alone(&samples.cell));
            match place {
                Some((_, points)) => points.push(point),
                None => grouped.push((samples.cell, vec![point])),
            }
        }
        let series = grouped.into_iter().map(|(_, mut points)| {
            points.sort_by(|a, b| a.reduced_pressure.total_cmp(&b.reduced_pressure));
            Series::of(merged, points)
        });
        series.collect()
    }

    fn of(merged: &Merged, points: Vec<SeriesPoint>) -> Series {
        let samples: Vec<&CellSamples> = points.iter().map(|point| &merged.samples[point.cell]).collect();
        let spectra: Vec<CellSpectrum> =
            points.iter().zip(&samples).filter_map(|(point, samples)| CellSpectrum::of(point, samples)).collect();
        let estimates = estimates(&points, &samples);
        let critical = estimates.iter().find_map(MethodEstimate::by_spectrum).and_then(TransitionPressure::best);
        let lengths: Vec<Lengths> =
            points.iter().zip(&samples).map(|(point, samples)| Lengths::of(point, samples)).collect();
        Series {
            cell: samples[0].cell,
            matching: matching(&points, &samples),
            pressure_changes: points
                .iter()
                .map(|point| merged.cells[point.cell].numbers.get("scaled_pressure_change").copied())
                .collect(),
            divergence: AngleDivergence::of(&spectra, critical),
            at_transition: critical.and_then(|at| AtPressure::of(&points, &samples, at)),
            at_published: AtPressure::of(&points, &samples, PUBLISHED).filter(|_| samples[0].cell.is_published()),
            lengths,
            points,
            spectra,
            estimates,
        }
    }

    /// N, the number of disks in the circle by area.
    pub fn mobile_count(&self) -> f64 {
        self.cell.mobile_count()
    }

    /// A description with law, size, inflation and relaxer.
    pub fn name(&self) -> String {
        let Cell { law, disk_count, increase, relaxer, .. } = self.cell;
        let disks = self.cell.particles();
        let (law, relaxer, drive) = (law.name(), relaxer.description(), self.cell.drive_words());
        format!("{law} {disk_count} {disks}, d_0 = {increase}, {relaxer}{drive}")
    }
}

impl AtPressure {
    fn of(points: &[SeriesPoint], samples: &[&CellSamples], reduced_pressure: f64) -> Option<Self> {
        let above = points.iter().position(|point| point.reduced_pressure >= reduced_pressure)?;
        // The published value may be the lowest target, within the tolerance of the preparation.
        let below = match above {
            0 if points[0].reduced_pressure <= 1.02 * reduced_pressure => 0,
            0 => return None,
            above => above - 1,
        };
        let (low, high) = (libm::log(points[below].reduced_pressure), libm::log(points[above].reduced_pressure));
        let share = if above == below { 0.0 } else { (libm::log(reduced_pressure) - low) / (high - low) };
        let between = |values: [f64; 2]| (1.0 - share) * values[0] + share * values[1];
        let pair = [samples[below], samples[above]];
        let of_number = |name: &str| {
            let values = [pair[0].numbers.get(name)?, pair[1].numbers.get(name)?];
            let mean = |side: usize, chosen: &[usize]| {
                chosen.iter().map(|&i| values[side][i]).sum::<f64>() / chosen.len() as f64
            };
            let sizes = [values[0].len(), values[1].len()];
            let found =
                bootstrap(&sizes, RESAMPLINGS, |groups| Some(between([mean(0, &groups[0]), mean(1, &groups[1])])))?;
            Some(Sampled { found, sample_count: sizes[0].min(sizes[1]) })
        };
        let of_powers = |of: fn(&[Vec<f64>], &[usize]) -> Option<f64>| {
            let sizes = [pair[0].powers.len(), pair[1].powers.len()];
            let slope = |side: usize, chosen: &[usize]| of(&pair[side].powers, chosen);
            let found =
                bootstrap(&sizes, RESAMPLINGS, |groups| Some(between([slope(0, &groups[0])?, slope(1, &groups[1])?])))?;
            Some(Sampled { found, sample_count: sizes[0].min(sizes[1]) })
        };
        Some(AtPressure {
            reduced_pressure,
            anticorrelation: of_number(ANTICORRELATION),
            angle: of_number(ANGLE),
            slope: of_powers(slope_of),
            likelihood_slope: of_powers(likelihood_slope_of),
        })
    }
}
