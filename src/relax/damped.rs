//! Explicit damped dynamics: Newton's equations with contact damping, until everything is at rest.
//!
//! ```text
//! v_{n+1/2} = v_n + (h/2) a_n        u_{n+1} = u_n + h v_{n+1/2}
//! a_{n+1} = F(u_{n+1}) − Γ(u_{n+1}) (v_n + h a_n)        v_{n+1} = v_{n+1/2} + (h/2) a_{n+1}      (masses 1)
//! ```
//!
//! Velocity Verlet with the velocity of the damping force predicted to the end of the step: second order with one
//! evaluation of the forces a step, also where forces depend on velocities (with v_{n+1/2} in the damping force, as is
//! usual, it would be first order).
//!
//! A mode of stiffness λ_K and damping λ_Γ is stable for `h λ_Γ + h² λ_K / 4 < 1` (beyond, the scheme multiplies it by less
//! than −1 each step). The step is bound by that with the largest eigenvalues of the two matrices, both bound in their turn
//! by Gershgorin's rows. A motion that gains energy all the same, as with a fixed step too long, ends as
//! [`Stop::Unstable`].
//!
//! # Source
//! Groot, Warren (1997), J. Chem. Phys. 107, 4423 (the predicted velocity). The bound: the roots of the scheme's
//! characteristic polynomial for one mode; asserted in the book.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::forces::assembly::Assembly;
use crate::forces::damped::{add_damping, damped_forces};
use crate::law::damping::{DampingChoice, DampingLaw};
use crate::law::pair_law::PairLaw;
use crate::neighbours::for_each_pair::{Walked, walk};
use crate::packing::{Packing, PackingError};
use crate::relax::energy_balance::{Energies, EnergyBalance};
use crate::relax::explicit_step::ExplicitStep;
use crate::relax::flat::products;
use crate::relax::monitor::{LOOK_EVERY, Monitor};
use crate::relax::{Cost, ForceLimit, Look, Outcome, Relaxer, Stop, Trace};
use crate::vector::{Vector, difference, dot, larger};

/// Explicit damped dynamics.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DampedDynamics {
    /// How contacts dissipate. Changes results.
    pub damping: DampingChoice,
    /// When the packing counts as at rest. Changes results.
    pub limit: ForceLimit,
    /// Which net force the limit is on. Changes results.
    pub net_force: NetForce,
    /// The time step.
    pub time_step: TimeStep,
    /// Steps allowed.
    pub step_limit: usize,
}

impl Default for DampedDynamics {
    fn default() -> Self {
        DampedDynamics {
            damping: DampingChoice::default(),
            limit: ForceLimit::default(),
            net_force: NetForce::default(),
            time_step: TimeStep::default(),
            // 10⁴ steps at p > 500, 10⁶ near jamming (design §7).
            step_limit: 20_000_000,
        }
    }
}

/// The net force of damped dynamics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NetForce {
    /// Elastic forces only: the state is at rest in the energy landscape.
    #[default]
    Elastic,
    /// Elastic and damping forces: also met by a slow creep, in which the two cancel.
    Total,
}

/// The time step of damped dynamics.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeStep {
    /// Always this \[time\].
    Fixed(f64),
    /// This share of the bound on a stable step, followed as contacts change \[1\].
    OfStability(f64),
}

impl Default for TimeStep {
    /// 0.9 of the bound: at the bound itself a mode whose row is tight would oscillate for ever. Gershgorin's rows are about twice the eigenvalue of a packing's damping matrix (12 to 14
    /// against 5.5 to 5.8 at unit damping), so this is about half of the longest stable step.
    fn default() -> Self {
        TimeStep::OfStability(0.9)
    }
}

/// Share of the bound below which steps that gain energy are not shortened any more.
const SMALLEST_SHARE: f64 = 1e-3;

/// Ratio of a step to one that gained energy.
const SHORTER: f64 = 0.5;

/// Growth of the share after steps that gained none.
const SHARE_GROWTH: f64 = 1.2;

impl Relaxer for DampedDynamics {
    fn relax<const D: usize, L: PairLaw>(
        &self,
        packing: Packing<D>,
        law: &L,
        trace: &mut impl Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        self.relax_with(packing, law, &law.contact_damping(&self.damping), trace)
    }

    fn passing(&self, limit: f64) -> Option<Self> {
        self.limit.loosened(limit).map(|limit| DampedDynamics { limit, ..*self })
    }
}

