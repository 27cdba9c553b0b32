//! [`Motion`]: disks in damped motion, moved by velocity Verlet.
//!
//! ```text
//! v_{n+1/2} = v_n + (h/2) a_n        u_{n+1} = u_n + h v_{n+1/2}
//! a_{n+1} = F(u_{n+1}) − Γ(u_{n+1}) (v_n + h a_n)        v_{n+1} = v_{n+1/2} + (h/2) a_{n+1}      (masses 1)
//! ```
//!
//! The velocity in the damping force is predicted for the end of the step. So the scheme is of second order with one
//! force evaluation per step, also for velocity-dependent forces. With the usual v_{n+1/2} in the damping force it
//! would be of first order.
//!
//! A mode of stiffness λ_K and damping λ_Γ is stable for `h λ_Γ + h² λ_K / 4 < 1`. Beyond this limit, the scheme
//! multiplies it by less than −1 in each step. [`Motion::stable_step`] uses the largest eigenvalues of both matrices,
//! bounded by Gershgorin's theorem.
//!
//! # Source
//! Groot, Warren (1997), J. Chem. Phys. 107, 4423 (the predicted velocity). The bound: the roots of the scheme's
//! characteristic polynomial for one mode; asserted in the book.

use crate::forces::assembly::Assembly;
use crate::forces::damped::{add_damping, damped_forces};
use crate::law::damping::ContactDamping;
use crate::law::pair_law::PairLaw;
use crate::neighbours::for_each_pair::{MovedPair, for_each_pair};
use crate::packing::{Packing, PackingError};
use crate::relax::column_operations::products;
use crate::vector::{Vector, difference, dot, larger};

/// A packing in motion: disks of mass 1 under elastic and damping forces.
#[derive(Debug, Clone)]
pub struct Motion<const D: usize> {
    /// Positions and elastic forces. The forces are those of the last evaluation; a step evaluates none.
    pub assembly: Assembly<D>,
    /// Velocities in working order; those of held disks stay 0 \[length / time\].
    pub velocities: Vec<Vector<D>>,
    pub(super) accelerations: Vec<Vector<D>>,
    predicted: Vec<Vector<D>>,
    damping: ContactDamping,
    damping_coefficient: Vec<f64>,
    /// Work of damping since the start \[energy\].
    pub dissipated: f64,
    /// Power of damping now \[energy / time\].
    dissipation: f64,
    /// The largest kinetic energy since the last call of `take_peak` \[energy\].
    peak: f64,
    row: Vec<f64>,
    before: Before<D>,
}

/// State that [`Motion::take_back`] restores, beside the positions.
#[derive(Debug, Clone, Default)]
struct Before<const D: usize> {
    velocities: Vec<Vector<D>>,
    accelerations: Vec<Vector<D>>,
    dissipated: f64,
    dissipation: f64,
}

impl<const D: usize> Motion<D> {
    /// A packing at rest.
    ///
    /// # Errors
    /// As [`Assembly::new`].
    pub fn new(packing: &Packing<D>, law: &dyn PairLaw, damping: &ContactDamping) -> Result<Self, PackingError> {
        Ok(Self::of(Assembly::new(packing, law)?, damping))
    }

    /// An assembled packing, at rest.
    pub fn of(mut assembly: Assembly<D>, damping: &ContactDamping) -> Self {
        assembly.evaluate();
        let zero = vec![[0.0; D]; assembly.len()];
        let mut motion = Motion {
            velocities: zero.clone(),
            accelerations: assembly.forces.clone(),
            predicted: zero,
            damping: *damping,
            damping_coefficient: Vec::new(),
            dissipated: 0.0,
            dissipation: 0.0,
            peak: 0.0,
            row: Vec::new(),
            before: Before::default(),
            assembly,
        };
        motion.set_damping_coefficients();
        motion
    }

    /// An assembled packing with these velocities of its mobile disks, in working order.
    ///
    /// # Panics
    /// If the number of velocities differs from that of the mobile disks.
    pub fn moving(assembly: Assembly<D>, velocities: &[Vector<D>], damping: &ContactDamping) -> Self {
        let mut motion = Self::of(assembly, damping);
        motion.velocities[..motion.assembly.mobile_count()].copy_from_slice(velocities);
        motion.dissipation = add_damping(
            &motion.damping,
            motion.assembly.pairs(),
            &motion.damping_coefficient,
            &motion.assembly.displacements,
            &motion.velocities,
            &mut motion.accelerations,
        );
        motion
    }

