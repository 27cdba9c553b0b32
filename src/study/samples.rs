//! [`CellSamples`]: the data kept of all samples of a cell. A study of any length fits in memory.
//!
//! Of every sample: its numbers, the powers of its ring, and the stretching fluctuation of its rings if it has an
//! isostatic length. Of curves: sums over samples. Of the first few samples: the radial profile. For 5548 disks this is
//! about 120 numbers per sample, 41 of them for the rings: 1 kB, so 100 MB for 10⁵ samples.

use std::collections::BTreeMap;

use crate::response::{EvidenceCounts, PhaseOutcome};
use crate::study::record::{Cell, FailureKind, Record, RecordOutcome};
use crate::study::statistics::{CellStatistics, NumberStatistics, PhaseCounts};

/// Number of samples with their own radial profile.
const SINGLE_COUNT: usize = 4;

/// All samples of a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellSamples {
    /// The cell.
    pub cell: Cell,
    /// Samples measured.
    pub done_count: usize,
    /// Samples that failed, by type of failure.
    pub failures: BTreeMap<FailureKind, usize>,
    /// Samples of every phase.
    pub phases: PhaseCounts,
    /// Numbers of samples by phase, for every type of evidence.
    pub evidence: EvidenceCounts,
    /// Numbers by name \[unit in the table of names in the book\], of the samples with this number, in the order of the
    /// plan.
    pub numbers: BTreeMap<String, Vec<f64>>,
    /// P_f over the variance of the ring, f = 1, 2, …, of every sample with this spectrum.
    pub powers: Vec<Vec<f64>>,
    /// h_∥ of every ring with ΔZ, of every sample with both: 8 bytes per ring.
    pub stretching: Vec<StretchingRow>,
    /// Curves by name, averaged.
    pub curves: BTreeMap<String, MeanCurve>,
    /// The first samples.
    pub singles: Vec<Single>,
}

/// The stretching fluctuation of one sample.
#[derive(Debug, Clone, PartialEq)]
pub struct StretchingRow {
    /// ΔZ \[1\].
    pub excess: f64,
    /// Mean h_∥ of the rings from r = i to i + 1 at index i \[length\]; NaN if there is none.
    pub rings: Vec<f64>,
}

impl StretchingRow {
    fn of(excess: f64, points: &[[f64; 2]]) -> Self {
        let places = |[radius, _]: &[f64; 2]| radius.floor() as usize;
        let count = points.iter().map(places).max().map_or(0, |last| last + 1);
        let mut sums = vec![(0.0, 0.0); count];
        for point in points {
            let sum = &mut sums[places(point)];
            *sum = (sum.0 + point[1], sum.1 + 1.0);
        }
        // 0/0 is NaN.
        StretchingRow { excess, rings: sums.into_iter().map(|(sum, count)| sum / count).collect() }
    }
}

/// One sample's radial profile.
#[derive(Debug, Clone, PartialEq)]
pub struct Single {
    /// Its seed.
    pub seed: u64,
    /// (r, ⟨d_r⟩) \[length\].
    pub profile: Vec<[f64; 2]>,
    /// Its numbers \[unit in the table of names in the book\].
    pub numbers: BTreeMap<String, f64>,
}

/// A curve averaged over samples, bin by bin.
///
/// Angles and frequencies are the same in all samples. Points at distances are in bins as wide as a ring, those at r̂
/// in bins of a tenth of R.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeanCurve {
    /// By bin.
    sums: BTreeMap<i64, Sums>,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Sums {
    count: usize,
    abscissa: f64,
    /// First value; sums are relative to it, so that no digits are lost.
    first: f64,
    ordinate: f64,
    square: f64,
}

/// One point of a mean curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanPoint {
    /// Mean abscissa \[unit in the list of curves in the book\].
    pub x: f64,
    /// Mean ordinate \[unit in the list of curves in the book\].
    pub y: f64,
    /// Its standard error \[unit of the ordinate\]; none from one sample.
    pub standard_error: Option<f64>,
    /// Number of samples.
    pub count: usize,
}

impl MeanCurve {
    fn add(&mut self, points: &[[f64; 2]], place: impl Fn(usize, f64) -> i64) {
        for (index, &[x, y]) in points.iter().enumerate() {
            let sums = self.sums.entry(place(index, x)).or_insert(Sums { first: y, ..Sums::default() });
            sums.count += 1;
            sums.abscissa += x;
            sums.ordinate += y - sums.first;
            sums.square += (y - sums.first) * (y - sums.first);
        }
    }

    /// Its points, in ascending order.
    pub fn points(&self) -> Vec<MeanPoint> {
        let point = |sums: &Sums| {
            let count = sums.count as f64;
            let mean = sums.ordinate / count;
            let square = (sums.square - count * mean * mean).max(0.0);
            let standard_error = (sums.count > 1).then(|| (square / (count - 1.0) / count).sqrt());
            MeanPoint { x: sums.abscissa / count, y: sums.first + mean, standard_error, count: sums.count }
        };
        self.sums.values().map(point).collect()
    }
}

