//! The contact law of a packing: from the file if given there, otherwise from the command line, otherwise that of the
//! model.

use std::path::Path;

use jamscope::io::{Frame, properties_of_frame};
use jamscope::law::{Hertzian, Hookean, LawChoice, PairLaw, PowerLaw};

/// A law on the command line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LawName {
    /// Hertzian.
    Hertzian,
    /// Hookean.
    Hookean,
    /// The dimensionless power law with this exponent.
    Power(f64),
}

/// `hertzian`, `hookean` or `power:ALPHA`; as in files, the first four letters decide: `hertz`, `Hooke`.
pub fn parse(text: &str) -> Result<LawName, String> {
    let name = text.to_ascii_lowercase();
    match name.split_once(':') {
        None if name.starts_with("hert") => Ok(LawName::Hertzian),
        None if name.starts_with("hook") => Ok(LawName::Hookean),
        Some(("power", exponent)) => exponent
            .parse()
            .map(LawName::Power)
            .map_err(|_| format!("the exponent of the power law is `{exponent}`, not a number")),
        _ => Err("not one of hertzian, hookean, power:ALPHA".into()),
    }
}

impl std::fmt::Display for LawName {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            LawName::Hertzian => formatter.write_str("hertzian"),
            LawName::Hookean => formatter.write_str("hookean"),
            LawName::Power(exponent) => write!(formatter, "power:{exponent}"),
        }
    }
}

/// Why the law is unknown.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LawOfFileError {
    /// The law of the file is unknown, and the command line gives none.
    #[error("{path}: law is `{law}`, which is unknown (known: hertz…, hook…, power…); give it with --law")]
    UnknownLaw {
        /// The file.
        path: String,
        /// The law in the file.
        law: String,
    },
    /// A parameter of the law in the file is invalid.
    #[error("{path}: {key} is `{value}`, not a positive number")]
    NotANumber {
        /// The file.
        path: String,
        /// Its key.
        key: &'static str,
        /// Its text.
        value: String,
    },
    /// The file contradicts itself.
    #[error("{path}: law is `{law}`, but {key} is {value}")]
    OwnContradiction {
        /// The file.
        path: String,
        /// The law in words.
        law: String,
        /// The contradicting key.
        key: &'static str,
        /// Its value.
        value: f64,
    },
    /// The file gives an exponent without a law.
    #[error("{path}: exponent is `{exponent}`, but the law is missing; give it with --law power:{exponent}")]
    ExponentWithoutLaw {
        /// The file.
        path: String,
        /// The exponent.
        exponent: String,
    },
    /// The file gives the power law but not its exponent.
    #[error("{path}: law is `{law}`, but its exponent is missing; give it with --law power:ALPHA")]
    NoExponent {
        /// The file.
        path: String,
        /// The law in the file.
        law: String,
    },
    /// The file contradicts the command line or the scene.
    #[error("{path}: the file gives {what} {file}, but {asked} is asked for")]
    Contradiction {
        /// The file.
        path: String,
        /// The contradicting quantity.
        what: &'static str,
        /// Its value in the file.
        file: String,
        /// Its value on the command line or in the scene.
        asked: String,
    },
}

