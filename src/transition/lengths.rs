//! [`Lengths`]: the screening length ℓ_s and the isostatic length ℓ_iso of a cell; [`JammingSeries`]: ξ below jamming.
//!
//! ```text
//! ℓ_s = 1/κ_fit, mean over the samples with κ_fit ≥ κ_1/2
//! y(x) = (h_∥(r)/h_∥(1.5)) x, x = r ΔZ, of the means over samples        ℓ_iso: the smallest r with y ≥ 1.3
//! ```
//!
//! The threshold is of disks. For spheres, whose y is (h_∥(r)/h_∥(1.5)) x², none is known: ℓ_iso is that of single samples
//! only, in their records.
//!
//! The interval of ℓ_iso is from resampling the samples of the cell, each with its h_∥ and ΔZ. The radii of rings are
//! fixed: means over all samples.
//!
//! Source: the study, appendix C and S8 (threshold 1.3), S3 (ξ, φ_J = 0.842).

use serde::Serialize;

use crate::fit::ensemble::{
    DivergenceAt, DivergenceOutcome, MeasuredPoint, bootstrap, bootstrap_all, fit_divergence, fit_divergence_at,
};
use crate::study::{Cell, CellSamples, MeanPoint, Merged, NumberStatistics, StretchingRow, Target};
use crate::transition::evidence::{RESAMPLINGS, Sampled};
use crate::transition::pressure::poles;
use crate::transition::series_point::SeriesPoint;

/// y beyond which bonds stretch as in a continuum. Source: the study.
pub(crate) const ISOSTATIC_THRESHOLD: f64 = 1.3;

/// Radius at which h_∥ is the unit \[length\].
const NEAR_CENTRE: f64 = 1.5;

/// φ_J. Source: O'Hern, Langer, Liu, Nagel (2002), Phys. Rev. Lett. 88, 075507, as cited by the study.
pub(crate) const JAMMING: f64 = 0.842;

/// Share of R above which the rim limits ξ.
const LARGEST_SHARE: f64 = 0.5;

/// Thresholds of ξ in the study.
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
    /// ℓ_iso \[length\]; absent if y is above the threshold in all rings or in none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub isostatic: Option<Sampled>,
    /// ℓ_iso ΔZ \[length\], with ΔZ of the resampled samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scaled_isostatic: Option<Sampled>,
    /// r \[length\], x, y, h_r/h_r(1.5) x^(D−1) \[1\].
    #[serde(skip)]
    pub curve: Vec<[f64; 4]>,
}

/// A length over samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LengthPoint {
    /// Mean \[length\].
    pub mean: f64,
    /// Its standard error, for at least two samples \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standard_error: Option<f64>,
    /// Number of samples with this length.
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
                let screened =
                    all.iter().filter(|&&kappa| kappa * radius >= 0.5 * poles(samples.cell.spreading_dimension())[0]);
                screened.map(|kappa| kappa.recip()).collect()
            })
            .unwrap_or_default();
        let screening = (!screening.is_empty()).then(|| {
            let found = NumberStatistics::of(&screening);
            LengthPoint { mean: found.mean, standard_error: found.standard_error, count: found.count }
        });
        let curve = excess.filter(|excess| *excess > 0.0).map_or(Vec::new(), |excess| curve(samples, excess));
        let [isostatic, scaled_isostatic] = isostatic(samples);
        Lengths { point: *point, excess, screening, isostatic, scaled_isostatic, curve }
    }
}

/// ℓ_iso and ℓ_iso ΔZ with their intervals.
fn isostatic(samples: &CellSamples) -> [Option<Sampled>; 2] {
    if samples.cell.spreading_dimension() != 2 {
        return [None, None];
    }
    let (rows, radii) = (&samples.stretching, ring_radii(samples));
    let found = bootstrap_all(&[rows.len()], RESAMPLINGS, |groups| {
        let [length, excess] = isostatic_of(rows, &radii, &groups[0])?;
        Some(vec![length, length * excess])
    });
    let found = found.unwrap_or_default();
    [0, 1].map(|i| found.get(i).map(|&found| Sampled { found, sample_count: rows.len() }))
}

