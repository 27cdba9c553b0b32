//! Sums in a fixed number of lanes, independent of the vector width: the same bits on every machine.
//!
//! The loops use vectors explicitly, because the compiler does not vectorise sums over arrays of lanes well.

use crate::processor;
use crate::simd::real::Real;

/// Lanes of a sum.
pub const LANES: usize = 8;

/// Lanes of a sum in single precision.
pub const SINGLE_LANES: usize = 32;

/// Σ a_k.
#[inline(always)]
pub fn sum<S: pulp::Simd>(simd: S, column: &[f64]) -> f64 {
    let mut sums = [simd.splat_f64s(0.0); LANES];
    let (column, rest) = column.as_chunks::<LANES>();
    let each = LANES / S::F64_LANES;
    let vectors = S::as_simd_f64s(column.as_flattened()).0;
    for first in (0..vectors.len()).step_by(each) {
        for k in 0..each {
            sums[k] = simd.add_f64s(sums[k], vectors[first + k]);
        }
    }
    let mut lanes = lanes_of::<S>(&sums);
    for (lane, value) in lanes.iter_mut().zip(rest) {
        *lane += value;
    }
    lanes.iter().sum()
}

/// Σ a_k b_k of two columns of the same length.
pub fn dot_product(a: &[f64], b: &[f64]) -> f64 {
    debug_assert_eq!(a.len(), b.len());
    processor::dispatch(DotProduct { a, b })
}

struct DotProduct<'a> {
    a: &'a [f64],
    b: &'a [f64],
}

impl pulp::WithSimd for DotProduct<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) -> f64 {
        let mut sums = [simd.splat_f64s(0.0); LANES];
        let ((a, a_rest), (b, b_rest)) = (self.a.as_chunks::<LANES>(), self.b.as_chunks::<LANES>());
        let (a, b) = (S::as_simd_f64s(a.as_flattened()).0, S::as_simd_f64s(b.as_flattened()).0);
        let each = LANES / S::F64_LANES;
        for first in (0..a.len()).step_by(each) {
            let (a, b) = (&a[first..first + each], &b[first..first + each]);
            for k in 0..each {
                sums[k] = simd.add_f64s(sums[k], simd.mul_f64s(a[k], b[k]));
            }
        }
        with_rest(lanes_of::<S>(&sums), a_rest, b_rest)
    }
}

/// A number type whose products are summed in a fixed number of lanes.
pub trait Summed: Real {
    /// Number of lanes of a sum.
    const LANES: usize;

    /// Length of the parts that are summed in this precision. The sums of parts are added in double precision.
    const PART: usize;

    /// The sum of the lanes, plus the products of the remaining numbers of two columns.
    fn total(lanes: &[Self], a: &[Self], b: &[Self]) -> f64;
}

impl Summed for f64 {
    const LANES: usize = LANES;
    const PART: usize = usize::MAX;

    #[inline(always)]
    fn total(lanes: &[f64], a: &[f64], b: &[f64]) -> f64 {
        let mut all = [0.0; LANES];
        all.copy_from_slice(lanes);
        with_rest(all, a, b)
    }
}

impl Summed for f32 {
    const LANES: usize = SINGLE_LANES;
    const PART: usize = 64 * SINGLE_LANES;

    #[inline(always)]
    fn total(lanes: &[f32], a: &[f32], b: &[f32]) -> f64 {
        let rest = a.iter().zip(b).map(|(&a, &b)| f64::from(a) * f64::from(b));
        lanes.iter().map(|&lane| f64::from(lane)).chain(rest).sum()
    }
}

/// Computes Σ a_k b_k, Σ a_k², Σ b_k² and the largest |a_k| in one pass over a part. They are 0 for an empty part; the
/// largest |a_k| may lose a NaN.
#[inline(always)]
pub fn products<S: pulp::Simd, T: Summed>(simd: S, a: &[T], b: &[T]) -> ([f64; 3], f64) {
    let whole = a.len() / T::LANES * T::LANES;
    let ((a, a_rest), (b, b_rest)) = (a.split_at(whole), b.split_at(whole));
    let (a, b) = (T::vectors::<S>(a).0, T::vectors::<S>(b).0);
    // Number of vectors that hold the lanes; it does not exceed the number of lanes.
    let each = T::LANES / T::numbers::<S>(&[T::splat(simd, T::default())]).len();
    let zero = [T::splat(simd, T::default()); SINGLE_LANES];
    let (mut both, mut a_squared, mut b_squared, mut most) = (zero, zero, zero, zero[0]);
    for first in (0..a.len()).step_by(each) {
        let (a, b) = (&a[first..first + each], &b[first..first + each]);
        for k in 0..each {
            both[k] = T::plus(simd, both[k], T::times(simd, a[k], b[k]));
            a_squared[k] = T::plus(simd, a_squared[k], T::times(simd, a[k], a[k]));
            b_squared[k] = T::plus(simd, b_squared[k], T::times(simd, b[k], b[k]));
            most = T::larger_size(simd, most, a[k]);
        }
    }
    let sums = [(both, a_rest, b_rest), (a_squared, a_rest, a_rest), (b_squared, b_rest, b_rest)]
        .map(|(vectors, a, b)| T::total(T::numbers::<S>(&vectors[..each]), a, b));
    let most = T::largest(simd, most).widened();
    (sums, a_rest.iter().fold(most, |most, a| most.max(a.widened().abs())))
}

