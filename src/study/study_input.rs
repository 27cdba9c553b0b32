//! [`Written`]: the form of a study in a file, in which a protocol may stand in place of the relaxers.

use serde::de::Error;
use serde::{Deserialize, Deserializer};

use crate::law::choice::LawChoice;
use crate::relax::RelaxerChoice;
use crate::scene::scene_input::without_samples;
#[cfg(feature = "cli")]
use crate::scene::toml_text::{self, TomlError};
use crate::scene::{ProtocolChoice, Scene};
use crate::study::settings::{Part, Seeds, Study, Target};

/// The fields of a [`Study`], and `protocol`, whose relaxer is then the only one.
#[derive(Deserialize)]
#[serde(rename = "Study", deny_unknown_fields, default)]
struct Written {
    #[serde(deserialize_with = "without_samples")]
    scene: Scene,
    protocol: Option<ProtocolChoice>,
    disk_counts: Vec<usize>,
    targets: Vec<Target>,
    increases: Vec<f64>,
    centres_held: Vec<bool>,
    laws: Vec<LawChoice>,
    relaxers: Vec<RelaxerChoice>,
    seeds: Seeds,
    #[serde(rename = "part")]
    parts: Vec<Part>,
    time_limit: Option<f64>,
}

impl Default for Written {
    fn default() -> Self {
        let Study { scene, disk_counts, targets, increases, centres_held, laws, relaxers, seeds, parts, time_limit } =
            Study::default();
        let protocol = None;
        Written {
            scene,
            protocol,
            disk_counts,
            targets,
            increases,
            centres_held,
            laws,
            relaxers,
            seeds,
            parts,
            time_limit,
        }
    }
}

impl<'de> Deserialize<'de> for Study {
    fn deserialize<R: Deserializer<'de>>(reader: R) -> Result<Self, R::Error> {
        Written::deserialize(reader)?.complete().map_err(R::Error::custom)
    }
}

impl Written {
    fn complete(self) -> Result<Study, &'static str> {
        let Written {
            scene,
            protocol,
            disk_counts,
            targets,
            increases,
            centres_held,
            laws,
            relaxers,
            seeds,
            parts,
            time_limit,
        } = self;
        let relaxers = match protocol {
            Some(_) if !relaxers.is_empty() => return Err("protocol and relaxers: give only one of them"),
            Some(protocol) => vec![protocol.relaxer()],
            None => relaxers,
        };
        Ok(Study { scene, disk_counts, targets, increases, centres_held, laws, relaxers, seeds, parts, time_limit })
    }
}

#[cfg(feature = "cli")]
impl Study {
    /// Reads a study, which is not yet [checked](Self::check). Absent fields have their defaults.
    ///
    /// # Errors
    /// No TOML, an unknown field, a value of the wrong type, a protocol beside relaxers.
    pub fn from_toml(text: &str) -> Result<Self, TomlError> {
        toml_text::read(text)
    }

    /// The text of this study, with every field.
    ///
    /// # Errors
    /// A number or a path that TOML cannot express; none in a study that is [checked](Self::check).
    pub fn to_toml(&self) -> Result<String, TomlError> {
        toml_text::write(self)
    }
}
