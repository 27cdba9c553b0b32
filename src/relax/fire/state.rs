//! [`State`]: the velocities of FIRE, in double precision, or in single precision while the residual is large.

use crate::forces::advance::Advanced;
use crate::forces::assembly::Assembly;
use crate::forces::single_precision::Single;
use crate::relax::column_operations::{Products, combine, products};
use crate::relax::fire::step::Step;
use crate::simd::lanes::Summed;
use crate::vector::Vector;

/// Velocities of the mobile disks; in single precision also their displacements.
pub(super) enum State<const D: usize> {
    /// \[length / time\]
    Double(Vec<Vector<D>>),
    /// In units of [`Single`].
    Single(Box<Single<D>>, Vec<[f32; D]>),
}

impl<const D: usize> State<D> {
    /// Disks at rest; in single precision if requested and possible.
    pub(super) fn new(assembly: &Assembly<D>, in_single: bool) -> Self {
        let mobile = assembly.mobile_count();
        match in_single.then(|| Single::new(assembly)).flatten() {
            Some(disks) => State::Single(Box::new(disks), vec![[0.0; D]; mobile]),
            None => State::Double(vec![[0.0; D]; mobile]),
        }
    }

    /// Whether the state is in single precision.
    pub(super) fn is_single(&self) -> bool {
        matches!(self, State::Single(..))
    }

    /// Switches to double precision. The assembly must have the present displacements.
    pub(super) fn switch_to_double(&mut self) {
        if let State::Single(disks, velocities) = self {
            let unit = disks.units().speed();
            *self = State::Double(velocities.iter().map(|v| v.map(|v| unit * f64::from(v))).collect());
        }
    }

    /// Writes the displacements into the assembly.
    pub(super) fn write_displacements(&self, assembly: &mut Assembly<D>) {
        if let State::Single(disks, _) = self {
            disks.write_displacements(assembly);
        }
    }

    /// Marks the base as outdated: the displacements of the assembly become the base of the next step. Needed after
    /// they were written or moved, or after a change of the list.
    pub(super) fn invalidate_base(&mut self) {
        if let State::Single(disks, _) = self {
            disks.invalidate_base();
        }
    }

    /// Sets all velocities to 0.
    pub(super) fn rest(&mut self) {
        match self {
            State::Double(velocities) => velocities.fill([0.0; D]),
            State::Single(_, velocities) => velocities.fill([0.0; D]),
        }
    }

    /// Evaluates the forces and computes the products.
    pub(super) fn evaluate(&mut self, assembly: &mut Assembly<D>) -> Products {
        match self {
            State::Double(_) => {
                assembly.evaluate();
                self.products(assembly)
            }
            State::Single(disks, velocities) => {
                disks.evaluate(assembly);
                in_units(disks, &products_of(&disks.forces[..velocities.len()], velocities))
            }
        }
    }

    /// The products with the forces of the assembly's last evaluation.
    pub(super) fn products(&mut self, assembly: &Assembly<D>) -> Products {
        match self {
            State::Double(velocities) => products_of(&assembly.forces[..velocities.len()], velocities),
            State::Single(disks, velocities) => {
                disks.take_forces(assembly);
                in_units(disks, &products_of(&disks.forces[..velocities.len()], velocities))
            }
        }
    }

    /// Moves the disks, evaluates their forces and computes the products, tile by tile ([`Assembly::advance`]). No
    /// displacement is longer than `reach` times the largest velocity component \[time\].
    pub(super) fn advance(&mut self, assembly: &mut Assembly<D>, step: Step, reach: f64) -> Advanced<Products> {
        match self {
            State::Double(velocities) => {
                assembly.advance(velocities, |f, v, u| reach * step.kick(f, v, u), products_of)
            }
            State::Single(disks, velocities) => {
                let (step, reach) = (step.in_units(disks.units()), reach * disks.units().speed());
                let kick = |forces: &[_], velocities: &mut [_], displacements: &mut [_]| {
                    reach * step.kick(forces, velocities, displacements)
                };
                disks.advance(assembly, velocities, kick, products_of)
            }
        }
    }

    /// The products of all disks, from those of their parts.
    pub(super) fn sum(&self, parts: &[Products]) -> Products {
        match self {
            State::Double(_) => sum_of(parts),
            State::Single(disks, _) => in_units(disks, &sum_of(parts)),
        }
    }

    /// Moves the disks and writes their displacements into the assembly. Returns the largest velocity component
    /// \[length / time\].
    pub(super) fn kick(&mut self, assembly: &mut Assembly<D>, step: Step) -> f64 {
        let mobile = assembly.mobile_count();
        match self {
            State::Double(velocities) => {
                step.kick(&assembly.forces[..mobile], velocities, &mut assembly.displacements[..mobile])
            }
            State::Single(disks, velocities) => {
                let step = step.in_units(disks.units());
                let fastest = disks.kick(assembly, velocities, |forces, velocities, displacements| {
                    step.kick(forces, velocities, displacements)
                });
                disks.write_displacements(assembly);
                disks.units().speed() * fastest
            }
        }
    }

    /// `u ← u − (dt/2) v`: takes back half of an uphill step.
    pub(super) fn step_back(&mut self, assembly: &mut Assembly<D>, time_step: f64) {
        let mobile = assembly.mobile_count();
        let displacements = assembly.displacements[..mobile].as_flattened_mut();
        match self {
            State::Double(velocities) => combine(1.0, displacements, -0.5 * time_step, velocities.as_flattened()),
            State::Single(disks, velocities) => {
                let back = -0.5 * time_step * disks.units().speed();
                for (u, v) in displacements.iter_mut().zip(velocities.as_flattened()) {
                    *u += back * f64::from(*v);
                }
            }
        }
        self.invalidate_base();
    }
}

fn products_of<T: Summed, const D: usize>(forces: &[[T; D]], velocities: &[[T; D]]) -> Products {
    products(forces.as_flattened(), velocities.as_flattened())
}

fn in_units<const D: usize>(disks: &Single<D>, products: &Products) -> Products {
    let (force, speed) = (disks.units().force, disks.units().speed());
    Products {
        power: force * speed * products.power,
        force_squared: force * force * products.force_squared,
        speed_squared: speed * speed * products.speed_squared,
        largest_force: force * products.largest_force,
    }
}

fn sum_of(parts: &[Products]) -> Products {
    parts.iter().fold(Products::ZERO, |sums, part| sums.with(part))
}
