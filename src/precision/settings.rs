//! The ladders of a measurement, and their errors.

use serde::{Deserialize, Serialize};

use crate::run::RunError;
use crate::scene::{SceneError, finite_numbers};

/// The ladders.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PrecisionSettings {
    /// Force limits, over the mean contact force \[1\].
    pub force_limits: Vec<f64>,
    /// Time steps of damped dynamics, over the stability limit \[1\].
    pub time_steps: Vec<f64>,
    /// Tolerances of the implicit motions, over the median overlap \[1\].
    pub tolerances: Vec<f64>,
    /// Step limit of relaxers with one or two force evaluations per step.
    pub explicit_step_limit: usize,
    /// Step limit of an implicit motion that finishes by its own steps.
    pub implicit_step_limit: usize,
    /// Force limit of the references, over the mean contact force \[1\].
    pub reference_limit: f64,
}

impl Default for PrecisionSettings {
    fn default() -> Self {
        PrecisionSettings {
            force_limits: vec![1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12],
            time_steps: vec![0.45, 0.225],
            tolerances: vec![0.3, 0.1, 0.03, 0.01, 0.003],
            explicit_step_limit: 50_000,
            implicit_step_limit: 4000,
            reference_limit: 1e-13,
        }
    }
}

/// Why nothing can be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PrecisionError {
    /// The scene is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A ladder contains an invalid number.
    #[error("{field} = {value}: must be a positive, finite number")]
    NotPositive {
        /// The field of the settings.
        field: &'static str,
        /// The value.
        value: f64,
    },
    /// A ladder is empty.
    #[error("{field} is empty")]
    Empty {
        /// The field of the settings.
        field: &'static str,
    },
    /// The preparation of a sample, or its inflation, failed.
    #[error("sample \"{name}\": {source}")]
    Sample {
        /// The sample.
        name: String,
        /// The error.
        source: RunError,
    },
}

/// Step limit of an implicit motion of an unjammed packing, whose disks move until they touch nothing.
const FLIGHT_LIMIT: usize = 100;

impl PrecisionSettings {
    /// The ladders for an unjammed packing, in which all limits relative to contact forces are met as soon as these
    /// vanish.
    pub(super) fn for_unjammed(&self) -> Self {
        PrecisionSettings {
            force_limits: vec![self.force_limits.iter().copied().fold(f64::INFINITY, f64::min)],
            time_steps: Vec::new(),
            tolerances: self.tolerances.iter().copied().take(1).collect(),
            implicit_step_limit: self.implicit_step_limit.min(FLIGHT_LIMIT),
            ..self.clone()
        }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// [`PrecisionError`] with the field and the value.
    pub fn check(&self) -> Result<(), PrecisionError> {
        let ladders =
            [("force_limits", &self.force_limits), ("time_steps", &self.time_steps), ("tolerances", &self.tolerances)];
        for (field, ladder) in ladders {
            if let Some(&value) = ladder.iter().find(|&&value| !(value.is_finite() && value > 0.0)) {
                return Err(PrecisionError::NotPositive { field, value });
            }
        }
        if self.force_limits.is_empty() {
            return Err(PrecisionError::Empty { field: "force_limits" });
        }
        let value = self.reference_limit;
        if !(value.is_finite() && value > 0.0) {
            return Err(PrecisionError::NotPositive { field: "reference_limit", value });
        }
        // Fields that no rule above checks, such as new ones.
        Ok(finite_numbers::check(self).map_err(SceneError::from)?)
    }
}
