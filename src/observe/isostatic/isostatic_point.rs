//! [`IsostaticPoint`]: one ring of the curve from which ℓ_iso is read.

use serde::{Deserialize, Serialize};

/// One ring, scaled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct IsostaticPoint {
    /// r \[length\].
    pub radius: f64,
    /// x = r ΔZ or r √ΔZ \[1\].
    pub scaled_radius: f64,
    /// y = (h_∥/h_0) xⁿ \[1\].
    pub scaled_fluctuation: f64,
    /// Standard error of y from that of h_∥; h_0 is treated as exact \[1\].
    pub standard_error: f64,
}
