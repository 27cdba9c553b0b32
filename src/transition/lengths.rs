//! [`Lengths`]: the screening length ℓ_s and the isostatic length ℓ_iso of a cell; [`JammingSeries`]: ξ below jamming.
//!
//! ```text
//! ℓ_s = 1/κ_fit, mean over the samples with κ_fit ≥ κ_1/2
//! y(x) = (h_∥(r)/h_∥(1.5)) x, x = r ΔZ, of the means over samples        ℓ_iso: the smallest r with y ≥ 1.3
//! ```
//!
//! Source: the study, appendix C and S8 (threshold 1.3), S3 (ξ, φ_J = 0.842).

use serde::Serialize;

use crate::fit::ensemble::{DivergenceAt, DivergenceOutcome, MeasuredPoint, fit_divergence, fit_divergence_at};
use crate::study::{Cell, CellSamples, MeanPoint, Merged, NumberStatistics, Target};
use crate::transition::series::SeriesPoint;

/// y from which on bonds stretch as in a continuum. Source: the study.
pub(crate) const ISOSTATIC_THRESHOLD: f64 = 1.3;

/// Where h_∥ is taken as its unit \[length\].
const NEAR_CENTRE: f64 = 1.5;

/// φ_J. Source: O'Hern, Langer, Liu, Nagel (2002), Phys. Rev. Lett. 88, 075507, as the study cites it.
pub(crate) const JAMMING: f64 = 0.842;

/// Beyond this share of R the rim holds ξ back.
const LARGEST_SHARE: f64 = 0.5;

/// Thresholds of ξ the study has.
const THRESHOLDS: [&str; 4] = ["0.001", "0.0001", "0.00001", "0.000001"];

/// Both lengths of a cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Lengths {
    /// The cell.
    pub point: SeriesPoint,
    /// ΔZ, mean over samples \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excess: Option<f64>,
    /// ℓ_s \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub screening: Option<LengthPoint>,
    /// ℓ_iso \[length\]; absent where y is above the threshold from the start or never.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub isostatic: Option<f64>,
    /// r \[length\], x, y, h_r/h_r(1.5) x \[1\].
    #[serde(skip)]
    pub curve: Vec<[f64; 4]>,
}

/// A length over samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LengthPoint {
    /// Mean \[length\].
    pub mean: f64,
    /// Its standard error, from two samples on \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standard_error: Option<f64>,
    /// Samples that have it.
    pub count: usize,
}

impl Lengths {
    pub(super) fn of(point: &SeriesPoint, samples: &CellSamples) -> Self {
        let number = |name: &str| samples.numbers.get(name).map(|values| NumberStatistics::of(values));
        let excess = number("excess_coordination").map(|it| it.mean);
        let radius = number("outer_radius").map(|it| it.mean);
        let screening: Vec<f64> = samples
            .numbers
            .get("wavenumber")
            .zip(radius)
            .map(|(all, radius)| {
                let screened = all.iter().filter(|&&kappa| kappa * radius >= 0.5 * super::pressure::FIRST_ZERO);
                screened.map(|kappa| kappa.recip()).collect()
            })
            .unwrap_or_default();
        let screening = (!screening.is_empty()).then(|| {
            let found = NumberStatistics::of(&screening);
            LengthPoint { mean: found.mean, standard_error: found.standard_error, count: found.count }
        });
        let curve = excess.filter(|excess| *excess > 0.0).map_or(Vec::new(), |excess| curve(samples, excess));
        Lengths { point: *point, excess, screening, isostatic: reached(&curve), curve }
    }
}

/// p where ℓ_iso falls to the longest screening length, linear in logarithms between cells.
pub(super) fn matching(lengths: &[Lengths], samples: &[&CellSamples]) -> Option<f64> {
    let radii = samples.first()?.numbers.get("outer_radius")?;
    let longest = NumberStatistics::of(radii).mean / super::pressure::FIRST_ZERO;
    let points: Vec<[f64; 2]> = lengths
        .iter()
        .filter_map(|it| Some([libm::log(it.point.pressure), libm::log(it.isostatic? / longest)]))
        .collect();
    points.windows(2).find_map(|pair| {
        let [low, high] = [pair[0], pair[1]];
        let share = low[1] / (low[1] - high[1]);
        (low[1] > 0.0 && high[1] <= 0.0).then(|| libm::exp((1.0 - share) * low[0] + share * high[0]))
    })
}

fn curve(samples: &CellSamples, excess: f64) -> Vec<[f64; 4]> {
    let points = |name: &str| samples.curves.get(name).map_or(Vec::new(), |curve| curve.points());
    let (stretching, radial) = (points("stretching_fluctuation"), points("radial_fluctuation"));
    let unit = |points: &[MeanPoint]| {
        let near = points.iter().min_by(|a, b| (a.x - NEAR_CENTRE).abs().total_cmp(&(b.x - NEAR_CENTRE).abs()));
        near.map_or(f64::NAN, |point| point.y)
    };
    let units = [unit(&stretching), unit(&radial)];
    stretching
        .iter()
        .filter_map(|point| {
            let other = radial.iter().find(|other| other.x.floor() == point.x.floor())?;
            let x = point.x * excess;
            Some([point.x, x, point.y / units[0] * x, other.y / units[1] * x])
        })
        .collect()
}