/// The lanes of vectors of any width.
#[inline(always)]
fn lanes_of<S: pulp::Simd>(vectors: &[S::f64s; LANES]) -> [f64; LANES] {
    let all: &[f64] = pulp::bytemuck::cast_slice(&vectors[..LANES / S::F64_LANES]);
    let mut lanes = [0.0; LANES];
    lanes.copy_from_slice(all);
    lanes
}

/// The sum of the lanes and of the products of the remaining numbers.
fn with_rest(mut lanes: [f64; LANES], a: &[f64], b: &[f64]) -> f64 {
    for ((lane, x), y) in lanes.iter_mut().zip(a).zip(b) {
        *lane += x * y;
    }
    lanes.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::processor::{Processor, dispatch};

    /// Sum in eight lanes with scalar operations.
    fn plain(terms: impl Iterator<Item = f64>) -> f64 {
        let mut lanes = [0.0; LANES];
        terms.enumerate().for_each(|(k, term)| lanes[k % LANES] += term);
        lanes.iter().sum()
    }

    #[test]
    fn the_bits_of_single_precision_do_not_depend_on_it_either() {
        for length in [0, 1, 31, 32, 33, 64, 1003] {
            let column = |by: f64| (0..length).map(|k| (by * k as f64).sin() as f32).collect::<Vec<f32>>();
            let (a, b) = (column(1.3), column(2.7));
            let whole = length / SINGLE_LANES * SINGLE_LANES;
            let product = |x: &[f32], y: &[f32]| {
                let mut lanes = [0f32; SINGLE_LANES];
                (0..whole).for_each(|k| lanes[k % SINGLE_LANES] += x[k] * y[k]);
                let rest = (whole..length).map(|k| f64::from(x[k]) * f64::from(y[k]));
                lanes.iter().map(|&lane| f64::from(lane)).chain(rest).sum::<f64>()
            };
            let most = a.iter().fold(0f32, |most, value| most.max(value.abs()));
            let expected = ([product(&a, &b), product(&a, &a), product(&b, &b)], f64::from(most));
            for processor in Processor::all() {
                assert_eq!(processor.run(|| dispatch(Single(&a, &b))), expected, "{processor:?}, {length}");
            }
        }
    }

    struct Single<'a>(&'a [f32], &'a [f32]);

    impl pulp::WithSimd for Single<'_> {
        type Output = ([f64; 3], f64);

        fn with_simd<S: pulp::Simd>(self, simd: S) -> Self::Output {
            products(simd, self.0, self.1)
        }
    }

    struct All<'a>(&'a [f64], &'a [f64]);

    impl pulp::WithSimd for All<'_> {
        type Output = [f64; 6];

        fn with_simd<S: pulp::Simd>(self, simd: S) -> [f64; 6] {
            let ([both, a_squared, b_squared], most) = products(simd, self.0, self.1);
            [sum(simd, self.0), dot_product(self.0, self.1), both, a_squared, b_squared, most]
        }
    }

    #[test]
    fn the_bits_do_not_depend_on_the_width_of_vectors() {
        for length in [0, 1, 7, 8, 9, 64, 1003] {
            let column = |by: f64| (0..length).map(|k| (by * k as f64).sin() / (1.0 + k as f64)).collect::<Vec<f64>>();
            let (a, b) = (column(1.3), column(2.7));
            let product = |x: &[f64], y: &[f64]| plain(x.iter().zip(y).map(|(x, y)| x * y));
            let both = product(&a, &b);
            let most = a.iter().fold(0.0f64, |most, value| most.max(value.abs()));
            let expected = [plain(a.iter().copied()), both, both, product(&a, &a), product(&b, &b), most];
            for processor in Processor::all() {
                assert_eq!(processor.run(|| dispatch(All(&a, &b))), expected, "{processor:?}, {length}");
            }
        }
    }
}
