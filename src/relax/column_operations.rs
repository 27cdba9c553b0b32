//! Operations on long columns of numbers, with sums in a fixed order.
//!
//! The loops have lanes for the vector instructions of the processor. Long columns are cut into pieces of a fixed
//! length. Pieces may be processed in parallel; their sums are added in order.

use crate::parallel;
use crate::processor;
use crate::simd::lanes::{self, Summed};
use crate::simd::real::Real;
use crate::vector::larger;

/// Length of a piece of a long column. It is fixed, so the bits do not depend on the number of threads.
const PIECE: usize = 1 << 15;

/// The products a step of FIRE needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Products {
    /// F·v.
    pub power: f64,
    /// F·F.
    pub force_squared: f64,
    /// v·v.
    pub speed_squared: f64,
    /// The largest size of a component of F. A NaN may be lost here, but not in the others.
    pub largest_force: f64,
}

impl Products {
    /// The products of empty columns.
    pub const ZERO: Self = Products { power: 0.0, force_squared: 0.0, speed_squared: 0.0, largest_force: 0.0 };

    /// Whether all products are finite. A NaN among forces or velocities makes them NaN.
    pub fn is_finite(&self) -> bool {
        (self.power + self.force_squared + self.speed_squared).is_finite()
    }

    /// The products of both parts together.
    pub fn with(&self, part: &Self) -> Self {
        Products {
            power: self.power + part.power,
            force_squared: self.force_squared + part.force_squared,
            speed_squared: self.speed_squared + part.speed_squared,
            largest_force: larger(self.largest_force, part.largest_force),
        }
    }
}

/// F·v, F·F and v·v in one pass. Sums of up to some thousand terms have the precision of `T`; the sums of these parts
/// are double.
pub fn products<T: Summed>(force: &[T], velocity: &[T]) -> Products {
    let of_piece = |(force, velocity)| processor::dispatch(ProductsOf { force, velocity });
    if force.len() <= PIECE {
        return of_piece((force, velocity));
    }
    let pieces = parallel::each(force.chunks(PIECE).zip(velocity.chunks(PIECE)), of_piece);
    pieces.iter().fold(Products::ZERO, |sum, piece| sum.with(piece))
}

struct ProductsOf<'a, T> {
    force: &'a [T],
    velocity: &'a [T],
}

impl<T: Summed> pulp::WithSimd for ProductsOf<'_, T> {
    type Output = Products;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) -> Products {
        let mut sum = Products::ZERO;
        for (force, velocity) in self.force.chunks(T::PART).zip(self.velocity.chunks(T::PART)) {
            let ([power, force_squared, speed_squared], largest_force) = lanes::products(simd, force, velocity);
            sum = sum.with(&Products { power, force_squared, speed_squared, largest_force });
        }
        sum
    }
}

/// `v ← keep·v + push·F`, then `u ← u + dt·v`. Returns the largest size of a component of v.
pub fn kick_and_drift<T: Real>(
    keep: f64,
    push: f64,
    time_step: f64,
    force: &[T],
    velocity: &mut [T],
    displacement: &mut [T],
) -> f64 {
    let [keep, push, time_step] = [keep, push, time_step].map(T::rounded);
    let piece = |((force, velocity), displacement): ((&_, &mut _), &mut _)| {
        processor::dispatch(KickAndDrift { keep, push, time_step, force, velocity, displacement })
    };
    if force.len() <= PIECE {
        return piece(((force, velocity), displacement));
    }
    let pieces = force.chunks(PIECE).zip(velocity.chunks_mut(PIECE)).zip(displacement.chunks_mut(PIECE));
    parallel::each(pieces, piece).into_iter().fold(0.0, larger)
}

struct KickAndDrift<'a, T> {
    keep: T,
    push: T,
    time_step: T,
    force: &'a [T],
    velocity: &'a mut [T],
    displacement: &'a mut [T],
}

impl<T: Real> pulp::WithSimd for KickAndDrift<'_, T> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) -> f64 {
        let splat = |value| T::splat(simd, value);
        let (keep, push, time_step) = (splat(self.keep), splat(self.push), splat(self.time_step));
        let (force, force_rest) = T::vectors::<S>(self.force);
        let (velocity, velocity_rest) = T::vectors_mut::<S>(self.velocity);
        let (displacement, displacement_rest) = T::vectors_mut::<S>(self.displacement);
        // A NaN may be lost here; it stays in v and u.
        let mut fastest = splat(T::default());
        let count = force.len();
        let (velocity, displacement) = (&mut velocity[..count], &mut displacement[..count]);
        for k in 0..count {
            // Kept in a register: a vector that crosses a cache line is slow to read after it was stored.
            let kicked = T::plus(simd, T::times(simd, keep, velocity[k]), T::times(simd, push, force[k]));
            velocity[k] = kicked;
            displacement[k] = T::plus(simd, displacement[k], T::times(simd, time_step, kicked));
            fastest = T::larger_size(simd, fastest, kicked);
        }
        let mut fastest = T::largest(simd, fastest).widened();
        for ((&f, v), u) in force_rest.iter().zip(velocity_rest).zip(displacement_rest) {
            *v = self.keep * *v + self.push * f;
            *u = *u + self.time_step * *v;
            fastest = larger(fastest, v.widened().abs());
        }
        fastest
    }
}

/// `y ← keep·y + factor·x`.
pub fn combine(keep: f64, y: &mut [f64], factor: f64, x: &[f64]) {
    processor::dispatch(Combine { keep, y, factor, x });
}

struct Combine<'a> {
    keep: f64,
    y: &'a mut [f64],
    factor: f64,
    x: &'a [f64],
}

impl pulp::WithSimd for Combine<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) {
        for (y, x) in self.y.iter_mut().zip(self.x) {
            *y = self.keep * *y + self.factor * x;
        }
    }
}
