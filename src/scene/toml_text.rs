//! Scenes as TOML text: [`Scene::from_toml`], [`Scene::to_toml`].

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::relax::RelaxerChoice;
use crate::scene::definition::Scene;

/// Why a text is not a scene or a study, or why there is no text of one.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{text}")]
pub struct TomlError {
    /// The message, with the line and the field if the text could not be read.
    text: String,
    /// The message without the line.
    pub message: String,
}

/// Reads plain data.
pub(crate) fn read<T: DeserializeOwned>(text: &str) -> Result<T, TomlError> {
    toml::from_str(text).map_err(|error| TomlError { text: error.to_string(), message: error.message().into() })
}

/// Writes plain data.
pub(crate) fn write<T: Serialize>(data: &T) -> Result<String, TomlError> {
    toml::to_string(data).map_err(|error| TomlError { text: error.to_string(), message: error.to_string() })
}

impl Scene {
    /// Reads a scene, which is not yet [checked](Self::check). Absent fields have the values of the built-in scene.
    ///
    /// # Errors
    /// No TOML, an unknown field, a value of the wrong type.
    pub fn from_toml(text: &str) -> Result<Self, TomlError> {
        read(text)
    }

    /// The text of this scene, with every field.
    ///
    /// # Errors
    /// A number or a path that TOML cannot express; none in a scene that is [checked](Self::check).
    pub fn to_toml(&self) -> Result<String, TomlError> {
        write(self)
    }
}

/// A relaxer with its default settings, by its name in a scene.
///
/// # Errors
/// No relaxer has this name.
pub fn relaxer_by_name(name: &str) -> Result<RelaxerChoice, TomlError> {
    read(&format!("{name} = {{}}"))
}

/// Like [`relaxer_by_name`], with this relative limit of the net force \[1\].
///
/// # Errors
/// No relaxer has this name.
pub fn relaxer_with_limit(name: &str, limit: f64) -> Result<RelaxerChoice, TomlError> {
    read(&format!("{name} = {{ limit = {{ relative = {limit:?} }} }}"))
}
