//! [`Fire`]: the settings of FIRE.

use serde::{Deserialize, Serialize};

use crate::relax::force_limit::ForceLimit;

/// Settings of FIRE. Defaults: Bitzek et al. (2006), Phys. Rev. Lett. 97, 170201, unless another origin is given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Fire {
    /// Criterion of mechanical equilibrium. Changes results.
    pub limit: ForceLimit,
    /// Largest number of steps.
    pub step_limit: usize,
    /// Largest time step over the stability limit 2/√λ of Gershgorin's bound \[1\]. Changes speed only. The bound
    /// exceeds the largest eigenvalue, so values slightly above 1 can be stable. Values of 1.3 and more do not converge
    /// near jamming.
    pub time_step_fraction: f64,
    /// Number of downhill steps before the time step grows.
    pub delay: usize,
    /// Factor on the time step after a step downhill \[1\].
    pub step_growth: f64,
    /// Factor on the time step at a restart \[1\].
    pub step_cut: f64,
    /// Mixing of velocity and force at a restart \[1\].
    pub mixing: f64,
    /// Factor on the mixing after a step downhill \[1\].
    pub mixing_decay: f64,
    /// Treatment of a step that increased the energy.
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
    /// Double precision in all steps.
    #[default]
    Double,
    /// Single precision while the relative residual is above 10⁻⁶, then double. Energies, residuals, bounds on the time
    /// step and the final forces are always in double precision.
    Mixed,
}

impl Precision {
    /// Whether this is the default, which is omitted from files.
    pub(crate) fn is_double(&self) -> bool {
        *self == Precision::Double
    }
}

/// Treatment of a step that increased the energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Uphill {
    /// The disks stop at their present positions.
    #[default]
    Restart,
    /// The disks go back by half a step and stop there.
    StepBack(StepBack),
}

impl Uphill {
    /// Whether this is the default, which is omitted from files.
    fn is_restart(&self) -> bool {
        *self == Uphill::Restart
    }
}

/// The corrections of FIRE 2.0. Defaults: Guénolé et al. (2020), Comput. Mater. Sci. 175, 109584, table 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StepBack {
    /// Number of initial steps in which an uphill step does not reduce the time step.
    pub start_delay: usize,
    /// Number of consecutive uphill steps allowed; one more ends the relaxation.
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
            // Random points of 88776 disks close to jamming need about 10⁵ steps.
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
