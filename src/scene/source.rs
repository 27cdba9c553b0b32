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
