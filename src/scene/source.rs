//! [`Source`]: the source of a packing.

use serde::{Deserialize, Serialize};

/// The source of a packing.
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

/// φ_J. Below it FIRE relaxes: viscoelastic damping vanishes with the overlaps, so a packing without contacts would
/// never stop. Source: O'Hern, Langer, Liu, Nagel (2002), Phys. Rev. Lett. 88, 075507.
const JAMMING: f64 = 0.842;

impl Source {
    /// Whether random points are quenched below φ_J.
    pub fn is_below_jamming(&self) -> bool {
        matches!(self, Source::PackingFraction(fraction) if *fraction < JAMMING)
    }
}
