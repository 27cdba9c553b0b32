//! [`ImplicitMotion`]: disks in damped motion, integrated with long steps of a linearly implicit method.
//!
//! ```text
//! u̇ = v        m v̇ = F(u) − ζ v − Σ c_ij (n·v_ij) n        Ẇ = ζ v² + Σ c_ij (n·v_ij)²
//! (m/(hg)² + (ζ + C)/(hg) + K) U_i = r_v + (m/(hg) + ζ + C) r_u        r_u, r_v the right sides of the stage
//! ```
//!
//! C is the matrix of the contact damping, K the [`Hessian`](crate::linear::hessian::Hessian). Damped dynamics has m =
//! 1, ζ = 0. Gradient flow has m = 0, C = 0, and no velocities. The matrix is symmetric, and one factorisation serves
//! all stages. It neglects the derivatives of C with respect to u, and contains contacts that may close during the
//! step. Neither changes the order, see [`super::tableau`]. The matrix is positive definite except for the prestress in
//! K, which is omitted where necessary.

use crate::forces::assembly::Assembly;
use crate::forces::damped::add_damping;
use crate::forces::totals::Totals;
use crate::law::damping::ContactDamping;
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::column_operations::products;
use crate::relax::dynamics::implicit::inertia::{Inertia, Work};
use crate::relax::dynamics::implicit::multirate::shells::Shells;
use crate::relax::dynamics::implicit::rkc::stages::Stages;
use crate::relax::dynamics::implicit::step_matrix::StepMatrix;
use crate::relax::dynamics::implicit::tableau::{ROS34PW2, STAGE_COUNT};
use crate::vector::{Vector, dot};

/// One stage: U of positions, of velocities and of the work of damping.
#[derive(Debug, Clone, Default)]
pub(super) struct Stage<const D: usize> {
    pub(super) moved: Vec<Vector<D>>,
    pub(super) kick: Vec<Vector<D>>,
    pub(super) work: f64,
}

/// A packing in motion under elastic and damping forces.
pub struct ImplicitMotion<const D: usize> {
    /// Positions and elastic forces.
    pub assembly: Assembly<D>,
    /// Velocities of the mobile disks in working order; 0 for gradient flow \[length / time\].
    pub velocities: Vec<Vector<D>>,
    /// Work of damping and friction since the start \[energy\].
    pub dissipated: f64,
    /// Time since the start \[time\].
    pub time: f64,
    /// Cost so far.
    pub work: Work,
    /// Distance by which disks are assumed closer in the matrix than at the start of the step \[length\]. The matrix
    /// then contains contacts that close during the step; without them a step may be unstable.
    pub margin: f64,
    /// Marks of disks in working order. The matrix contains the prestress of contacts between two marked disks.
    /// Initially all are marked.
    pub prestressed: Vec<bool>,
    pub(super) inertia: Inertia,
    pub(super) damping: ContactDamping,
    pub(super) damping_coefficient: Vec<f64>,
    /// Elastic and damping forces at the present positions and velocities.
    pub(super) net_forces: Vec<Vector<D>>,
    pub(super) dissipation: f64,
    /// Set by the first step.
    pub(super) matrix: Option<StepMatrix<D>>,
    /// Displacements since the start of the step.
    pub(super) moved: Vec<Vector<D>>,
    pub(super) taken_back: bool,
    pub(super) stages: [Stage<D>; STAGE_COUNT],
    pub(super) rkc_stages: Stages<D>,
    pub(super) shells: Shells<D>,
    pub(super) before: Before<D>,
    /// Velocities of all disks, and all forces including damping.
    pub(super) all_velocities: Vec<Vector<D>>,
    pub(super) all_forces: Vec<Vector<D>>,
    pub(super) carried: Vec<Vector<D>>,
    pub(super) right_side: Vec<f64>,
    pub(super) unknowns: Vec<f64>,
    pub(super) row: Vec<f64>,
    pub(super) smallest_radius: f64,
}

