//! [`PairLaw`]: force, energy and stiffness of one overlap.
//!
//! The law is a type: the arithmetic of a block of contacts is compiled once for each law and has no branch on it. A law that is chosen at run
//! time is [resolved](PairLaw::resolve) once a block. So what surrounds the arithmetic is compiled once.

use std::slice::from_ref;

use pulp::Simd;
use pulp::bytemuck::{cast_slice, cast_slice_mut};

use crate::law::damping::{ContactDamping, DampingChoice};

/// What happens where two disks touch: a pure function of the overlap and of a coefficient made once a pair.
pub trait PairLaw: Copy + std::fmt::Debug + Send + Sync {
    /// The viscoelastic damping that goes with this law, with the rate γ.
    fn viscoelastic(&self, rate: f64) -> ContactDamping;

    /// A damping law that was chosen, for contacts of this law.
    fn contact_damping(&self, choice: &DampingChoice) -> ContactDamping {
        match choice {
            DampingChoice::Constant(damping) => ContactDamping::Constant(*damping),
            DampingChoice::Viscoelastic(damping) => self.viscoelastic(damping.rate),
        }
    }

    /// Shows `visitor` the law itself, or the one that it stands for.
    #[inline(always)]
    fn resolve<V: LawVisitor>(&self, visitor: V) -> V::Output {
        visitor.visit(self)
    }

    /// Coefficient c of a pair \[force / length^(α−1)\].
    fn coefficient(&self, first_radius: f64, second_radius: f64) -> f64;

    /// Relative growth of the coefficient with the first radius, ∂ ln c/∂R_i \[1 / length\]: what a disk that grows at a
    /// fixed overlap adds to its contact forces.
    fn coefficient_growth(&self, first_radius: f64, second_radius: f64) -> f64;

    /// Repulsive force F(δ) for an overlap δ ≥ 0 \[force\]. A NaN stays one.
    fn force(&self, coefficient: f64, overlap: f64) -> f64;

    /// [`force`](Self::force) of two vectors of pairs, one pair a lane, with the same bits \[force\]; one after the other, where a law
    /// has nothing faster.
    #[inline(always)]
    fn forces<S: Simd>(&self, _simd: S, coefficients: [S::f64s; 2], overlaps: [S::f64s; 2]) -> [S::f64s; 2] {
        let mut forces = overlaps;
        let each: &[f64] = cast_slice(&coefficients);
        for (force, &coefficient) in cast_slice_mut(&mut forces).iter_mut().zip(each) {
            *force = self.force(coefficient, *force);
        }
        forces
    }

    /// c δ^(α−1) of a vector of pairs in single precision, in whatever units c and δ have: what it costs decides how long a relaxation
    /// takes while disks are far from rest.
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

    /// Stiffness F'(δ) from the force at that overlap, 0 where there is none \[force / length\].
    #[inline(always)]
    fn stiffness(&self, force: f64, overlap: f64) -> f64 {
        if overlap > 0.0 { (self.exponent() - 1.0) * force / overlap } else { 0.0 }
    }

    /// Whether all pairs have one coefficient, whatever their radii: the loop then reads one a block.
    const ONE_COEFFICIENT: bool = false;

    /// Γ of an energy −Γu²/2 of the displacement u of every disk from its site, 0 without it, see [`OnSite`](crate::law::on_site::OnSite)
    /// \[force / length\].
    fn on_site_coupling(&self) -> f64 {
        0.0
    }

    /// Whether disks have sites: Γ is not 0.
    fn has_sites(&self) -> bool {
        self.on_site_coupling() != 0.0
    }

    /// The force of a disk pressed against its like by its own radius: the scale on which a force counts as none \[force\].
    fn force_scale(&self, radius: f64) -> f64 {
        self.force(self.coefficient(radius, radius), radius)
    }
}

/// What is done with a law whose type is known.
pub trait LawVisitor {
    /// What comes of it.
    type Output;

    /// Does it.
    fn visit<L: PairLaw>(self, law: &L) -> Self::Output;
}
