//! Vectors of D = 2 or 3 components and the error-free sums for positions.
//!
//! A position is an unevaluated sum `high + low` of two vectors. So the distance of two touching disks is known to the
//! rounding of the distance itself (2·10⁻¹⁶), not to that of the side of the box (10⁻¹⁴ and more).

use std::ops::{Add, Mul, Sub};

use crate::processor;

/// A vector of D components.
pub type Vector<const D: usize> = [f64; D];

/// Number type of the loop over contacts: `f64`, or `f32` while disks are far from rest.
pub trait Number: Copy + Default + Send + Sync + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}

impl Number for f32 {}
impl Number for f64 {}

// Plain loops: one closure per component might not be inlined in the hot loop.

/// `a + b`, component by component.
#[inline(always)]
pub fn sum<T: Number, const D: usize>(a: [T; D], b: [T; D]) -> [T; D] {
    let mut result = [T::default(); D];
    for d in 0..D {
        result[d] = a[d] + b[d];
    }
    result
}

/// `a − b`, component by component.
#[inline(always)]
pub fn difference<T: Number, const D: usize>(a: [T; D], b: [T; D]) -> [T; D] {
    let mut result = [T::default(); D];
    for d in 0..D {
        result[d] = a[d] - b[d];
    }
    result
}

/// The vector at a place of D columns.
#[inline(always)]
pub fn vector_at<const D: usize, const N: usize>(columns: &[[f64; N]; D], place: usize) -> Vector<D> {
    let mut result = [0.0; D];
    for d in 0..D {
        result[d] = columns[d][place];
    }
    result
}

/// `factor · a`.
#[inline(always)]
pub fn scaled<const D: usize>(factor: f64, a: Vector<D>) -> Vector<D> {
    let mut result = [0.0; D];
    for d in 0..D {
        result[d] = factor * a[d];
    }
    result
}

/// `Σ a_d b_d`.
#[inline(always)]
pub fn dot<const D: usize>(a: Vector<D>, b: Vector<D>) -> f64 {
    let mut total = a[0] * b[0];
    for d in 1..D {
        total += a[d] * b[d];
    }
    total
}

/// Length of a vector.
#[inline(always)]
pub fn norm<const D: usize>(a: Vector<D>) -> f64 {
    dot(a, a).sqrt()
}

/// The larger of two numbers; NaN if either is NaN (`f64::max` would drop it).
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// The largest `|a_k − b_k|²` of two columns of vectors; NaN if any is NaN.
pub fn longest_difference_squared<const D: usize>(a: &[Vector<D>], b: &[Vector<D>]) -> f64 {
    processor::dispatch(LongestDifference { a, b })
}

struct LongestDifference<'a, const D: usize> {
    a: &'a [Vector<D>],
    b: &'a [Vector<D>],
}

impl<const D: usize> pulp::WithSimd for LongestDifference<'_, D> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) -> f64 {
        const PIECE: usize = 64;
        let mut squares = [0.0; PIECE];
        // A NaN is lost by the comparisons but not by the sums.
        let (mut most, mut total) = ([0.0; PIECE], [0.0; PIECE]);
        for (a, b) in self.a.chunks(PIECE).zip(self.b.chunks(PIECE)) {
            for (square, (&a, &b)) in squares.iter_mut().zip(a.iter().zip(b)) {
                *square = dot(difference(a, b), difference(a, b));
            }
            for ((most, total), &square) in most.iter_mut().zip(&mut total).zip(&squares[..a.len()]) {
                *total += square;
                *most = if square > *most { square } else { *most };
            }
        }
        if total.iter().any(|total| total.is_nan()) { f64::NAN } else { most.into_iter().fold(0.0, larger) }
    }
}

/// `a + b` without error: the rounded sum and the rounding error.
///
/// # Source
/// Knuth, The Art of Computer Programming, vol. 2, §4.2.2, theorem B.
#[inline(always)]
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let high = a + b;
    let b_part = high - a;
    (high, (a - (high - b_part)) + (b - b_part))
}

/// The sum `(a_high + a_low) + b` as a rounded sum and its remainder; the error is below 2⁻¹⁰⁴ of the result.
#[inline(always)]
pub fn extended_sum(a: (f64, f64), b: f64) -> (f64, f64) {
    let (high, low) = two_sum(a.0, b);
    let (high, low) = two_sum(high, low + a.1);
    (high, low)
}

/// `a · b` without error: the rounded product and the rounding error (no overflow for |a|, |b| < 2⁹⁹⁵).
///
/// # Source
/// Dekker (1971), Numer. Math. 18, 224 (no fused operation needed, so the same bits everywhere).
#[inline(always)]
pub fn two_product(a: f64, b: f64) -> (f64, f64) {
    // 2²⁷ + 1 splits 53 bits in two halves.
    const SPLIT: f64 = 134_217_729.0;
    let halves = |x: f64| {
        let shifted = SPLIT * x;
        let high = shifted - (shifted - x);
        (high, x - high)
    };
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    let high = a * b;
    (high, ((a_high * b_high - high) + a_high * b_low + a_low * b_high) + a_low * b_low)
}

/// Length of the unevaluated sum of two vectors, as a rounded number and its remainder; the error is below 2⁻¹⁰⁰ of it.
pub fn extended_norm<const D: usize>(high: Vector<D>, low: Vector<D>) -> (f64, f64) {
    let mut square = (0.0, 0.0);
    for d in 0..D {
        let (product, rest) = two_product(high[d], high[d]);
        let (total, lost) = two_sum(square.0, product);
        square = two_sum(total, square.1 + (lost + rest + 2.0 * high[d] * low[d]));
    }
    let root = square.0.sqrt();
    let (product, rest) = two_product(root, root);
    // One Newton step for the root, with the residual computed without cancellation; no branch, so that loops can be
    // vectorised.
    let step = ((square.0 - product) - rest + square.1) / (2.0 * root);
    two_sum(root, if root == 0.0 { 0.0 } else { step })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_sum_keeps_what_rounding_takes() {
        // 2⁻⁶⁰ is far below half an ulp of 1 (2⁻⁵³).
        let tiny = (-60f64).exp2();
        assert_eq!(two_sum(1.0, tiny), (1.0, tiny));
        assert_eq!(two_sum(tiny, 1.0), (1.0, tiny));
    }

    #[test]
    fn extended_norm_is_right_to_twice_the_digits() {
        // (1 + ε)² + 0 = the square of an unevaluated sum; and 3-4-5 with a low part: |(3 + e, 4)| = 5 + 3e/5 + O(e²).
        let tiny = (-70f64).exp2();
        assert_eq!(extended_norm([1.0, 0.0], [tiny, 0.0]), (1.0, tiny));
        let (high, low) = extended_norm([3.0, 4.0], [tiny, 0.0]);
        assert_eq!(high, 5.0);
        assert!((low / (0.6 * tiny) - 1.0).abs() < 1e-12);
        // √2 to 32 digits: 1.41421356237309504880168872420969807.
        let (high, low) = extended_norm([1.0, 1.0], [0.0, 0.0]);
        assert_eq!(high, std::f64::consts::SQRT_2);
        assert!((low - -9.667_293_313_452_913e-17).abs() < 1e-31);
    }

    #[test]
    fn larger_keeps_nan_from_either_side() {
        assert!(larger(f64::NAN, 1.0).is_nan());
        assert!(larger(1.0, f64::NAN).is_nan());
        assert_eq!(larger(1.0, 2.0), 2.0);
    }
}
