//! [`PairLaw`]: force, energy and stiffness of one overlap.
//!
//! All other code takes a `&dyn PairLaw`, and is compiled once and not once per law. The loop over contacts calls the law
//! once per block of pairs, for a column of forces ([`PairLaw::forces`]), and not once per pair.

use std::sync::Arc;

use pulp::{Simd, WithSimd};

use crate::law::damping::{ContactDamping, DampingChoice};
use crate::processor;

/// The mechanics of one contact: pure functions of the overlap and of a coefficient computed once per pair.
///
/// Only the functions of one pair must be given. Those of columns call them for one pair after the other, compiled for
/// each vector width. A law may give its own for speed, as [`Hertzian`](crate::law::Hertzian) does.
pub trait PairLaw: ShareLaw + std::fmt::Debug + Send + Sync + 'static {
    /// The viscoelastic damping for this law, with the rate γ.
    fn viscoelastic(&self, rate: f64) -> ContactDamping;

    /// The chosen damping for contacts of this law.
    fn contact_damping(&self, choice: &DampingChoice) -> ContactDamping {
        match choice {
            DampingChoice::Constant(damping) => ContactDamping::Constant(*damping),
            DampingChoice::Viscoelastic(damping) => self.viscoelastic(damping.rate),
        }
    }

    /// Coefficient c of a pair \[force / length^(α−1)\].
    fn coefficient(&self, first_radius: f64, second_radius: f64) -> f64;

    /// Relative growth of the coefficient with the first radius, ∂ ln c/∂R_i \[1 / length\]: its effect on the contact
    /// forces of a disk that grows at fixed overlap.
    fn coefficient_growth(&self, first_radius: f64, second_radius: f64) -> f64;

    /// Repulsive force F(δ) for an overlap δ ≥ 0 \[force\]. A NaN is kept.
    fn force(&self, coefficient: f64, overlap: f64) -> f64;

    /// Exponent α of the energy \[1\].
    fn exponent(&self) -> f64;

    /// Energy u(δ) from the force at that overlap \[energy\].
    #[inline(always)]
    fn energy(&self, force: f64, overlap: f64) -> f64 {
        force * overlap / self.exponent()
    }

    /// Stiffness F'(δ) from the force at that overlap, 0 without overlap \[force / length\].
    #[inline(always)]
    fn stiffness(&self, force: f64, overlap: f64) -> f64 {
        if overlap > 0.0 { (self.exponent() - 1.0) * force / overlap } else { 0.0 }
    }

    /// Whether the force is c δ^(α−1) for all overlaps. Only such a law is computed in single precision, whose units of
    /// force and length are others.
    fn is_power(&self) -> bool {
        false
    }

    /// Whether all pairs have the same coefficient for any radii. The column of coefficients is then not prefetched, as
    /// such a law need not read it.
    fn has_one_coefficient(&self) -> bool {
        false
    }

    /// Γ of an energy −Γu²/2 of the displacement u of every disk from its site, see
    /// [`OnSite`](crate::law::on_site::OnSite); 0 without sites \[force / length\].
    fn on_site_coupling(&self) -> f64 {
        0.0
    }

    /// Whether disks have sites: Γ is not 0.
    fn has_sites(&self) -> bool {
        self.on_site_coupling() != 0.0
    }

    /// The force between two equal disks with an overlap of one radius: the scale for forces that count as zero
    /// \[force\].
    fn force_scale(&self, radius: f64) -> f64 {
        self.force(self.coefficient(radius, radius), radius)
    }

    /// [`force`](Self::force) of each pair of a column, with the same bits \[force\].
    ///
    /// # Shape
    /// All columns must be of one length; `forces` is overwritten. The last places may belong to no pair, and their
    /// results are not used.
    fn forces(&self, coefficients: &[f64], overlaps: &[f64], forces: &mut [f64]) {
        combine([coefficients, overlaps], forces, |c, overlap| self.force(c, overlap));
    }

    /// [`energy`](Self::energy) of each pair of a column \[energy\].
    ///
    /// # Shape
    /// As for [`forces`](Self::forces).
    fn energies(&self, forces: &[f64], overlaps: &[f64], energies: &mut [f64]) {
        combine([forces, overlaps], energies, |force, overlap| self.energy(force, overlap));
    }

    /// [`stiffness`](Self::stiffness) of each pair of a column \[force / length\].
    ///
    /// # Shape
    /// As for [`forces`](Self::forces).
    fn stiffnesses(&self, forces: &[f64], overlaps: &[f64], stiffnesses: &mut [f64]) {
        combine([forces, overlaps], stiffnesses, |force, overlap| self.stiffness(force, overlap));
    }

    /// c δ^(α−1) of each pair of a column in single precision, in any units of c and δ; called only if the law
    /// [is a power](Self::is_power). Its cost dominates a relaxation while disks are far from rest.
    ///
    /// # Shape
    /// As for [`forces`](Self::forces).
    fn forces_in_single(&self, coefficients: &[f32], overlaps: &[f32], forces: &mut [f32]) {
        let power = self.exponent() - 1.0;
        let force = |c, overlap| (f64::from(c) * libm::pow(f64::from(overlap), power)) as f32;
        combine([coefficients, overlaps], forces, force);
    }
}