    /// The largest kinetic energy since the last call \[energy\].
    pub(crate) fn take_peak(&mut self) -> f64 {
        std::mem::take(&mut self.peak)
    }

    /// Stores the present state, for [`Motion::take_back`].
    pub(super) fn remember(&mut self) {
        self.assembly.set_checkpoint();
        self.before.velocities.clone_from(&self.velocities);
        self.before.accelerations.clone_from(&self.accelerations);
        (self.before.dissipated, self.before.dissipation) = (self.dissipated, self.dissipation);
    }

    /// Restores the stored state.
    pub(super) fn take_back(&mut self) -> Result<(), PackingError> {
        self.assembly.restore()?;
        self.set_damping_coefficients();
        self.velocities.clone_from(&self.before.velocities);
        self.accelerations.clone_from(&self.before.accelerations);
        (self.dissipated, self.dissipation) = (self.before.dissipated, self.before.dissipation);
        Ok(())
    }

    /// One step of the scheme of this module.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn step(&mut self, time_step: f64) -> Result<(), PackingError> {
        let mobile = self.assembly.mobile_count();
        let half = 0.5 * time_step;
        let (a, v) = (self.accelerations[..mobile].as_flattened(), self.velocities[..mobile].as_flattened_mut());
        let predicted = self.predicted[..mobile].as_flattened_mut();
        let u = self.assembly.displacements[..mobile].as_flattened_mut();
        let mut speed_squared = 0.0;
        for (((a, v), predicted), u) in a.iter().zip(v).zip(predicted).zip(u) {
            *predicted = *v + time_step * a;
            *v += half * a;
            *u += time_step * *v;
            speed_squared += *v * *v;
        }
        self.peak = larger(0.5 * speed_squared, self.peak);
        if self.assembly.update_list(time_step * speed_squared.sqrt())? {
            self.set_damping_coefficients();
        }
        let dissipation = self.accelerate();
        self.dissipated += half * (self.dissipation + dissipation);
        self.dissipation = dissipation;
        let (a, v) = (self.accelerations[..mobile].as_flattened(), self.velocities[..mobile].as_flattened_mut());
        for (a, v) in a.iter().zip(v) {
            *v += half * a;
        }
        Ok(())
    }

    /// Computes the net forces, with damping by the predicted velocities. Returns the power of damping.
    fn accelerate(&mut self) -> f64 {
        let Motion { assembly, damping, damping_coefficient, predicted, accelerations, .. } = self;
        if assembly.has_on_site_forces() {
            // Contacts, sites and loads first, then damping.
            assembly.evaluate();
            accelerations.copy_from_slice(&assembly.forces);
            return add_damping(
                damping,
                assembly.pairs(),
                damping_coefficient,
                &assembly.displacements,
                predicted,
                accelerations,
            );
        }
        let laws = (assembly.law(), &*damping);
        damped_forces(laws, assembly.pairs(), damping_coefficient, &assembly.displacements, predicted, accelerations)
    }

    /// Net forces, damping included, after the last step \[force\].
    pub fn total_forces(&self) -> &[Vector<D>] {
        &self.accelerations
    }

    /// Σ v²/2 \[energy\].
    pub fn kinetic_energy(&self) -> f64 {
        let v = self.velocities.as_flattened();
        0.5 * products(v, v).speed_squared
    }

    /// The longest step within the bound `h λ_Γ + h² λ_K / 4 = 1`, with both λ by Gershgorin's theorem \[time\].
    pub fn stable_step(&mut self) -> f64 {
        let stiffness = self.assembly.stiffness_bound(&mut self.row);
        let (law, coefficient) = (&self.damping, &self.damping_coefficient);
        let damping =
            self.assembly.row_bound(&mut self.row, Some(&|pair, overlap, _| law.damping(coefficient[pair], overlap)));
        if stiffness == 0.0 {
            // Without contacts: the stiffness of a contact with an overlap of 0.1 % of a radius.
            let (law, radius) = (self.assembly.law(), self.assembly.radii()[0]);
            let overlap = 1e-3 * radius;
            let bound = 2.0 * law.stiffness(law.force(law.coefficient(radius, radius), overlap), overlap);
            return 2.0 / bound.sqrt();
        }
        longest_stable(stiffness, damping)
    }

    /// The longest step within the bound for the largest overlaps that contacts can reach within this time, for the
    /// present velocities and forces \[time\].
    pub(crate) fn stable_step_within(&mut self, time: f64) -> f64 {
        let Motion { assembly, velocities, accelerations, damping, damping_coefficient, row, .. } = self;
        let (law, mobile) = (assembly.law(), assembly.mobile_count());
        // Stiffness of each disk, then damping of each disk.
        row.clear();
        row.resize(2 * assembly.len(), 0.0);
        let (stiffness, resistance) = row.split_at_mut(assembly.len());
        for_each_pair(
            assembly.pairs(),
            &assembly.displacements,
            &mut |&MovedPair { pair, ends, separation, distance, overlap, coefficient }| {
                let (i, j) = (ends.0 as usize, ends.1 as usize);
                let closing = |of: &[Vector<D>]| {
                    let other = if j < mobile { of[j] } else { [0.0; D] };
                    (-dot(difference(of[i], other), separation) / distance).max(0.0)
                };
                let ahead = overlap + time * (closing(velocities) + 0.5 * time * closing(accelerations));
                if ahead > 0.0 {
                    let sides = if j < mobile { 2.0 } else { 1.0 };
                    let (k, c) = (
                        sides * law.stiffness(law.force(coefficient, ahead), ahead),
                        sides * damping.damping(damping_coefficient[pair], ahead),
                    );
                    (stiffness[i], resistance[i]) = (stiffness[i] + k, resistance[i] + c);
                    (stiffness[j], resistance[j]) = (stiffness[j] + k, resistance[j] + c);
                }
            },
        );
        let most = |rows: &[f64]| rows[..mobile].iter().fold(0.0, |most, &row| larger(row, most));
        let sites = law.on_site_coupling().abs();
        let (stiffness, resistance) = (most(stiffness) + sites, most(resistance));
        if stiffness == 0.0 { self.stable_step() } else { longest_stable(stiffness, resistance) }
    }

    pub(super) fn set_damping_coefficients(&mut self) {
        let (pairs, radii) = (self.assembly.pairs(), self.assembly.radii());
        let of_pair = |(&i, &j): (&u32, &u32)| self.damping.coefficient(radii[i as usize], radii[j as usize]);
        self.damping_coefficient = pairs.first.iter().zip(&pairs.second).map(of_pair).collect();
    }
}