/// The smallest r at which y rises to the threshold, linear between rings.
fn reached(curve: &[[f64; 4]]) -> Option<f64> {
    let after = curve.iter().position(|point| point[2] >= ISOSTATIC_THRESHOLD).filter(|&place| place > 0)?;
    let (low, high) = (curve[after - 1], curve[after]);
    let share = (ISOSTATIC_THRESHOLD - low[2]) / (high[2] - low[2]);
    Some(low[0] + share * (high[0] - low[0]))
}

/// ξ of one size against φ.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JammingSeries {
    /// The cell of the lowest φ.
    pub cell: Cell,
    /// d_th \[length\].
    pub threshold: f64,
    /// ξ.
    pub points: Vec<PenetrationPoint>,
    /// ν with φ_J = 0.842, of the points with ξ up to R/2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_jamming: Option<DivergenceAt>,
    /// ν and φ_J together.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub free: Option<DivergenceOutcome>,
}

/// ξ at one φ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PenetrationPoint {
    /// φ \[1\].
    pub packing_fraction: f64,
    /// ξ \[length\].
    pub length: LengthPoint,
    /// R \[length\].
    pub outer_radius: f64,
}

impl JammingSeries {
    pub(super) fn all(merged: &Merged) -> Vec<JammingSeries> {
        let mut all: Vec<JammingSeries> = Vec::new();
        for threshold in THRESHOLDS {
            let name = format!("penetration_length_at_{threshold}");
            let threshold: f64 = threshold.parse().unwrap_or(f64::NAN);
            for samples in &merged.samples {
                let Target::PackingFraction(packing_fraction) = samples.cell.target else { continue };
                let (Some(found), Some(radii)) = (samples.numbers.get(&name), samples.numbers.get("outer_radius"))
                else {
                    continue;
                };
                let found = NumberStatistics::of(found);
                let length = LengthPoint { mean: found.mean, standard_error: found.standard_error, count: found.count };
                let outer_radius = NumberStatistics::of(radii).mean;
                let point = PenetrationPoint { packing_fraction, length, outer_radius };
                let own = |it: &&mut JammingSeries| {
                    it.threshold == threshold && it.cell.differs_in_target_alone(&samples.cell)
                };
                match all.iter_mut().find(own) {
                    Some(series) => series.points.push(point),
                    None => all.push(JammingSeries {
                        cell: samples.cell,
                        threshold,
                        points: vec![point],
                        at_jamming: None,
                        free: None,
                    }),
                }
            }
        }
        for series in &mut all {
            series.points.sort_by(|a, b| a.packing_fraction.total_cmp(&b.packing_fraction));
            let usable: Vec<MeasuredPoint> = series
                .points
                .iter()
                .filter(|point| point.length.mean <= LARGEST_SHARE * point.outer_radius)
                .filter_map(|point| {
                    let (x, y) = (point.packing_fraction, point.length.mean);
                    Some(MeasuredPoint { x, y, error: point.length.standard_error? })
                })
                .collect();
            let below: Vec<MeasuredPoint> = usable.iter().copied().filter(|point| point.x < JAMMING).collect();
            series.at_jamming = fit_divergence_at(&below, JAMMING).ok();
            series.free = fit_divergence(&usable).ok();
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_match_where_one_falls_to_the_other() {
        let cell = crate::study::Cell {
            law: Default::default(),
            disk_count: 100,
            target: Target::Pressure(1.0),
            increase: 0.1,
            relaxer: Default::default(),
            boundary: Default::default(),
        };
        let mut samples = CellSamples::new(cell);
        samples.numbers.insert("outer_radius".into(), vec![10.0 * super::super::pressure::FIRST_ZERO]);
        // ℓ_iso = 100/p, and 1/κ_1 = 10.
        let length = |pressure: f64| Lengths {
            point: SeriesPoint { cell: 0, pressure, reduced_pressure: pressure, sample_count: 1 },
            excess: None,
            screening: None,
            isostatic: Some(100.0 / pressure),
            curve: Vec::new(),
        };
        let found = matching(&[length(2.0), length(5.0), length(20.0)], &[&samples]).expect("between 5 and 20");
        assert!((found - 10.0).abs() < 1e-12, "{found}");
        assert_eq!(matching(&[length(11.0), length(20.0)], &[&samples]), None);
    }

    #[test]
    fn the_threshold_is_reached_between_two_rings() {
        let curve = [[1.5, 0.15, 0.15, 0.0], [2.5, 0.25, 1.1, 0.0], [3.5, 0.35, 1.5, 0.0]];
        assert!((reached(&curve).expect("between the last two") - 3.0).abs() < 1e-12);
        assert_eq!(reached(&curve[2..]), None);
        assert_eq!(reached(&curve[..2]), None);
    }
}