impl DampedDynamics {
    fn relax_with<const D: usize, L: PairLaw, C: DampingLaw>(
        &self,
        packing: Packing<D>,
        law: &L,
        damping: &C,
        trace: &mut impl Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let start = Instant::now();
        let mut motion = Motion::new(&packing, law, damping)?;
        let mut monitor = Monitor::new(self.limit, &motion.assembly);
        let (mut time_step, mut step_count) = (0.0, 0);
        let (fixed, mut control) = match self.time_step {
            TimeStep::Fixed(step) => (step, None),
            TimeStep::OfStability(share) => (0.0, Some(ExplicitStep::new(share))),
        };
        // The one that made the motion.
        let mut evaluation_count = 1;
        let mut balance: Option<EnergyBalance> = None;
        let mut rejected_count = 0;
        let mobile = motion.assembly.mobile_count();
        let stop = loop {
            if step_count % LOOK_EVERY == 0 {
                let totals = motion.assembly.evaluate_totals();
                evaluation_count += 1;
                let kinetic_energy = motion.kinetic_energy();
                let look = Look {
                    step_count,
                    energy: totals.energy,
                    kinetic_energy,
                    residual: 0.0,
                    time_step,
                    restart: false,
                };
                let energies = Energies::new(&totals, kinetic_energy, motion.dissipated).with_peak(motion.take_peak());
                let balance = balance.get_or_insert(EnergyBalance::new(energies));
                if balance.accept(energies) {
                    motion.remember();
                    if let (Some(control), TimeStep::OfStability(share)) = (&mut control, self.time_step) {
                        control.lengthen(SHARE_GROWTH, share);
                    }
                } else if let Some(control) = control.as_mut().filter(|control| control.share() > SMALLEST_SHARE)
                    && step_count < self.step_limit
                {
                    control.shorten(SHORTER);
                    motion.take_back()?;
                    rejected_count += LOOK_EVERY;
                    continue;
                } else {
                    break if totals.energy.is_finite() { Stop::Unstable } else { Stop::NonFinite };
                }
                let net_forces = match self.net_force {
                    NetForce::Elastic => &motion.assembly.forces[..mobile],
                    NetForce::Total => &motion.accelerations[..mobile],
                };
                if let Some(stop) = monitor.look(&motion.assembly, net_forces, &totals, look, trace) {
                    break stop;
                }
                if monitor.takes_new_anchors() {
                    motion.assembly.reanchor()?;
                    motion.set_damping_coefficients();
                }
            }
            if step_count >= self.step_limit {
                break Stop::StepLimit;
            }
            time_step = match &mut control {
                None => fixed,
                Some(control) => control.next(&mut motion),
            };
            let list_count = motion.assembly.rebuild_count();
            motion.step(time_step)?;
            step_count += 1;
            evaluation_count += 1;
            if motion.assembly.rebuild_count() > list_count && monitor.ran_away(&motion.assembly) {
                break Stop::NoMinimum;
            }
        };
        if matches!(stop, Stop::StepLimit | Stop::NoMinimum) {
            // No look came before: the elastic forces are of an earlier step.
            motion.assembly.evaluate();
            evaluation_count += 1;
        }
        let net_forces = match self.net_force {
            NetForce::Elastic => &motion.assembly.forces[..mobile],
            NetForce::Total => &motion.accelerations[..mobile],
        };
        let monitor_energies = monitor.energies();
        let (residual, rounding_floor) = monitor.finish(&motion.assembly, net_forces);
        let cost = Cost {
            step_count,
            rejected_count,
            energies: monitor_energies.zip(balance).map(|(energies, balance)| balance.account(energies.after)),
            force_evaluation_count: evaluation_count,
            rebuild_count: motion.assembly.rebuild_count(),
            seconds: start.elapsed().as_secs_f64(),
            ..Cost::default()
        };
        Ok(Outcome { state: motion.assembly.placed(packing), stop, residual, rounding_floor, cost })
    }
}

/// A packing in motion: disks of mass 1 under elastic and damping forces.
#[derive(Debug, Clone)]
pub struct Motion<const D: usize, L, C> {
    /// Where the disks are; the elastic forces are those of its last evaluation, which a step is not.
    pub assembly: Assembly<D, L>,
    /// Velocities in working order; those of held disks stay 0 \[length / time\].
    pub velocities: Vec<Vector<D>>,
    accelerations: Vec<Vector<D>>,
    predicted: Vec<Vector<D>>,
    damping: C,
    damping_coefficient: Vec<f64>,
    /// Work of damping since the start \[energy\].
    pub dissipated: f64,
    /// What is lost to damping now \[energy / time\].
    dissipation: f64,
    /// The largest kinetic energy since it was last asked for \[energy\].
    peak: f64,
    row: Vec<f64>,
    before: Before<D>,
}

/// What [`Motion::take_back`] goes back to, beside the places of the disks.
#[derive(Debug, Clone, Default)]
struct Before<const D: usize> {
    velocities: Vec<Vector<D>>,
    accelerations: Vec<Vector<D>>,
    dissipated: f64,
    dissipation: f64,
}

impl<const D: usize, L: PairLaw, C: DampingLaw> Motion<D, L, C> {
    /// A packing at rest.
    ///
    /// # Errors
    /// As [`Assembly::new`].
    pub fn new(packing: &Packing<D>, law: &L, damping: &C) -> Result<Self, PackingError> {
        Ok(Self::of(Assembly::new(packing, *law)?, damping))
    }

