//! [`ImplicitMotion`]: disks in damped motion, moved by one long step of a linearly implicit method at a time.
//!
//! ```text
//! u̇ = v        m v̇ = F(u) − ζ v − Σ c_ij (n·v_ij) n        Ẇ = ζ v² + Σ c_ij (n·v_ij)²
//! (m/(hγ)² + (ζ + C)/(hγ) + K) U_i = r_v + (m/(hγ) + ζ + C) r_u        r_u, r_v the right sides of the stage
//! ```
//!
//! C is the matrix of the contact damping, K the [`Hessian`](crate::contact::Hessian); m = 1, ζ = 0 for damped dynamics, m = 0, C = 0 for gradient
//! flow, which then has no velocities. The matrix is symmetric, and one factorisation serves all stages. What it leaves out
//! (how C turns and grows with u) and what it holds beside (contacts that may close during the step) costs no order: see
//! [`super::tableau`]. It is positive definite but for the prestress in K, which is left out where it would not be.

use crate::contact::PairLaw;
use crate::contact::assembly::Assembly;
use crate::contact::damping::DampingLaw;
use crate::contact::forces::{Totals, add_damping};
use crate::linear::LinearError;
use crate::packing::{Packing, PackingError};
use crate::relax::damped::{BOUND_EVERY, Motion};
use crate::relax::flat::products;
use crate::relax::implicit::matrix::{Ready, StepMatrix, StepTerms};
use crate::relax::implicit::tableau::{ROS34PW2, STAGE_COUNT};
use crate::vector::{Vector, difference, dot, larger, scaled, sum};

/// What resists motion beside the contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Inertia {
    /// Masses 1, no friction: damped dynamics.
    Massive,
    /// No masses, friction ζ on every disk: gradient flow \[force / velocity\].
    Friction(f64),
}

impl Inertia {
    /// Mass and friction of a disk.
    pub(super) fn resistance(self) -> (f64, f64) {
        match self {
            Inertia::Massive => (1.0, 0.0),
            Inertia::Friction(friction) => (0.0, friction),
        }
    }
}

/// What a step came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stepped<const D: usize> {
    /// The disks are where the step ends.
    Moved(Totals<D>),
    /// The factors of its matrix do not fit in memory; nothing has moved.
    OutOfMemory,
    /// The matrix is not positive definite: the step is so long that it would pass over a motion that grows, away from a
    /// saddle; nothing has moved.
    Indefinite,
    /// A disk would go farther than the smallest radius: to be taken back.
    TooFar,
}

/// Work of a motion so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Evaluations of forces and damping.
    pub evaluation_count: usize,
    /// Sparse factorisations tried.
    pub factorisation_count: usize,
    /// Iterations of conjugate gradients.
    pub iteration_count: usize,
    /// Steps over whose start the set of contacts had changed since the start of the step before.
    pub contact_change_count: usize,
}

/// One stage: U of positions, of velocities and of the work of damping.
#[derive(Debug, Clone, Default)]
struct Stage<const D: usize> {
    way: Vec<Vector<D>>,
    kick: Vec<Vector<D>>,
    work: f64,
}

/// A packing in motion under elastic and damping forces.
pub struct ImplicitMotion<const D: usize, L, C> {
    /// Where the disks are, and the elastic forces.
    pub assembly: Assembly<D, L>,
    /// Velocities of the mobile disks in working order; 0 for gradient flow.
    pub velocities: Vec<Vector<D>>,
    /// Work of damping and friction since the start \[energy\].
    pub dissipated: f64,
    /// Time since the start.
    pub time: f64,
    /// Work so far.
    pub work: Work,
    /// How much nearer disks are taken to be in the matrix of a step than they are at its start \[length\]: contacts that
    /// close on the way are in it then, and no step is unstable for want of them.
    pub margin: f64,
    /// Whether the prestress of contacts between two such disks is in the matrix, one a disk in working order; all at first.
    pub prestressed: Vec<bool>,
    inertia: Inertia,
    damping: C,
    damping_coefficient: Vec<f64>,
    /// Elastic and damping forces at the present positions and velocities.
    net_forces: Vec<Vector<D>>,
    dissipation: f64,
    /// From the first step on.
    matrix: Option<StepMatrix<D>>,
    /// Where the disks are, less where they were at the start of the step.
    moved: Vec<Vector<D>>,
    taken_back: bool,
    stages: [Stage<D>; STAGE_COUNT],
    before: Before<D>,
    /// Velocities of all disks, and all forces with damping.
    all_velocities: Vec<Vector<D>>,
    all_forces: Vec<Vector<D>>,
    carried: Vec<Vector<D>>,
    right_side: Vec<f64>,
    unknowns: Vec<f64>,
    row: Vec<f64>,
    smallest_radius: f64,
}

