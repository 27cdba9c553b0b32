//! [`Calibration`]: how often samples of an ensemble are classified as plastic or quasielastic, by type of evidence and
//! pressure.
//!
//! ```text
//! share of a phase at p̂ = samples with this phase / samples of the cell nearest to p̂        p̂ = p N^(α−1)
//! ```
//!
//! The ensembles are those of the chapter *Which dynamics make the plastic phase*. A sample is compared with an
//! ensemble of the same law, relaxer and inflation, of a size within a factor of 1.5, and with a cell within half a
//! decade of its p̂. Otherwise it has no calibration.

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use crate::response::phase::{Phase, PhaseDecision, PhaseOutcome};

/// Ensembles of samples with known phases.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Calibration {
    /// The ensembles.
    pub ensembles: Vec<CalibratedEnsemble>,
}

/// Samples that differ only in pressure and seed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CalibratedEnsemble {
    /// The contact law, by name.
    pub law: String,
    /// The method of relaxation after the inflation, in words.
    pub relaxer: String,
    /// Disks in the box.
    pub disk_count: usize,
    /// d_0 \[length\].
    pub increase: f64,
    /// p̂_c by κ, if the ensemble determines it \[force / length\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub critical_by_wavenumber: Option<f64>,
    /// p̂_c by Δp, if the ensemble determines it \[force / length\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub critical_by_pressure_change: Option<f64>,
    /// Cells in ascending order of p̂.
    pub cells: Vec<CalibratedCell>,
}

/// Samples of one p̂.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CalibratedCell {
    /// Target p̂ \[force / length\].
    pub reduced_pressure: f64,
    /// Numbers of samples by phase.
    pub counts: EvidenceCounts,
}

/// Numbers of samples by phase, for every type of evidence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct EvidenceCounts {
    /// All samples at rest and jammed.
    pub sample_count: usize,
    /// By all evidence together.
    pub phase: WordCounts,
    /// By the radial profile.
    pub profile: WordCounts,
    /// By the sign of Δp.
    pub pressure_change: WordCounts,
    /// By the angular spectrum.
    pub spectrum: WordCounts,
    /// By the share of changed contacts.
    pub contact_changes: WordCounts,
}

/// Numbers of plastic and quasielastic samples; the others have no phase, or contradictory evidence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct WordCounts {
    /// Plastic.
    pub plastic: usize,
    /// Quasielastic.
    pub quasielastic: usize,
}

/// The calibration of one sample.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhaseFrequency {
    /// p̂ of the sample \[force / length\].
    pub reduced_pressure: f64,
    /// Number of disks in the box of the ensemble.
    pub disk_count: usize,
    /// p̂ of the cell \[force / length\].
    pub cell_reduced_pressure: f64,
    /// p̂_c by κ in that ensemble \[force / length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub critical_by_wavenumber: Option<f64>,
    /// p̂_c by Δp \[force / length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub critical_by_pressure_change: Option<f64>,
    /// Number of samples of the cell.
    pub sample_count: usize,
    /// Number of these samples with the same phase.
    pub alike_count: usize,
}

/// The properties of a sample that select its ensemble.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions<'a> {
    /// The contact law, by name.
    pub law: &'a str,
    /// The method of relaxation after the inflation, in words.
    pub relaxer: &'a str,
    /// Disks in the box.
    pub disk_count: usize,
    /// d_0 \[length\].
    pub increase: f64,
    /// p̂ \[force / length\].
    pub reduced_pressure: f64,
}

/// Largest ratio of sizes for a comparison. The published p̂_c is one number for sizes that differ by 4, but our κ and
/// Δp depend on size.
const LARGEST_SIZE_RATIO: f64 = 1.5;

/// Largest ratio of p̂ for a comparison; cells are half a decade or a whole one apart.
const LARGEST_PRESSURE_RATIO: f64 = 3.3;

impl EvidenceCounts {
    /// Adds a sample. Unjammed samples and those not at rest have no phase and do not count.
    pub fn add(&mut self, decision: &PhaseDecision) {
        let word = match decision.outcome {
            PhaseOutcome::Plastic => Some(Phase::Plastic),
            PhaseOutcome::Quasielastic => Some(Phase::Quasielastic),
            PhaseOutcome::Undecided => None,
            PhaseOutcome::Unjammed | PhaseOutcome::NotAtRest => return,
        };
        self.sample_count += 1;
        self.phase.add(word);
        self.profile.add(decision.by_profile);
        self.pressure_change.add(decision.by_pressure_change);
        self.spectrum.add(decision.by_spectrum);
        self.contact_changes.add(decision.by_contact_changes);
    }

    /// Number of samples with this outcome; none for outcomes that are not counted.
    pub fn alike(&self, outcome: PhaseOutcome) -> Option<usize> {
        match outcome {
            PhaseOutcome::Plastic => Some(self.phase.plastic),
            PhaseOutcome::Quasielastic => Some(self.phase.quasielastic),
            PhaseOutcome::Undecided => Some(self.sample_count - self.phase.plastic - self.phase.quasielastic),
            PhaseOutcome::Unjammed | PhaseOutcome::NotAtRest => None,
        }
    }
}

impl WordCounts {
    fn add(&mut self, word: Option<Phase>) {
        match word {
            Some(Phase::Plastic) => self.plastic += 1,
            Some(Phase::Quasielastic) => self.quasielastic += 1,
            None => {}
        }
    }
}