    /// A packing laid out already, at rest.
    pub fn of(mut assembly: Assembly<D, L>, damping: &C) -> Self {
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

    /// A packing laid out already, whose mobile disks have these velocities, in working order.
    ///
    /// # Panics
    /// If there is not one velocity a mobile disk.
    pub fn moving(assembly: Assembly<D, L>, velocities: &[Vector<D>], damping: &C) -> Self {
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
    pub(super) fn take_peak(&mut self) -> f64 {
        std::mem::take(&mut self.peak)
    }

    /// Remembers where everything is, for [`Motion::take_back`].
    fn remember(&mut self) {
        self.assembly.set_checkpoint();
        self.before.velocities.clone_from(&self.velocities);
        self.before.accelerations.clone_from(&self.accelerations);
        (self.before.dissipated, self.before.dissipation) = (self.dissipated, self.dissipation);
    }

    /// Goes back to what was last remembered.
    fn take_back(&mut self) -> Result<(), PackingError> {
        self.assembly.restore()?;
        self.set_damping_coefficients();
        self.velocities.clone_from(&self.before.velocities);
        self.accelerations.clone_from(&self.before.accelerations);
        (self.dissipated, self.dissipation) = (self.before.dissipated, self.before.dissipation);
        Ok(())
    }

    /// One step of the scheme above.
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
        if self.assembly.keep_listed(time_step * speed_squared.sqrt())? {
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

    /// Net forces where the disks are, of damping by the predicted velocities; what is lost to it is returned.
    fn accelerate(&mut self) -> f64 {
        let Motion { assembly, damping, damping_coefficient, predicted, accelerations, .. } = self;
        if assembly.law().has_sites() {
            // Contacts and sites, then damping.
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

    /// The longest step the bound allows: `h λ_Γ + h² λ_K / 4 = 1`, both λ by Gershgorin's rows \[time\].
    pub fn stable_step(&mut self) -> f64 {
        let stiffness = self.assembly.stiffness_bound(&mut self.row);
        let (law, coefficient) = (&self.damping, &self.damping_coefficient);
        let damping =
            self.assembly.row_bound(&mut self.row, Some(&|pair, overlap, _| law.damping(coefficient[pair], overlap)));
        if stiffness == 0.0 {
            // No contact: as if one were pressed by a thousandth of a radius.
            let (law, radius) = (self.assembly.law(), self.assembly.radii()[0]);
            let overlap = 1e-3 * radius;
            let bound = 2.0 * law.stiffness(law.force(law.coefficient(radius, radius), overlap), overlap);
            return 2.0 / bound.sqrt();
        }
        longest_stable(stiffness, damping)
    }

    /// The longest step the bound allows while contacts are pressed as far as they can be within this time, by velocities and forces as
    /// they are \[time\].
    pub(super) fn stable_step_within(&mut self, time: f64) -> f64 {
        let Motion { assembly, velocities, accelerations, damping, damping_coefficient, row, .. } = self;
        let (law, mobile) = (assembly.law(), assembly.mobile_count());
        // Stiffness, then damping, of each disk.
        row.clear();
        row.resize(2 * assembly.len(), 0.0);
        let (stiffness, resistance) = row.split_at_mut(assembly.len());
        walk(
            assembly.pairs(),
            &assembly.displacements,
            &mut |&Walked { pair, ends, apart, distance, overlap, coefficient }| {
                let (i, j) = (ends.0 as usize, ends.1 as usize);
                let closing = |of: &[Vector<D>]| {
                    let other = if j < mobile { of[j] } else { [0.0; D] };
                    (-dot(difference(of[i], other), apart) / distance).max(0.0)
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

    fn set_damping_coefficients(&mut self) {
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
    use crate::law::damping::ConstantDamping;
    use crate::law::power_laws::Hookean;
    use crate::packing::Domain;

    /// Two disks pressed together, Hookean with damping: the overlap is a damped oscillator,
    /// δ'' = −2 k δ − 2 γ δ', so δ(t) = δ₀ e^(−γt) (cos ωt + (γ/ω) sin ωt) with ω² = 2k − γ².
    fn overlap_error(step_count: usize) -> f64 {
        let (stiffness, rate, first, time) = (2e5, 100.0, 0.01, 1e-3);
        let packing =
            Packing::new(Domain::<2>::Open, vec![[0.0, 0.0], [1.2 - first, 0.0]], vec![0.5, 0.7]).expect("valid");
        let mut motion =
            Motion::new(&packing, &Hookean { stiffness }, &ConstantDamping { rate }).expect("two disks apart");
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
        // Halving the step divides the error by 4; what is left over is of relative order h ω = 0.02 at 32 steps.
        let errors = [overlap_error(32), overlap_error(64), overlap_error(128)];
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((order - 2.0).abs() < 0.05, "order {order}, errors {errors:?}");
        }
    }
}
