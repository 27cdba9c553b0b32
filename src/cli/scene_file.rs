//! Scenes in TOML files, and the commented default scene.

use std::path::Path;

use jamscope::scene::{Scene, SceneError};

/// The text of `jamscope scene`: every field with its default, its unit and its meaning.
///
/// Tables are separated by blank lines; those of features missing in this build are left out.
pub fn commented_scene() -> String {
    let known = |table: &&str| {
        let fitted = ["[observables.profile_fit]", "[observables.spectrum_fit]", "[observables.elastic_modes]"]
            .iter()
            .any(|it| table.starts_with(it));
        (cfg!(feature = "fit") || !fitted)
            && (cfg!(feature = "linear") || !table.starts_with("[observables.plastic_part]"))
    };
    let text = include_str!("default_scene.toml").split("\n\n").filter(known).collect::<Vec<_>>().join("\n\n");
    let default = format!("protocol = \"{}\"", jamscope::scene::ProtocolChoice::default().name());
    text.replace("protocol = \"study\"", &default)
}

/// Why a scene file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SceneFileError {
    /// The file cannot be read.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: String,
        /// The error of the system.
        source: std::io::Error,
    },
    /// Not TOML, an unknown field, or a value with the wrong type; the message shows the line.
    #[error("{path}: {message}")]
    Toml {
        /// The file.
        path: String,
        /// The message of the parser, with line and field.
        message: String,
    },
    /// A number is invalid.
    #[error("{path}: {source}")]
    Scene {
        /// The file.
        path: String,
        /// The error.
        source: SceneError,
    },
}

/// Refuses a text whose last line has no line break. A truncated file may be another valid scene, such as a pressure of
/// 1 for 1000.
pub fn refuse_cut(text: &str) -> Result<(), String> {
    if text.is_empty() || text.ends_with('\n') {
        return Ok(());
    }
    let line = text.lines().count();
    Err(format!(
        "line {line}: the last line has no line break, so the file may have been cut; add one if it is complete"
    ))
}

/// Reads and checks a scene.
pub fn read_scene(path: &Path) -> Result<Scene, SceneFileError> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|source| SceneFileError::Io { path: name.clone(), source })?;
    if text.trim().is_empty() {
        return Err(SceneFileError::Toml {
            path: name,
            message: "the file is empty; `jamscope scene` prints a scene".into(),
        });
    }
    let scene = Scene::from_toml(&text)
        .map_err(|error| SceneFileError::Toml { path: name.clone(), message: error.to_string() })?;
    scene.check().map_err(|source| SceneFileError::Scene { path: name.clone(), source })?;
    refuse_cut(&text).map_err(|message| SceneFileError::Toml { path: name, message })?;
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_commented_scene_is_the_built_in_one() {
        let scene = Scene::from_toml(&commented_scene()).expect("the printed scene parses");
        assert_eq!(scene, Scene::default());
    }

    #[test]
    fn a_text_is_cut_where_its_last_line_has_no_break() {
        let cut = refuse_cut("seed = 1\npressure = 1").expect_err("of 1000, perhaps");
        assert!(cut.contains("line 2") && cut.contains("may have been cut"), "{cut}");
        assert_eq!(refuse_cut("seed = 1\n"), Ok(()));
        assert_eq!(refuse_cut(&commented_scene()), Ok(()));
    }

    #[test]
    fn an_unknown_field_is_named() {
        let error = Scene::from_toml("sede = 1\n").expect_err("no such field").to_string();
        assert!(error.contains("sede"), "{error}");
    }
}