/// The law of a frame of a packing file: from the file, then from `asked`, then that of the model.
pub fn law_of(
    path: &Path,
    frame: Frame,
    asked: Option<LawName>,
    asked_stiffness: Option<f64>,
) -> Result<LawChoice, Box<dyn std::error::Error>> {
    let name = path.display().to_string();
    let properties = properties_of_frame(path, frame)?;
    let value = |key: &str| properties.iter().find(|(other, _)| other.eq_ignore_ascii_case(key)).map(|(_, text)| text);
    // A parameter of the law by its key, or by a word of the law itself; both only if they agree.
    let number = |key: &'static str, word: &str| -> Result<Option<f64>, LawOfFileError> {
        let wrong = |value: &str| LawOfFileError::NotANumber { path: name.clone(), key, value: value.into() };
        let positive = |text: &str| text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
        let keyed = value(key).map(|text| positive(text).ok_or_else(|| wrong(text))).transpose()?;
        let Some(law) = value("law") else { return Ok(keyed) };
        match (keyed, number_after(law, word)) {
            (Some(value), Some(worded)) if value != worded => {
                Err(LawOfFileError::OwnContradiction { path: name.clone(), law: law.clone(), key, value })
            }
            (keyed, worded) => Ok(keyed.or(worded)),
        }
    };
    // A law with a fixed exponent allows no other.
    let fixed = |law: &String, own: f64| match number("exponent", "exponent")? {
        Some(value) if value != own => {
            let (path, law) = (name.clone(), law.clone());
            Err(LawOfFileError::OwnContradiction { path, law, key: "exponent", value })
        }
        _ => Ok(()),
    };
    let in_file = match value("law") {
        None => match (value("exponent"), asked) {
            (Some(exponent), None) => {
                return Err(LawOfFileError::ExponentWithoutLaw { path: name, exponent: exponent.clone() }.into());
            }
            _ => None,
        },
        Some(law) => {
            let word = law.to_ascii_lowercase();
            match (word.get(..4), asked) {
                (Some("hert"), _) => {
                    fixed(law, Hertzian::default().exponent())?;
                    Some(LawName::Hertzian)
                }
                (Some("hook"), _) => {
                    fixed(law, Hookean::default().exponent())?;
                    Some(LawName::Hookean)
                }
                (Some("powe"), _) => match (number("exponent", "exponent")?, asked) {
                    (Some(exponent), _) => Some(LawName::Power(exponent)),
                    (None, Some(LawName::Power(exponent))) => Some(LawName::Power(exponent)),
                    (None, _) => return Err(LawOfFileError::NoExponent { path: name, law: law.clone() }.into()),
                },
                (_, Some(_)) => None,
                (_, None) => return Err(LawOfFileError::UnknownLaw { path: name, law: law.clone() }.into()),
            }
        }
    };
    // A stiffness belongs to the law given with it.
    let stiffness_in_file = match in_file {
        Some(LawName::Power(_)) => number("stiffness", "scale")?,
        Some(_) => number("stiffness", "stiffness")?,
        None => None,
    };
    let law = agreed(&name, "law", in_file, asked)?.unwrap_or(LawName::Hertzian);
    let stiffness = agreed(&name, "stiffness", stiffness_in_file, asked_stiffness)?;
    Ok(match law {
        LawName::Hertzian => {
            LawChoice::Hertzian(stiffness.map_or_else(Hertzian::default, |stiffness| Hertzian { stiffness }))
        }
        LawName::Hookean => {
            LawChoice::Hookean(stiffness.map_or_else(Hookean::default, |stiffness| Hookean { stiffness }))
        }
        LawName::Power(exponent) => LawChoice::PowerLaw(PowerLaw { energy_scale: stiffness.unwrap_or(1.0), exponent }),
    })
}

/// The number after a word of the text, as in "Hertzian contacts, stiffness 200000".
fn number_after(text: &str, word: &str) -> Option<f64> {
    let mut parts = text.split(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | '=' | ':' | '(' | ')'));
    parts.find(|part| part.eq_ignore_ascii_case(word))?;
    parts.find(|part| !part.is_empty())?.parse().ok()
}

/// The value that is given; both only if they agree.
fn agreed<T: Copy + PartialEq + std::fmt::Display>(
    path: &str,
    what: &'static str,
    in_file: Option<T>,
    asked: Option<T>,
) -> Result<Option<T>, LawOfFileError> {
    match (in_file, asked) {
        (Some(file), Some(asked)) if file != asked => Err(LawOfFileError::Contradiction {
            path: path.into(),
            what,
            file: file.to_string(),
            asked: asked.to_string(),
        }),
        _ => Ok(in_file.or(asked)),
    }
}
