//! Sums over flat columns in a fixed order, in lanes the compiler can turn into vector instructions.

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
    pulp::Arch::new().dispatch(ProductsOf { force, velocity })
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
    let mut lanes = [[0.0; LANES]; 3];
    let (forces, velocities) = (force.chunks_exact(LANES), velocity.chunks_exact(LANES));
    let rest = (forces.remainder(), velocities.remainder());
    for (f, v) in forces.zip(velocities) {
        for k in 0..LANES {
            lanes[0][k] += f[k] * v[k];
            lanes[1][k] += f[k] * f[k];
            lanes[2][k] += v[k] * v[k];
        }
    }
    for (k, (&f, &v)) in rest.0.iter().zip(rest.1).enumerate() {
        lanes[0][k] += f * v;
        lanes[1][k] += f * f;
        lanes[2][k] += v * v;
    }
    let [power, force_squared, speed_squared] = lanes.map(|lane| lane.iter().sum());
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
    pulp::Arch::new().dispatch(KickAndDrift { keep, push, time_step, force, velocity, displacement });
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