/// Index and mean radius of every ring \[length\].
fn ring_radii(samples: &CellSamples) -> Vec<(usize, f64)> {
    let points = samples.curves.get("stretching_fluctuation").map_or(Vec::new(), |curve| curve.points());
    points.iter().map(|point| (point.x.floor() as usize, point.x)).collect()
}

/// ℓ_iso and ΔZ of some of the samples.
fn isostatic_of(rows: &[StretchingRow], radii: &[(usize, f64)], chosen: &[usize]) -> Option<[f64; 2]> {
    let excess = chosen.iter().map(|&i| rows[i].excess).sum::<f64>() / chosen.len() as f64;
    if excess.is_nan() || excess <= 0.0 {
        return None;
    }
    let mean = |place: usize| {
        let values = chosen.iter().filter_map(|&i| rows[i].rings.get(place)).filter(|value| value.is_finite());
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
        (count > 0.0).then_some(sum / count)
    };
    let rings: Vec<(f64, f64)> = radii.iter().filter_map(|&(place, radius)| Some((radius, mean(place)?))).collect();
    let near = rings.iter().min_by(|a, b| (a.0 - NEAR_CENTRE).abs().total_cmp(&(b.0 - NEAR_CENTRE).abs()))?;
    let curve: Vec<(f64, f64)> =
        rings.iter().map(|&(radius, fluctuation)| (radius, fluctuation / near.1 * radius * excess)).collect();
    Some([reached(&curve)?, excess])
}

/// p where ℓ_iso falls to the longest screening length, by linear interpolation in logarithms; the samples of all cells
/// are resampled.
pub(super) fn matching(points: &[SeriesPoint], samples: &[&CellSamples]) -> Option<Sampled> {
    let first = samples.first().filter(|samples| samples.cell.spreading_dimension() == 2)?;
    let radii = first.numbers.get("outer_radius")?;
    let longest = NumberStatistics::of(radii).mean / poles(2)[0];
    let pressures: Vec<f64> = points.iter().map(|point| point.pressure).collect();
    let rings: Vec<Vec<(usize, f64)>> = samples.iter().map(|samples| ring_radii(samples)).collect();
    let matched_of = |groups: &[Vec<usize>]| {
        let length = |cell: usize| Some(isostatic_of(&samples[cell].stretching, &rings[cell], &groups[cell])?[0]);
        let lengths: Vec<Option<f64>> = (0..samples.len()).map(length).collect();
        matched(&pressures, &lengths, longest)
    };
    let sizes: Vec<usize> = samples.iter().map(|samples| samples.stretching.len()).collect();
    let all: Vec<Vec<usize>> = sizes.iter().map(|&size| (0..size).collect()).collect();
    let (_, cells) = matched_of(&all)?;
    let found = bootstrap(&sizes, RESAMPLINGS, |groups| Some(matched_of(groups)?.0))?;
    Some(Sampled { found, sample_count: sizes[cells[0]].min(sizes[cells[1]]) })
}

/// p where a length falls to another, and the two cells around it.
fn matched(pressures: &[f64], lengths: &[Option<f64>], longest: f64) -> Option<(f64, [usize; 2])> {
    let points: Vec<(usize, [f64; 2])> = lengths
        .iter()
        .enumerate()
        .filter_map(|(cell, length)| Some((cell, [libm::log(pressures[cell]), libm::log((*length)? / longest)])))
        .collect();
    points.windows(2).find_map(|pair| {
        let [(below, low), (above, high)] = [pair[0], pair[1]];
        let share = low[1] / (low[1] - high[1]);
        (low[1] > 0.0 && high[1] <= 0.0).then(|| (libm::exp((1.0 - share) * low[0] + share * high[0]), [below, above]))
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
            // An inflated disk is held: its strain falls as 1/r^(D−1).
            let factor = x.powi(samples.cell.dimension as i32 - 1);
            Some([point.x, x, point.y / units[0] * factor, other.y / units[1] * factor])
        })
        .collect()
}