impl CellSamples {
    /// A cell without samples.
    pub fn new(cell: Cell) -> Self {
        CellSamples {
            cell,
            done_count: 0,
            failures: BTreeMap::new(),
            phases: PhaseCounts::default(),
            evidence: EvidenceCounts::default(),
            numbers: BTreeMap::new(),
            powers: Vec::new(),
            stretching: Vec::new(),
            curves: BTreeMap::new(),
            singles: Vec::new(),
        }
    }

    /// Whether a record belongs to it.
    pub(super) fn has(&self, record: &Record) -> bool {
        self.cell == record.cell
    }

    pub(crate) fn add(&mut self, record: &Record) {
        let (phase, numbers, curves) = match &record.outcome {
            RecordOutcome::Failed { kind, .. } => {
                *self.failures.entry(*kind).or_default() += 1;
                return;
            }
            RecordOutcome::Done { phase, numbers, curves } => (phase, numbers, curves),
        };
        self.done_count += 1;
        let phases = &mut self.phases;
        *match phase.outcome {
            PhaseOutcome::Unjammed => &mut phases.unjammed,
            PhaseOutcome::Plastic => &mut phases.plastic,
            PhaseOutcome::Quasielastic => &mut phases.quasielastic,
            PhaseOutcome::Undecided => &mut phases.undecided,
            PhaseOutcome::NotAtRest => &mut phases.not_at_rest,
        } += 1;
        self.evidence.add(phase);
        for (name, &value) in numbers {
            self.numbers.entry(name.clone()).or_default().push(value);
        }
        for (name, points) in curves {
            let place = |index: usize, x: f64| match name.as_str() {
                "angular_correlation" | "shell_correlation" => index as i64,
                name if name.ends_with("_by_radius") => (10.0 * x).round() as i64,
                _ => x.floor() as i64,
            };
            self.curves.entry(name.clone()).or_default().add(points, place);
        }
        if let Some(points) = curves.get("power_spectrum") {
            self.powers.push(points.iter().map(|point| point[1]).collect());
        }
        if let (Some(points), Some(&excess)) =
            (curves.get("stretching_fluctuation"), numbers.get("excess_coordination"))
        {
            self.stretching.push(StretchingRow::of(excess, points));
        }
        if let Some(profile) = curves.get("radial_profile")
            && self.singles.len() < SINGLE_COUNT
        {
            self.singles.push(Single { seed: record.seed, profile: profile.clone(), numbers: numbers.clone() });
        }
    }

    /// Statistics of every number.
    pub fn statistics(&self) -> CellStatistics {
        CellStatistics {
            cell: self.cell,
            done_count: self.done_count,
            failures: self.failures.clone(),
            phases: self.phases,
            evidence: self.evidence,
            numbers: self.numbers.iter().map(|(name, values)| (name.clone(), NumberStatistics::of(values))).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretching_stands_in_the_place_of_its_ring() {
        let row = StretchingRow::of(0.5, &[[1.5, 0.3], [2.25, 0.25], [2.75, 0.15], [4.5, 0.1]]);
        assert_eq!(row.excess, 0.5);
        assert!(row.rings[0].is_nan() && row.rings[3].is_nan());
        assert_eq!((row.rings.len(), &row.rings[1..3], row.rings[4]), (5, &[0.3, 0.2][..], 0.1));
    }

    #[test]
    fn a_sample_without_its_excess_has_no_row() {
        let mut cell = CellSamples::new(crate::study::Cell {
            dimension: 2,
            law: Default::default(),
            disk_count: 100,
            target: crate::study::Target::Pressure(1.0),
            increase: 0.1,
            relaxer: Default::default(),
            boundary: Default::default(),
            centre_held: true,
        });
        let record = |numbers: BTreeMap<String, f64>| Record {
            cell: cell.cell,
            seed: 1,
            outcome: RecordOutcome::Done {
                phase: Default::default(),
                numbers,
                curves: BTreeMap::from([("stretching_fluctuation".into(), vec![[1.5, 0.3]])]),
            },
        };
        let both = [record(BTreeMap::new()), record(BTreeMap::from([("excess_coordination".into(), 0.4)]))];
        both.iter().for_each(|record| cell.add(record));
        assert_eq!((cell.done_count, cell.stretching.len(), cell.stretching[0].excess), (2, 1, 0.4));
    }

    #[test]
    fn means_keep_their_digits() {
        let mut curve = MeanCurve::default();
        for offset in [0.0, 1.0, 2.0] {
            curve.add(&[[1.2 + 0.1 * offset, 1e9 + offset], [2.5, offset]], |_, x| x.floor() as i64);
        }
        let points = curve.points();
        assert_eq!(points.len(), 2);
        // Values 0, 1, 2 above 10⁹: mean 1, standard error √(1/3).
        assert_eq!((points[0].y, points[0].count), (1e9 + 1.0, 3));
        assert!((points[0].standard_error.expect("three") - (1.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!((points[0].x - 1.3).abs() < 1e-15 && points[1].y == 1.0);
    }
}
