//! [`Scene`]: everything a run needs, as plain data, checked once.
//!
//! A scene has one law, one mixture, one inflation, and one or more samples: packings to which the same thing is done.
//! What an observable needs and the scene does not name is not computed.

mod check;
pub mod finite;
mod loose_limit;
mod observables;
mod protocol;
pub(crate) mod reduced_pressure;
mod scale;
mod size;
mod written;

use serde::{Deserialize, Serialize};

pub use check::SceneError;
pub use finite::NotWritable;
pub use observables::{
    AngularCorrelationSettings, AngularProfileSettings, BondChangeSettings, ContactChangeSettings,
    DisplacementFieldSettings, Observables, RadialProfileSettings,
};
#[cfg(feature = "linear")]
pub use observables::{PlasticPartSettings, ProtocolSettings};
#[cfg(feature = "fit")]
pub use observables::{ProfileFitSettings, SpectrumFitSettings};
pub use protocol::ProtocolChoice;

use crate::inflation::Inflation;
use crate::law::choice::LawChoice;
use crate::packing::Mixture;
use crate::relax::RelaxerChoice;
use crate::verdict::VerdictSettings;

/// Everything a run needs.
///
/// A file may name a [`ProtocolChoice`] as `protocol`: it is the relaxer of every sample that names none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "written::Written")]
pub struct Scene {
    /// Number of disks in the box.
    pub disk_count: usize,
    /// The contact law.
    pub law: LawChoice,
    /// The distribution of radii.
    pub mixture: Mixture,
    /// How packings are made.
    pub preparation: PreparationSettings,
    /// The inflation.
    pub inflation: Inflation,
    /// What is measured.
    pub observables: Observables,
    /// When a phase and fits are given.
    pub verdict: VerdictSettings,
    /// The packings.
    pub sample: Vec<Sample>,
}

/// How packings are made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PreparationSettings {
    /// Largest relative deviation of a pressure from the one asked for \[1\].
    pub pressure_tolerance: f64,
    /// How they come to rest.
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
    /// Seed of the random points and of the choice of the inflated disk; 1 where a file names none.
    pub seed: u64,
    /// Where the packing comes from.
    pub source: Source,
    /// How it comes to rest after the inflation; that of the protocol where a file names none.
    pub relaxer: RelaxerChoice,
}

/// Where a packing comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Random points quenched at this packing fraction \[1\].
    PackingFraction(f64),
    /// Random points quenched, then brought to this pressure \[force / length\].
    Pressure(f64),
    /// A packing from a file.
    File(std::path::PathBuf),
}

impl Default for Scene {
    /// The three phases at the study's smallest size: unjammed, plastic and quasielastic.
    ///
    /// The transition lies at p_c = p̂_c N^(−3/2) with p̂_c from 8·10⁷ to 3·10⁸ and N = 4016 disks in the circle: 300 to
    /// 1200. As in the study, FIRE relaxes the unjammed packing and damped dynamics with viscoelastic damping the others.
    ///
    /// Samples differ a lot at this size. Of unjammed packings 24 of 38 answer like this one: neither solution describes the
    /// profile; the others feel the rim. At p = 10 the seed is the first of all: 70 of the seeds 1 to 100 are called plastic,
    /// like this one, and 72 have Δp < 0; at p = 4000 31 of the seeds 1 to 40 are called quasielastic (`book/studies/plastic_seeds.toml`).
    fn default() -> Self {
        let sample = |name: &str, seed, source| {
            let relaxer = ProtocolChoice::default().relaxer_of(&source);
            Sample { name: name.into(), seed, source, relaxer }
        };
        Scene {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_scene_makes_sense() {
        assert_eq!(Scene::default().check(), Ok(()));
    }

    #[test]
    fn nonsense_is_named_with_its_field() {
        let mut scene = Scene::default();
        scene.sample[0].source = Source::PackingFraction(4.5);
        let message = scene.check().expect_err("packing fraction above 4").to_string();
        assert_eq!(message, "sample \"unjammed\": source.packing_fraction = 4.5: must be above 0 and below 4");
        let mut scene = Scene::default();
        scene.mixture.components[1].radius = -0.7;
        assert!(scene.check().expect_err("negative radius").to_string().contains("radius is -0.7"));
        let scene = Scene { disk_count: 0, ..Scene::default() };
        assert!(scene.check().is_err());
    }
}
