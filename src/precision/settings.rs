//! The ladders a measurement goes along, and what can be wrong with them.

use serde::{Deserialize, Serialize};

use crate::run::RunError;
use crate::scene::{SceneError, finite};

/// The ladders.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PrecisionSettings {
    /// Force limits, over the mean contact force \[1\].
    pub force_limits: Vec<f64>,
    /// Time steps of damped dynamics, over the bound on a stable one \[1\].
    pub time_steps: Vec<f64>,
    /// Tolerances of the implicit motions, over the mean overlap \[1\].
    pub tolerances: Vec<f64>,
    /// Steps allowed to the relaxers that take one or two force evaluations a step.
    pub explicit_step_limit: usize,
    /// Steps allowed to an implicit motion that finishes by its own steps.
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

/// Why there is nothing to compare.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PrecisionError {
    /// The scene makes no sense.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A ladder holds a number that makes no sense.
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
    /// The packing of a sample, or its inflation, could not be had.
    #[error("sample \"{name}\": {source}")]
    Sample {
        /// The sample.
        name: String,
        /// Why.
        source: RunError,
    },
}

/// Steps allowed to an implicit motion of an unjammed packing, whose disks fly until they hit nothing any more.
const FLIGHT_LIMIT: usize = 100;

impl PrecisionSettings {
    /// The ladders of an unjammed packing: there every limit relative to contact forces is met at once, when these are gone.
    pub(super) fn where_nothing_presses(&self) -> Self {
        PrecisionSettings {
            force_limits: vec![self.force_limits.iter().copied().fold(f64::INFINITY, f64::min)],
            time_steps: Vec::new(),
            tolerances: self.tolerances.iter().copied().take(1).collect(),
            implicit_step_limit: self.implicit_step_limit.min(FLIGHT_LIMIT),
            ..self.clone()
        }
    }

    /// Whether every number makes sense.
    ///
    /// # Errors
    /// [`PrecisionError`] names the field and the value.
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
        // What no rule above has named: a new field.
        Ok(finite::check(self).map_err(SceneError::from)?)
    }
}
