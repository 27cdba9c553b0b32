//! [`EndingResponse`]: angular correlation and contact changes of an ending, relative to the state before the
//! inflation.

use serde::Serialize;

/// The numbers of the response of an ending that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EndingResponse {
    /// G* = −G(π) of d_r in the ring, or the shell of spheres, r̂ = 0.5 ± 0.03 \[1\]; absent if it has too few disks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anticorrelation: Option<f64>,
    /// θ*, or γ* of spheres, where G falls to 0.1 \[rad\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlation_angle: Option<f64>,
    /// Contacts of the backbone made by the inflation.
    pub made_count: usize,
    /// Contacts of the backbone broken by the inflation.
    pub broken_count: usize,
}
