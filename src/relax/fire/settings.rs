//! [`Fire`]: the settings of FIRE.

use serde::{Deserialize, Serialize};

use crate::relax::force_limit::ForceLimit;

/// FIRE. Defaults: Bitzek et al. (2006), Phys. Rev. Lett. 97, 170201, where no other origin is given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Fire {
    /// When the packing counts as at rest. Changes results.
    pub limit: ForceLimit,
    /// Steps allowed.
    pub step_limit: usize,
    /// Largest time step over the stability limit 2/√λ of Gershgorin's bound \[1\]. Changes speed only. The bound lies
    /// above the largest eigenvalue: values of 0.9 to 1.2 take the fewest steps, and 1.3 does not converge near jamming.
    pub time_step_fraction: f64,
    /// Steps downhill before the time step grows.
    pub delay: usize,
    /// Factor on the time step after a step downhill \[1\].
    pub step_growth: f64,
    /// Factor on the time step at a restart \[1\].
    pub step_cut: f64,
    /// Mixing of velocity and force at a restart \[1\].
    pub mixing: f64,
    /// Factor on the mixing after a step downhill \[1\].
    pub mixing_decay: f64,
    /// What happens after a step that raised the energy.
    #[serde(skip_serializing_if = "Uphill::is_restart")]
    pub uphill: Uphill,
    /// Precision of the steps. Changes results where minima lie close together.
    #[serde(skip_serializing_if = "Precision::is_double")]
    pub precision: Precision,
}

/// The precision of the steps of FIRE.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    /// Double throughout.
    #[default]
    Double,
    /// Single while the residual is above 10⁻⁶, then double. Energies, residuals and bounds on the time step are always
    /// computed in double precision. The same holds for the forces at rest.
    Mixed,
}

impl Precision {
    /// Whether this is the default, which is not written.
    pub(crate) fn is_double(&self) -> bool {
        *self == Precision::Double
    }
}

/// What FIRE does after a step that raised the energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Uphill {
    /// The disks rest where they are.
    #[default]
    Restart,
    /// The disks go half a step back and rest there.
    StepBack(StepBack),
}

impl Uphill {
    /// Whether this is the default, which is not written.
    fn is_restart(&self) -> bool {
        *self == Uphill::Restart
    }
}

/// The corrections of FIRE 2.0. Defaults: Guénolé et al. (2020), Comput. Mater. Sci. 175, 109584, table 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StepBack {
    /// Number of steps from the start in which a climbing step does not shorten the time step.
    pub start_delay: usize,
    /// Number of consecutive climbing steps allowed; one more ends the relaxation.
    pub uphill_limit: usize,
}

impl Default for StepBack {
    fn default() -> Self {
        StepBack { start_delay: 20, uphill_limit: 2000 }
    }
}

impl Default for Fire {
    fn default() -> Self {
        Fire {
            limit: ForceLimit::default(),
            // Random points of 88776 disks close to jamming need about 10⁵.
            step_limit: 2_000_000,
            time_step_fraction: 1.0,
            delay: 5,
            step_growth: 1.1,
            step_cut: 0.5,
            mixing: 0.1,
            mixing_decay: 0.99,
            uphill: Uphill::default(),
            precision: Precision::default(),
        }
    }
}
