//! [`LawChoice`]: a contact law chosen at run time.

use serde::{Deserialize, Serialize};

use crate::law::damping::ContactDamping;
use crate::law::pair_law::{LawVisitor, PairLaw};
use crate::law::power_laws::{Hertzian, Hookean, PowerLaw};

/// A contact law chosen at run time, as a scene or a command line names it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LawChoice {
    /// [`Hertzian`].
    Hertzian(Hertzian),
    /// [`Hookean`].
    Hookean(Hookean),
    /// [`PowerLaw`].
    PowerLaw(PowerLaw),
}

impl Default for LawChoice {
    fn default() -> Self {
        LawChoice::Hertzian(Hertzian::default())
    }
}

/// An invalid parameter of a law.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawError {
    /// The stiffness or energy scale must be positive and finite.
    #[error("the stiffness of the contact law is {stiffness}, not a positive number")]
    StiffnessNotPositive {
        /// The value given.
        stiffness: f64,
    },
    /// The energy must have a continuous force: α ≥ 2.
    #[error("the exponent of the contact law is {exponent}, not a number of at least 2")]
    ExponentTooSmall {
        /// The value given.
        exponent: f64,
    },
}

impl LawChoice {
    /// Its name in a scene.
    pub fn name(&self) -> &'static str {
        match self {
            LawChoice::Hertzian(_) => "hertzian",
            LawChoice::Hookean(_) => "hookean",
            LawChoice::PowerLaw(_) => "power_law",
        }
    }

    /// Checks the parameters.
    ///
    /// # Errors
    /// [`LawError`] with the parameter.
    pub fn check(&self) -> Result<(), LawError> {
        let (stiffness, exponent) = match self {
            LawChoice::Hertzian(law) => (law.stiffness, law.exponent()),
            LawChoice::Hookean(law) => (law.stiffness, law.exponent()),
            LawChoice::PowerLaw(law) => (law.energy_scale, law.exponent),
        };
        if !(stiffness.is_finite() && stiffness > 0.0) {
            return Err(LawError::StiffnessNotPositive { stiffness });
        }
        if !(exponent.is_finite() && exponent >= 2.0) {
            return Err(LawError::ExponentTooSmall { exponent });
        }
        Ok(())
    }

    /// Exponent α of the energy \[1\].
    pub fn exponent(&self) -> f64 {
        match self {
            LawChoice::Hertzian(law) => law.exponent(),
            LawChoice::Hookean(law) => law.exponent(),
            LawChoice::PowerLaw(law) => law.exponent(),
        }
    }
}

/// Results have the same bits as those of the chosen law.
impl PairLaw for LawChoice {
    const IS_POWER: bool = true;

    #[inline(always)]
    fn resolve<V: LawVisitor>(&self, visitor: V) -> V::Output {
        match self {
            LawChoice::Hertzian(law) => visitor.visit(law),
            LawChoice::Hookean(law) => visitor.visit(law),
            LawChoice::PowerLaw(law) => visitor.visit(law),
        }
    }

    fn viscoelastic(&self, rate: f64) -> ContactDamping {
        match self {
            LawChoice::Hertzian(law) => law.viscoelastic(rate),
            LawChoice::Hookean(law) => law.viscoelastic(rate),
            LawChoice::PowerLaw(law) => law.viscoelastic(rate),
        }
    }

    fn coefficient(&self, first_radius: f64, second_radius: f64) -> f64 {
        match self {
            LawChoice::Hertzian(law) => law.coefficient(first_radius, second_radius),
            LawChoice::Hookean(law) => law.coefficient(first_radius, second_radius),
            LawChoice::PowerLaw(law) => law.coefficient(first_radius, second_radius),
        }
    }

    fn coefficient_growth(&self, first_radius: f64, second_radius: f64) -> f64 {
        match self {
            LawChoice::Hertzian(law) => law.coefficient_growth(first_radius, second_radius),
            LawChoice::Hookean(law) => law.coefficient_growth(first_radius, second_radius),
            LawChoice::PowerLaw(law) => law.coefficient_growth(first_radius, second_radius),
        }
    }

    #[inline(always)]
    fn force(&self, coefficient: f64, overlap: f64) -> f64 {
        match self {
            LawChoice::Hertzian(law) => law.force(coefficient, overlap),
            LawChoice::Hookean(law) => law.force(coefficient, overlap),
            LawChoice::PowerLaw(law) => law.force(coefficient, overlap),
        }
    }

    fn exponent(&self) -> f64 {
        LawChoice::exponent(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nonsense_is_named() {
        let law = LawChoice::Hertzian(Hertzian { stiffness: -1.0 });
        assert_eq!(law.check(), Err(LawError::StiffnessNotPositive { stiffness: -1.0 }));
        let law = LawChoice::PowerLaw(PowerLaw { energy_scale: 1.0, exponent: 1.5 });
        assert_eq!(law.check(), Err(LawError::ExponentTooSmall { exponent: 1.5 }));
    }
}
