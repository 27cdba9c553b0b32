//! [`LawChoice`]: a contact law chosen at run time.

use serde::{Deserialize, Serialize};

use crate::law::pair_law::{PairLaw, delegate_to_law};
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
        self.chosen().exponent()
    }

    /// The chosen law.
    fn chosen(&self) -> &dyn PairLaw {
        match self {
            LawChoice::Hertzian(law) => law,
            LawChoice::Hookean(law) => law,
            LawChoice::PowerLaw(law) => law,
        }
    }
}

/// Results have the same bits as those of the chosen law.
impl PairLaw for LawChoice {
    delegate_to_law!(self => self.chosen());
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
