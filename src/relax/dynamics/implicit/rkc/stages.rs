//! [`Stages`]: buffers and update of the stages of one Runge–Kutta–Chebyshev step, and its estimated error.

use crate::processor;
use crate::relax::dynamics::implicit::rkc::coefficients::{Chebyshev, StageTerms};
use crate::relax::dynamics::implicit::tableau::ROS34PW2;
use crate::vector::{Vector, difference, dot, larger, scaled, sum};

/// Buffers of the stages of a step.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stages<const D: usize> {
    pub(crate) method: Option<Chebyshev>,
    /// Displacements since the start of the step, after the last stage and after the stage before it.
    pub(crate) moved: Vec<Vector<D>>,
    earlier_moved: Vec<Vector<D>>,
    /// Velocities of all disks at the same stages; those of held disks are 0.
    pub(crate) velocity: Vec<Vector<D>>,
    earlier_velocity: Vec<Vector<D>>,
    /// Sums of c n n over the contacts of a disk.
    pub(crate) blocks: Vec<[Vector<D>; D]>,
}

/// Lanes of a maximum.
const LANES: usize = 8;

impl<const D: usize> Stages<D> {
    /// Sets everything to the start of a step.
    pub(crate) fn begin(&mut self, velocities: &[Vector<D>], disk_count: usize) {
        for moved in [&mut self.moved, &mut self.earlier_moved] {
            moved.clear();
            moved.resize(velocities.len(), [0.0; D]);
        }
        for velocity in [&mut self.velocity, &mut self.earlier_velocity] {
            velocity.clear();
            velocity.extend_from_slice(velocities);
            velocity.resize(disk_count, [0.0; D]);
        }
    }

    /// Computes one stage. Returns the largest component of a displacement since the last stage, and since the start of
    /// the step.
    pub(crate) fn advance(
        &mut self,
        terms: &StageTerms,
        [slope, start_slope]: [f64; 2],
        (start_velocities, start_forces): (&[f64], &[f64]),
        forces: &[f64],
        displacements: &mut [f64],
    ) -> (f64, f64) {
        let count = displacements.len();
        let (moved, velocity) = (&self.moved.as_flattened()[..count], &self.velocity.as_flattened()[..count]);
        let next_moved = &mut self.earlier_moved.as_flattened_mut()[..count];
        let next_velocity = &mut self.earlier_velocity.as_flattened_mut()[..count];
        let (start_velocities, start_forces) = (&start_velocities[..count], &start_forces[..count]);
        let forces = &forces[..count];
        let (mut change, mut farthest) = ([0.0f64; LANES], [0.0f64; LANES]);
        processor::dispatch(
            #[inline(always)]
            || {
                for k in 0..count {
                    let moved = terms.last * moved[k]
                        + terms.earlier * next_moved[k]
                        + slope * velocity[k]
                        + start_slope * start_velocities[k];
                    next_velocity[k] = terms.start * start_velocities[k]
                        + terms.last * velocity[k]
                        + terms.earlier * next_velocity[k]
                        + slope * forces[k]
                        + start_slope * start_forces[k];
                    next_moved[k] = moved;
                }
                for ((next, last), u) in
                    next_moved.chunks(LANES).zip(moved.chunks(LANES)).zip(displacements.chunks_mut(LANES))
                {
                    for (k, ((&next, &last), u)) in next.iter().zip(last).zip(u).enumerate() {
                        let step = next - last;
                        *u += step;
                        change[k] = if step.abs() > change[k] { step.abs() } else { change[k] };
                        farthest[k] = if next.abs() > farthest[k] { next.abs() } else { farthest[k] };
                    }
                }
            },
        );
        std::mem::swap(&mut self.moved, &mut self.earlier_moved);
        std::mem::swap(&mut self.velocity, &mut self.earlier_velocity);
        (change.into_iter().fold(0.0, larger), farthest.into_iter().fold(0.0, larger))
    }
}

/// Error of a stabilised step, from the displacement of a disk and its velocities and forces at start and end
/// \[length\].
pub(crate) fn estimated_error<const D: usize>(
    time_step: f64,
    moved: Vector<D>,
    [start_velocity, velocity]: [Vector<D>; 2],
    [start_force, force]: [Vector<D>; 2],
) -> f64 {
    let change = sum(scaled(-0.8, moved), scaled(0.4 * time_step, sum(start_velocity, velocity)));
    let kick = sum(scaled(0.8, difference(start_velocity, velocity)), scaled(0.4 * time_step, sum(start_force, force)));
    measure(time_step, change, kick)
}

/// Norm of a difference between two states of a disk: its position, and its velocity times hγ \[length\].
pub(crate) fn measure<const D: usize>(time_step: f64, change: Vector<D>, kick: Vector<D>) -> f64 {
    let scale = time_step * ROS34PW2.diagonal;
    (dot(change, change) + scale * scale * dot(kick, kick)).sqrt()
}