/// The step at which `h λ_Γ + h² λ_K / 4 = 1` \[time\].
fn longest_stable(stiffness: f64, damping: f64) -> f64 {
    2.0 * ((damping * damping + stiffness).sqrt() - damping) / stiffness
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::damping::{ConstantDamping, ContactDamping};
    use crate::law::power_laws::Hookean;
    use crate::packing::Domain;

    /// Two overlapping Hookean disks with damping. The overlap is a damped oscillator, δ'' = −2 k δ − 2 γ δ'. So
    /// δ(t) = δ₀ e^(−γt) (cos ωt + (γ/ω) sin ωt) with ω² = 2k − γ².
    fn overlap_error(step_count: usize) -> f64 {
        let (stiffness, rate, first, time) = (2e5, 100.0, 0.01, 1e-3);
        let packing =
            Packing::new(Domain::<2>::Open, vec![[0.0, 0.0], [1.2 - first, 0.0]], vec![0.5, 0.7]).expect("valid");
        let mut motion =
            Motion::new(&packing, &Hookean { stiffness }, &ContactDamping::Constant(ConstantDamping { rate }))
                .expect("two disks apart");
        for _ in 0..step_count {
            motion.step(time / step_count as f64).expect("no coincidence");
        }
        let omega = (2.0 * stiffness - rate * rate).sqrt();
        let exact = first * (-rate * time).exp() * ((omega * time).cos() + rate / omega * (omega * time).sin());
        let placed = motion.assembly.placed(packing);
        let overlap = 1.2 - crate::vector::norm(placed.separation(0, 1));
        (overlap - exact).abs()
    }

    #[test]
    fn a_hookean_pair_is_a_damped_oscillator_to_second_order() {
        // Halving the step divides the error by 4. The remainder is of relative order h ω = 0.02 at 32 steps.
        let errors = [overlap_error(32), overlap_error(64), overlap_error(128)];
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((order - 2.0).abs() < 0.05, "order {order}, errors {errors:?}");
        }
    }
}