impl Calibration {
    /// The calibration by the ensembles of the book.
    pub fn built_in() -> &'static Self {
        static BUILT_IN: OnceLock<Calibration> = OnceLock::new();
        // A test checks the file; if it is unreadable, a report has no calibration.
        BUILT_IN.get_or_init(|| serde_json::from_str(include_str!("calibration.json")).unwrap_or_default())
    }

    /// How often similar samples have this outcome; none without a similar ensemble.
    pub fn frequency(&self, of: &Conditions<'_>, outcome: PhaseOutcome) -> Option<PhaseFrequency> {
        let alike = |it: &&CalibratedEnsemble| {
            (it.law.as_str(), it.relaxer.as_str(), it.increase) == (of.law, of.relaxer, of.increase)
        };
        let size = |it: &CalibratedEnsemble| ratio(it.disk_count as f64, of.disk_count as f64);
        let ensembles = self.ensembles.iter().filter(alike);
        let ensemble = ensembles.min_by(|a, b| size(a).total_cmp(&size(b)))?;
        let distance = |cell: &CalibratedCell| ratio(cell.reduced_pressure, of.reduced_pressure);
        let cell = ensemble.cells.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        if size(ensemble) > LARGEST_SIZE_RATIO
            || distance(cell) > LARGEST_PRESSURE_RATIO
            || cell.counts.sample_count == 0
        {
            return None;
        }
        Some(PhaseFrequency {
            reduced_pressure: of.reduced_pressure,
            disk_count: ensemble.disk_count,
            cell_reduced_pressure: cell.reduced_pressure,
            critical_by_wavenumber: ensemble.critical_by_wavenumber,
            critical_by_pressure_change: ensemble.critical_by_pressure_change,
            sample_count: cell.counts.sample_count,
            alike_count: cell.counts.alike(outcome)?,
        })
    }
}

/// The larger of two numbers over the smaller; infinite if one is not positive.
fn ratio(a: f64, b: f64) -> f64 {
    if a > 0.0 && b > 0.0 { (a / b).max(b / a) } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decision(outcome: PhaseOutcome, by_profile: Option<Phase>) -> PhaseDecision {
        PhaseDecision { outcome, by_profile, ..PhaseDecision::default() }
    }

    #[test]
    fn a_sample_is_held_against_the_nearest_cell_of_its_own_kind() {
        let mut counts = EvidenceCounts::default();
        counts.add(&decision(PhaseOutcome::Plastic, Some(Phase::Plastic)));
        counts.add(&decision(PhaseOutcome::Plastic, None));
        counts.add(&decision(PhaseOutcome::Quasielastic, Some(Phase::Quasielastic)));
        counts.add(&decision(PhaseOutcome::Undecided, None));
        counts.add(&decision(PhaseOutcome::Unjammed, None));
        counts.add(&decision(PhaseOutcome::NotAtRest, None));
        assert_eq!(counts.sample_count, 4);
        assert_eq!(counts.phase, WordCounts { plastic: 2, quasielastic: 1 });
        assert_eq!(counts.profile, WordCounts { plastic: 1, quasielastic: 1 });
        let ensemble = |disk_count, cells| CalibratedEnsemble {
            law: "Hertzian".into(),
            relaxer: "FIRE".into(),
            disk_count,
            increase: 0.1,
            critical_by_wavenumber: Some(1e8),
            critical_by_pressure_change: None,
            cells,
        };
        let cell = |reduced_pressure, counts| CalibratedCell { reduced_pressure, counts };
        let empty = EvidenceCounts::default();
        let calibration = Calibration {
            ensembles: vec![
                ensemble(5548, vec![cell(1e6, counts), cell(1e8, empty)]),
                ensemble(22184, vec![cell(1e6, empty)]),
            ],
        };
        let near =
            Conditions { law: "Hertzian", relaxer: "FIRE", disk_count: 5000, increase: 0.1, reduced_pressure: 2e6 };
        let share = |of: Conditions<'_>, outcome| {
            calibration.frequency(&of, outcome).map(|it| (it.alike_count, it.sample_count, it.disk_count))
        };
        assert_eq!(share(near, PhaseOutcome::Plastic), Some((2, 4, 5548)));
        assert_eq!(share(near, PhaseOutcome::Undecided), Some((1, 4, 5548)));
        assert_eq!(share(near, PhaseOutcome::Unjammed), None);
        // No similar ensemble: another law, relaxer or inflation, a size or p̂ too far away, a cell without samples.
        for other in [
            Conditions { law: "Hookean", ..near },
            Conditions { relaxer: "constant 500", ..near },
            Conditions { increase: 0.2, ..near },
            Conditions { disk_count: 1387, ..near },
            Conditions { disk_count: 22184, ..near },
            Conditions { reduced_pressure: 1e5, ..near },
            Conditions { reduced_pressure: 1e8, ..near },
            Conditions { reduced_pressure: f64::NAN, ..near },
        ] {
            assert_eq!(share(other, PhaseOutcome::Plastic), None, "{other:?}");
        }
    }

    #[test]
    fn the_built_in_calibration_is_read() {
        let text = include_str!("calibration.json");
        let read: Calibration = serde_json::from_str(text).expect("the file of this folder");
        assert_eq!(&read, Calibration::built_in());
        assert!(!read.ensembles.is_empty());
        for ensemble in &read.ensembles {
            assert!(ensemble.cells.windows(2).all(|pair| pair[0].reduced_pressure < pair[1].reduced_pressure));
        }
    }
}
