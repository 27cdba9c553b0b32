//! [`ProfileFit`]: the results of the fits to a radial profile.

use serde::{Deserialize, Serialize};

use crate::fit::Estimate;

/// The elastic solution fitted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ElasticFit {
    /// d_0^eff \[length\].
    pub amplitude: Estimate,
    /// Largest κ compatible with the profile, one-sided, 95 % \[1/length\]; none if it is above the search range.
    pub wavenumber_bound: Option<f64>,
    /// Σ (residual/error)² over the rings.
    pub chi_squared: f64,
    /// Share of the weighted Σ (r^(D−1) d_r)² described, per degree of freedom: `1 − (χ²/(n−1))/(χ²_0/n)` \[1\].
    pub share_described: f64,
    /// Number of independent rings n_eff, from its residuals.
    pub effective_ring_count: f64,
    /// Probability that zero displacement would fit this much worse by chance (F test).
    pub chance_of_nothing: f64,
}

/// The screened solution fitted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ScreenedFit {
    /// d_0^eff \[length\]; of either sign, zero at a pole.
    pub amplitude: Estimate,
    /// κ \[1/length\].
    pub wavenumber: Estimate,
    /// Correlation of the two errors \[1\].
    pub correlation: f64,
    /// Number of poles below κ: 0 below κ_1, 1 between κ_1 and κ_2.
    pub branch: usize,
    /// Σ (residual/error)² over the rings.
    pub chi_squared: f64,
    /// Share of the weighted Σ (r^(D−1) d_r)² described, per degree of freedom: `1 − (χ²/(n−2))/(χ²_0/n)` \[1\].
    pub share_described: f64,
    /// Number of independent rings n_eff, from its residuals.
    pub effective_ring_count: f64,
    /// Probability that zero displacement would fit this much worse by chance (F test, corrected for the branches).
    pub chance_of_nothing: f64,
    /// Probability that κ = 0 would fit this much worse by chance (F test, corrected for the branches).
    pub chance_of_elastic: f64,
}

/// The solution that describes the profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Decision {
    /// The elastic solution; κ is consistent with zero, below [`ElasticFit::wavenumber_bound`].
    Elastic,
    /// The screened solution, with κ ≠ 0.
    Screened,
    /// Neither of the two.
    Neither,
}

/// Both fits and the decision between them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ProfileFit {
    /// The solution that describes the profile.
    pub decision: Decision,
    /// The elastic solution.
    pub elastic: ElasticFit,
    /// The screened solution. Absent if no κ > 0 up to the largest searched fits better than κ = 0, or if the rings
    /// cannot separate κ from the amplitude.
    pub screened: Option<ScreenedFit>,
    /// Number of rings used.
    pub ring_count: usize,
    /// Inner and outer end of the range used \[length\].
    pub range: [f64; 2],
    /// Largest κ searched \[1/length\].
    pub largest_wavenumber: f64,
}
