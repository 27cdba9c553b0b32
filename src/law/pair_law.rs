//! [`PairLaw`]: force, energy and stiffness of one overlap.
//!
//! The law is a type: the arithmetic of a block of contacts is compiled once per law and has no branch on it. A law
//! chosen at run time is [resolved](PairLaw::resolve) once per block, so the surrounding code is compiled only once.

use std::slice::from_ref;

use pulp::Simd;
use pulp::bytemuck::{cast_slice, cast_slice_mut};

use crate::law::damping::{ContactDamping, DampingChoice};

/// The mechanics of one contact: pure functions of the overlap and of a coefficient computed once per pair.
pub trait PairLaw: Copy + std::fmt::Debug + Send + Sync {
    /// The viscoelastic damping for this law, with the rate γ.
    fn viscoelastic(&self, rate: f64) -> ContactDamping;

    /// The chosen damping for contacts of this law.
    fn contact_damping(&self, choice: &DampingChoice) -> ContactDamping {
        match choice {
            DampingChoice::Constant(damping) => ContactDamping::Constant(*damping),
            DampingChoice::Viscoelastic(damping) => self.viscoelastic(damping.rate),
        }
    }

    /// Calls `visitor` with this law, or with the law that it represents.
    #[inline(always)]
    fn resolve<V: LawVisitor>(&self, visitor: V) -> V::Output {
        visitor.visit(self)
    }

    /// Coefficient c of a pair \[force / length^(α−1)\].
    fn coefficient(&self, first_radius: f64, second_radius: f64) -> f64;

    /// Relative growth of the coefficient with the first radius, ∂ ln c/∂R_i \[1 / length\]: its effect on the contact
    /// forces of a disk that grows at fixed overlap.
    fn coefficient_growth(&self, first_radius: f64, second_radius: f64) -> f64;

    /// Repulsive force F(δ) for an overlap δ ≥ 0 \[force\]. A NaN is kept.
    fn force(&self, coefficient: f64, overlap: f64) -> f64;

    /// [`force`](Self::force) for two vectors of pairs, one pair per lane, with the same bits \[force\]. By default
    /// computed one after the other.
    #[inline(always)]
    fn forces<S: Simd>(&self, _simd: S, coefficients: [S::f64s; 2], overlaps: [S::f64s; 2]) -> [S::f64s; 2] {
        let mut forces = overlaps;
        let each: &[f64] = cast_slice(&coefficients);
        for (force, &coefficient) in cast_slice_mut(&mut forces).iter_mut().zip(each) {
            *force = self.force(coefficient, *force);
        }
        forces
    }

    /// Whether the force is c δ^(α−1) for all overlaps. Only such a law is computed in single precision, whose units of
    /// force and length are others.
    const IS_POWER: bool = false;

    /// c δ^(α−1) for a vector of pairs in single precision, in any units of c and δ; called only if the law
    /// [is a power](Self::IS_POWER). Its cost dominates a relaxation while disks are far from rest.
    #[inline(always)]
    fn forces_in_single<S: Simd>(&self, _simd: S, coefficients: S::f32s, overlaps: S::f32s) -> S::f32s {
        let mut forces = [overlaps];
        let each: &[f32] = cast_slice(from_ref(&coefficients));
        for (force, &coefficient) in cast_slice_mut::<_, f32>(&mut forces).iter_mut().zip(each) {
            *force = (f64::from(coefficient) * libm::pow(f64::from(*force), self.exponent() - 1.0)) as f32;
        }
        forces[0]
    }

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

    /// Whether all pairs have the same coefficient for any radii; the loop then reads one per block.
    const ONE_COEFFICIENT: bool = false;

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
}

/// A function of a law whose type is known.
pub trait LawVisitor {
    /// Its result.
    type Output;

    /// Calls the function.
    fn visit<L: PairLaw>(self, law: &L) -> Self::Output;
}