/// What a step that is taken back has to put back.
#[derive(Debug, Clone, Default)]
struct Before<const D: usize> {
    velocities: Vec<Vector<D>>,
    net_forces: Vec<Vector<D>>,
    forces: Vec<Vector<D>>,
    dissipated: f64,
    dissipation: f64,
    time: f64,
}

impl<const D: usize, L: PairLaw, C: DampingLaw> ImplicitMotion<D, L, C> {
    /// A packing at rest. A `damping` without rate belongs to gradient flow.
    ///
    /// # Errors
    /// As [`Assembly::new`].
    pub fn new(packing: &Packing<D>, law: &L, damping: &C, inertia: Inertia) -> Result<Self, PackingError> {
        let assembly = Assembly::new(packing, *law)?;
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
            stages: std::array::from_fn(|_| Stage { way: zero.clone(), kick: zero.clone(), work: 0.0 }),
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

    /// Forces of the present positions and velocities, and what is lost to damping.
    pub fn evaluate(&mut self) -> Totals<D> {
        let totals = self.assembly.evaluate_totals();
        self.add_damping_forces();
        totals
    }

    /// One step of length h \[time\]; [`ImplicitMotion::take_back`] undoes it.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn step(&mut self, time_step: f64) -> Result<Stepped<D>, PackingError> {
        let mut matrix = self.matrix.take().unwrap_or_else(|| StepMatrix::of(&self.assembly));
        if !self.taken_back {
            matrix.set_ways(&self.moved);
        }
        self.taken_back = false;
        self.remember();
        let terms = StepTerms {
            scale: time_step * ROS34PW2.diagonal,
            inertia: self.inertia,
            damping: &self.damping,
            damping_coefficient: &self.damping_coefficient,
            margin: self.margin,
            prestressed: &self.prestressed,
        };
        let stepped = match matrix.set(&self.assembly, &terms, &mut self.work) {
            Ok(mut ready) => self.stages(time_step, &mut ready),
            Err(LinearError::OutOfMemory { .. }) => Ok(Stepped::OutOfMemory),
            Err(_) => Ok(Stepped::Indefinite),
        };
        self.matrix = Some(matrix);
        stepped
    }

