//! Sums over flat columns in a fixed order, in lanes the compiler can turn into vector instructions. Long columns are cut into
//! pieces of a fixed length, which may be worked on side by side; their sums are added in order.

use crate::lanes;
use crate::side_by_side;

/// Length of a piece of a long column; fixed, so the bits do not depend on the number of threads.
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
}

/// F·v, F·F and v·v in one pass.
pub fn products(force: &[f64], velocity: &[f64]) -> Products {
    let of_piece = |(force, velocity)| pulp::Arch::new().dispatch(ProductsOf { force, velocity });
    if force.len() <= PIECE {
        return of_piece((force, velocity));
    }
    let pieces = side_by_side::each(force.chunks(PIECE).zip(velocity.chunks(PIECE)), of_piece);
    let zero = Products { power: 0.0, force_squared: 0.0, speed_squared: 0.0 };
    pieces.iter().fold(zero, |sum, piece| Products {
        power: sum.power + piece.power,
        force_squared: sum.force_squared + piece.force_squared,
        speed_squared: sum.speed_squared + piece.speed_squared,
    })
}

struct ProductsOf<'a> {
    force: &'a [f64],
    velocity: &'a [f64],
}

impl pulp::WithSimd for ProductsOf<'_> {
    type Output = Products;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) -> Products {
        let [power, force_squared, speed_squared] = lanes::products(simd, self.force, self.velocity);
        Products { power, force_squared, speed_squared }
    }
}

/// `v ← keep·v + push·F`, then `u ← u + dt·v`.
pub fn kick_and_drift(
    keep: f64,
    push: f64,
    time_step: f64,
    force: &[f64],
    velocity: &mut [f64],
    displacement: &mut [f64],
) {
    let piece = |((force, velocity), displacement): ((&_, &mut _), &mut _)| {
        pulp::Arch::new().dispatch(KickAndDrift { keep, push, time_step, force, velocity, displacement });
    };
    if force.len() <= PIECE {
        return piece(((force, velocity), displacement));
    }
    let pieces = force.chunks(PIECE).zip(velocity.chunks_mut(PIECE)).zip(displacement.chunks_mut(PIECE));
    side_by_side::each(pieces, piece);
}

struct KickAndDrift<'a> {
    keep: f64,
    push: f64,
    time_step: f64,
    force: &'a [f64],
    velocity: &'a mut [f64],
    displacement: &'a mut [f64],
}

impl pulp::WithSimd for KickAndDrift<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) {
        for ((f, v), u) in self.force.iter().zip(self.velocity).zip(self.displacement) {
            *v = self.keep * *v + self.push * f;
            *u += self.time_step * *v;
        }
    }
}

/// a·b.
pub fn dot_product(a: &[f64], b: &[f64]) -> f64 {
    pulp::Arch::new().dispatch(DotProduct { a, b })
}

struct DotProduct<'a> {
    a: &'a [f64],
    b: &'a [f64],
}

impl pulp::WithSimd for DotProduct<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) -> f64 {
        lanes::dot_product(simd, self.a, self.b)
    }
}

/// `y ← keep·y + factor·x`.
pub fn combine(keep: f64, y: &mut [f64], factor: f64, x: &[f64]) {
    pulp::Arch::new().dispatch(Combine { keep, y, factor, x });
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
