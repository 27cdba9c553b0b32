//! [`Real`]: numbers of either precision and their vectors, so that one loop serves both.

use pulp::Simd;

use crate::vector::Number;

/// `f64` or `f32`.
pub trait Real: Number {
    /// A vector of the machine.
    type Lanes<S: Simd>: Copy;

    /// The nearest number of this precision.
    fn rounded(value: f64) -> Self;

    /// The same number in double precision.
    fn widened(self) -> f64;

    /// A column as vectors, and the remaining numbers.
    fn vectors<S: Simd>(column: &[Self]) -> (&[Self::Lanes<S>], &[Self]);

    /// A mutable column as vectors, and the remaining numbers.
    fn vectors_mut<S: Simd>(column: &mut [Self]) -> (&mut [Self::Lanes<S>], &mut [Self]);

    /// The numbers of consecutive vectors.
    fn numbers<S: Simd>(vectors: &[Self::Lanes<S>]) -> &[Self];

    /// A number in every lane.
    fn splat<S: Simd>(simd: S, value: Self) -> Self::Lanes<S>;

    /// a + b.
    fn plus<S: Simd>(simd: S, a: Self::Lanes<S>, b: Self::Lanes<S>) -> Self::Lanes<S>;

    /// a · b.
    fn times<S: Simd>(simd: S, a: Self::Lanes<S>, b: Self::Lanes<S>) -> Self::Lanes<S>;

    /// The larger of a and |b|; a NaN may be lost.
    fn larger_size<S: Simd>(simd: S, a: Self::Lanes<S>, b: Self::Lanes<S>) -> Self::Lanes<S>;

    /// The largest lane; a NaN may be lost.
    fn largest<S: Simd>(simd: S, a: Self::Lanes<S>) -> Self;
}

/// Implements [`Real`] for a precision, by pulp's names of its operations.
macro_rules! real {
    ($number:ty, $bits:ty, $lanes:ident, $vectors:ident, $vectors_mut:ident, $splat:ident, $add:ident, $multiply:ident, $max:ident, $and:ident, $reduce_max:ident) => {
        impl Real for $number {
            type Lanes<S: Simd> = S::$lanes;

            #[inline(always)]
            fn rounded(value: f64) -> Self {
                value as $number
            }

            #[inline(always)]
            fn widened(self) -> f64 {
                f64::from(self)
            }

            #[inline(always)]
            fn vectors<S: Simd>(column: &[Self]) -> (&[S::$lanes], &[Self]) {
                S::$vectors(column)
            }

            #[inline(always)]
            fn vectors_mut<S: Simd>(column: &mut [Self]) -> (&mut [S::$lanes], &mut [Self]) {
                S::$vectors_mut(column)
            }

            #[inline(always)]
            fn numbers<S: Simd>(vectors: &[S::$lanes]) -> &[Self] {
                pulp::bytemuck::cast_slice(vectors)
            }

            #[inline(always)]
            fn splat<S: Simd>(simd: S, value: Self) -> S::$lanes {
                simd.$splat(value)
            }

            #[inline(always)]
            fn plus<S: Simd>(simd: S, a: S::$lanes, b: S::$lanes) -> S::$lanes {
                simd.$add(a, b)
            }

            #[inline(always)]
            fn times<S: Simd>(simd: S, a: S::$lanes, b: S::$lanes) -> S::$lanes {
                simd.$multiply(a, b)
            }

            #[inline(always)]
            // The sign bit is masked here: pulp's `abs` remains a call.
            fn larger_size<S: Simd>(simd: S, a: S::$lanes, b: S::$lanes) -> S::$lanes {
                simd.$max(a, simd.$and(b, simd.$splat(<$number>::from_bits(<$bits>::MAX >> 1))))
            }

            #[inline(always)]
            fn largest<S: Simd>(simd: S, a: S::$lanes) -> Self {
                simd.$reduce_max(a)
            }
        }
    };
}

real!(
    f64,
    u64,
    f64s,
    as_simd_f64s,
    as_mut_simd_f64s,
    splat_f64s,
    add_f64s,
    mul_f64s,
    max_f64s,
    and_f64s,
    reduce_max_f64s
);
real!(
    f32,
    u32,
    f32s,
    as_simd_f32s,
    as_mut_simd_f32s,
    splat_f32s,
    add_f32s,
    mul_f32s,
    max_f32s,
    and_f32s,
    reduce_max_f32s
);
