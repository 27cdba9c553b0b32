//! Summaries of the elastic moduli and of the lowest vibrational modes of a packing.

use std::collections::BTreeMap;
use std::fmt::Formatter;

use serde::Serialize;

use crate::law::PairLaw;
use crate::linear::Prestress;
use crate::linear::modes::Mode;
use crate::linear::moduli::Stiffness;
use crate::linear::{ElasticModuli, VibrationalModes};
use crate::packing::Packing;

/// Elastic moduli, or why there are none.
#[derive(Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Elasticity {
    /// The moduli.
    Found(Box<Moduli>),
    /// Why there are none.
    Refused(String),
}

/// Summary of the elastic moduli.
#[derive(Debug, Serialize)]
pub struct Moduli {
    /// At fixed relative positions of the disks.
    pub affine: Constants,
    /// After the relaxation of all disks.
    pub relaxed: Constants,
    /// Largest backward error of a solution \[1\].
    pub backward_error: f64,
}

/// Summary of the elastic constants \[force / length^(D−1)\].
#[derive(Debug, Serialize)]
pub struct Constants {
    /// −V dp/dV.
    pub bulk: f64,
    /// Shear modulus, the mean over all directions.
    pub shear_mean: f64,
    /// Shear modulus in the softest direction.
    pub shear_smallest: f64,
    /// Shear modulus in the stiffest direction.
    pub shear_largest: f64,
    /// C_abcd by its indices, each independent one once.
    pub constants: BTreeMap<String, f64>,
}

impl Constants {
    fn of<const D: usize>(stiffness: &Stiffness<D>) -> Self {
        let pairs: Vec<(usize, usize)> = (0..D).flat_map(|a| (a..D).map(move |b| (a, b))).collect();
        let name = |axis: usize| ["x", "y", "z"][axis];
        let mut constants = BTreeMap::new();
        for (at, &(a, b)) in pairs.iter().enumerate() {
            for &(c, d) in &pairs[at..] {
                constants.insert([a, b, c, d].map(name).concat(), stiffness.constants[a][b][c][d]);
            }
        }
        let shear = stiffness.shear();
        Constants {
            bulk: stiffness.bulk(),
            shear_mean: shear.mean,
            shear_smallest: shear.smallest,
            shear_largest: shear.largest,
            constants,
        }
    }
}

impl Elasticity {
    /// The moduli of a packing.
    pub fn of<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw) -> Self {
        match ElasticModuli::of(packing, law, Prestress::Included) {
            Ok(moduli) => Elasticity::Found(Box::new(Moduli {
                affine: Constants::of(&moduli.affine),
                relaxed: Constants::of(&moduli.relaxed),
                backward_error: moduli.backward_error,
            })),
            Err(error) => Elasticity::Refused(error.to_string()),
        }
    }

    /// The moduli as lines.
    pub fn write(&self, f: &mut Formatter<'_>, unit: &str) -> std::fmt::Result {
        let moduli = match self {
            Elasticity::Refused(reason) => return writeln!(f, "{:<28} none: {reason}", "elastic moduli"),
            Elasticity::Found(moduli) => moduli,
        };
        let (relaxed, affine) = (&moduli.relaxed, &moduli.affine);
        writeln!(f, "{:<28} {} (affine {}) [{unit}]", "bulk modulus, -V dp/dV", relaxed.bulk, affine.bulk)?;
        writeln!(f, "{:<28} {} (affine {}) [{unit}]", "shear modulus, mean", relaxed.shear_mean, affine.shear_mean)?;
        writeln!(
            f,
            "{:<28} {} to {} [{unit}]",
            "shear modulus, by direction", relaxed.shear_smallest, relaxed.shear_largest
        )?;
        for (name, value) in &relaxed.constants {
            writeln!(f, "{:<28} {value} [{unit}]", format!("C_{name}"))?;
        }
        Ok(())
    }
}

/// The lowest vibrational modes, or why there are none.
#[derive(Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Vibrations {
    /// The modes.
    Found {
        /// Number of translations, which are excluded.
        translation_count: usize,
        /// The modes, ascending.
        lowest: Vec<ModeSummary>,
    },
    /// Why there are none.
    Refused(String),
}

/// Summary of one mode.
#[derive(Debug, Serialize)]
pub struct ModeSummary {
    /// λ = ω² for masses 1 \[force / length / mass\].
    pub eigenvalue: f64,
    /// ‖K e − λ e‖ / ‖K‖ \[1\].
    pub residual: f64,
    /// Participation ratio, (Σ|e_i|²)²/(N Σ|e_i|⁴) \[1\].
    pub participation_ratio: f64,
    /// e, D values per disk, Σ |e_i|² = 1; 0 for held disks and those off the backbone \[1\]. Not in the JSON.
    #[serde(skip)]
    pub displacements: Vec<f64>,
}

impl Vibrations {
    /// The `count` lowest modes of a packing.
    pub fn of<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw, count: usize) -> Self {
        match VibrationalModes::lowest(packing, law, Prestress::Included, count) {
            Ok(found) => {
                let summary = |mode: &Mode<D>| ModeSummary {
                    eigenvalue: mode.eigenvalue,
                    residual: mode.residual,
                    participation_ratio: mode.participation_ratio,
                    displacements: mode.displacements.as_flattened().to_vec(),
                };
                let lowest = found.modes.iter().map(summary).collect();
                Vibrations::Found { translation_count: found.translation_count, lowest }
            }
            Err(error) => Vibrations::Refused(error.to_string()),
        }
    }

    /// The names `mode_1`, `mode_2`, … and the vectors of the modes; none if they were refused.
    pub fn columns(&self) -> Vec<(String, &[f64])> {
        let Vibrations::Found { lowest, .. } = self else { return Vec::new() };
        let names = (1..=lowest.len()).map(|number| format!("mode_{number}"));
        names.zip(lowest.iter().map(|mode| mode.displacements.as_slice())).collect()
    }

    /// The modes as lines.
    pub fn write(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let (translation_count, lowest) = match self {
            Vibrations::Refused(reason) => return writeln!(f, "{:<28} none: {reason}", "modes"),
            Vibrations::Found { translation_count, lowest } => (translation_count, lowest),
        };
        writeln!(f, "{:<28} {translation_count} left out", "translations")?;
        for (at, mode) in lowest.iter().enumerate() {
            writeln!(
                f,
                "{:<28} {} [force / length / mass], participation {:.4}, residual {:e}",
                format!("mode {}, omega^2", at + 1),
                mode.eigenvalue,
                mode.participation_ratio,
                mode.residual
            )?;
        }
        Ok(())
    }
}
