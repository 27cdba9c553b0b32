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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::law::damping::{ConstantDamping, ContactDamping, DampingChoice};
    use crate::law::pair_law::ShareLaw;

    /// A law that defines everything itself.
    #[derive(Debug, Clone)]
    struct Own;

    const DAMPING: ContactDamping = ContactDamping::Constant(ConstantDamping { rate: 7.0 });

    impl PairLaw for Own {
        fn viscoelastic(&self, _: f64) -> ContactDamping {
            DAMPING
        }
        fn contact_damping(&self, _: &DampingChoice) -> ContactDamping {
            DAMPING
        }
        fn coefficient(&self, first_radius: f64, second_radius: f64) -> f64 {
            first_radius + 2.0 * second_radius
        }
        fn coefficient_growth(&self, _: f64, _: f64) -> f64 {
            11.0
        }
        fn force(&self, _: f64, _: f64) -> f64 {
            13.0
        }
        fn exponent(&self) -> f64 {
            17.0
        }
        fn energy(&self, _: f64, _: f64) -> f64 {
            19.0
        }
        fn stiffness(&self, _: f64, _: f64) -> f64 {
            23.0
        }
        fn is_power(&self) -> bool {
            true
        }
        fn has_one_coefficient(&self) -> bool {
            true
        }
        fn force_scale(&self, _: f64) -> f64 {
            29.0
        }
    }

    #[test]
    fn a_law_with_sites_and_a_shared_one_keep_all_that_the_law_defines() {
        let numbers = |law: &dyn PairLaw| {
            let mut columns = [[0.0]; 3];
            law.forces(&[1.0], &[1.0], &mut columns[0]);
            law.energies(&[1.0], &[1.0], &mut columns[1]);
            law.stiffnesses(&[1.0], &[1.0], &mut columns[2]);
            let of_pair = [law.force(1.0, 1.0), law.energy(1.0, 1.0), law.stiffness(1.0, 1.0), law.force_scale(1.0)];
            let of_radii = [law.coefficient(1.0, 2.0), law.coefficient_growth(1.0, 2.0), law.exponent()];
            let damping = [law.viscoelastic(500.0), law.contact_damping(&DampingChoice::default())];
            (columns, of_pair, of_radii, damping, law.is_power(), law.has_one_coefficient())
        };
        let shared: Arc<dyn PairLaw> = Own.shared();
        let (plain, with_sites) = (OnSite { law: Own, coupling: 3.0 }, OnSite { law: shared.clone(), coupling: 3.0 });
        for law in [&plain as &dyn PairLaw, &with_sites, &shared] {
            assert_eq!(numbers(law), numbers(&Own), "{law:?}");
        }
        assert_eq!((plain.on_site_coupling(), with_sites.on_site_coupling()), (3.0, 3.0));
        assert!(with_sites.has_sites() && !shared.has_sites());
    }
}