/// A motion at the start of a phase.
pub(crate) struct Snapshot<const D: usize> {
    assembly: Assembly<D>,
    velocities: Vec<Vector<D>>,
    dissipated: f64,
    time: f64,
}

/// State that a rejected step has to restore.
#[derive(Debug, Clone, Default)]
pub(super) struct Before<const D: usize> {
    pub(super) velocities: Vec<Vector<D>>,
    pub(super) net_forces: Vec<Vector<D>>,
    pub(super) forces: Vec<Vector<D>>,
    pub(super) dissipated: f64,
    pub(super) dissipation: f64,
    pub(super) time: f64,
}

impl<const D: usize> ImplicitMotion<D> {
    /// A packing at rest. A `damping` without rate belongs to gradient flow.
    ///
    /// # Errors
    /// As [`Assembly::new`].
    pub fn new(
        packing: &Packing<D>,
        law: &dyn PairLaw,
        damping: &ContactDamping,
        inertia: Inertia,
    ) -> Result<Self, PackingError> {
        let assembly = Assembly::new(packing, law)?;
        let mobile = assembly.mobile_count();
        let zero = vec![[0.0; D]; mobile];
        let mut motion = ImplicitMotion {
            velocities: zero.clone(),
            dissipated: 0.0,
            time: 0.0,
            work: Work::default(),
            margin: 0.0,
            prestressed: vec![true; assembly.len()],
            inertia,
            damping: *damping,
            damping_coefficient: Vec::new(),
            net_forces: zero.clone(),
            dissipation: 0.0,
            matrix: None,
            moved: vec![[f64::INFINITY; D]; mobile],
            taken_back: false,
            stages: std::array::from_fn(|_| Stage { moved: zero.clone(), kick: zero.clone(), work: 0.0 }),
            rkc_stages: Stages::default(),
            shells: Shells::default(),
            before: Before::default(),
            all_velocities: vec![[0.0; D]; assembly.len()],
            all_forces: Vec::new(),
            carried: vec![[0.0; D]; assembly.len()],
            right_side: Vec::new(),
            unknowns: Vec::new(),
            row: Vec::new(),
            smallest_radius: assembly.radii().iter().copied().fold(f64::INFINITY, f64::min),
            assembly,
        };
        motion.set_damping_coefficients();
        let _ = motion.evaluate();
        Ok(motion)
    }

    /// Evaluates the forces and the power of damping at the present positions and velocities.
    pub fn evaluate(&mut self) -> Totals<D> {
        let totals = self.assembly.evaluate_totals();
        self.add_damping_forces();
        totals
    }

    /// Time in which this force moves a disk at rest by this distance \[time\].
    pub(crate) fn time_to_move(&self, distance: f64, force: f64) -> f64 {
        match self.inertia {
            Inertia::Massive => (2.0 * distance / force).sqrt(),
            Inertia::Friction(friction) => distance * friction / force,
        }
    }

    /// Whether the disks have masses.
    pub(crate) fn has_masses(&self) -> bool {
        self.inertia == Inertia::Massive
    }

