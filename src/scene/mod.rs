//! [`Scene`]: all settings of a run as plain data, checked once.
//!
//! A scene has one law, one mixture, one inflation, and one or more samples: packings with the same treatment.
//! Observables that the scene does not contain are not computed.

mod check;
mod definition;
pub mod finite_numbers;
mod loose_limit;
mod observables;
mod protocol;
pub(crate) mod reduced_pressure;
mod scale;
pub(crate) mod scene_input;
mod size;
mod source;
#[cfg(feature = "cli")]
pub(crate) mod toml_text;

pub use check::SceneError;
pub use definition::{PreparationSettings, Sample, Scene};
pub(crate) use definition::{is_plane, plane};
pub use finite_numbers::NotWritable;
pub use observables::{
    AngularCorrelationSettings, AngularProfileSettings, BondChangeSettings, ContactChangeSettings,
    DisplacementFieldSettings, Observables, RadialProfileSettings, ShellCorrelationSettings,
};
#[cfg(feature = "linear")]
pub use observables::{PlasticPartSettings, ProtocolSettings};
#[cfg(feature = "fit")]
pub use observables::{ProfileFitSettings, ShellFitSettings, SpectrumFitSettings};
pub use protocol::ProtocolChoice;
pub use source::Source;
#[cfg(feature = "cli")]
pub use toml_text::{TomlError, relaxer_by_name, relaxer_with_limit};

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