    /// So many explicit steps of damped dynamics, each of this share of the bound on a stable one; the last one's length
    /// \[time\] beside the totals. `ahead` is the length of the step that is to follow, which looks out for contacts that far.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(super) fn go_explicitly(
        &mut self,
        count: usize,
        share: f64,
        ahead: f64,
    ) -> Result<(Totals<D>, f64), PackingError> {
        let mut motion = Motion::moving(self.assembly.clone(), &self.velocities, &self.damping);
        let mut time_step = 0.0;
        for step in 0..count {
            if step % BOUND_EVERY == 0 {
                time_step = share * motion.stable_step();
            }
            motion.step(time_step)?;
            self.time += time_step;
        }
        self.work.evaluation_count += count + 1;
        self.dissipated += motion.dissipated;
        self.velocities.copy_from_slice(&motion.velocities[..self.assembly.mobile_count()]);
        self.assembly = motion.assembly;
        self.taken_back = false;
        for (moved, &velocity) in self.moved.iter_mut().zip(&self.velocities) {
            *moved = scaled(ahead, velocity);
        }
        self.set_damping_coefficients();
        Ok((self.evaluate(), time_step))
    }

    /// The longest stable explicit step, as [`Motion::stable_step`].
    pub(super) fn stable_step(&mut self) -> f64 {
        self.work.evaluation_count += 1;
        Motion::of(self.assembly.clone(), &self.damping).stable_step()
    }

    /// The time in which this force moves a disk at rest by this way \[time\].
    pub(super) fn time_of_way(&self, way: f64, force: f64) -> f64 {
        match self.inertia {
            Inertia::Massive => (2.0 * way / force).sqrt(),
            Inertia::Friction(friction) => way * friction / force,
        }
    }

    /// Whether there are masses.
    pub(super) fn has_masses(&self) -> bool {
        self.inertia == Inertia::Massive
    }

    /// Puts everything back to where the last step began.
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

    /// Estimated error of the last step over what is allowed, for each mobile disk: that of the position, and that of the
    /// velocity times h γ.
    pub fn error(&self, time_step: f64, disk: usize) -> f64 {
        let scale = time_step * ROS34PW2.diagonal;
        let (mut way, mut kick) = ([0.0; D], [0.0; D]);
        for (stage, weight) in self.stages.iter().zip(ROS34PW2.error) {
            way = sum(way, scaled(weight, stage.way[disk]));
            kick = sum(kick, scaled(weight, stage.kick[disk]));
        }
        match self.inertia {
            Inertia::Massive => (dot(way, way) + scale * scale * dot(kick, kick)).sqrt(),
            Inertia::Friction(_) => dot(way, way).sqrt(),
        }
    }

    /// Forces with damping on the mobile disks \[force\].
    pub fn net_forces(&self) -> &[Vector<D>] {
        &self.net_forces
    }

    /// Σ v²/2, 0 without masses \[energy\].
    pub fn kinetic_energy(&self) -> f64 {
        let v = self.velocities.as_flattened();
        0.5 * products(v, v).speed_squared
    }

    /// Anchors take over the displacements.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn reanchor(&mut self) -> Result<(), PackingError> {
        self.assembly.reanchor()?;
        self.set_damping_coefficients();
        let _ = self.evaluate();
        Ok(())
    }

    /// The step at which (hγ)² λ or hγ λ/ζ is `limit`, λ a bound on the stiffness of contacts; infinite without one \[time\].
    pub fn longest_step(&mut self, limit: f64) -> f64 {
        let stiffness = self.assembly.stiffness_bound(&mut self.row);
        let ratio = limit / stiffness;
        match self.inertia {
            Inertia::Massive => ratio.sqrt() / ROS34PW2.diagonal,
            Inertia::Friction(friction) => ratio * friction / ROS34PW2.diagonal,
        }
    }

    /// Forces anew after the assembly was replaced by one of the same packing.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub(super) fn put_back(&mut self) -> Result<(), PackingError> {
        self.set_damping_coefficients();
        let _ = self.evaluate();
        Ok(())
    }

    fn remember(&mut self) {
        self.assembly.set_checkpoint();
        self.before.velocities.clone_from(&self.velocities);
        self.before.net_forces.clone_from(&self.net_forces);
        self.before.forces.clone_from(&self.assembly.forces);
        (self.before.dissipated, self.before.dissipation, self.before.time) =
            (self.dissipated, self.dissipation, self.time);
    }

    /// All stages; the disks are where the step ends afterwards.
    fn stages(&mut self, time_step: f64, ready: &mut Ready<'_, D>) -> Result<Stepped<D>, PackingError> {
        let scale = time_step * ROS34PW2.diagonal;
        let (mass, friction) = self.inertia.resistance();
        let mobile = self.assembly.mobile_count();
        let dimension = ready.hessian.matrix().dimension();
        self.right_side.resize(dimension, 0.0);
        self.unknowns.resize(dimension, 0.0);
        for index in 0..STAGE_COUNT {
            if index > 0 && self.go(&ROS34PW2.argument[index][..index])?.is_none() {
                return Ok(Stepped::TooFar);
            }
            let (done, rest) = self.stages.split_at_mut(index);
            let stage = &mut rest[0];
            let carried = ROS34PW2.carried[index];
            // r_u, kept in `carried`; r_v + (m/(hγ) + ζ) r_u, gathered in the stage.
            for disk in 0..mobile {
                let (mut way, mut kick) = (self.velocities[disk], self.net_forces[disk]);
                for (past, factor) in done.iter().zip(carried) {
                    way = sum(way, scaled(factor / time_step, past.way[disk]));
                    kick = sum(kick, scaled(factor / time_step, past.kick[disk]));
                }
                self.carried[disk] = way;
                stage.way[disk] = sum(kick, scaled(mass / scale + friction, way));
            }
            let kept: f64 = done.iter().zip(carried).map(|(past, factor)| factor * past.work).sum();
            stage.work = scale * (self.dissipation + kept / time_step);
            for link in ready.links {
                let (i, j) = (link.ends.0 as usize, link.ends.1 as usize);
                let along = dot(difference(self.carried[i], self.carried[j]), link.normal);
                let force = scaled(link.damping * along, link.normal);
                stage.way[i] = sum(stage.way[i], force);
                if j < mobile {
                    stage.way[j] = difference(stage.way[j], force);
                }
            }
            let alone = 1.0 / (mass / (scale * scale) + friction / scale);
            for disk in 0..mobile {
                match ready.hessian.row_of(disk as u32) {
                    Some(row) => self.right_side[row..row + D].copy_from_slice(&stage.way[disk]),
                    // A disk that touches nothing: the matrix is its diagonal.
                    None => stage.way[disk] = scaled(alone, stage.way[disk]),
                }
            }
            self.work.iteration_count += ready.solve(&self.right_side, &mut self.unknowns);
            for disk in 0..mobile {
                if let Some(row) = ready.hessian.row_of(disk as u32) {
                    stage.way[disk] = std::array::from_fn(|d| self.unknowns[row + d]);
                }
                if mass > 0.0 {
                    stage.kick[disk] = difference(scaled(1.0 / scale, stage.way[disk]), self.carried[disk]);
                }
            }
        }
        // Stiffly accurate: the end is the argument of the last stage and its U.
        let mut weights = ROS34PW2.argument[STAGE_COUNT - 1];
        weights[STAGE_COUNT - 1] = 1.0;
        let Some(totals) = self.go(&weights)? else { return Ok(Stepped::TooFar) };
        self.dissipated =
            self.before.dissipated + self.stages.iter().zip(weights).map(|(stage, m)| m * stage.work).sum::<f64>();
        self.time = self.before.time + time_step;
        Ok(Stepped::Moved(totals))
    }

    /// Disks and velocities at the start of the step plus this sum of stages, and the forces there. None if a disk would go
    /// farther than the smallest radius, or nowhere that is a place.
    fn go(&mut self, weights: &[f64]) -> Result<Option<Totals<D>>, PackingError> {
        let mut longest = 0.0;
        for (disk, moved) in self.moved.iter_mut().enumerate() {
            let summed = self.stages.iter().zip(weights);
            *moved = summed.fold([0.0; D], |way, (stage, &weight)| sum(way, scaled(weight, stage.way[disk])));
            longest = larger(dot(*moved, *moved), longest);
        }
        let longest = longest.sqrt();
        if longest.is_nan() || longest > self.smallest_radius {
            return Ok(None);
        }
        self.assembly.restore()?;
        for (disk, &moved) in self.moved.iter().enumerate() {
            let summed = self.stages.iter().zip(weights);
            self.velocities[disk] = summed.fold(self.before.velocities[disk], |velocity, (stage, &weight)| {
                sum(velocity, scaled(weight, stage.kick[disk]))
            });
            self.assembly.displacements[disk] = sum(self.assembly.displacements[disk], moved);
        }
        // A restored assembly may have a new list as well.
        let _ = self.assembly.keep_listed(longest)?;
        self.set_damping_coefficients();
        Ok(Some(self.evaluate()))
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

    fn set_damping_coefficients(&mut self) {
        let (pairs, radii) = (self.assembly.pairs(), self.assembly.radii());
        let of_pair = |(&i, &j): (&u32, &u32)| self.damping.coefficient(radii[i as usize], radii[j as usize]);
        self.damping_coefficient.clear();
        self.damping_coefficient.extend(pairs.first.iter().zip(&pairs.second).map(of_pair));
    }
}