/// Implemented for every [`PairLaw`] that is `Clone`.
pub trait ShareLaw {
    /// The law behind a shared pointer.
    fn shared(&self) -> Arc<dyn PairLaw>;
}

impl<L: PairLaw + Clone> ShareLaw for L {
    fn shared(&self) -> Arc<dyn PairLaw> {
        Arc::new(self.clone())
    }
}

/// Overwrites a column by a function of two others, place by place, compiled for each vector width.
#[inline(always)]
pub(super) fn combine<T: Copy>(from: [&[T]; 2], to: &mut [T], of: impl Fn(T, T) -> T) {
    processor::dispatch(Combine { from, to, of });
}

struct Combine<'a, T, F> {
    from: [&'a [T]; 2],
    to: &'a mut [T],
    of: F,
}

impl<T: Copy, F: Fn(T, T) -> T> WithSimd for Combine<'_, T, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        // Equal lengths and a plain index, so that the compiler inlines the loop.
        let (count, [a, b]) = (self.to.len(), self.from);
        let (a, b) = (&a[..count], &b[..count]);
        for k in 0..count {
            self.to[k] = (self.of)(a[k], b[k]);
        }
    }
}

/// Forwards the methods of [`PairLaw`] to another law, apart from the coupling to sites.
macro_rules! delegate_to_law {
    ($this:ident => $law:expr) => {
        fn viscoelastic(&$this, rate: f64) -> $crate::law::damping::ContactDamping {
            $law.viscoelastic(rate)
        }
        fn contact_damping(&$this, choice: &$crate::law::damping::DampingChoice) -> $crate::law::damping::ContactDamping {
            $law.contact_damping(choice)
        }
        fn force_scale(&$this, radius: f64) -> f64 {
            $law.force_scale(radius)
        }
        fn coefficient(&$this, first_radius: f64, second_radius: f64) -> f64 {
            $law.coefficient(first_radius, second_radius)
        }
        fn coefficient_growth(&$this, first_radius: f64, second_radius: f64) -> f64 {
            $law.coefficient_growth(first_radius, second_radius)
        }
        fn force(&$this, coefficient: f64, overlap: f64) -> f64 {
            $law.force(coefficient, overlap)
        }
        fn exponent(&$this) -> f64 {
            $law.exponent()
        }
        fn energy(&$this, force: f64, overlap: f64) -> f64 {
            $law.energy(force, overlap)
        }
        fn stiffness(&$this, force: f64, overlap: f64) -> f64 {
            $law.stiffness(force, overlap)
        }
        fn is_power(&$this) -> bool {
            $law.is_power()
        }
        fn has_one_coefficient(&$this) -> bool {
            $law.has_one_coefficient()
        }
        fn forces(&$this, coefficients: &[f64], overlaps: &[f64], forces: &mut [f64]) {
            $law.forces(coefficients, overlaps, forces);
        }
        fn energies(&$this, forces: &[f64], overlaps: &[f64], energies: &mut [f64]) {
            $law.energies(forces, overlaps, energies);
        }
        fn stiffnesses(&$this, forces: &[f64], overlaps: &[f64], stiffnesses: &mut [f64]) {
            $law.stiffnesses(forces, overlaps, stiffnesses);
        }
        fn forces_in_single(&$this, coefficients: &[f32], overlaps: &[f32], forces: &mut [f32]) {
            $law.forces_in_single(coefficients, overlaps, forces);
        }
    };
}
pub(crate) use delegate_to_law;

/// A shared law is a law.
impl PairLaw for Arc<dyn PairLaw> {
    delegate_to_law!(self => self.as_ref());

    fn on_site_coupling(&self) -> f64 {
        self.as_ref().on_site_coupling()
    }
}
