//! Checks of force limits that would accept states far from rest.
//!
//! A state with a residual above [`LARGEST_RESIDUAL`] is not at rest. A relative limit is compared with it. An absolute
//! limit is compared with that share of the largest possible mean contact force of a packing of the scene:
//!
//! ```text
//! ⟨F⟩ ≤ p π ⟨R²⟩ / (φ ⟨R⟩)       at a pressure p: Σ F r = 2 p V, φ = 0.8, at least one contact per disk, including
//! rattlers
//! ⟨F⟩ ≤ F(δ = R_max)             at a packing fraction: overlaps of a whole radius
//! ```

use crate::law::pair_law::PairLaw;
use crate::relax::{ForceLimit, RelaxerChoice};
use crate::scene::SceneError;
use crate::scene::definition::{Sample, Scene};
use crate::scene::source::Source;
use crate::verdict::LARGEST_RESIDUAL;

/// A packing fraction below that of any jammed packing of disks, for an upper bound of the force \[1\].
const PACKING_FRACTION: f64 = 0.8;

impl Scene {
    /// Checks the limits of all relaxers and that of a verdict.
    pub(super) fn check_rest(&self) -> Result<(), SceneError> {
        let (field, limit) = ("verdict.residual_limit", self.verdict.residual_limit);
        if !(limit > 0.0 && limit <= LARGEST_RESIDUAL) {
            let range = "above 0 and at most 0.01";
            return Err(SceneError::OutOfRange { field: field.into(), value: limit, range });
        }
        for sample in &self.sample {
            let most = self.largest_mean_force(sample);
            check("preparation.relaxer", &self.preparation.relaxer, most)?;
            check(&format!("sample \"{}\": relaxer", sample.name), &sample.relaxer, most)?;
        }
        Ok(())
    }

    /// Upper bound of the mean contact force of the packing of a sample \[force\].
    fn largest_mean_force(&self, sample: &Sample) -> f64 {
        let shares: f64 = self.mixture.components.iter().map(|part| part.share).sum();
        let mean = |of: &dyn Fn(f64) -> f64| {
            self.mixture.components.iter().map(|part| part.share * of(part.radius)).sum::<f64>() / shares
        };
        match sample.source {
            Source::Pressure(pressure) | Source::FileAtPressure { pressure, .. } => {
                let square = mean(&|radius| radius * radius);
                pressure * std::f64::consts::PI * square / (PACKING_FRACTION * mean(&|radius| radius))
            }
            Source::PackingFraction(_) | Source::File(_) => {
                let largest = self.mixture.components.iter().map(|part| part.radius).fold(0.0, f64::max);
                self.law.force_scale(largest)
            }
        }
    }
}

fn check(field: &str, relaxer: &RelaxerChoice, largest_mean_force: f64) -> Result<(), SceneError> {
    let (name, value, limit) = match relaxer.limit() {
        ForceLimit::Relative(value) => ("relative", value, LARGEST_RESIDUAL),
        ForceLimit::Absolute(value) => ("absolute", value, LARGEST_RESIDUAL * largest_mean_force),
    };
    if value <= limit {
        return Ok(());
    }
    Err(SceneError::LimitTooLoose { field: format!("{field}.limit.{name}"), value, limit })
}
