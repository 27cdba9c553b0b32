//! Dissipation at a contact: a force −c_ij v_n along the contact, v_n the normal part of the relative velocity.
//!
//! | law | c_ij |
//! |---|---|
//! | [`ConstantDamping`] | γ, as the model is usually printed |
//! | [`ViscoelasticDamping`] on a Hertzian contact | γ m_eff √(δ R_ij), m_eff = 1/2, as LAMMPS `gran/hertz/history` computes it |
//! | [`MassDamping`], for viscoelastic damping of a Hookean contact | γ m_eff, as LAMMPS `gran/hooke` computes it |
//!
//! Constant and viscoelastic damping lead to very different dynamics near jamming. A scene names one of them
//! ([`DampingChoice`]); with a contact law this is a [`ContactDamping`].

use serde::{Deserialize, Serialize};

/// Reduced mass of two disks of mass 1 \[mass\].
pub const REDUCED_MASS: f64 = 0.5;

/// Effective radius `R_i R_j / (R_i + R_j)` of two touching disks \[length\].
#[inline(always)]
pub fn effective_radius(first_radius: f64, second_radius: f64) -> f64 {
    first_radius * second_radius / (first_radius + second_radius)
}

/// `c_ij = γ` for any overlap.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstantDamping {
    /// γ \[force / velocity\].
    pub rate: f64,
}

/// `c_ij = γ m_eff √(δ R_ij)` (Hertzian contacts).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViscoelasticDamping {
    /// γ \[1 / (time length)\].
    pub rate: f64,
}

/// `c_ij = γ m_eff` (the viscoelastic law of a Hookean contact).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassDamping {
    /// γ \[1 / time\].
    pub rate: f64,
}

/// Damping of a contact: a pure function of the overlap and of a coefficient computed once per pair.
///
/// It is a [`DampingChoice`] for a given contact law ([`PairLaw::contact_damping`](crate::law::PairLaw::contact_damping)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ContactDamping {
    /// c_ij = γ.
    Constant(ConstantDamping),
    /// c_ij = γ m_eff √(δ R_ij).
    Viscoelastic(ViscoelasticDamping),
    /// c_ij = γ m_eff.
    Mass(MassDamping),
}

impl ContactDamping {
    /// Coefficient of a pair: γ, γ m_eff √R_ij or γ m_eff.
    pub fn coefficient(&self, first_radius: f64, second_radius: f64) -> f64 {
        match self {
            ContactDamping::Constant(law) => law.rate,
            ContactDamping::Viscoelastic(law) => {
                law.rate * REDUCED_MASS * effective_radius(first_radius, second_radius).sqrt()
            }
            ContactDamping::Mass(law) => law.rate * REDUCED_MASS,
        }
    }

    /// c_ij for an overlap δ > 0 \[force / velocity\].
    #[inline(always)]
    pub fn damping(&self, coefficient: f64, overlap: f64) -> f64 {
        match self {
            ContactDamping::Viscoelastic(_) => coefficient * overlap.sqrt(),
            ContactDamping::Constant(_) | ContactDamping::Mass(_) => coefficient,
        }
    }
}

impl From<ConstantDamping> for ContactDamping {
    fn from(law: ConstantDamping) -> Self {
        ContactDamping::Constant(law)
    }
}

/// A damping law chosen at run time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DampingChoice {
    /// [`ConstantDamping`].
    Constant(ConstantDamping),
    /// [`ViscoelasticDamping`] on Hertzian contacts, γ m_eff on the others.
    Viscoelastic(ViscoelasticDamping),
}

impl Default for DampingChoice {
    /// Constant, γ = 500. Source: the published study.
    fn default() -> Self {
        DampingChoice::Constant(ConstantDamping { rate: 500.0 })
    }
}

impl DampingChoice {
    /// γ of either law \[force / velocity, or 1 / (time length)\].
    pub fn rate(&self) -> f64 {
        match self {
            DampingChoice::Constant(law) => law.rate,
            DampingChoice::Viscoelastic(law) => law.rate,
        }
    }

    /// Damping ratio of a Hertzian contact: below 1 it oscillates, above 1 it creeps.
    ///
    /// ```text
    /// ζ = c_ij/(2 √(k m_eff))        k = (3/2) k' √(δ R_ij), the stiffness dF/dδ
    /// ```
    ///
    /// # Example
    /// A contact of two small disks at p ≈ 10 has an overlap of about 2·10⁻³. With a rate of 500 it is underdamped for
    /// viscoelastic damping and overdamped for constant damping.
    /// ```
    /// use jamscope::law::damping::{ConstantDamping, DampingChoice, ViscoelasticDamping};
    ///
    /// let ratio = |damping: DampingChoice| damping.hertzian_damping_ratio(2e5, 0.25, 2e-3);
    /// assert!((ratio(DampingChoice::Viscoelastic(ViscoelasticDamping { rate: 500.0 })) - 0.0483).abs() < 1e-4);
    /// assert!((ratio(DampingChoice::Constant(ConstantDamping { rate: 500.0 })) - 4.3167).abs() < 1e-3);
    /// ```
    pub fn hertzian_damping_ratio(&self, stiffness: f64, effective_radius: f64, overlap: f64) -> f64 {
        let root = (overlap * effective_radius).sqrt();
        let damping = match self {
            DampingChoice::Constant(law) => law.rate,
            DampingChoice::Viscoelastic(law) => law.rate * REDUCED_MASS * root,
        };
        damping / (2.0 * (1.5 * stiffness * root * REDUCED_MASS).sqrt())
    }
}
