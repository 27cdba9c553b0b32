//! Vectors of D = 2 or 3 components and the error-free sums that positions need.
//!
//! A position is kept as an unevaluated sum `high + low` of two vectors, so that the distance of two touching disks is
//! known to the rounding of the distance itself (2·10⁻¹⁶), not to that of the side of the box (10⁻¹⁴ and more).

/// A vector of D components.
pub type Vector<const D: usize> = [f64; D];

/// `a + b`, component by component.
#[inline(always)]
pub fn sum<const D: usize>(a: Vector<D>, b: Vector<D>) -> Vector<D> {
    std::array::from_fn(|d| a[d] + b[d])
}

/// `a − b`, component by component.
#[inline(always)]
pub fn difference<const D: usize>(a: Vector<D>, b: Vector<D>) -> Vector<D> {
    std::array::from_fn(|d| a[d] - b[d])
}

/// `factor · a`.
#[inline(always)]
pub fn scaled<const D: usize>(factor: f64, a: Vector<D>) -> Vector<D> {
    std::array::from_fn(|d| factor * a[d])
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

/// The larger of two numbers, NaN if either is one (`f64::max` would drop it).
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// `a + b` without error: the rounded sum and what rounding took away.
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
    fn larger_keeps_nan_from_either_side() {
        assert!(larger(f64::NAN, 1.0).is_nan());
        assert!(larger(1.0, f64::NAN).is_nan());
        assert_eq!(larger(1.0, 2.0), 2.0);
    }
}
