//! Sums over flat columns in a fixed order, in lanes the compiler can turn into vector instructions. Long columns are cut into
//! pieces of a fixed length, which may be worked on side by side; their sums are added in order.

use crate::side_by_side;

/// Length of a piece of a long column; fixed, so the bits do not depend on the number of threads.
const PIECE: usize = 1 << 15;

/// Lanes of a sum; fixed, so the bits do not depend on the machine.
const LANES: usize = 8;

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
    fn with_simd<S: pulp::Simd>(self, _simd: S) -> Products {
        products_in_lanes(self.force, self.velocity)
    }
}

#[inline(always)]
fn products_in_lanes(force: &[f64], velocity: &[f64]) -> Products {
    // A loop for each sum: of one loop over all three the compiler makes a patchwork.
    let (mut power, mut force_squared, mut speed_squared) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
    let (forces, force_rest) = force.as_chunks::<LANES>();
    let (velocities, velocity_rest) = velocity.as_chunks::<LANES>();
    for (f, v) in forces.iter().zip(velocities) {
        for k in 0..LANES {
            power[k] += f[k] * v[k];
        }
        for k in 0..LANES {
            force_squared[k] += f[k] * f[k];
        }
        for k in 0..LANES {
            speed_squared[k] += v[k] * v[k];
        }
    }
    for (k, (&f, &v)) in force_rest.iter().zip(velocity_rest).enumerate() {
        power[k] += f * v;
        force_squared[k] += f * f;
        speed_squared[k] += v * v;
    }
    let [power, force_squared, speed_squared] = [power, force_squared, speed_squared].map(|lanes| lanes.iter().sum());
    Products { power, force_squared, speed_squared }
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
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            let mut lanes = [0.0; LANES];
            let (left, right) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
            let rest = (left.remainder(), right.remainder());
            for (x, y) in left.zip(right) {
                for k in 0..LANES {
                    lanes[k] += x[k] * y[k];
                }
            }
            for (k, (&x, &y)) in rest.0.iter().zip(rest.1).enumerate() {
                lanes[k] += x * y;
            }
            lanes.iter().sum()
        },
    )
}

/// `y ← keep·y + factor·x`.
pub fn combine(keep: f64, y: &mut [f64], factor: f64, x: &[f64]) {
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            for (y, x) in y.iter_mut().zip(x) {
                *y = keep * *y + factor * x;
            }
        },
    );
}