    /// Restores the state at the start of the last step.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn take_back(&mut self) -> Result<(), PackingError> {
        self.taken_back = true;
        self.assembly.restore()?;
        self.velocities.clone_from(&self.before.velocities);
        self.net_forces.clone_from(&self.before.net_forces);
        self.assembly.forces.clone_from(&self.before.forces);
        (self.dissipated, self.dissipation, self.time) =
            (self.before.dissipated, self.before.dissipation, self.before.time);
        self.set_damping_coefficients();
        Ok(())
    }

    /// Forces on the mobile disks, damping included \[force\].
    pub fn net_forces(&self) -> &[Vector<D>] {
        &self.net_forces
    }

    /// Σ v²/2, 0 without masses \[energy\].
    pub fn kinetic_energy(&self) -> f64 {
        let v = self.velocities.as_flattened();
        0.5 * products(v, v).speed_squared
    }

    /// Σ v²/2 over these disks, in working order \[energy\].
    pub(crate) fn kinetic_energy_of(&self, members: &[bool]) -> f64 {
        let of_members = self.velocities.iter().zip(members).filter(|&(_, &member)| member);
        0.5 * of_members.map(|(&v, _)| dot(v, v)).sum::<f64>()
    }

    /// Moves the anchors to the present positions.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn reanchor(&mut self) -> Result<(), PackingError> {
        self.assembly.reanchor()?;
        self.set_damping_coefficients();
        let _ = self.evaluate();
        Ok(())
    }

    /// The step at which (hg)² λ or hg λ/ζ equals `limit`, where λ bounds the contact stiffness \[time\]. Infinite
    /// without contacts.
    pub fn longest_step(&mut self, limit: f64) -> f64 {
        let stiffness = self.assembly.stiffness_bound(&mut self.row);
        let ratio = limit / stiffness;
        match self.inertia {
            Inertia::Massive => ratio.sqrt() / ROS34PW2.diagonal,
            Inertia::Friction(friction) => ratio * friction / ROS34PW2.diagonal,
        }
    }

    /// Evaluates the forces after the assembly was replaced by another one of the same packing.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(crate) fn put_back(&mut self) -> Result<(), PackingError> {
        self.set_damping_coefficients();
        let _ = self.evaluate();
        Ok(())
    }

    /// A copy of everything that a phase changes.
    pub(crate) fn snapshot(&self) -> Snapshot<D> {
        Snapshot {
            assembly: self.assembly.clone(),
            velocities: self.velocities.clone(),
            dissipated: self.dissipated,
            time: self.time,
        }
    }

    /// Restores a snapshot.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(crate) fn return_to(&mut self, snapshot: Snapshot<D>) -> Result<(), PackingError> {
        let Snapshot { assembly, velocities, dissipated, time } = snapshot;
        (self.assembly, self.velocities, self.dissipated, self.time) = (assembly, velocities, dissipated, time);
        self.taken_back = true;
        self.put_back()
    }

    /// Stores the present state, for [`ImplicitMotion::take_back`].
    pub(super) fn remember(&mut self) {
        self.assembly.set_checkpoint();
        self.before.velocities.clone_from(&self.velocities);
        self.before.net_forces.clone_from(&self.net_forces);
        self.before.forces.clone_from(&self.assembly.forces);
        (self.before.dissipated, self.before.dissipation, self.before.time) =
            (self.dissipated, self.dissipation, self.time);
    }

    /// Adds the damping forces to the elastic ones just evaluated.
    fn add_damping_forces(&mut self) {
        self.work.evaluation_count += 1;
        let mobile = self.assembly.mobile_count();
        match self.inertia {
            Inertia::Massive => {
                self.all_velocities[..mobile].copy_from_slice(&self.velocities);
                self.all_forces.clone_from(&self.assembly.forces);
                self.dissipation = add_damping(
                    &self.damping,
                    self.assembly.pairs(),
                    &self.damping_coefficient,
                    &self.assembly.displacements,
                    &self.all_velocities,
                    &mut self.all_forces,
                );
                self.net_forces.copy_from_slice(&self.all_forces[..mobile]);
            }
            Inertia::Friction(friction) => {
                self.net_forces.copy_from_slice(&self.assembly.forces[..mobile]);
                // u̇ = F/ζ.
                let f = self.net_forces.as_flattened();
                self.dissipation = products(f, f).force_squared / friction;
            }
        }
    }

    pub(super) fn set_damping_coefficients(&mut self) {
        let (pairs, radii) = (self.assembly.pairs(), self.assembly.radii());
        let of_pair = |(&i, &j): (&u32, &u32)| self.damping.coefficient(radii[i as usize], radii[j as usize]);
        self.damping_coefficient.clear();
        self.damping_coefficient.extend(pairs.first.iter().zip(&pairs.second).map(of_pair));
    }
}
