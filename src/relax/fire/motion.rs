//! Velocities and steps of FIRE, in double precision or, while disks are far from rest, in single.

use crate::forces::advance::Advanced;
use crate::forces::assembly::Assembly;
use crate::forces::single::{Single, Units};
use crate::law::pair_law::PairLaw;
use crate::relax::flat::{Products, combine, kick_and_drift, products};
use crate::simd::lanes::Summed;
use crate::simd::real::Real;
use crate::vector::Vector;

/// A step: `v ← keep·v + push·F`, then `u ← u + dt·v`.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    pub keep: f64,
    pub push: f64,
    pub time_step: f64,
}

impl Step {
    /// How fast the fastest disk then is along an axis, in the units of the step.
    fn kick<T: Real, const D: usize>(&self, forces: &[[T; D]], velocities: &mut [[T; D]], ways: &mut [[T; D]]) -> f64 {
        let (velocities, ways) = (velocities.as_flattened_mut(), ways.as_flattened_mut());
        kick_and_drift(self.keep, self.push, self.time_step, forces.as_flattened(), velocities, ways)
    }

    /// The same step in other units.
    fn in_units(&self, units: Units) -> Step {
        let push = self.push * (units.force / units.speed());
        Step { keep: self.keep, push, time_step: self.time_step / units.time }
    }
}

/// Velocities of the mobile disks, and in single precision where the disks are.
pub enum Motion<const D: usize> {
    /// \[length / time\]
    Double(Vec<Vector<D>>),
    /// In units of [`Single`].
    Single(Box<Single<D>>, Vec<[f32; D]>),
}

impl<const D: usize> Motion<D> {
    /// Disks at rest; in single precision if that is asked for and can be.
    pub fn new<L: PairLaw>(assembly: &Assembly<D, L>, in_single: bool) -> Self {
        let mobile = assembly.mobile_count();
        match in_single.then(|| Single::new(assembly)).flatten() {
            Some(disks) => Motion::Single(Box::new(disks), vec![[0.0; D]; mobile]),
            None => Motion::Double(vec![[0.0; D]; mobile]),
        }
    }

    /// Whether this is single precision.
    pub fn is_single(&self) -> bool {
        matches!(self, Motion::Single(..))
    }

    /// Goes on in double precision. The disks are settled.
    pub fn refine(&mut self) {
        if let Motion::Single(disks, velocities) = self {
            let unit = disks.units().speed();
            *self = Motion::Double(velocities.iter().map(|v| v.map(|v| unit * f64::from(v))).collect());
        }
    }

    /// Puts the disks of the assembly where they are.
    pub fn settle<L: PairLaw>(&self, assembly: &mut Assembly<D, L>) {
        if let Motion::Single(disks, _) = self {
            disks.settle(assembly);
        }
    }

    /// Where the disks of the assembly are is the base of the next step: they are settled there, or were moved, or have another list.
    pub fn forget(&mut self) {
        if let Motion::Single(disks, _) = self {
            disks.forget();
        }
    }

    /// Velocities 0.
    pub fn rest(&mut self) {
        match self {
            Motion::Double(velocities) => velocities.fill([0.0; D]),
            Motion::Single(_, velocities) => velocities.fill([0.0; D]),
        }
    }

    /// Evaluates the forces and takes the products.
    pub fn evaluate<L: PairLaw>(&mut self, assembly: &mut Assembly<D, L>) -> Products {
        match self {
            Motion::Double(_) => {
                assembly.evaluate();
                self.products(assembly)
            }
            Motion::Single(disks, velocities) => {
                disks.evaluate(assembly);
                in_units(disks, &products_of(&disks.forces[..velocities.len()], velocities))
            }
        }
    }

    /// The products with the forces of the assembly's last evaluation.
    pub fn products<L: PairLaw>(&mut self, assembly: &Assembly<D, L>) -> Products {
        match self {
            Motion::Double(velocities) => products_of(&assembly.forces[..velocities.len()], velocities),
            Motion::Single(disks, velocities) => {
                disks.take_forces(assembly);
                in_units(disks, &products_of(&disks.forces[..velocities.len()], velocities))
            }
        }
    }

    /// Moves the disks, evaluates their forces and takes the products, tile by tile ([`Assembly::advance`]). No disk goes farther than `reach`
    /// times the fastest one along an axis \[time\].
    pub fn advance<L: PairLaw>(&mut self, assembly: &mut Assembly<D, L>, step: Step, reach: f64) -> Advanced<Products> {
        match self {
            Motion::Double(velocities) => {
                assembly.advance(velocities, |f, v, u| reach * step.kick(f, v, u), products_of)
            }
            Motion::Single(disks, velocities) => {
                let (step, reach) = (step.in_units(disks.units()), reach * disks.units().speed());
                let kick =
                    |forces: &[_], velocities: &mut [_], ways: &mut [_]| reach * step.kick(forces, velocities, ways);
                disks.advance(assembly, velocities, kick, products_of)
            }
        }
    }

    /// The sum of what was seen of each part of the disks.
    pub fn sum(&self, parts: &[Products]) -> Products {
        match self {
            Motion::Double(_) => sum_of(parts),
            Motion::Single(disks, _) => in_units(disks, &sum_of(parts)),
        }
    }

    /// Moves the disks and settles them: how fast the fastest is along an axis \[length / time\].
    pub fn kick<L: PairLaw>(&mut self, assembly: &mut Assembly<D, L>, step: Step) -> f64 {
        let mobile = assembly.mobile_count();
        match self {
            Motion::Double(velocities) => {
                step.kick(&assembly.forces[..mobile], velocities, &mut assembly.displacements[..mobile])
            }
            Motion::Single(disks, velocities) => {
                let step = step.in_units(disks.units());
                let fastest =
                    disks.kick(assembly, velocities, |forces, velocities, ways| step.kick(forces, velocities, ways));
                disks.settle(assembly);
                disks.units().speed() * fastest
            }
        }
    }

    /// `u ← u − (dt/2) v`: half of the step that climbed, back.
    pub fn step_back<L: PairLaw>(&mut self, assembly: &mut Assembly<D, L>, time_step: f64) {
        let mobile = assembly.mobile_count();
        let displacements = assembly.displacements[..mobile].as_flattened_mut();
        match self {
            Motion::Double(velocities) => combine(1.0, displacements, -0.5 * time_step, velocities.as_flattened()),
            Motion::Single(disks, velocities) => {
                let back = -0.5 * time_step * disks.units().speed();
                for (u, v) in displacements.iter_mut().zip(velocities.as_flattened()) {
                    *u += back * f64::from(*v);
                }
            }
        }
        self.forget();
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
