//! [`OnSite`]: a contact law with an additional energy that pushes every disk away from its site, or pulls it back.
//!
//! ```text
//! E = Σ_(i<j) u(δ_ij) − (Γ/2) Σ_i u_i²        force on disk i: contacts + Γ u_i        u_i = r_i − site of i
//! ```
//!
//! Γ > 0 weakens the packing equally in all directions, like screening of the displacement in a continuum. An isotropic
//! lattice with Γ responds as the screened continuum with κ² = (Γ/A)/(λ+2μ), A the area per disk. Γ < 0 ties every disk
//! to its site. The site of a disk is its position at the start of the first relaxation with such a law, and is stored
//! with the packing ([`Packing::sites`](crate::packing::Packing::sites)).
//!
//! Γ = 0 is a law without sites ([`PairLaw::on_site_coupling`]).
//!
//! The energy of a relaxation is that of contacts and sites. Pressure, stress and virial are those of the contacts
//! alone, because the virial of an external force depends on the origin. The relative residual is scaled by the mean
//! contact force, and only contacts form a backbone.

use crate::law::pair_law::{PairLaw, delegate_to_law};

/// A contact law with the energy −Γ u²/2 on every disk, u its displacement from its site.
///
/// # Units
/// Γ in force / length: the stiffness of a spring, negative for Γ > 0.
///
/// # Example
/// A disk between two others is stable with Γ < 0: 2 F' u = Γ u has only the solution u = 0.
/// ```
/// use jamscope::law::{Hookean, OnSite, PairLaw};
///
/// let tied = OnSite { law: Hookean { stiffness: 2.0 }, coupling: -0.5 };
/// assert_eq!((tied.on_site_coupling(), tied.law.on_site_coupling()), (-0.5, 0.0));
/// assert_eq!(tied.force(tied.coefficient(0.5, 0.5), 0.1), 0.2);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnSite<L> {
    /// The contact law.
    pub law: L,
    /// Γ, positive away from the site \[force / length\].
    pub coupling: f64,
}

/// Sites do not change the contacts.
impl<L: PairLaw + Clone> PairLaw for OnSite<L> {
    delegate_to_law!(self => self.law);

    /// The sum of Γ and that of the inner law, if it has one.
    fn on_site_coupling(&self) -> f64 {
        self.coupling + self.law.on_site_coupling()
    }
}