/// The smallest r at which y rises to the threshold, by linear interpolation between rings.
fn reached(curve: &[(f64, f64)]) -> Option<f64> {
    let after = curve.iter().position(|point| point.1 >= ISOSTATIC_THRESHOLD).filter(|&place| place > 0)?;
    let (low, high) = (curve[after - 1], curve[after]);
    let share = (ISOSTATIC_THRESHOLD - low.1) / (high.1 - low.1);
    Some(low.0 + share * (high.0 - low.0))
}

/// ξ of one size against φ.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JammingSeries {
    /// The cell with the lowest φ.
    pub cell: Cell,
    /// d_th \[length\].
    pub threshold: f64,
    /// ξ of every cell.
    pub points: Vec<PenetrationPoint>,
    /// Smallest number of samples of a fitted point; 0 without fitted points.
    pub sample_count: usize,
    /// ν for φ_J = 0.842, from the points with ξ up to R/2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_jamming: Option<DivergenceAt>,
    /// Fit of both ν and φ_J.
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
                        sample_count: 0,
                        at_jamming: None,
                        free: None,
                    }),
                }
            }
        }
        for series in &mut all {
            series.points.sort_by(|a, b| a.packing_fraction.total_cmp(&b.packing_fraction));
            let within = |point: &&PenetrationPoint| point.length.mean <= LARGEST_SHARE * point.outer_radius;
            series.sample_count =
                series.points.iter().filter(within).map(|point| point.length.count).min().unwrap_or(0);
            let usable: Vec<MeasuredPoint> = series
                .points
                .iter()
                .filter(within)
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
    use std::collections::BTreeMap;

    use super::*;
    use crate::study::{Record, RecordOutcome};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    #[test]
    fn lengths_match_where_one_falls_to_the_other() {
        // ℓ = 100/p, and 10.
        let of = |pressures: [f64; 3]| matched(&pressures, &pressures.map(|pressure| Some(100.0 / pressure)), 10.0);
        let (pressure, cells) = of([2.0, 5.0, 20.0]).expect("between 5 and 20");
        assert!((pressure - 10.0).abs() < 1e-12 && cells == [1, 2], "{pressure}");
        assert_eq!(of([11.0, 20.0, 30.0]), None);
        let (_, cells) = matched(&[2.0, 5.0, 20.0], &[Some(50.0), None, Some(5.0)], 10.0).expect("between 2 and 20");
        assert_eq!(cells, [0, 2]);
    }

    #[test]
    fn the_threshold_is_reached_between_two_rings() {
        let curve = [(1.5, 0.15), (2.5, 1.1), (3.5, 1.5)];
        assert!((reached(&curve).expect("between the last two") - 3.0).abs() < 1e-12);
        assert_eq!(reached(&curve[2..]), None);
        assert_eq!(reached(&curve[..2]), None);
    }

    /// A cell whose samples have h_∥ = unit (1 + scatter) at all radii, and ΔZ about 0.3.
    fn cell_of(seed: u64, count: usize, pressure: f64, unit: f64) -> (SeriesPoint, CellSamples) {
        let mut generator = Pcg64::seed_from_u64(seed);
        let cell = Cell {
            dimension: 2,
            law: Default::default(),
            disk_count: 100,
            target: Target::Pressure(pressure),
            increase: 0.1,
            relaxer: Default::default(),
            boundary: Default::default(),
            centre_held: true,
        };
        let mut samples = CellSamples::new(cell);
        for seed in 0..count {
            let mut draw = || generator.random::<f64>() - 0.5;
            let numbers = BTreeMap::from([
                ("excess_coordination".to_string(), unit * (1.0 + 0.2 * draw())),
                ("outer_radius".to_string(), 8.0 * poles(2)[0]),
            ]);
            let rings: Vec<[f64; 2]> =
                (1..30).map(|place| [f64::from(place) + 0.5, 0.01 * (1.0 + 0.4 * draw())]).collect();
            let curves = BTreeMap::from([
                ("stretching_fluctuation".to_string(), rings.clone()),
                ("radial_fluctuation".to_string(), rings),
            ]);
            let outcome = RecordOutcome::Done { phase: Default::default(), numbers, curves };
            samples.add(&Record { cell, seed: seed as u64, outcome });
        }
        let point = SeriesPoint { cell: 0, pressure, reduced_pressure: pressure, sample_count: count };
        (point, samples)
    }

    #[test]
    fn the_isostatic_length_has_the_interval_of_its_samples() {
        // y = r ΔZ reaches 1.3 at r = 1.3/0.3.
        let of = |seed: u64, count: usize| {
            let (point, samples) = cell_of(seed, count, 1.0, 0.3);
            Lengths::of(&point, &samples)
        };
        let lengths = of(1, 40);
        let found = lengths.isostatic.expect("it is reached");
        assert_eq!(found.sample_count, 40);
        // The means of the curve and those of the rows agree.
        let curve: Vec<(f64, f64)> = lengths.curve.iter().map(|row| (row[0], row[2])).collect();
        assert!((found.found.best / reached(&curve).expect("it is reached") - 1.0).abs() < 1e-12);
        let product = lengths.scaled_isostatic.expect("likewise").found;
        assert!((product.best / found.found.best - lengths.excess.expect("ΔZ")).abs() < 1e-12);
        // 95 % intervals of 30 studies of 40 samples: 28.5 are expected to contain the true value, with a standard
        // deviation of 1.2.
        let held = (0..30).filter(|&seed| of(100 + seed, 40).isostatic.expect("it is reached").found.holds(1.3 / 0.3));
        let held = held.count();
        assert!(held >= 25, "{held} of 30");
        let Some([low, high]) = of(1, 160).isostatic.and_then(|it| it.found.interval) else { panic!("no interval") };
        let Some([wide_low, wide_high]) = found.found.interval else { panic!("no interval") };
        // Four times the samples: half the width, to a fifth.
        let share = (high - low) / (wide_high - wide_low);
        assert!((0.35..0.7).contains(&share), "{share}");
    }

    #[test]
    fn spheres_have_the_square_of_the_scaled_distance_and_no_threshold() {
        let (point, mut samples) = cell_of(1, 10, 1.0, 0.3);
        let plane = Lengths::of(&point, &samples).curve;
        samples.cell.dimension = 3;
        let lengths = Lengths::of(&point, &samples);
        for (row, other) in lengths.curve.iter().zip(&plane) {
            assert_eq!(row[..2], other[..2]);
            for place in [2, 3] {
                // y = (h/h_0) x² in place of (h/h_0) x, three rounded products.
                assert!((row[place] / (other[place] * row[1]) - 1.0).abs() < 1e-15);
            }
        }
        assert!(lengths.isostatic.is_none() && lengths.scaled_isostatic.is_none());
        assert!(matching(&[point], &[&samples]).is_none());
    }

    #[test]
    fn the_pressure_of_equal_lengths_has_the_interval_of_both_cells() {
        // ℓ_iso = 1.3/ΔZ: 13 and 1.3/0.3 = 4.33; the longest screening length is 8.
        let cells = [cell_of(1, 20, 1.0, 0.1), cell_of(2, 12, 10.0, 0.3)];
        let (points, samples): (Vec<SeriesPoint>, Vec<&CellSamples>) =
            cells.iter().map(|(point, samples)| (*point, samples)).unzip();
        let found = matching(&points, &samples).expect("between both");
        assert_eq!(found.sample_count, 12);
        let truth = libm::pow(10.0, libm::log(13.0 / 8.0) / libm::log(3.0));
        let error = found.found.standard_error.expect("an interval");
        assert!((found.found.best - truth).abs() < 4.0 * error && error < 0.2 * truth, "{:?}", found.found);
        let Some([low, high]) = found.found.interval else { panic!("no interval") };
        assert!(low < found.found.best && found.found.best < high);
    }
}
