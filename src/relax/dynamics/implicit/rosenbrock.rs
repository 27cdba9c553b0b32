//! One step of the Rosenbrock method of [`super::tableau`]: matrix, four stages, error.

use crate::forces::totals::Totals;
use crate::linear::LinearError;
use crate::packing::PackingError;
use crate::relax::dynamics::implicit::inertia::{Inertia, Stepped};
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::relax::dynamics::implicit::step_matrix::{PreparedMatrix, StepMatrix, StepTerms};
use crate::relax::dynamics::implicit::tableau::{ROS34PW2, STAGE_COUNT};
use crate::vector::{difference, dot, larger, scaled, sum};

impl<const D: usize> ImplicitMotion<D> {
    /// One step of length h \[time\]; [`ImplicitMotion::take_back`] undoes it.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn step(&mut self, time_step: f64) -> Result<Stepped<D>, PackingError> {
        let mut matrix = self.matrix.take().unwrap_or_else(|| StepMatrix::of(&self.assembly));
        if !self.taken_back {
            matrix.set_last_distances(&self.moved);
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
            Ok(mut prepared) => self.stages(time_step, &mut prepared),
            Err(LinearError::OutOfMemory { .. }) => Ok(Stepped::OutOfMemory),
            Err(_) => Ok(Stepped::Indefinite),
        };
        self.matrix = Some(matrix);
        stepped
    }

    /// Estimated error of the last step for a mobile disk: that of its position, and that of its velocity times hg
    /// \[length\].
    pub fn error(&self, time_step: f64, disk: usize) -> f64 {
        let scale = time_step * ROS34PW2.diagonal;
        let (mut moved, mut kick) = ([0.0; D], [0.0; D]);
        for (stage, weight) in self.stages.iter().zip(ROS34PW2.error) {
            moved = sum(moved, scaled(weight, stage.moved[disk]));
            kick = sum(kick, scaled(weight, stage.kick[disk]));
        }
        match self.inertia {
            Inertia::Massive => (dot(moved, moved) + scale * scale * dot(kick, kick)).sqrt(),
            Inertia::Friction(_) => dot(moved, moved).sqrt(),
        }
    }

    /// Computes all stages. Afterwards the disks are at the end of the step.
    fn stages(&mut self, time_step: f64, prepared: &mut PreparedMatrix<'_, D>) -> Result<Stepped<D>, PackingError> {
        let scale = time_step * ROS34PW2.diagonal;
        let (mass, friction) = self.inertia.resistance();
        let mobile = self.assembly.mobile_count();
        let dimension = prepared.hessian.matrix().dimension();
        self.right_side.resize(dimension, 0.0);
        self.unknowns.resize(dimension, 0.0);
        for index in 0..STAGE_COUNT {
            if index > 0 && self.go(&ROS34PW2.argument[index][..index])?.is_none() {
                return Ok(Stepped::TooFar);
            }
            let (done, rest) = self.stages.split_at_mut(index);
            let stage = &mut rest[0];
            let carried = ROS34PW2.carried[index];
            // r_u is stored in `carried`; r_v + (m/(hg) + ζ) r_u is summed in the stage.
            for disk in 0..mobile {
                let (mut moved, mut kick) = (self.velocities[disk], self.net_forces[disk]);
                for (past, factor) in done.iter().zip(carried) {
                    moved = sum(moved, scaled(factor / time_step, past.moved[disk]));
                    kick = sum(kick, scaled(factor / time_step, past.kick[disk]));
                }
                self.carried[disk] = moved;
                stage.moved[disk] = sum(kick, scaled(mass / scale + friction, moved));
            }
            let kept: f64 = done.iter().zip(carried).map(|(past, factor)| factor * past.work).sum();
            stage.work = scale * (self.dissipation + kept / time_step);
            for link in prepared.links {
                let (i, j) = (link.ends.0 as usize, link.ends.1 as usize);
                let along = dot(difference(self.carried[i], self.carried[j]), link.normal);
                let force = scaled(link.damping * along, link.normal);
                stage.moved[i] = sum(stage.moved[i], force);
                if j < mobile {
                    stage.moved[j] = difference(stage.moved[j], force);
                }
            }
            let alone = 1.0 / (mass / (scale * scale) + friction / scale);
            for disk in 0..mobile {
                match prepared.hessian.row_of(disk as u32) {
                    Some(row) => self.right_side[row..row + D].copy_from_slice(&stage.moved[disk]),
                    // For a disk without contacts the matrix is diagonal.
                    None => stage.moved[disk] = scaled(alone, stage.moved[disk]),
                }
            }
            self.work.iteration_count += prepared.solve(&self.right_side, &mut self.unknowns);
            for disk in 0..mobile {
                if let Some(row) = prepared.hessian.row_of(disk as u32) {
                    stage.moved[disk] = std::array::from_fn(|d| self.unknowns[row + d]);
                }
                if mass > 0.0 {
                    stage.kick[disk] = difference(scaled(1.0 / scale, stage.moved[disk]), self.carried[disk]);
                }
            }
        }
        // The method is stiffly accurate: the end state is the argument of the last stage plus its U.
        let mut weights = ROS34PW2.argument[STAGE_COUNT - 1];
        weights[STAGE_COUNT - 1] = 1.0;
        let Some(totals) = self.go(&weights)? else { return Ok(Stepped::TooFar) };
        self.dissipated =
            self.before.dissipated + self.stages.iter().zip(weights).map(|(stage, m)| m * stage.work).sum::<f64>();
        self.time = self.before.time + time_step;
        Ok(Stepped::Moved(totals))
    }

    /// Sets positions and velocities to the start of the step plus this weighted sum of stages, and evaluates the
    /// forces. None if a disk would move farther than the smallest radius, or if its displacement is NaN.
    fn go(&mut self, weights: &[f64]) -> Result<Option<Totals<D>>, PackingError> {
        let mut longest = 0.0;
        for (disk, moved) in self.moved.iter_mut().enumerate() {
            let summed = self.stages.iter().zip(weights);
            *moved = summed.fold([0.0; D], |moved, (stage, &weight)| sum(moved, scaled(weight, stage.moved[disk])));
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
        // A restored assembly may also have another list.
        let _ = self.assembly.update_list(longest)?;
        self.set_damping_coefficients();
        Ok(Some(self.evaluate()))
    }
}
