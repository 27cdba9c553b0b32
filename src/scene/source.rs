//! [`Source`]: the source of a packing.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// The source of a packing: in a scene `{ packing_fraction = … }`, `{ pressure = … }`, `{ file = … }` or
/// `{ file = …, pressure = … }`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Fields", into = "Fields")]
pub enum Source {
    /// Random points quenched at this packing fraction \[1\].
    PackingFraction(f64),
    /// Random points quenched, then brought to this pressure \[force / length\].
    Pressure(f64),
    /// A packing from a file.
    File(PathBuf),
    /// A packing from a file, compressed or decompressed to a pressure.
    FileAtPressure {
        /// The file.
        file: PathBuf,
        /// The pressure \[force / length\].
        pressure: f64,
    },
}

/// The fields of a source in a scene.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Source", deny_unknown_fields)]
struct Fields {
    #[serde(skip_serializing_if = "Option::is_none")]
    packing_fraction: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pressure: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<PathBuf>,
}

impl TryFrom<Fields> for Source {
    type Error = &'static str;

    fn try_from(fields: Fields) -> Result<Self, Self::Error> {
        match (fields.packing_fraction, fields.pressure, fields.file) {
            (Some(fraction), None, None) => Ok(Source::PackingFraction(fraction)),
            (None, Some(pressure), None) => Ok(Source::Pressure(pressure)),
            (None, None, Some(file)) => Ok(Source::File(file)),
            (None, Some(pressure), Some(file)) => Ok(Source::FileAtPressure { file, pressure }),
            _ => Err("a source is one of `packing_fraction`, `pressure`, `file`, or `file` and `pressure`"),
        }
    }
}

impl From<Source> for Fields {
    fn from(source: Source) -> Self {
        let none = Fields { packing_fraction: None, pressure: None, file: None };
        match source {
            Source::PackingFraction(fraction) => Fields { packing_fraction: Some(fraction), ..none },
            Source::Pressure(pressure) => Fields { pressure: Some(pressure), ..none },
            Source::File(file) => Fields { file: Some(file), ..none },
            Source::FileAtPressure { file, pressure } => Fields { file: Some(file), pressure: Some(pressure), ..none },
        }
    }
}

/// φ_J of disks and of spheres. Below it FIRE relaxes: viscoelastic damping vanishes with the overlaps, so a packing without contacts would
/// never stop. Source: O'Hern, Langer, Liu, Nagel (2002), Phys. Rev. Lett. 88, 075507; for spheres (2003), Phys. Rev. E 68, 011306.
const JAMMING: [f64; 2] = [0.842, 0.648];

impl Source {
    /// Whether random points in two or three dimensions are quenched below φ_J.
    pub fn is_below_jamming(&self, dimension: usize) -> bool {
        let jamming = JAMMING[usize::from(dimension == 3)];
        matches!(self, Source::PackingFraction(fraction) if *fraction < jamming)
    }
}
