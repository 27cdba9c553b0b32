//! [`Scene`]: the data of a run.

use serde::{Deserialize, Serialize};

use crate::inflation::Inflation;
use crate::law::choice::LawChoice;
use crate::packing::Mixture;
use crate::relax::RelaxerChoice;
use crate::scene::observables::Observables;
use crate::scene::protocol::ProtocolChoice;
use crate::scene::source::Source;
use crate::verdict::VerdictSettings;

/// All settings of a run.
///
/// A file may contain a [`ProtocolChoice`] as `protocol`: it sets the relaxer of every sample without one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scene {
    /// Dimension of space: 2 for disks, 3 for spheres. Written if it is not 2, so that the hash of an earlier scene is the same.
    #[serde(skip_serializing_if = "is_plane")]
    pub dimension: usize,
    /// Number of disks in the box.
    pub disk_count: usize,
    /// The contact law.
    pub law: LawChoice,
    /// The distribution of radii.
    pub mixture: Mixture,
    /// The preparation of packings.
    pub preparation: PreparationSettings,
    /// The inflation.
    pub inflation: Inflation,
    /// The observables.
    pub observables: Observables,
    /// When a phase and fits are reported.
    pub verdict: VerdictSettings,
    /// The packings.
    pub sample: Vec<Sample>,
}

/// Whether a dimension is that of the plane.
pub(crate) fn is_plane(dimension: &usize) -> bool {
    *dimension == 2
}

/// The dimension of files that give none.
pub(crate) fn plane() -> usize {
    2
}

/// The preparation of packings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PreparationSettings {
    /// Largest relative deviation of a pressure from its target \[1\].
    pub pressure_tolerance: f64,
    /// The relaxer of packings.
    pub relaxer: RelaxerChoice,
}

impl Default for PreparationSettings {
    fn default() -> Self {
        PreparationSettings { pressure_tolerance: 0.01, relaxer: RelaxerChoice::default() }
    }
}

/// One packing of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sample {
    /// Its name in reports and file names.
    pub name: String,
    /// Seed of the random points and of the choice of the inflated disk; 1 by default in a file.
    pub seed: u64,
    /// Source of the packing.
    pub source: Source,
    /// Relaxer after the inflation; by default in a file, that of the protocol.
    pub relaxer: RelaxerChoice,
}

impl Scene {
    /// The built-in scene of disks (2), or of spheres (3) with the same sizes of packings and the same observables, as
    /// far as spheres have them.
    pub fn in_dimension(dimension: usize) -> Self {
        let scene = Scene::default();
        if dimension != 3 {
            return scene;
        }
        let unjammed = Source::PackingFraction(0.62);
        let relaxer = ProtocolChoice::default().relaxer_in(3, &unjammed);
        let sample = scene.sample.iter().enumerate().map(|(place, sample)| match place {
            0 => Sample { source: unjammed.clone(), relaxer, ..sample.clone() },
            _ => sample.clone(),
        });
        Scene { dimension, sample: sample.collect(), observables: Observables::of_dimension(dimension), ..scene }
    }
}

impl Default for Scene {
    /// The three phases at the study's smallest size: unjammed, plastic and quasielastic.
    ///
    /// The transition is at p_c = p̂_c N^(−3/2), from 300 to 1200: p̂_c is from 8·10⁷ to 3·10⁸, and N = 4016 disks are in
    /// the circle. As in the study, FIRE relaxes the unjammed packing and damped dynamics with viscoelastic damping the
    /// others.
    ///
    /// Samples of this size differ strongly (`book/studies/plastic_seeds.toml`).
    fn default() -> Self {
        let sample = |name: &str, seed, source| {
            let relaxer = ProtocolChoice::default().relaxer_of(&source);
            Sample { name: name.into(), seed, source, relaxer }
        };
        Scene {
            dimension: 2,
            disk_count: 5548,
            law: LawChoice::default(),
            mixture: Mixture::default(),
            preparation: PreparationSettings::default(),
            inflation: Inflation::default(),
            observables: Observables::default(),
            verdict: VerdictSettings::default(),
            sample: vec![
                sample("unjammed", 3, Source::PackingFraction(0.82)),
                sample("plastic", 1, Source::Pressure(10.0)),
                sample("quasielastic", 11, Source::Pressure(4000.0)),
            ],
        }
    }
}
